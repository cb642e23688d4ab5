"""Random rooms of tags and what a hand-held camera sees of them, made without any of the program's own code: corners, no images.

usage: room = rooms.random_room(numpy.random.default_rng(7)); rooms.write(room, rooms.noisy(room, rooms.see(room), rng), folder)
       bench/make_room --kind clean --seed 7 --output FOLDER   (the same from the command line, faults included)

A room measures 2.5 to 8 m and has 6 to 20 tags of 0.08 to 0.2 m: in groups and alone, on walls, floor, ceiling and a table, some on boards
that stand anyhow; every edge may be up. The camera (VGA to 1280 x 1024, radtan or equidistant) is led on a smooth path past places from
which two tags or more are in view. A tag is seen from its front, under less than 75 degrees, whole, with edges of 12 px at least, in 19 of
20 such frames. Corners err as docs/algorithms/calibration.md says: normal to the edges, the two ends of an edge correlated; and by a bias
that a tag keeps in all of its views. Everything follows from the random generator alone. Needs python3-numpy.
"""
from dataclasses import dataclass, replace

import numpy as np

UNIT_CORNERS = np.array([[-1.0, 1, 0], [1, 1, 0], [1, -1, 0], [-1, -1, 0]]) / 2  # of a tag of 1 m, x right, y down, z into it
RESOLUTIONS = ((640, 480), (752, 480), (800, 600), (1024, 768), (1280, 720), (1280, 1024))
MIN_EDGE_PX, MAX_INCIDENCE_DEG, MARGIN_PX = 12.0, 75.0, 2.0
DETECTED_SHARE = 0.95
EDGE_END_CORRELATION = -0.45
MIN_SHARED_FRAMES, MIN_LINK_FRAMES = 8, 3
MAX_ATTEMPTS = 200
FRAMES_PER_GLANCE = 16
FAMILY, FAMILY_SIZE = "tag36h11", 587


@dataclass
class Camera:
    width: int
    height: int
    intrinsics: np.ndarray  # fx fy cx cy
    model: str  # radtan or equidistant
    coefficients: np.ndarray

    def distort(self, rays):
        """Of rays (..., 3); NaN outside what the lens covers."""
        x, y, z = np.moveaxis(rays, -1, 0)
        radius = np.hypot(x, y)
        if self.model == "equidistant":
            theta = np.arctan2(radius, z)
            theta_d = theta * (1 + sum(k * theta**(2 * i + 2) for i, k in enumerate(self.coefficients)))
            scale = np.where(radius > 0, theta_d / np.maximum(radius, 1e-12), 1 / np.maximum(z, 1e-12))
            return np.where((theta < self.limit())[..., None], rays[..., :2] * scale[..., None], np.nan)
        k1, k2, p1, p2 = self.coefficients
        z = np.where(z > 1e-6, z, np.nan)
        x, y, r2 = x / z, y / z, (radius / z)**2
        radial = 1 + k1 * r2 + k2 * r2**2
        distorted = np.stack([x * radial + 2 * p1 * x * y + p2 * (r2 + 2 * x * x), y * radial + p1 * (r2 + 2 * y * y) + 2 * p2 * x * y], -1)
        return np.where((r2 < self.limit()**2)[..., None], distorted, np.nan)

    def limit(self):
        """Up to where the lens is one to one: an angle (equidistant) or its tangent (radtan)."""
        if self.model == "equidistant":
            return np.radians(80)
        r = np.linspace(0, np.tan(np.radians(70)), 300)
        slope = 1 + 3 * self.coefficients[0] * r**2 + 5 * self.coefficients[1] * r**4
        return r[np.argmax(slope < 0.3)] if (slope < 0.3).any() else r[-1]

    def project(self, points):
        return self.distort(points) * self.intrinsics[:2] + self.intrinsics[2:]


@dataclass
class Style:
    """What kind of rooms are drawn; each pair a range."""
    tags: tuple = (6, 20)
    side_m: tuple = (2.5, 8.0)
    size_m: tuple = (0.08, 0.20)
    radtan_fov_deg: tuple = (55.0, 95.0)
    equidistant_fov_deg: tuple = (90.0, 150.0)
    equidistant_share: float = 0.4
    sigma_px: tuple = (0.05, 0.30)
    bias_px: float = 0.05
    frames: tuple = (60, 240)
    on_one_wall: bool = False  # all tags on one wall, and the camera before it, looking at it squarely


