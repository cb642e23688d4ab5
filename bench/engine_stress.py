"""The part `stress` of bench/engine: what makes a recording hard, and maps that are wrong."""
import csv

import engine_tools as tools
from engine_tools import VERDICTS, recordings, simulated_frames


def stress_scenes(b):
    """(name, scene, mode, options of simulate)"""
    n = tools.QUICK_FRAMES if b.args.quick else 360
    frames = ("--frames", n)
    blackouts = ("--blackout", f"{n // 4}:9", "--blackout", f"{n // 2}:{min(45, n // 4)}")
    return [("dark, 5 % of the light", "room", "ego", ("--light", "0.05", *frames)),
            ("dark, 1 % of the light", "room", "ego", ("--light", "0.01", *frames)),
            ("dark, 1 % of the light, gain 100", "room", "ego", ("--light", "0.01", "--gain", "100", *frames)),
            ("flicker 0.5", "room", "ego", ("--flicker", "0.5", *frames)),
            ("hand over 0.35, room", "room", "ego", ("--occlude", "0.35", *frames)),
            ("hand over 0.6, wall", "wall", "ego", ("--occlude", "0.6", *frames)),
            ("hand over 0.35, single", "single", "joint", ("--occlude", "0.35", *frames)),
            ("hand over 0.35, bundle", "bundle", "joint", ("--occlude", "0.35", *frames)),
            ("one tag", "wall-one", "ego", frames),
            ("one tag, hand over 0.35", "wall-one", "ego", ("--occlude", "0.35", *frames)),
            ("small tags", "room-small", "ego", frames),
            ("blackouts, room", "room", "ego", (*blackouts, *frames)),
            ("blackouts, one tag", "wall-one", "ego", (*blackouts, *frames)),
            ("blackouts, single", "single", "joint", (*blackouts, *frames)),
            ("one tag, hand over 0.7, take 2", "wall-one", "ego", ("--occlude", "0.7", "--take", "2", *frames)),
            ("thrown about, single", "single", "joint", ("--speed", "1.6", *frames)),
            ("thrown about, bundle", "bundle", "joint", ("--speed", "1.6", *frames)),
            ("static, 14 tags", "wall", "ego", ("--speed", "0", *frames)),
            ("static, 1 tag", "wall-one", "ego", ("--speed", "0", *frames))]


def slug(name):
    return "".join(c if c.isalnum() else "_" for c in name)


def decodable(b, folder):
    """Time stamps of the frames in which a mapped tag is read."""
    corners = b.out / "detections.csv"
    corners.unlink(missing_ok=True)
    status = b.apriltrack("detect", folder, "--output", corners, may_fail=True)[0]
    if status > 1:
        raise SystemExit(f"detect failed ({status})")
    mapped = set(tools.read_map(b, folder / "map.yaml"))
    rows = csv.DictReader(open(corners)) if corners.exists() else []
    return {int(row["timestamp_ns"]) for row in rows if (row["family"], int(row["id"])) in mapped}


MIN_GAP = 3  # frames without a readable tag that make a loss of the pose likely


def recoveries(run, readable):
    """Frames from the first with a readable tag after a gap (or since the start) to the first with a good pose: claimed
    and not silently wrong. [(time stamp of the readable frame, frames waited or None: never again)]."""
    found, dark = [], MIN_GAP  # the start is such a gap
    for i, frame in enumerate(run.frames):
        if frame["t"] not in readable:
            dark += 1
            continue
        if dark >= MIN_GAP:
            good = (j for j, f in enumerate(run.frames[i:]) if f["status"] in tools.CLAIMED and f["err"] is not None
                    and f["err"] <= tools.SILENT_PX)
            found.append((frame["t"], next(good, None)))
        dark = 0
    return found


def stress(b):
    print("\n## Stress: dark, flicker, a hand, a lone tag, small tags, black frames, standing still, and a map that is wrong\n")
    print(f"Recovery: frames from the first in which `detect` reads a mapped tag, after {MIN_GAP} or more in which it does not and "
          "at the start, to the first claimed pose that is within 10 px.\n")
    rows = []
    for name, scene, mode, words in stress_scenes(b):
        folder = tools.simulate(b, slug(name), scene, *words)
        run = tools.track(b, folder, mode=mode, name=name)
        waits = recoveries(run, decodable(b, folder))
        longest = max((len(run.frames) if wait is None else wait for _, wait in waits), default=0)
        slow = [str(t) for t, wait in waits if wait is None or wait > 2]
        rows.append({**run.row(tools.BINS), "gaps": len(waits), "longest recovery": longest, "slow after": " ".join(slow) or "none"})
        VERDICTS.no_silent("stress", run)
        VERDICTS.at_most("stress", f"{name}: frames to recover ({len(waits)} gaps)", 2, longest, 0)
    rows += [dict(run.row(tools.BINS), **{"gaps": "-", "longest recovery": "-", "slow after": "-"}) for run in wrong_maps(b)]
    recordings.table(rows)


def wrong_maps(b):
    """One tag hangs 10 cm and 20 degrees elsewhere than its map says; and two tags' ids are swapped."""
    runs = []
    for scene, moved, swapped in (("wall", 7, (5, 8)), ("room", 1, (4, 6))):
        folder = tools.simulate(b, f"{scene}_for_wrong_maps", scene, *simulated_frames(b, 240))
        tags = tools.read_map(b, folder / "map.yaml")
        one, first, second = (("tag36h11", number) for number in (moved, *swapped))
        for word, changed in (("a tag moved", tools.with_moved_tag(tags, one, 0.10, 20.0)),
                              ("two ids swapped", tools.with_swapped_tags(tags, first, second))):
            wrong = tools.write_map(b.out / f"{slug(scene + word)}.yaml", changed)
            run = tools.track(b, folder, map_file=wrong, name=f"{scene}, {word}")
            VERDICTS.no_silent("stress", run)
            runs.append(run)
    return runs
