"""How well a map without a fault explains what is seen of one with a fault: all poses free, of tags and of frames, as no calibration knows
more. Levenberg's method on errors whitened by edges, frames eliminated.

usage: sigmas = room_maps.evidence(room, exact_views)
"""
from dataclasses import replace

import numpy as np

import rooms

ITERATIONS = 60
LEAST_GAIN = 1e-4
LOST = 100.0  # a whitened error of a corner that the lens does not cover


def rotations_by(vectors):
    """(N, 3, 3) of rotation vectors (N, 3)."""
    angle = np.linalg.norm(vectors, axis=1)[:, None, None]
    x, y, z = vectors.T
    zero = np.zeros_like(x)
    K = np.stack([zero, -z, y, z, zero, -x, -y, x, zero], 1).reshape(-1, 3, 3)
    a = np.where(angle > 1e-9, np.sin(angle) / np.maximum(angle, 1e-9), 1.0)
    b = np.where(angle > 1e-9, (1 - np.cos(angle)) / np.maximum(angle, 1e-9)**2, 0.5)
    return np.eye(3) + a * K + b * K @ K


def moved(T, xi):
    """Poses (N, 4, 4), perturbed on the right by [translation; rotation]."""
    step = np.tile(np.eye(4), (len(T), 1, 1))
    step[:, :3, :3], step[:, :3, 3] = rotations_by(xi[:, 3:]), xi[:, :3]
    return T @ step


def whitened_errors(room, views, T_camera_tag):
    """(V, 8), as room_fits has them of one tag."""
    local = rooms.UNIT_CORNERS * room.stated_sizes[views.tag][:, None, None]
    points = np.einsum("vij,vkj->vki", T_camera_tag[:, :3, :3], local) + T_camera_tag[:, None, :3, 3]
    errors = views.pixels - room.camera.project(points)
    along = np.roll(views.pixels, -1, 1) - views.pixels
    normal = np.stack([-along[..., 1], along[..., 0]], -1) / np.linalg.norm(along, axis=-1, keepdims=True)
    begin, end = (errors * normal).sum(-1), (np.roll(errors, -1, 1) * normal).sum(-1)
    rho, sigma = rooms.EDGE_END_CORRELATION, np.hypot(room.sigma_px, room.bias_px)
    u, v = (begin + end) / np.sqrt(2 * (1 + rho)), (begin - end) / np.sqrt(2 * (1 - rho))
    return np.nan_to_num(np.concatenate([u, v], 1) / sigma, nan=LOST)


class Map:
    """Poses of all frames and tags; which explain `views`."""

    def __init__(self, room, views):
        self.room = room
        self.views = replace(views, tag=np.array([np.flatnonzero(room.ids == number)[0] for number in room.ids])[views.tag])
        self.frame = np.unique(views.frame, return_inverse=True)[1]
        self.T_world_camera = np.linalg.inv(room.T_camera_world)[np.unique(views.frame)]
        self.T_world_tag = np.array(room.T_world_tag)

    def errors(self, frames, tags):
        return whitened_errors(self.room, self.views, np.linalg.inv(frames)[self.frame] @ tags[self.views.tag])

    def derivatives(self, step=1e-6):
        """(V, 8, 6) by the frames and by the tags."""
        here = self.errors(self.T_world_camera, self.T_world_tag)
        by_frame, by_tag = [], []
        for axis in step * np.eye(6):
            by_frame.append((self.errors(moved(self.T_world_camera, np.tile(axis, (len(self.T_world_camera), 1))), self.T_world_tag) - here) / step)
            by_tag.append((self.errors(self.T_world_camera, moved(self.T_world_tag, np.tile(axis, (len(self.T_world_tag), 1)))) - here) / step)
        return here, np.stack(by_frame, -1), np.stack(by_tag, -1)

    def steps(self, here, by_frame, by_tag, damping):
        """Of the frames and the tags; the damping holds the gauge."""
        F, T = len(self.T_world_camera), len(self.T_world_tag)
        Hff, Htt, gf, gt = np.zeros((F, 6, 6)), np.zeros((T, 6, 6)), np.zeros((F, 6)), np.zeros((T, 6))
        np.add.at(Hff, self.frame, np.einsum("vri,vrj->vij", by_frame, by_frame))
        np.add.at(Htt, self.views.tag, np.einsum("vri,vrj->vij", by_tag, by_tag))
        np.add.at(gf, self.frame, np.einsum("vri,vr->vi", by_frame, here))
        np.add.at(gt, self.views.tag, np.einsum("vri,vr->vi", by_tag, here))
        for H in (Hff, Htt):
            H += damping * np.einsum("nij,ij->nij", H, np.eye(6)) + 1e-6 * np.eye(6)
        inverse = np.linalg.inv(Hff)
        coupling = np.zeros((F, 6, T, 6))
        np.add.at(coupling, (self.frame, slice(None), self.views.tag), np.einsum("vri,vrj->vij", by_frame, by_tag))
        coupling = coupling.reshape(F, 6, 6 * T)
        S = np.zeros((6 * T, 6 * T))
        for t in range(T):
            S[6 * t:6 * t + 6, 6 * t:6 * t + 6] = Htt[t]
        S -= np.einsum("fia,fij,fjb->ab", coupling, inverse, coupling, optimize=True)
        tags = np.linalg.solve(S, -(gt.ravel() - np.einsum("fia,fij,fj->a", coupling, inverse, gf, optimize=True)))
        frames = np.einsum("fij,fj->fi", inverse, -gf - coupling @ tags)
        return frames, tags.reshape(T, 6)

    def settle(self):
        """The least chi squared about here."""
        damping, least = 1e-3, np.inf
        for _ in range(ITERATIONS):
            here, by_frame, by_tag = self.derivatives()
            least = (here**2).sum()
            while damping < 1e8:
                frame_steps, tag_steps = self.steps(here, by_frame, by_tag, damping)
                frames, tags = moved(self.T_world_camera, frame_steps), moved(self.T_world_tag, tag_steps)
                found = (self.errors(frames, tags)**2).sum()
                if found < least:
                    break
                damping *= 10
            else:
                return least
            self.T_world_camera, self.T_world_tag, damping = frames, tags, damping / 10
            if least - found < LEAST_GAIN * least + 1e-3:
                return found
        return least


def as_if_at_the_first(room, views, first, second):
    """The map as one sees it who takes the second copy of an id for the first: frames that show the second alone, and tags seen in such frames
    only, lie about the first."""
    found = Map(room, views)
    frames = np.unique(views.frame)
    shows = views.counts(len(room.times_ns), len(room.ids))[frames]
    moves = shows[:, second] & ~shows[:, first]
    change = room.T_world_tag[first] @ np.linalg.inv(room.T_world_tag[second])
    found.T_world_camera[moves] = change @ found.T_world_camera[moves]
    hangs = shows[moves].any(0) & ~shows[~moves].any(0)
    found.T_world_tag[hangs] = change @ found.T_world_tag[hangs]
    return found


def evidence(room, exact_views):
    """In sigmas: what no map without a fault explains of the views, as they are without noise. From the truth; of an id that hangs twice, also
    from where either copy is taken for the other."""
    starts = [Map(room, exact_views)]
    numbers, counts = np.unique(room.ids, return_counts=True)
    for number in numbers[counts > 1]:
        first, second = np.flatnonzero(room.ids == number)
        starts += [as_if_at_the_first(room, exact_views, first, second), as_if_at_the_first(room, exact_views, second, first)]
    return float(min(start.settle() for start in starts))**0.5
