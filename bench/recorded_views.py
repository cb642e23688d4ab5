"""Recorded corners under a map that is held: cameras' poses solved anew, and what is left in pixels. None of the program's own code.

usage: rig = read_rig(camera.yaml); views, times_ns = read_views(detections.csv, rig, keys); corners = corners_of(sizes, T_map_tag)
       poses, cost = fitted(rig, views, corners, start); errors_px(rig, views, corners, poses)   (V, 4, 2)

Pixels, frames, corner order and files: docs/conventions.md, docs/file_formats.md. Poses are T_rig_map of each moment: cameras with equal time
stamps share it. Needs python3-numpy and python3-yaml.
"""
import csv
from dataclasses import dataclass, replace

import numpy as np
import yaml

UNIT_CORNERS = np.array([[-1.0, 1, 0], [1, 1, 0], [1, -1, 0], [-1, -1, 0]]) / 2
CAUCHY_PX = 1.0  # poses are first solved robustly at this scale: views may be far off
MAX_PROPOSERS = 4  # tags of a moment, the largest ones, whose two planar poses are tried
MAX_ITERATIONS = 60
TOLERANCE = 1e-10  # of the cost: what a step gains at the end
UNSEEN_PX = 1e3  # error of a corner that no lens projects
MIN_DEPTH = 1e-6


@dataclass
class Lens:
    intrinsics: np.ndarray  # fx fy cx cy
    model: str  # none, radtan or equidistant
    coefficients: np.ndarray
    T_camera_rig: np.ndarray

    def distort(self, rays):
        """Where rays (..., 3) lie in the picture before focal length and centre; NaN behind a camera that is no fisheye."""
        x, y, z = np.moveaxis(rays, -1, 0)
        if self.model == "equidistant":
            radius = np.hypot(x, y)
            theta = np.arctan2(radius, z)
            bent = theta * (1 + sum(k * theta**(2 * i + 2) for i, k in enumerate(self.coefficients)))
            factor = np.where(radius > 0, bent / np.maximum(radius, 1e-15), 1 / np.maximum(z, MIN_DEPTH))
            return np.stack([x * factor, y * factor], -1)
        z = np.where(z > MIN_DEPTH, z, np.nan)
        x, y = x / z, y / z
        r2 = x * x + y * y
        k1, k2, p1, p2, k3, k4, k5, k6 = np.pad(self.coefficients, (0, 8 - len(self.coefficients)))
        radial = (1 + r2 * (k1 + r2 * (k2 + r2 * k3))) / (1 + r2 * (k4 + r2 * (k5 + r2 * k6)))
        return np.stack([x * radial + 2 * p1 * x * y + p2 * (r2 + 2 * x * x), y * radial + p1 * (r2 + 2 * y * y) + 2 * p2 * x * y], -1)

    def project(self, points):
        return self.distort(points) * self.intrinsics[:2] + self.intrinsics[2:]

    def rays(self, pixels):
        """Unit rays (..., 3) of pixels, by Newton on the direction; good to what is needed for a start."""
        target = (pixels - self.intrinsics[2:]) / self.intrinsics[:2]
        angle = np.linalg.norm(target, axis=-1, keepdims=True)
        rays = np.concatenate([target, np.ones_like(angle)], -1)
        if self.model == "equidistant":
            rays = np.concatenate([target / np.maximum(angle, 1e-15) * np.sin(angle), np.cos(angle)], -1)
        for _ in range(12):
            rays = rays / np.linalg.norm(rays, axis=-1, keepdims=True)
            off = target - self.distort(rays)
            by_ray = derivative(self.distort, rays)
            rays = rays + np.einsum("...ij,...j->...i", np.linalg.pinv(np.nan_to_num(by_ray)), np.nan_to_num(off))
        return rays / np.linalg.norm(rays, axis=-1, keepdims=True)


