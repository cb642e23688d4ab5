"""Where the cameras stood, from corners and a map: planar poses for a start, then all corners of a moment; and the least error that any map
of the same tags leaves."""
import numpy as np

from recorded_views import CAUCHY_PX, MAX_PROPOSERS, UNIT_CORNERS, by_motion, by_point, corners_of, damped, errors_px, exp, fitted, moved, sum_by

ROUNDS, TRIAL_ITERATIONS = 40, 12


def turned_to(direction):
    """(V, 3, 3) that take `direction` to z."""
    z = direction / np.linalg.norm(direction, axis=-1, keepdims=True)
    x = np.cross(np.where(np.abs(z[:, 1:2]) < 0.9, [[0.0, 1, 0]], [[1.0, 0, 0]]), z)
    x /= np.linalg.norm(x, axis=-1, keepdims=True)
    return np.stack([x, np.cross(z, x), z], 1)


def planar_poses(rays, sizes):
    """T_camera_tag (2, V, 4, 4) by the homography of four rays (V, 4, 3), and its mirror image about the line of sight."""
    R_turned_camera = turned_to(rays.mean(1))
    rays = np.einsum("vij,vkj->vki", R_turned_camera, rays)
    target = rays[..., :2] / rays[..., 2:]
    X = np.broadcast_to(UNIT_CORNERS[:, :2] * np.asarray(sizes)[:, None, None], target.shape)
    rows = []
    for axis in range(2):
        row = np.zeros((*X.shape[:2], 8))
        row[..., 3 * axis:3 * axis + 2], row[..., 3 * axis + 2] = X, 1
        row[..., 6:] = -target[..., axis:axis + 1] * X
        rows.append(row)
    h = np.linalg.solve(np.concatenate(rows, 1), np.concatenate([target[..., 0], target[..., 1]], 1)[..., None])[..., 0]
    H = np.concatenate([h, np.ones((len(h), 1))], 1).reshape(-1, 3, 3)
    H = H / np.linalg.norm(H[..., :2], axis=1).mean(1)[:, None, None]
    U, _, Vt = np.linalg.svd(np.stack([H[..., 0], H[..., 1], np.cross(H[..., 0], H[..., 1])], -1))
    R, t = U @ Vt, H[..., 2]
    sight = t / np.linalg.norm(t, axis=-1, keepdims=True)
    mirror = np.eye(3) - 2 * sight[:, :, None] * sight[:, None, :]
    first = mirror @ R[..., :2]
    flipped = np.concatenate([first, np.cross(first[..., 0], first[..., 1])[..., None]], -1)
    result = np.tile(np.eye(4), (2, len(t), 1, 1))
    for one, rotation in zip(result, (R, flipped)):
        one[:, :3, :3] = R_turned_camera.swapaxes(1, 2) @ rotation
        one[:, :3, 3] = np.einsum("vji,vj->vi", R_turned_camera, t)
    return result


def proposals(rig, views, sizes, T_map_tag):
    """T_rig_map (2, V, 4, 4) that each view alone proposes."""
    result = np.tile(np.eye(4), (2, len(views.tag), 1, 1))
    for index, lens in enumerate(rig.values()):
        mine = views.camera == index
        if mine.any():
            tag = views.tag[mine]
            T_camera_tag = planar_poses(lens.rays(views.pixels[mine]), sizes[tag])
            result[:, mine] = np.linalg.inv(lens.T_camera_rig) @ T_camera_tag @ np.linalg.inv(T_map_tag[tag])
    return result


def solved(rig, views, sizes, T_map_tag):
    """T_rig_map of each moment: the best, with Cauchy's loss, of those to which its largest tags' planar poses lead."""
    corners, proposed = corners_of(sizes, T_map_tag), proposals(rig, views, sizes, T_map_tag)
    area = np.linalg.norm(views.pixels[:, 2] - views.pixels[:, 0], axis=-1) * np.linalg.norm(views.pixels[:, 3] - views.pixels[:, 1], axis=-1)
    number = views.moment.max() + 1
    order = np.lexsort((-area, views.moment))
    begin = np.searchsorted(views.moment, np.arange(number + 1))
    best, least = np.tile(np.eye(4), (number, 1, 1)), np.full(number, np.inf)
    for rank in range(MAX_PROPOSERS):
        has = begin[:-1] + rank < begin[1:]
        proposer = order[np.where(has, begin[:-1] + rank, begin[:-1])]
        for one in proposed:
            poses, cost = fitted(rig, views, corners, one[proposer], CAUCHY_PX, TRIAL_ITERATIONS)
            is_better = has & (cost < least)
            best[is_better], least[is_better] = poses[is_better], cost[is_better]
    return fitted(rig, views, corners, best, CAUCHY_PX)[0]


def least_squares(rig, views, sizes, T_map_tag, poses):
    """Plain adjustment of tags and poses together, the first tag held: T_map_tag, poses. What it leaves no map of these tags undercuts."""
    T_map_tag, poses, tags, number = T_map_tag.copy(), poses.copy(), len(sizes), len(poses)
    damping, free = 1e-3, slice(6, None)
    off = errors_px(rig, views, corners_of(sizes, T_map_tag), poses)
    for _ in range(ROUNDS):
        points = moved(poses[views.moment], corners_of(sizes, T_map_tag)[views.tag])
        pixel = by_point(rig, views.camera, points)
        Jf = pixel @ by_motion(points)
        local = np.broadcast_to(UNIT_CORNERS * sizes[views.tag][:, None, None], points.shape)
        R = (poses[views.moment] @ T_map_tag[views.tag])[:, None, :3, :3]
        Jt = pixel @ R @ by_motion(local)
        product = lambda a, b: np.einsum("vkai,vkaj->vij", a, b)
        Hff, gf = sum_by(views.moment, product(Jf, Jf), number), sum_by(views.moment, np.einsum("vkai,vka->vi", Jf, off), number)
        Htt, gt = sum_by(views.tag, product(Jt, Jt), tags), sum_by(views.tag, np.einsum("vkai,vka->vi", Jt, off), tags)
        Htf = sum_by(views.moment * tags + views.tag, product(Jt, Jf), number * tags).reshape(number, 6 * tags, 6)
        weighted = Htf @ np.linalg.inv(damped(Hff, damping))
        S = -np.einsum("fij,fkj->ik", weighted, Htf)
        for i, block in enumerate(damped(Htt, damping)):
            S[6 * i:6 * i + 6, 6 * i:6 * i + 6] += block
        step = np.zeros(6 * tags)
        step[free] = -np.linalg.solve(S[free, free], (gt.ravel() - np.einsum("fij,fj->i", weighted, gf))[free])
        step_f = -np.linalg.solve(damped(Hff, damping), (gf + np.einsum("fji,j->fi", Htf, step))[..., None])[..., 0]
        tried_tags, tried_poses = T_map_tag @ exp(step.reshape(-1, 6)), exp(step_f) @ poses
        tried = errors_px(rig, views, corners_of(sizes, tried_tags), tried_poses)
        gain = (off**2).sum() - (tried**2).sum()
        if gain > 0:
            T_map_tag, poses, off = tried_tags, tried_poses, tried
        damping = np.clip(damping / 10 if gain > 0 else damping * 10, 1e-12, 1e8)
        if 0 < gain < 1e-10 * (off**2).sum():
            break
    return T_map_tag, poses