@dataclass
class Room:
    camera: Camera
    ids: np.ndarray  # (N,)
    sizes: np.ndarray  # (N,)
    T_world_tag: np.ndarray  # (N, 4, 4)
    T_camera_world: np.ndarray  # (F, 4, 4)
    times_ns: np.ndarray  # (F,)
    sigma_px: float
    bias_px: float
    corners: np.ndarray  # (N, 4, 3), or (F, N, 4, 3) where they move: where the corners are in the world
    stated_sizes: np.ndarray = None  # what the user says; the truth where None
    stated_camera: Camera = None
    family: str = FAMILY

    def __post_init__(self):
        self.stated_sizes = self.sizes if self.stated_sizes is None else self.stated_sizes
        self.stated_camera = self.stated_camera or self.camera


@dataclass
class Views:
    """Tags in frames: frame by frame, and in a frame tag by tag."""
    frame: np.ndarray  # (V,)
    tag: np.ndarray  # (V,) index into the room's tags
    pixels: np.ndarray  # (V, 4, 2)

    def chosen(self, which):
        return Views(self.frame[which], self.tag[which], self.pixels[which])

    def counts(self, num_frames, num_tags):
        seen = np.zeros((num_frames, num_tags), bool)
        seen[self.frame, self.tag] = True
        return seen


def rotation_about(axis, angle):
    axis = np.asarray(axis, float) / np.linalg.norm(axis)
    K = np.array([[0, -axis[2], axis[1]], [axis[2], 0, -axis[0]], [-axis[1], axis[0], 0]])
    return np.eye(3) + np.sin(angle) * K + (1 - np.cos(angle)) * K @ K


def random_direction(rng):
    v = rng.normal(size=3)
    return v / np.linalg.norm(v)


def pose(R, t):
    T = np.eye(4)
    T[:3, :3], T[:3, 3] = R, t
    return T


def facing(inward, turn):
    """The rotation of a tag whose front looks along `inward`, turned about that by `turn`."""
    z = -np.asarray(inward, float)
    x = np.cross([0.0, 0, 1] if abs(z[2]) < 0.9 else [1.0, 0, 0], z)
    x /= np.linalg.norm(x)
    return np.stack([x, np.cross(z, x), z], 1) @ rotation_about([0, 0, 1], turn)


def corners_of(T_world_tag, sizes):
    local = UNIT_CORNERS[None] * np.asarray(sizes)[:, None, None]
    return np.einsum("nij,nkj->nki", T_world_tag[:, :3, :3], local) + T_world_tag[:, None, :3, 3]


def random_camera(rng, style):
    width, height = RESOLUTIONS[rng.integers(len(RESOLUTIONS))]
    centre = np.array([width, height]) / 2 - 0.5 + rng.uniform(-0.02, 0.02, 2) * width
    is_fisheye = rng.random() < style.equidistant_share
    if is_fisheye:
        focal = width / 2 / np.radians(rng.uniform(*style.equidistant_fov_deg) / 2)
        coefficients = rng.uniform(-1, 1, 4) * [0.02, 0.004, 0.0006, 0.0001]
    else:
        focal = width / 2 / np.tan(np.radians(rng.uniform(*style.radtan_fov_deg) / 2))
        coefficients = np.array([rng.uniform(-0.05, 0.05), rng.uniform(0, 0.015), *rng.uniform(-1e-3, 1e-3, 2)])
    intrinsics = np.array([focal, focal * rng.uniform(0.995, 1.005), *centre])
    return Camera(width, height, intrinsics, "equidistant" if is_fisheye else "radtan", coefficients)


def surfaces(side):
    """(a point, two directions in it as long as it is, the way into the room): walls, floor, ceiling, a table."""
    a, b, c = side
    x, y, z = np.eye(3)
    table = 0.25 * np.array([a, b, 0]) + [0, 0, 0.75]
    return [(0 * x, b * y, c * z, x), (a * x, b * y, c * z, -x), (0 * x, a * x, c * z, y), (b * y, a * x, c * z, -y),
            (0 * x, a * x, b * y, z), (c * z, a * x, b * y, -z), (table, min(1.2, a / 2) * x, min(0.8, b / 2) * y, z)]