@dataclass
class Views:
    """Tags in moments, in the order of the moments."""
    moment: np.ndarray  # (V,) index of the time
    camera: np.ndarray  # (V,) index into the rig
    tag: np.ndarray  # (V,) index into the keys
    pixels: np.ndarray  # (V, 4, 2)

    def chosen(self, which):
        return replace(self, moment=self.moment[which], camera=self.camera[which], tag=self.tag[which], pixels=self.pixels[which])

    def without_edge_offset(self, offsets_px):
        """The detector's edges, so far inside the true ones (by camera), moved there."""
        along = np.roll(self.pixels, -1, 1) - self.pixels
        along /= np.linalg.norm(along, axis=-1, keepdims=True)
        outward = np.stack([-along[..., 1], along[..., 0]], -1)
        meeting = np.stack([outward, np.roll(outward, 1, 1)], -2)
        by = np.broadcast_to(np.asarray(offsets_px, float)[self.camera][:, None, None, None], (*self.pixels.shape, 1))
        return replace(self, pixels=self.pixels + np.linalg.solve(meeting, by)[..., 0])


def derivative(function, points, step=1e-6):
    """(..., 2, 3) by central differences."""
    size = step * np.linalg.norm(points, axis=-1, keepdims=True)
    return np.stack([(function(points + size * e) - function(points - size * e)) / (2 * size) for e in np.eye(3)], -1)


def read_rig(path):
    """{name: Lens}, in the order of the file."""
    T_camera_rig, rig = np.eye(4), {}
    for name, said in yaml.safe_load(open(path)).items():
        if name.startswith("cam"):
            T_camera_rig = np.array(said["T_cn_cnm1"]) @ T_camera_rig if "T_cn_cnm1" in said else np.eye(4)
            model = said.get("distortion_model", "none")
            rig[name] = Lens(np.array(said["intrinsics"], float), model, np.array(said.get("distortion_coeffs") or [], float), T_camera_rig)
    return rig


def read_views(path, rig, keys):
    """Of the tags named in keys, [(family, id), ...], by the cameras named in rig; (Views, time stamps in ns)."""
    cameras, tags = list(rig), {key: i for i, key in enumerate(keys)}
    rows = [row for row in csv.DictReader(open(path)) if (row["family"], int(row["id"])) in tags]
    times, moment = np.unique([int(row["timestamp_ns"]) for row in rows], return_inverse=True)
    pixels = np.array([[float(row[f"c{i}{axis}"]) for i in range(4) for axis in "xy"] for row in rows]).reshape(-1, 4, 2)
    views = Views(moment, np.array([cameras.index(row["camera"]) for row in rows]),
                  np.array([tags[row["family"], int(row["id"])] for row in rows]), pixels)
    return views.chosen(np.argsort(moment, kind="stable")), times


def write_views(path, views, times_ns, rig, keys):
    cameras = list(rig)
    with open(path, "w") as file:
        file.write("timestamp_ns,camera,family,id,c0x,c0y,c1x,c1y,c2x,c2y,c3x,c3y\n")
        for moment, camera, tag, pixels in zip(views.moment, views.camera, views.tag, views.pixels):
            family, number = keys[tag]
            file.write(f"{times_ns[moment]},{cameras[camera]},{family},{number}," + ",".join(f"{v:.6f}" for v in pixels.ravel()) + "\n")


def corners_of(sizes, T_map_tag):
    """(N, 4, 3) in the map's frame."""
    local = UNIT_CORNERS[None] * np.asarray(sizes)[:, None, None]
    return np.einsum("nij,nkj->nki", T_map_tag[:, :3, :3], local) + T_map_tag[:, None, :3, 3]


def moved(T, points):
    return np.einsum("vij,vkj->vki", T[:, :3, :3], points) + T[:, None, :3, 3]


def per_camera(rig, camera, points_rig, function, shape):
    result = np.full((*points_rig.shape[:2], *shape), np.nan)
    for index, lens in enumerate(rig.values()):
        mine = camera == index
        if mine.any():
            result[mine] = function(lens, moved(np.broadcast_to(lens.T_camera_rig, (mine.sum(), 4, 4)), points_rig[mine]))
    return result


def projected(rig, camera, points_rig):
    return per_camera(rig, camera, points_rig, lambda lens, points: lens.project(points), (2,))


