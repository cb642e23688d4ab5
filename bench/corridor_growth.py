"""The part growth of bench/calibration: a long corridor, tags on both of its walls, and the time and memory that its map takes.

usage: bench/calibration SHARED --only growth

Each frame sees some ten tags: the camera walks down the middle, and looks from one wall to the other. Judged is the time of all cores, which
what else the machine does changes little, and which is more than what the user waits. Needs python3-numpy.
"""
import os
import subprocess
import time

import numpy as np

import rooms
from engine_tools import VERDICTS, recordings

TAGS_FRAMES = ((20, 200), (50, 500), (100, 1000), (200, 2000), (500, 5000), (1000, 10000))
OFF_DIAGONAL = ((20, 2000), (100, 10000), (500, 1000))
QUICK = 4
STEP_M, WIDTH_M, SIZE_M = 0.18, 2.4, 0.16
CAMERA = rooms.Camera(1280, 1024, np.array([700.0, 700.0, 639.5, 511.5]), "radtan", np.array([-0.02, 0.005, 0.0, 0.0]))
RANDOM_SEED = 1
FAMILY = "tagStandard41h12"  # has 2115 ids
MAX_EXPONENT, MAX_GIB = 1.2, 4.0


def corridor(tags, frames):
    """(the room, what is seen of it): tags in turn on the left and on the right wall."""
    rng = np.random.default_rng([RANDOM_SEED, tags, frames])
    along, left = STEP_M * np.arange(tags), np.arange(tags) % 2 == 0
    places = np.stack([along, np.where(left, 0.0, WIDTH_M), rng.uniform(0.9, 2.1, tags)], 1)
    turns = rng.uniform(-0.3, 0.3, tags)
    inward = np.stack([0 * along, np.where(left, 1.0, -1.0), 0 * along], 1)
    T_world_tag = np.array([rooms.pose(rooms.facing(*way), t) for *way, t in zip(inward, turns, places)])
    sizes = np.full(tags, SIZE_M)
    walk = np.linspace(-2.5, max(along[-1] - 1.5, -2.0), frames)
    swing = 0.35 * np.sin(2 * np.pi * np.arange(frames) / 37)
    eye = np.stack([walk, WIDTH_M / 2 + 0.3 * np.sin(walk), 1.5 + 0.1 * np.sin(1.3 * walk)], 1)
    towards = np.stack([np.cos(swing), np.sin(swing), 0.1 * np.sin(0.7 * walk)], 1)
    times = 1_600_000_000_000_000_000 + 100_000_000 * np.arange(frames, dtype=np.int64)
    path = rooms.looking(eye, towards, np.tile([0.0, 0, 1], (frames, 1)))
    corners = rooms.corners_of(T_world_tag, sizes)
    room = rooms.Room(CAMERA, np.arange(tags), sizes, T_world_tag, path, times, 0.15, 0.05, corners, family=FAMILY)
    return room, rooms.noisy(room, seen_in_pieces(room, rng), rng)


def seen_in_pieces(room, rng, frames_at_once=200, reach=40):
    """As rooms.see, of the tags that are near only."""
    pieces = []
    for begin in range(0, len(room.times_ns), frames_at_once):
        path = room.T_camera_world[begin:begin + frames_at_once]
        eyes = np.linalg.inv(path)[:, 0, 3]
        first, last = (int(np.clip(x / STEP_M, 0, len(room.ids))) for x in (eyes.min(), eyes.max() + reach * STEP_M))
        pixels, seen = rooms.project_all(room.camera, path, room.corners[first:last])
        frame, tag = np.nonzero(seen & (rng.random(seen.shape) < rooms.DETECTED_SHARE))
        pieces.append(rooms.Views(frame + begin, tag + first, pixels[frame, tag]))
    return rooms.Views(*(np.concatenate([getattr(piece, name) for piece in pieces]) for name in ("frame", "tag", "pixels")))


def measured(b, folder):
    """(status, seconds, seconds of all cores, peak MB) of calibrate on a folder."""
    words = [b.program, "calibrate", "--detections", folder / "detections.csv", "--camera", folder / "camera.yaml", "--tag-size", SIZE_M,
             "--output", folder / "calibrated.yaml", "--quiet"]
    words = [str(word) for word in words]
    print(f"    {b.shown(words)}", flush=True)
    begin = time.monotonic()
    with subprocess.Popen(words, stdout=subprocess.DEVNULL) as child:
        _, status, usage = os.wait4(child.pid, 0)
        child.returncode = os.waitstatus_to_exitcode(status)
    return child.returncode, time.monotonic() - begin, usage.ru_utime + usage.ru_stime, usage.ru_maxrss / 1024


def grown(b, tags, frames):
    folder = b.out / f"corridor_{tags}_{frames}"
    room, views = corridor(tags, frames)
    rooms.write(room, views, folder)
    status, seconds, busy, peak = measured(b, folder)
    row = {"tags": tags, "frames": frames, "views": len(views.frame), "views a frame": f"{len(views.frame) / frames:.1f}",
           "status": status, "s": f"{seconds:.2f}", "s of all cores": f"{busy:.2f}", "peak MB": f"{peak:.0f}"}
    score = b.score_map(folder / "map.yaml", folder / "calibrated.yaml") if status == 0 else None
    nees = (score or {}).get("nees_over_6", {}).get("mean", "-")
    row = {**row, "mm rms": score["position_mm"]["rms"] if score else "-", "nees/6": nees}
    return row, (len(views.frame), tags * frames, seconds, busy, peak, status)


def slope(x, y):
    return float(np.polyfit(np.log(x), np.log(y), 1)[0])


def growth(b):
    print("\n## Growth: a corridor\n")
    rows, figures = zip(*(grown(b, *size) for size in TAGS_FRAMES[:QUICK if b.args.quick else None]))
    views, products, seconds, busy, peaks, statuses = zip(*figures)
    others = [] if b.args.quick else [grown(b, *size)[0] for size in OFF_DIAGONAL]
    recordings.table([*rows, *others])
    recordings.table([{"exponent, of the first rows": name, "over views": f"{slope(views, values):.3f}",
                       "over tags times frames": f"{slope(products, values):.3f}",
                       "over views, of the last two": f"{slope(views[-2:], values[-2:]):.3f}"}
                      for name, values in (("s", seconds), ("s of all cores", busy), ("peak MB", peaks))])
    tags, frames = TAGS_FRAMES[len(rows) - 1]
    VERDICTS.add("growth", "corridors without a map", "0", str(sum(status != 0 for status in statuses)), not any(statuses))
    if not any(statuses):
        to = f"up to {tags} tags and {frames} frames"
        VERDICTS.at_most("growth", f"exponent of time (of all cores) over views, {to}", MAX_EXPONENT, slope(views, busy))
        VERDICTS.at_most("growth", f"memory, GiB, {to}", MAX_GIB, max(peaks) / 1024)