def random_layout(rng, style, number):
    """(side lengths, sizes, T_world_tag) of half as many tags again as are asked for, where they fit: no two overlap."""
    side = np.array([*rng.uniform(*style.side_m, 2), rng.uniform(2.3, 3.2)])
    walls = surfaces(side)[:1] if style.on_one_wall else surfaces(side)
    groups = [(walls[rng.integers(len(walls))], rng.uniform(0.1, 0.9, 2)) for _ in range(rng.integers(1, 5))]
    sizes, poses = [], []
    for _ in range(20 * number):
        if 2 * len(poses) >= 3 * number:
            break
        size, kind = rng.uniform(*style.size_m), rng.random()
        (origin, u, v, inward), place = groups[rng.integers(len(groups))]
        if kind < 0.6:
            place = place + rng.normal(0, 0.5, 2) / [np.linalg.norm(u), np.linalg.norm(v)]
        else:
            (origin, u, v, inward), place = walls[rng.integers(len(walls))], rng.random(2)
        room_for_it = size / np.array([np.linalg.norm(u), np.linalg.norm(v)])
        t = origin + np.clip(place, room_for_it, 1 - room_for_it) @ np.stack([u, v])
        R = facing(inward, rng.choice([rng.uniform(-np.pi, np.pi), rng.integers(4) * np.pi / 2]))
        if kind > (0.6 if style.on_one_wall else 0.88):  # a board that stands anyhow
            t = t + inward * rng.uniform(0.1, 0.6)
            R = R @ rotation_about(random_direction(rng), rng.uniform(0.1, 0.4 if style.on_one_wall else 0.8))
        if all(np.linalg.norm(t - other[:3, 3]) > 0.8 * (size + s) for other, s in zip(poses, sizes)):
            sizes.append(size)
            poses.append(pose(R, t))
    return side, np.array(sizes), np.array(poses)


def looking(eye, towards, up):
    """T_camera_world (..., 4, 4), y down the picture."""
    z = towards / np.linalg.norm(towards, axis=-1, keepdims=True)
    x = np.cross(-up, z)
    x /= np.linalg.norm(x, axis=-1, keepdims=True)
    R = np.stack([x, np.cross(z, x), z], -2)
    T = np.zeros((*eye.shape[:-1], 4, 4))
    T[..., :3, :3], T[..., 3, 3] = R, 1
    T[..., :3, 3] = -np.einsum("...ij,...j->...i", R, eye)
    return T


def project_all(camera, T_camera_world, corners):
    """(pixels (F, N, 4, 2), is seen (F, N)) of corners (N, 4, 3) or (F, N, 4, 3)."""
    corners = np.broadcast_to(corners, (len(T_camera_world), *corners.shape[-3:]))
    points = np.einsum("fij,fnkj->fnki", T_camera_world[:, :3, :3], corners) + T_camera_world[:, None, None, :3, 3]
    with np.errstate(invalid="ignore"):
        pixels = camera.project(points)
        inside = ((pixels > MARGIN_PX) & (pixels < np.array([camera.width, camera.height]) - 1 - MARGIN_PX)).all((-1, -2))
        edges = np.linalg.norm(pixels - np.roll(pixels, -1, 2), axis=-1).min(-1)
    into = np.cross(points[:, :, 3] - points[:, :, 1], points[:, :, 2] - points[:, :, 0])  # along the tag's z, twice its area
    centre = points.mean(2)
    cosine = (into * centre).sum(-1) / (np.linalg.norm(into, axis=-1) * np.linalg.norm(centre, axis=-1))
    return pixels, inside & (edges >= MIN_EDGE_PX) & (cosine > np.cos(np.radians(MAX_INCIDENCE_DEG)))


def random_glances(rng, side, T_world_tag, style, number=400):
    """(eye, towards, up): places before a tag, from which the camera looks between it and one that is near."""
    centres = T_world_tag[:, :3, 3]
    near = np.argsort(np.linalg.norm(centres[:, None] - centres, axis=-1), 1)[:, 1:5]
    first = rng.integers(len(centres), size=number)
    second = near[first, rng.integers(near.shape[1], size=number)]
    sideways = rng.normal(0, 0.15 if style.on_one_wall else 0.8, (number, 3))
    away = -T_world_tag[first, :3, 2] + sideways
    distance = rng.uniform(0.45, 0.95, number) * side[0] if style.on_one_wall else np.exp(rng.uniform(np.log(0.4), np.log(4.0), number))
    eye = np.clip(centres[first] + away / np.linalg.norm(away, axis=1, keepdims=True) * distance[:, None], 0.2, side - 0.2)
    unit = [target - eye for target in (centres[first], centres[second])]
    towards = sum(u / np.linalg.norm(u, axis=-1, keepdims=True) for u in unit)
    return eye, towards + rng.normal(0, 0.1, (number, 3)), np.array([0, 0, 1.0]) + rng.normal(0, 0.25, (number, 3))


