"""Faults planted into random rooms, each by a function of its own, and the cases that the calibration is judged on.

usage: case = room_faults.make("moved", 17); case.write(folder)
       bench/make_room --kind moved --seed 17 --output FOLDER

A case is the same for a kind and a seed, whatever else was made before it. `case.signal_px` tells how large a fault is in the picture: the
rms over its tag's views (over all views, of a focal length) of how far its corners lie from where they would be without it. A pose that
gives way takes up a part of that; `case.evidence` is the rest, in sigmas, over all views of the tag (of the kinds in WITH_EVIDENCE). Faults
with less than MIN_EVIDENCE, which cannot be seen at all, are drawn anew. Needs python3-numpy.
"""
from dataclasses import dataclass, field, replace
import zlib

import numpy as np

import room_fits
import rooms

FLIP_STYLE = rooms.Style(tags=(6, 16), side_m=(5.0, 8.0), size_m=(0.08, 0.12), radtan_fov_deg=(14.0, 32.0), equidistant_share=0.0,
                         sigma_px=(0.15, 0.30), on_one_wall=True)
MIN_APART_M, MAX_TOGETHER = 0.5, 0.2
MIN_VIEWS_PER_PLACE = 5
OUTLIER_PX = (3.0, 50.0)
MAX_REDRAWS = 200
MIN_EVIDENCE = 8.0
WITH_EVIDENCE = ("wrong_size", "moved", "bent", "loose")


class NotInThisRoom(Exception):
    """A room in which the fault cannot be planted as it is defined: another one is drawn."""


@dataclass
class Case:
    kind: str
    seed: int
    room: rooms.Room
    views: rooms.Views
    culprits: list = field(default_factory=list)  # ids
    size: str = ""
    signal_px: float = 0.0
    views_of_it: int = 0
    evidence: float = float("nan")
    exact_views: rooms.Views = None

    def write(self, folder):
        rooms.write(self.room, self.views, folder)


def log_uniform(rng, low, high, count=None):
    return np.exp(rng.uniform(np.log(low), np.log(high), count))


def seen_matrix(room):
    return rooms.project_all(room.camera, room.T_camera_world, room.corners)[1]


def rms_px(pixels, others):
    """Infinite where the others lie outside what the lens covers."""
    squares = ((pixels - others)**2).sum(-1)
    return float(np.sqrt(squares[np.isfinite(squares)].mean())) if np.isfinite(squares).any() else float("inf")


def faulty(rng, room, tag, corners, size, **changes):
    """The room with one tag's corners elsewhere (of shape (4, 3) or (F, 4, 3)), what is seen of it, and how far off that is."""
    moving = np.array(np.broadcast_to(room.corners, (len(room.times_ns), *room.corners.shape[-3:])))
    moving[:, tag] = corners
    planted = replace(room, corners=moving, **changes)
    views = rooms.see(planted, rng)
    of_it = views.tag == tag
    true = rooms.project_all(room.camera, room.T_camera_world, room.corners)[0][views.frame[of_it], views.tag[of_it]]
    return planted, views, [room.ids[tag]], size, rms_px(views.pixels[of_it], true), int(of_it.sum())


def clean(rng, room):
    return room, rooms.see(room, rng), [], "", 0.0, 0


def wrong_size(rng, room):
    """The file of sizes states 3 to 15 % too much or too little of one tag."""
    tag, share = rng.integers(len(room.ids)), rng.choice([-1, 1]) * log_uniform(rng, 0.03, 0.15)
    stated = room.sizes.copy()
    stated[tag] *= 1 + share
    views = rooms.see(room, rng)
    of_it = views.tag == tag
    meant = rooms.project_all(room.camera, room.T_camera_world, rooms.corners_of(room.T_world_tag, stated))[0]
    signal = rms_px(views.pixels[of_it], meant[views.frame[of_it], tag])
    return replace(room, stated_sizes=stated), views, [room.ids[tag]], f"{100 * share:+.1f} %", signal, int(of_it.sum())


def duplicate(rng, room):
    """Two tags of one size carry one id, 0.5 m apart at least; most often never seen together, at most in 20 % of the frames of either."""
    seen = seen_matrix(room).astype(int)
    together = seen.T @ seen / np.maximum(np.minimum(*np.meshgrid(seen.sum(0), seen.sum(0))), 1)
    apart = np.linalg.norm(room.T_world_tag[:, None, :3, 3] - room.T_world_tag[:, :3, 3], axis=-1)
    most = 0.0 if rng.random() < 0.7 else MAX_TOGETHER
    pairs = np.argwhere((together <= most) & (apart > MIN_APART_M))
    if len(pairs) == 0:
        raise NotInThisRoom
    first, second = pairs[rng.integers(len(pairs))]
    ids, sizes = room.ids.copy(), room.sizes.copy()
    ids[second], sizes[second] = ids[first], sizes[first]
    planted = replace(room, ids=ids, sizes=sizes, stated_sizes=sizes, corners=rooms.corners_of(room.T_world_tag, sizes))
    if not rooms.is_well_seen(seen_matrix(planted)):
        raise NotInThisRoom
    views = rooms.see(planted, rng)
    both = np.intersect1d(views.frame[views.tag == first], views.frame[views.tag == second]).size
    size = f"{apart[first, second]:.2f} m apart, both in {both} frames"
    meant = rooms.project_all(room.camera, room.T_camera_world, planted.corners)[0]
    of_it = views.tag == second
    return planted, views, [ids[first]], size, rms_px(views.pixels[of_it], meant[views.frame[of_it], first]), int(of_it.sum())


