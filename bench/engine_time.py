"""The parts of bench/engine that measure time and memory: latency, growth, endurance."""
import csv
import math
import os
import statistics
import subprocess

import engine_tools as tools
from engine_tools import VERDICTS, photoreal, recordings, simulated_frames


def peak_mb(b, *words):
    """Peak resident memory of one run, as the kernel counts it (ru_maxrss)."""
    words = [str(w) for w in words]
    print(f"    {b.shown(words)}  # memory", flush=True)
    with subprocess.Popen(words, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL) as child:
        _, status, usage = os.wait4(child.pid, 0)
        child.returncode = os.waitstatus_to_exitcode(status)
    if child.returncode:
        raise SystemExit(f"failed ({child.returncode}): {' '.join(words)}")
    return usage.ru_maxrss / 1024


RUNS = 11


def times_of_run(b, folder, map_file):
    """Latencies per frame in ms on one thread, from the decoded image to the result: the whole, the part of it that readable
    tags were looked for in, and the rest."""
    b.apriltrack("track", folder, "--method", "blur", "--map", map_file, "--threads", 1, "--output", b.out / "time.tum",
                 "--frames-csv", b.out / "time.csv")
    rows = list(csv.DictReader(open(b.out / "time.csv")))
    total, search = ([float(row[column] or 0) for row in rows] for column in ("latency_ms", "detection_ms"))
    return {"whole": total, "search": search, "without search": [t - s for t, s in zip(total, search)]}


def timed(b, cases):
    """By name, of (folder, map): RUNS runs of each in turn, and of every frame its least time, as what else the machine does
    only adds to it; and the runs by themselves."""
    runs = {name: [] for name in cases}
    for _ in range(1 if b.args.quick else RUNS):
        for name, (folder, map_file) in cases.items():
            runs[name].append(times_of_run(b, folder, map_file))
    least = {name: {what: [min(frame) for frame in zip(*(run[what] for run in of_case), strict=True)] for what in of_case[0]}
             for name, of_case in runs.items()}
    return least, runs


def medians_and_tails(runs):
    return [statistics.median(run["whole"]) for run in runs], [tools.percentile(run["whole"], 0.99) for run in runs]


def latency_row(name, times, runs):
    row = {"recording": name, "frames": len(times["whole"])}
    for what, values in times.items():
        row[f"{what}: median / p99 ms"] = f"{statistics.median(values):.2f} / {tools.percentile(values, 0.99):.2f}"
    medians, tails = medians_and_tails(runs)
    row[f"whole, single runs ({len(runs)})"] = f"{min(medians):.2f}-{max(medians):.2f} / {min(tails):.2f}-{max(tails):.2f}"
    return row


def latency(b):
    print("\n## Latency on one thread, 640 x 480, maps of 14 tags; memory\n")
    wall = tools.simulate(b, "wall_timed", "wall", *simulated_frames(b, 264))
    room = photoreal(b, "room_blur")
    least, runs = timed(b, {"wall (14 tags in view)": (wall, wall / "map.yaml"),
                            "room_blur (1 to 5 in view)": (room, room / "map.yaml")})
    print("\nRuns of the films in turn. The table's figures are of each frame's least time, but for the last column.\n")
    for name, of_case in runs.items():
        medians, tails = medians_and_tails(of_case)
        VERDICTS.at_most("latency", f"{name}: median ms, of {len(of_case)} runs the middle one", 5, statistics.median(medians), 2)
        VERDICTS.at_most("latency", f"{name}: p99 ms, of {len(of_case)} runs the middle one", 20, statistics.median(tails), 2)
    recordings.table([latency_row(name, least[name], runs[name]) for name in least])
    base = peak_mb(b, b.program, "--version")
    track = peak_mb(b, b.program, "track", wall, "--threads", 1, "--quiet", "--output", b.out / "memory.tum")
    detect = peak_mb(b, b.program, "detect", wall, "--threads", 1, "--quiet", "--output", b.out / "memory.csv")
    recordings.table([{"run": name, "peak MB": f"{mb:.1f}", "beyond --version": f"{mb - base:.1f}"}
                      for name, mb in (("--version", base), ("detect, wall", detect), ("track, wall", track))])
    VERDICTS.at_most("memory", "track, wall: peak beyond --version, MB", 100, track - base, 1)


GROWN_FAMILIES = (("tag36h11", 587), ("tagStandard52h13", 48714))  # of other families, 10,000 ids are not to be had
GROWN_TAGS = 10_000


def grown_map(b, tags, count, family_ids, name):
    """The room's own tags, and others in the same places of other rooms, 20 m apart, row by row."""
    rooms = math.ceil(math.sqrt(count / len(tags))) + 1
    origin = [(20.0 * x, 20.0 * y) for x in range(rooms) for y in range(rooms)][1:]
    own = list(tags.values())
    more = dict(tags)
    for key in family_ids:
        if len(more) == count:
            break
        k = len(more) - len(tags)
        size, p, q = own[k % len(own)]
        x, y = origin[k // len(own)]
        more[key] = (size, [p[0] + x, p[1] + y, p[2]], q)
    assert len(more) == count
    return tools.write_map(b.out / name, more)


def growth(b):
    print(f"\n## Growth: maps of 14 to {GROWN_TAGS} tags, the same 14 in view\n")
    wall = tools.simulate(b, "wall_timed", "wall", *simulated_frames(b, 264))
    folder = tools.linked(b, wall, "wall_grown", 6 if b.args.quick else 60)
    tags = tools.read_map(b, folder / "map.yaml")
    ids = [(family, i) for family, count in GROWN_FAMILIES for i in range(count) if (family, i) not in tags]
    maps = {"14 tags": grown_map(b, tags, len(tags), [], "grown_14.yaml"),
            "15 tags, two families": grown_map(b, tags, len(tags) + 1, ids[-1:], "grown_15.yaml"),
            "587 tags": grown_map(b, tags, 587, ids, "grown_587.yaml"),
            f"{GROWN_TAGS} tags, two families": grown_map(b, tags, GROWN_TAGS, ids, "grown.yaml")}
    least, runs = timed(b, {name: (folder, path) for name, path in maps.items()})
    print("\nRuns of the maps in turn. Figures are of each frame's least time, but for the last column.\n")
    recordings.table([latency_row(f"wall, map of {name}", least[name], runs[name]) for name in least])
    grown = list(maps)[-1]
    for what in ("without search", "whole"):
        ratio = statistics.median(least[grown][what]) / statistics.median(least["14 tags"][what])
        VERDICTS.at_most("growth", f"wall, {what}: map of {grown} over map of 14 tags", 1.05, ratio)


def endurance(b):
    frames = 400 if b.args.quick else b.args.frames
    print(f"\n## Endurance: a clip of 60 s shown again and again, {frames} frames\n")
    clip = tools.simulate(b, "endurance", "room", "--frames", "60" if b.args.quick else "1800")
    out = b.run(b.program.parent / "bench_endurance", clip, "--frames", frames)[1]
    print("\n" + "".join(f"    {line}\n" for line in out.splitlines()))
    blocks = []
    for line in out.splitlines():
        words = line.split()
        if words[0] == "frames":
            blocks.append(dict(zip(words[0:8:2], map(float, words[1:8:2]))))
    first, last = blocks[1], blocks[-1]  # the first block warms up
    VERDICTS.at_most("endurance", "resident memory, last tenth over second tenth", 1.02, last["resident_mb"] / first["resident_mb"])
    VERDICTS.at_most("endurance", "median latency, last tenth over second tenth", 1.10, last["median_ms"] / first["median_ms"])