def largest_joined(seen):
    """Indices of the most tags that frames (F, N) tie together."""
    links = (seen.T.astype(int) @ seen > 0) | np.eye(seen.shape[1], dtype=bool)
    for _ in range(5):
        links = links.astype(int) @ links > 0
    return np.flatnonzero(links[np.argmax(links.sum(1))])


def joined(seen, least=1):
    """Whether frames tie all tags together, each link by `least` frames; seen is (F, N)."""
    links = seen.T.astype(int) @ seen >= least
    reached = links[0]
    for _ in range(len(links)):
        reached = links[reached].any(0) | reached
    return bool(reached.all())


def choose_glances(rng, seen, number):
    """Indices of `number` glances that tie all tags together, if any do: those first that show tags not yet joined."""
    useful = [i for i in rng.permutation(len(seen)) if seen[i].sum() >= 2]
    chosen, reached = [], np.zeros(seen.shape[1], bool)
    while useful and not reached.all():
        best = max(useful, key=lambda i: (bool(chosen) <= (seen[i] & reached).any()) * (seen[i] & ~reached).sum())
        if chosen and not ((seen[best] & reached).any() and (seen[best] & ~reached).any()):
            return []
        chosen.append(best)
        useful.remove(best)
        reached |= seen[best]
    return chosen + useful[:max(0, number - len(chosen))] if reached.all() else []


def tour(keys):
    """An order of rows that keeps neighbours near each other."""
    left, order = list(range(1, len(keys))), [0]
    while left:
        order.append(min(left, key=lambda i: np.linalg.norm(keys[i] - keys[order[-1]])))
        left.remove(order[-1])
    return order


def through(keys, steps):
    """A smooth curve (Catmull and Rom) through rows, `steps` rows of it, as far apart as the keys' distances say."""
    along = np.concatenate([[0], np.cumsum(np.linalg.norm(np.diff(keys, axis=0), axis=1))])
    at = np.interp(np.linspace(0, along[-1] * (1 - 1e-9), steps), along, np.arange(len(keys)))
    i, u = at.astype(int), (at % 1)[:, None]
    p = np.concatenate([keys[:1], keys, keys[-1:]])
    a, b, c, d = p[i], p[i + 1], p[i + 2], p[i + 3]
    return b + 0.5 * u * (c - a + u * (2 * a - 5 * b + 4 * c - d + u * (3 * (b - c) + d - a)))