def moved(rng, room):
    """From some frame on one tag hangs 3 to 50 cm from where it hung (mostly in its plane), or turned by 5 to 40 degrees, or both."""
    tag, what = rng.integers(len(room.ids)), rng.choice(["shifted", "turned", "both"])
    frames = np.flatnonzero(seen_matrix(room)[:, tag])
    when = frames[int(len(frames) * rng.uniform(0.25, 0.75))]
    metres = 0.0 if what == "turned" else log_uniform(rng, 0.03, 0.50)
    degrees = 0.0 if what == "shifted" else log_uniform(rng, 5, 40)
    R = room.T_world_tag[tag, :3, :3]
    direction = R @ np.array([*rng.normal(size=2), 0]) if rng.random() < 0.7 else rooms.random_direction(rng)
    turn = rooms.rotation_about([0, 0, 1] if rng.random() < 0.5 else rooms.random_direction(rng), np.radians(degrees))
    T = rooms.pose(R @ turn, room.T_world_tag[tag, :3, 3] + metres * direction / np.linalg.norm(direction))
    corners = np.repeat(room.corners[None, tag], len(room.times_ns), 0)
    corners[when:] = rooms.corners_of(T[None], room.sizes[[tag]])[0]
    planted = faulty(rng, room, tag, corners, f"{100 * metres:.1f} cm, {degrees:.1f} deg")
    of_it = planted[1].frame[planted[1].tag == tag]
    if min((of_it < when).sum(), (of_it >= when).sum()) < MIN_VIEWS_PER_PLACE:
        raise NotInThisRoom
    return planted


def bent(rng, room):
    """One corner lifted off by 3 to 8 % of the size, or a twist of as much (corners off the plane by half of it, in turn up and down), or the
    print curled round a cylinder, its arrow 6 to 15 % of the size: corners stay in a plane, and one side becomes 1 to 6 % shorter."""
    tag, what = rng.integers(len(room.ids)), rng.choice(["corner", "twist", "curl"])
    size, T = room.sizes[tag], room.T_world_tag[tag]
    local = rooms.UNIT_CORNERS * size
    share = log_uniform(rng, 0.06, 0.15) if what == "curl" else log_uniform(rng, 0.03, 0.08)
    if what == "corner":
        local[rng.integers(4), 2] -= share * size
    elif what == "twist":
        local[:, 2] += share * size / 2 * np.array([1, -1, 1, -1]) * rng.choice([-1, 1])
    else:
        local[:, rng.integers(2)] *= 1 - 8 / 3 * share**2
    return faulty(rng, room, tag, local @ T[:3, :3].T + T[:3, 3], f"{what} {100 * share:.1f} %")


def smooth_noise(rng, times_s, dimensions):
    """(times, dimensions) of variance 1 over long times: waves of 0.7 to 3 s."""
    waves = 12
    omega = 2 * np.pi / log_uniform(rng, 0.7, 3.0, (waves, dimensions))
    phase = rng.uniform(0, 2 * np.pi, (waves, dimensions))
    return np.sqrt(2 / waves) * np.sin(times_s[:, None, None] * omega + phase).sum(1)


def loose(rng, room):
    """One tag flaps: 5 to 20 mm and 2 to 8 degrees rms, smoothly from frame to frame."""
    tag, metres, degrees = rng.integers(len(room.ids)), log_uniform(rng, 0.005, 0.020), log_uniform(rng, 2, 8)
    noise = smooth_noise(rng, (room.times_ns - room.times_ns[0]) * 1e-9, 6) / np.sqrt(3)
    T, local = room.T_world_tag[tag], rooms.UNIT_CORNERS * room.sizes[tag]
    corners = []
    for offset, turn in zip(metres * noise[:, :3], np.radians(degrees) * noise[:, 3:]):
        R = T[:3, :3] @ rooms.rotation_about(turn, np.linalg.norm(turn))
        corners.append(local @ R.T + T[:3, 3] + offset)
    return faulty(rng, room, tag, np.array(corners), f"{1e3 * metres:.1f} mm, {degrees:.1f} deg")


