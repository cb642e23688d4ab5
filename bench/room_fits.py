"""How well one tag's views fit about a pose, where the cameras are known: Levenberg's method on errors whitened by edges.

usage: pose, chi_squared = room_fits.best_pose(room, views, T_world_tag, size)
"""
import numpy as np

import rooms

ITERATIONS = 30
OUTLIER_SIGMAS = 6.0


def angles_deg(A, B):
    cosine = (np.einsum("nij,nij->n", A[:, :3, :3], B[:, :3, :3]) - 1) / 2
    return np.degrees(np.arccos(np.clip(cosine, -1, 1)))


def whitened_errors(room, views, T_world_tag, size):
    """(V, 8): sums and differences of the errors at the ends of edges, normal to them, of variance 1."""
    local = rooms.UNIT_CORNERS * size @ T_world_tag[:3, :3].T + T_world_tag[:3, 3]
    T = room.T_camera_world[views.frame]
    errors = views.pixels - room.camera.project(np.einsum("vij,kj->vki", T[:, :3, :3], local) + T[:, None, :3, 3])
    along = np.roll(views.pixels, -1, 1) - views.pixels
    normal = np.stack([-along[..., 1], along[..., 0]], -1) / np.linalg.norm(along, axis=-1, keepdims=True)
    begin, end = (errors * normal).sum(-1), (np.roll(errors, -1, 1) * normal).sum(-1)
    rho, sigma = rooms.EDGE_END_CORRELATION, np.hypot(room.sigma_px, room.bias_px)
    return np.concatenate([(begin + end) / np.sqrt(2 * (1 + rho)), (begin - end) / np.sqrt(2 * (1 - rho))], 1) / sigma


def moved_by(T, xi):
    angle = np.linalg.norm(xi[3:])
    return T @ rooms.pose(rooms.rotation_about(xi[3:], angle) if angle > 0 else np.eye(3), xi[:3])


def best_pose(room, views, T, size):
    """(the best pose about T, its chi squared); derivatives by differences."""
    def residuals(pose):
        return np.nan_to_num(whitened_errors(room, views, pose, size).ravel(), nan=1e3)  # outside what the lens covers

    step, damping, r = 1e-6, 1e-3, residuals(T)
    for _ in range(ITERATIONS):
        J = np.stack([(residuals(moved_by(T, step * axis)) - r) / step for axis in np.eye(6)], 1)
        H = J.T @ J
        candidate = moved_by(T, np.linalg.solve(H + damping * np.diag(np.diag(H) + 1), -J.T @ r))
        r_new = residuals(candidate)
        if r_new @ r_new < r @ r:
            T, r, damping = candidate, r_new, damping / 5
        else:
            damping *= 5
    return T, float(r @ r)


def misfit(room, views, number, T_world_tag):
    """How much worse a tag's views fit about this pose than about the true one; views that are outliers there do not count.
    Infinite where they fit nowhere about this pose, but lead from it to the true one."""
    index = int(np.flatnonzero(room.ids == number)[0])
    true, size = room.T_world_tag[index], room.sizes[index]
    of_it = views.chosen(views.tag == index)
    of_it = of_it.chosen(np.abs(whitened_errors(room, of_it, true, size)).max(1) < OUTLIER_SIGMAS)
    if len(of_it.frame) == 0:
        return float("nan")
    true, least = best_pose(room, of_it, true, size)
    other, more = best_pose(room, of_it, T_world_tag, size)
    return float("inf") if angles_deg(true[None], other[None])[0] < 1 else more - least


def evidence(room, exact_views, index):
    """Of what is wrong about a tag, in sigmas: what no pose of it explains of its views, as they are without noise."""
    return best_pose(room, exact_views.chosen(exact_views.tag == index), room.T_world_tag[index], room.stated_sizes[index])[1]**0.5