def random_path(rng, side, glances, seen, style):
    """T_camera_world (F, 4, 4) past glances that join all tags; None where there is no such path."""
    frames = int(rng.integers(style.frames[0], style.frames[1] + 1))
    chosen = choose_glances(rng, seen, max(6, frames // FRAMES_PER_GLANCE))
    if not chosen:
        return None
    eye, towards, up = glances
    keys = np.concatenate([eye, towards / np.linalg.norm(towards, axis=-1, keepdims=True), up], 1)[chosen]
    curve = through(keys[tour(keys)], frames)
    if np.linalg.norm(curve[:, 3:6], axis=1).min() < 0.2:
        return None  # it would turn on the spot
    return looking(np.clip(curve[:, :3], 0.15, side - 0.15), curve[:, 3:6], curve[:, 6:])


def is_well_seen(seen):
    """(F, N): every tag in enough frames with another, and all joined by more than a chance frame."""
    shared = seen & (seen.sum(1) > 1)[:, None]
    return bool((shared.sum(0) >= MIN_SHARED_FRAMES).all()) and joined(shared, MIN_LINK_FRAMES)


def random_room(rng, style=Style()):
    """A room whose tags a calibration can join, drawn anew until it is one. Tags that no glance joins to the others are not hung."""
    for _ in range(MAX_ATTEMPTS):
        number = int(rng.integers(style.tags[0], style.tags[1] + 1))
        side, sizes, poses = random_layout(rng, style, number)
        camera = random_camera(rng, style)
        glances = random_glances(rng, side, poses, style)
        seen = project_all(camera, looking(*glances), corners_of(poses, sizes))[1]
        kept = largest_joined(seen)[:number]
        if len(kept) < style.tags[0]:
            continue
        sizes, poses = sizes[kept], poses[kept]
        path, corners = random_path(rng, side, glances, seen[:, kept], style), corners_of(poses, sizes)
        if path is None or not is_well_seen(project_all(camera, path, corners)[1]):
            continue
        times = 1_600_000_000_000_000_000 + np.round(np.arange(len(path)) * 1e9 / rng.uniform(10, 15)).astype(np.int64)
        ids = rng.choice(FAMILY_SIZE, len(sizes), replace=False)
        return Room(camera, ids, sizes, poses, path, times, rng.uniform(*style.sigma_px), style.bias_px, corners)
    raise RuntimeError("no room in which all tags are seen together was found")


def see(room, rng=None):
    """What is in view, exactly where it is; with a generator, 1 of 20 views is missed."""
    pixels, seen = project_all(room.camera, room.T_camera_world, room.corners)
    if rng is not None:
        seen = seen & (rng.random(seen.shape) < DETECTED_SHARE)
    frame, tag = np.nonzero(seen)
    return Views(frame, tag, pixels[frame, tag])


def edge_errors(rng, count, sigma_px):
    """(count, 4, 2): of each edge the errors normal to it, at its begin and its end."""
    common, own = rng.normal(size=(2, count, 4))
    rho = EDGE_END_CORRELATION
    return sigma_px * np.stack([common, rho * common + np.sqrt(1 - rho**2) * own], -1)


def displaced(pixels, errors):
    """Corners (V, 4, 2) where edges, displaced at their ends by `errors` along their normals, meet."""
    along = np.roll(pixels, -1, 1) - pixels
    along /= np.linalg.norm(along, axis=-1, keepdims=True)
    normal = np.stack([-along[..., 1], along[..., 0]], -1)
    equations = np.stack([normal, np.roll(normal, 1, 1)], -2)  # of the edge that begins here, and of the one that ends here
    offsets = np.stack([errors[..., 0], np.roll(errors[..., 1], 1, 1)], -1)
    return pixels + np.linalg.solve(equations, offsets[..., None])[..., 0]


def noisy(room, views, rng):
    errors = edge_errors(rng, len(views.frame), room.sigma_px)
    errors += edge_errors(rng, len(room.ids), room.bias_px)[views.tag]
    return replace(views, pixels=displaced(views.pixels, errors))


def quaternion(R):
    """x, y, z, w; by the eigenvector of Bar-Itzhack's matrix, which no angle troubles."""
    (a, b, c), (d, e, f), (g, h, i) = R
    K = np.array([[a - e - i, b + d, c + g, h - f], [b + d, e - a - i, f + h, c - g], [c + g, f + h, i - a - e, d - b],
                  [h - f, c - g, d - b, a + e + i]])
    return np.linalg.eigh(K)[1][:, -1]


def camera_text(camera):
    row = lambda values: "[" + ", ".join(f"{v:.12g}" for v in values) + "]"
    return (f"cam0:\n  camera_model: pinhole\n  intrinsics: {row(camera.intrinsics)}\n  distortion_model: {camera.model}\n"
            f"  distortion_coeffs: {row(camera.coefficients)}\n  resolution: [{camera.width}, {camera.height}]\n")


def map_text(room):
    lines = ["apriltrack_map: 1", "frame: world", f"default_family: {room.family}", "tags:"]
    first = np.unique(room.ids, return_index=True)[1]  # of tags that carry one id
    for number, size, T in zip(room.ids[first], room.sizes[first], room.T_world_tag[first]):
        p, q = (", ".join(f"{k}: {v:.15g}" for k, v in zip("xyzw", values)) for values in (T[:3, 3], quaternion(T[:3, :3])))
        lines.append(f"  - {{id: {number}, size: {size:.15g}, pose: {{position: {{{p}}}, orientation: {{{q}}}}}}}")
    return "\n".join(lines) + "\n"


def detections_text(room, views):
    head = "timestamp_ns,camera,family,id," + ",".join(f"c{i}{axis}" for i in range(4) for axis in "xy")
    rows = zip(room.times_ns[views.frame], room.ids[views.tag], views.pixels.reshape(-1, 8))
    return "\n".join([head, *(f"{t},cam0,{room.family},{n}," + ",".join(f"{v:.8f}" for v in px) for t, n, px in rows)]) + "\n"


def sizes_text(room):
    sizes = dict(zip(room.ids, room.stated_sizes))
    return "sizes:\n" + "".join(f"  {number}: {sizes[number]:.15g}\n" for number in sorted(sizes))


def write(room, views, folder):
    """camera.yaml, detections.csv, tag_sizes.yaml as the user has them; map.yaml, the truth."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "camera.yaml").write_text(camera_text(room.stated_camera))
    (folder / "detections.csv").write_text(detections_text(room, views))
    (folder / "tag_sizes.yaml").write_text(sizes_text(room))
    (folder / "map.yaml").write_text(map_text(room))