def one_frame(rng, room):
    """One tag hangs by a single frame: all that is seen of it, or (in half of the rooms) it is seen alone in others."""
    views = rooms.see(room, rng)
    seen = views.counts(len(room.times_ns), len(room.ids))
    tag, seen_alone = rng.integers(len(room.ids)), rng.random() < 0.5
    frames = rng.permutation(np.flatnonzero(seen[:, tag] & (seen.sum(1) > 1)))
    if len(frames) == 0:
        raise NotInThisRoom
    seen[frames[1:], tag] = False
    if seen_alone:
        alone = frames[1:11]
        seen[alone] = False
        seen[alone, tag] = True
    others = np.delete(seen, tag, 1)
    if not rooms.is_well_seen(others) or seen[frames[0]].sum() < 2:
        raise NotInThisRoom
    kept = views.chosen(seen[views.frame, views.tag])
    return room, kept, [room.ids[tag]], "alone in others" if seen_alone else "seen once", 0.0, int(seen[:, tag].sum())


def focal(rng, room):
    """The camera file's fx and fy are 2 to 8 % too large or too small."""
    share = rng.choice([-1, 1]) * log_uniform(rng, 0.02, 0.08)
    stated = replace(room.camera, intrinsics=room.camera.intrinsics * [1 + share, 1 + share, 1, 1])
    views = rooms.see(room, rng)
    meant = rooms.project_all(stated, room.T_camera_world, room.corners)[0][views.frame, views.tag]
    return replace(room, stated_camera=stated), views, [], f"{100 * share:+.1f} %", rms_px(views.pixels, meant), len(views.frame)


def any_direction(rng, count, low, high):
    """Displacements (count, 2), their lengths log-uniform."""
    angle = rng.uniform(0, 2 * np.pi, count)
    return log_uniform(rng, low, high, count)[:, None] * np.stack([np.cos(angle), np.sin(angle)], 1)


def with_wrong_corners(rng, pixels, share):
    """Each corner with that probability 3 to 50 px from where it was."""
    wrong = rng.random(pixels.shape[:2]) < share
    pixels = pixels.copy()
    pixels[wrong] += any_direction(rng, wrong.sum(), *OUTLIER_PX)
    return pixels


def with_wrong_views(rng, pixels, share):
    """Each view with that probability wrong as a whole: moved by 3 to 50 px, or each corner by so much, or read turned."""
    pixels = pixels.copy()
    for view in np.flatnonzero(rng.random(len(pixels)) < share):
        how = rng.integers(3)
        if how < 2:
            pixels[view] += any_direction(rng, 4 if how else 1, *OUTLIER_PX)
        else:
            pixels[view] = np.roll(pixels[view], rng.integers(1, 4), 0)
    return pixels


def outliers(rng, room):
    """10 % of the corners, or 10 % of the views, or 5 % of each."""
    how = rng.choice(["corners", "views", "both"])
    views = rooms.noisy(room, rooms.see(room, rng), rng)
    share = 0.05 if how == "both" else 0.10
    pixels = views.pixels if how == "views" else with_wrong_corners(rng, views.pixels, share)
    pixels = pixels if how == "corners" else with_wrong_views(rng, pixels, share)
    return room, replace(views, pixels=pixels), [], how, 0.0, 0


def noise_free(rng, room):
    return replace(room, sigma_px=0.0, bias_px=0.0), rooms.see(room, rng), [], "", 0.0, 0


# kind: (the fault, the style of its rooms, whether noise is still to be added)
KINDS = {
    "clean": (clean, rooms.Style(), True), "noise_free": (noise_free, rooms.Style(), False),
    "unbiased": (clean, rooms.Style(bias_px=0.0), True),
    "outliers": (outliers, rooms.Style(), False), "outliers_flips": (outliers, FLIP_STYLE, False), "flips": (clean, FLIP_STYLE, True),
    "wrong_size": (wrong_size, rooms.Style(), True), "duplicate": (duplicate, rooms.Style(), True), "moved": (moved, rooms.Style(), True),
    "bent": (bent, rooms.Style(), True), "loose": (loose, rooms.Style(), True), "one_frame": (one_frame, rooms.Style(), True),
    "focal": (focal, rooms.Style(), True),
}


def evidence_of(kind, room, views, culprits):
    if kind not in WITH_EVIDENCE:
        return float("nan")
    found = room_fits.evidence(room, views, int(np.flatnonzero(room.ids == culprits[0])[0]))
    if found < MIN_EVIDENCE:
        raise NotInThisRoom
    return found


def make(kind, seed):
    plant, style, is_noise_wanted = KINDS[kind]
    rng = np.random.default_rng([zlib.crc32(kind.encode()), seed])
    for _ in range(MAX_REDRAWS):
        try:
            room, views, culprits, size, signal, count = plant(rng, rooms.random_room(rng, style))
            evidence = evidence_of(kind, room, views, culprits)
        except NotInThisRoom:
            continue
        noisy = rooms.noisy(room, views, rng) if is_noise_wanted else views
        return Case(kind, seed, room, noisy, [int(number) for number in culprits], size, signal, count, evidence, views)
    raise RuntimeError(f"{kind}, seed {seed}: no room takes this fault")
