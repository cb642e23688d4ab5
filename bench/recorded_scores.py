"""Maps of recorded tags against what is known of them: printed boards, a flat grid, another map of the same tags. Lengths in mm.

usage: tags = read_map(map.yaml); board_error(tags, layout); grid_error(tags, truth); halves_nees(first, second)
Needs python3-numpy and python3-yaml.
"""
from dataclasses import dataclass

import numpy as np
import yaml


@dataclass
class Tag:
    size_m: float
    T_map_tag: np.ndarray
    covariance: np.ndarray  # (6, 6), of the right perturbation, relative to the held tag; None where the map tells none


def rotation(x, y, z, w):
    x, y, z, w = np.array([x, y, z, w]) / np.linalg.norm([x, y, z, w])
    return np.array([[1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
                     [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
                     [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)]])


def read_map(path):
    """{(family, id): Tag}"""
    said, tags = yaml.load(open(path), Loader=getattr(yaml, "CSafeLoader", yaml.SafeLoader)), {}
    for tag in said["tags"]:
        T, place, covariance = np.eye(4), tag["pose"], tag.get("covariance")
        T[:3, :3] = rotation(**place["orientation"])
        T[:3, 3] = [place["position"][axis] for axis in "xyz"]
        key = (tag.get("family", said["default_family"]), tag["id"])
        tags[key] = Tag(tag["size"], T, None if covariance is None else np.reshape(covariance, (6, 6)).astype(float))
    return tags


def centres(tags, keys):
    return np.array([tags[key].T_map_tag[:3, 3] for key in keys])


def turn(target, points):
    """The rotation that takes centred points closest to a centred target."""
    U, _, Vt = np.linalg.svd(target.T @ points)
    return U @ np.diag([1, 1, np.linalg.det(U @ Vt)]) @ Vt


def aligned(target, points, with_scale=False):
    """Points moved onto the target, with or without a scale: (points, scale that they were multiplied with)."""
    a, b = target - target.mean(0), points - points.mean(0)
    b = b @ turn(a, b).T
    scale = (a * b).sum() / (b * b).sum() if with_scale else 1.0
    return target.mean(0) + scale * b, scale


def rms(values):
    """Of vectors' lengths, or of numbers."""
    values = np.asarray(values)
    return float(np.sqrt((values**2).sum(-1).mean() if values.ndim > 1 else (values**2).mean()))


@dataclass
class BoardError:
    rms_mm: float  # of tag centres in space, every board aligned by itself, all scaled alike
    in_plane_mm: float
    out_of_plane_mm: float  # each board's about the plane of its layout
    scale: float  # of the map over the layout
    tags: int
    by_board: dict


def board_error(tags, layout, family="tag36h11"):
    """layout: {board: {id: [metres right, metres up]}}; boards of which three tags are there count."""
    pairs = {}
    for board, places in layout.items():
        if len(known := [number for number in places if (family, number) in tags]) >= 3:
            printed = np.array([[places[number][0], -places[number][1], 0.0] for number in known])
            seen = centres(tags, [(family, number) for number in known])
            printed, seen = printed - printed.mean(0), seen - seen.mean(0)
            pairs[board] = (printed, seen @ turn(printed, seen).T)
    scale = sum((p * s).sum() for p, s in pairs.values()) / sum((p * p).sum() for p, _ in pairs.values())
    off = {board: 1e3 * (seen / scale - printed) for board, (printed, seen) in pairs.items()}
    together = np.concatenate(list(off.values()))
    return BoardError(rms(together), rms(together[:, :2]), rms(together[:, 2]), float(scale), len(together),
                      {board: rms(values) for board, values in off.items()})


@dataclass
class GridError:
    rms_mm: float  # of tag centres in space after rigid alignment
    scaled_rms_mm: float  # after alignment with a scale
    scale: float  # of the map over the truth
    bow_mm: np.ndarray  # (N,) out of the plane of the grid, towards its back (along the tags' z), after alignment
    bow_of_fit_mm: np.ndarray  # (N,) the second-order surface through them
    tags: int


def grid_error(tags, truth):
    """Against a flat printed grid, whose tags lie in the plane z = 0."""
    keys = sorted(set(tags) & set(truth))
    printed, seen = centres(truth, keys), centres(tags, keys)
    plain, scaled = aligned(printed, seen)[0] - printed, aligned(printed, seen, True)
    x, y = ((printed - printed.mean(0)) / np.ptp(printed, 0).max())[:, :2].T
    surface = np.stack([np.ones_like(x), x, y, x * x, x * y, y * y], -1)
    bow = 1e3 * plain[:, 2]
    return GridError(1e3 * rms(plain), 1e3 * rms(scaled[0] - printed), 1 / scaled[1], bow, surface @ np.linalg.lstsq(surface, bow, rcond=None)[0],
                     len(keys))


def log_rotation(R):
    angle = np.arccos(np.clip((np.trace(R) - 1) / 2, -1, 1))
    return (0.5 if angle < 1e-6 else angle / (2 * np.sin(angle))) * np.array([R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1]])


def held_tag(tags):
    """The tag that the gauge holds: its covariance is all zero."""
    held = [key for key, tag in tags.items() if tag.covariance is not None and not tag.covariance.any()]
    if len(held) != 1:
        raise ValueError(f"a map with one held tag is needed, and this one has {len(held)}")
    return held[0]


def halves_nees(first, second):
    """Of two maps that hold the same tag and share no observation: {key: squared difference by the sum of both covariances, over 6}."""
    held = held_tag(first)
    if held_tag(second) != held:
        raise ValueError(f"the two maps hold {held} and {held_tag(second)}: hold the same")
    result = {}
    for key in sorted(set(first) & set(second) - {held}):
        in_first, in_second = (np.linalg.inv(tags[held].T_map_tag) @ tags[key].T_map_tag for tags in (first, second))
        D = np.linalg.inv(in_first) @ in_second
        xi = np.concatenate([D[:3, 3], log_rotation(D[:3, :3])])
        result[key] = float(xi @ np.linalg.solve(first[key].covariance + second[key].covariance, xi)) / 6
    return result


def distance(tags, a, b):
    """(mm, sigma in mm) between two tags' centres, one of them the held one."""
    free, other = (a, b) if held_tag(tags) == b else (b, a)
    between = tags[free].T_map_tag[:3, 3] - tags[other].T_map_tag[:3, 3]
    length = np.linalg.norm(between)
    along_tag = tags[free].T_map_tag[:3, :3].T @ between / length
    return 1e3 * float(length), 1e3 * float(np.sqrt(along_tag @ tags[free].covariance[:3, :3] @ along_tag))