def by_point(rig, camera, points_rig):
    """(V, 4, 2, 3): pixels by points in the rig's frame."""
    of_lens = lambda lens, points: derivative(lens.project, points) @ lens.T_camera_rig[:3, :3]
    return np.nan_to_num(per_camera(rig, camera, points_rig, of_lens, (2, 3)))


def cross_matrix(v):
    x, y, z = np.moveaxis(v, -1, 0)
    zero = np.zeros_like(x)
    return np.stack([np.stack([zero, -z, y], -1), np.stack([z, zero, -x], -1), np.stack([-y, x, zero], -1)], -2)


def exp(xi):
    """(..., 4, 4) of [translation; rotation]; the translation is taken as it is."""
    T = np.zeros((*xi.shape[:-1], 4, 4))
    angle = np.linalg.norm(xi[..., 3:], axis=-1)[..., None, None]
    K = cross_matrix(xi[..., 3:])
    T[..., :3, :3] = np.eye(3) + np.sinc(angle / np.pi) * K + 0.5 * np.sinc(angle / 2 / np.pi)**2 * K @ K
    T[..., :3, 3], T[..., 3, 3] = xi[..., :3], 1
    return T


def by_motion(points):
    """(..., 3, 6): of points whose frame moves by Exp of [translation; rotation] from the left."""
    return np.concatenate([np.broadcast_to(np.eye(3), (*points.shape, 3)), -cross_matrix(points)], -1)


def damped(H, damping):
    return H + np.eye(6) * (np.reshape(damping, (-1, 1)) * np.einsum("pii->pi", H) + 1e-12)[:, None]


def errors_px(rig, views, corners, poses):
    """(V, 4, 2), UNSEEN_PX where nothing can be projected. corners: (N, 4, 3) of the tags; poses: T_rig_map of the moments."""
    off = projected(rig, views.camera, moved(poses[views.moment], corners[views.tag])) - views.pixels
    return np.where(np.isfinite(off), off, UNSEEN_PX)


def cost_of(off, scale_px):
    squared = (off**2).sum(-1)
    return (squared if scale_px is None else scale_px**2 * np.log1p(squared / scale_px**2)).sum(-1)


def sum_by(index, values, number):
    result = np.zeros((number, *values.shape[1:]))
    np.add.at(result, index, values)
    return result


def fitted(rig, views, corners, poses, scale_px=None, iterations=MAX_ITERATIONS):
    """Levenberg-Marquardt of each pose over all of its corners, plain or with Cauchy's loss: (poses, cost of each)."""
    poses, number = poses.copy(), len(poses)
    damping, is_open = np.full(number, 1e-3), np.ones(number, bool)
    cost = sum_by(views.moment, cost_of(errors_px(rig, views, corners, poses), scale_px), number)
    for _ in range(iterations):
        mine = views.chosen(is_open[views.moment])
        off = errors_px(rig, mine, corners, poses)
        points = moved(poses[mine.moment], corners[mine.tag])
        J = by_point(rig, mine.camera, points) @ by_motion(points)
        weight = np.ones(off.shape[:2]) if scale_px is None else 1 / (1 + (off**2).sum(-1) / scale_px**2)
        H = sum_by(mine.moment, np.einsum("vk,vkai,vkaj->vij", weight, J, J), number)
        g = sum_by(mine.moment, np.einsum("vk,vkai,vka->vi", weight, J, off), number)
        tried = exp(-np.linalg.solve(damped(H, damping), g[..., None])[..., 0]) @ poses
        tried_cost = sum_by(mine.moment, cost_of(errors_px(rig, mine, corners, tried), scale_px), number)
        is_better = is_open & (tried_cost < cost)
        is_settled = np.where(is_better, cost - tried_cost < TOLERANCE * cost, damping > 1e4) | (cost < 1e-20)
        poses[is_better], cost[is_better] = tried[is_better], tried_cost[is_better]
        damping = np.where(is_better, damping / 10, damping * 10).clip(1e-12, 1e8)
        is_open &= ~is_settled
        if not is_open.any():
            break
    return poses, cost
