"""What bench/engine is made of: recordings to judge on, the independent scorer's frames, and verdicts."""
import contextlib
import csv
import importlib.machinery
import importlib.util
import io
import json
import math
import pathlib
import re
import runpy
import statistics
import sys

CLAIMED = ("detected", "tracked")
GOOD_PX, SILENT_PX = 5.0, 10.0
BINS = ((0, 5), (5, 20), (20, 40), (40, math.inf))
QUICK_FRAMES = 40


def load(name):
    """A script of this folder as a module."""
    loader = importlib.machinery.SourceFileLoader(name, str(pathlib.Path(__file__).resolve().parent / name))
    module = importlib.util.module_from_spec(importlib.util.spec_from_loader(name, loader))
    loader.exec_module(module)
    return module


trackers = load("trackers")
recordings = trackers.recordings


class Verdicts:
    """Targets beside figures; and the frames that an engineer will want to look at."""

    MANY = 12  # time stamps of one recording that are listed

    def __init__(self):
        self.rows, self.silent, self.far = [], [], []

    def add(self, part, what, target, figure, is_met):
        word = {True: "met", False: "**missed**", None: "not judged"}[is_met]
        self.rows.append({"part": part, "what": what, "target": target, "figure": figure, "verdict": word})

    def at_least(self, part, what, target, value):
        self.add(part, what, f">= {target:g}", f"{value:.4f}", value >= target)

    def at_most(self, part, what, target, value, digits=3):
        self.add(part, what, f"<= {target:g}", f"{value:.{digits}f}", value <= target)

    def no_silent(self, part, run):
        bad = run.silent()
        self.add(part, f"{run.name}: silent failures", "0", str(len(bad)), not bad)
        self.silent += [{"part": part, "recording": run.name, "timestamp_ns": f["t"], "frame": f["index"],
                         "status": f["status"], "blur px": f"{f['blur']:.1f}", "error px": f"{f['err']:.1f}"} for f in bad]
        far = [f for f in run.frames if f["err"] is None or f["err"] >= GOOD_PX]
        if far:
            statuses = sorted({f["status"] for f in far})
            counts = ", ".join(f"{sum(f['status'] == s for f in far)} {s}" for s in statuses)
            listed = " ".join(str(f["t"]) for f in far[:self.MANY]) + (" ..." if len(far) > self.MANY else "")
            self.far.append({"part": part, "recording": run.name, "frames": counts, "timestamp_ns": listed})


VERDICTS = Verdicts()


class Run:
    """One recording tracked once, frame by frame as the scorer judges them: those that show a tag."""

    def __init__(self, name, frames, score, log):
        self.name, self.frames, self.score, self.log = name, frames, score, log

    def share(self, is_counted, low=0.0, high=math.inf):
        chosen = [f for f in self.frames if low <= f["blur"] < high]
        return sum(map(is_counted, chosen)) / len(chosen) if chosen else math.nan

    def within(self, low=0.0, high=math.inf):
        return self.share(lambda f: f["err"] is not None and f["err"] < GOOD_PX, low, high)

    def claimed(self):
        return self.share(lambda f: f["status"] in CLAIMED)

    def silent(self):
        return [f for f in self.frames if f["status"] in CLAIMED and f["err"] is not None and f["err"] > SILENT_PX]

    def median(self, low, high):
        errors = [f["err"] for f in self.frames if low <= f["blur"] < high and f["err"] is not None]
        return statistics.median(errors) if errors else math.nan

    def count(self, low, high):
        return sum(low <= f["blur"] < high for f in self.frames)

    def nees(self):
        return (self.score.get("nees_over_6") or {}).get("mean", math.nan)

    def latencies(self):
        return [float(row["latency_ms"]) for row in self.log if row["latency_ms"]]

    def row(self, bins):
        shown = {"recording": self.name, "frames": len(self.frames), "within 5 px": f"{self.within():.4f}",
                 "claimed": f"{self.claimed():.4f}", "silent": len(self.silent())}
        for low, high in bins:
            shown[bin_name(low, high)] = f"{self.median(low, high):.3f} ({self.count(low, high)})"
        return shown


def bin_name(low, high):
    return f"median px at {low:g}{'+' if high == math.inf else f'-{high:g}'} px (frames)"


def pooled(name, runs):
    """Several runs judged as one."""
    return Run(name, [f for run in runs for f in run.frames], {}, [row for run in runs for row in run.log])


def judge(b, name, recording, tum, log, mode):
    """Runs SHARED's scorer, which is no module: what it leaves behind has every frame, its summary has not."""
    words = [str(recording), str(tum), *(["--joint"] if mode == "joint" else []), "--frames-csv", str(log)]
    script = str(b.tools / "score_track.py")
    print(f"    {b.shown(['/usr/bin/python3', script, *words])}", flush=True)
    saved, sys.argv = sys.argv, [script, *words]
    try:
        with contextlib.redirect_stdout(io.StringIO()):
            left = runpy.run_path(script)
    finally:
        sys.argv = saved
    rows = list(csv.DictReader(open(log)))
    status = {int(row["timestamp_ns"]): row["status"] for row in rows}
    frames = [dict(f, status=status.get(f["t"], "lost"), index=left["times"].index(f["t"])) for f in left["rows"]]
    return Run(name, frames, left["out"], rows)


def track(b, recording, method="blur", mode="ego", map_file=None, name=None, scored_on=None, more=()):
    """Tracks and judges; `scored_on`: the folder with the truth and the true map, where it is not `recording`. A run
    that finds no pose at all (status 1) is judged as one that lost every frame."""
    map_file, scored_on = map_file or recording / "map.yaml", scored_on or recording
    known = b.__dict__.setdefault("known_runs", {})
    key = (str(recording), method, mode, str(map_file), str(scored_on), tuple(map(str, more)))
    if key in known:
        return known[key]
    tum, log = b.out / "out.tum", b.out / "out.csv"
    for old in (tum, log):
        old.unlink(missing_ok=True)
    status, _, error = b.apriltrack("track", recording, "--mode", mode, "--map", map_file, "--method", method, *more,
                                    "--output", tum, "--frames-csv", log, may_fail=True)
    if status > 1:
        sys.exit(f"failed ({status}): {error}")
    if status == 1:
        print(f"\nno pose at all: {b.shown([error.strip()])}\n")
    tum.touch()
    if not log.exists():
        log.write_text("timestamp_ns,status,latency_ms\n")
    known[key] = judge(b, name or f"{recording.name}, {method}", scored_on, tum, log, mode)
    return known[key]


def image_files(folder):
    return sorted((folder / "frames").iterdir(), key=lambda file: int(file.stem))


def linked(b, folder, name, num_frames=None):
    """A recording's own copy, its pictures by links, its first frames only where a number is given."""
    copy = b.out / name
    (copy / "frames").mkdir(parents=True)
    files = image_files(folder)[:num_frames]
    for file in files:
        (copy / "frames" / file.name).symlink_to(file.resolve())
    for file in ("camera.yaml", "map.yaml"):
        (copy / file).write_text((folder / file).read_text())
    times = {int(file.stem) for file in files}
    truth = (folder / "truth.tum").read_text().splitlines(True)
    (copy / "truth.tum").write_text("".join(line for line in truth if line.startswith("#") or tum_time(line) in times))
    if (folder / "frames.csv").exists():
        (copy / "frames.csv").write_text((folder / "frames.csv").read_text())
    print(f"    # {name}: {'the first ' + str(len(files)) + ' frames of ' if num_frames else ''}{b.shown([folder])}")
    return copy


def photoreal(b, name):
    """The whole recording, or its beginning where it is to be quick."""
    folder = b.data / name
    if not b.args.quick:
        return folder
    short = b.out / f"{name}_short"
    return short if short.exists() else linked(b, folder, short.name, QUICK_FRAMES)


def simulated_frames(b, full):
    return ["--frames", str(QUICK_FRAMES if b.args.quick else full)]


def seeds(b):
    return range(1, (1 if b.args.quick else b.args.seeds) + 1)


def tum_time(line):
    seconds, _, rest = line.split()[0].partition(".")
    return int(seconds) * 10**9 + int((rest + "0" * 9)[:9])


def with_exposure(b, folder, name, factor):
    """A copy that tells another exposure, in the camera file and in frames.csv; None: that tells none."""
    copy = linked(b, folder, name)
    camera = (copy / "camera.yaml").read_text()
    told = re.compile(r"(\n\s*exposure_time:\s*)([0-9.eE+-]+)")
    assert len(told.findall(camera)) == 1, f"{folder}: no exposure_time to change"
    change = (lambda m: "") if factor is None else (lambda m: f"{m[1]}{float(m[2]) * factor:.9g}")
    (copy / "camera.yaml").write_text(told.sub(change, camera))
    if (copy / "frames.csv").exists():
        rows = list(csv.DictReader(open(copy / "frames.csv")))
        with open(copy / "frames.csv", "w") as file:
            writer = csv.DictWriter(file, rows[0].keys())
            writer.writeheader()
            for row in rows:
                own = row["exposure_s"]
                row["exposure_s"] = "" if factor is None or not own else f"{float(own) * factor:.9g}"
                writer.writerow(row)
    print(f"    # {name}: exposure {'left out' if factor is None else f'times {factor:g}'}")
    return copy


def simulate(b, name, scene, *words):
    """Renders once per name; returns the folder."""
    folder = b.out / name
    if not folder.exists():
        b.apriltrack("simulate", "--scene", scene, *words, "--output", folder)
    return folder


def write_map(path, tags, family="tag36h11"):
    """tags: {(family, id): (size, position xyz, quaternion xyzw)}. By hand: a YAML library takes long for 10,000."""
    lines = ["apriltrack_map: 1", "frame: world", f"default_family: {family}", "tags:"]
    for (own, number), (size, p, q) in tags.items():
        lines.append(f"  - {{id: {number}, family: {own}, size: {size!r}, pose: {{position: {{x: {p[0]!r}, y: {p[1]!r}, "
                     f"z: {p[2]!r}}}, orientation: {{x: {q[0]!r}, y: {q[1]!r}, z: {q[2]!r}, w: {q[3]!r}}}}}}}")
    path.write_text("\n".join(lines) + "\n")
    return path


def read_map(b, path):
    shown = json.loads(b.apriltrack("map", "show", path)[1])
    tags = {}
    for tag in shown["tags"]:
        orientation = tag["orientation"]
        tags[(tag["family"], tag["id"])] = (tag["size_m"], [tag["position"][k] for k in "xyz"], [orientation[k] for k in "xyzw"])
    return tags


def times_quaternion(a, b):
    ax, ay, az, aw = a
    bx, by, bz, bw = b
    return [aw * bx + ax * bw + ay * bz - az * by, aw * by - ax * bz + ay * bw + az * bx,
            aw * bz + ax * by - ay * bx + az * bw, aw * bw - ax * bx - ay * by - az * bz]


def with_moved_tag(tags, key, by_m, by_deg):
    """One tag elsewhere: along its own x axis by so much, and turned about its y axis."""
    size, p, q = tags[key]
    x_axis = times_quaternion(times_quaternion(q, [1.0, 0.0, 0.0, 0.0]), [-q[0], -q[1], -q[2], q[3]])
    half = math.radians(by_deg) / 2
    return {**tags, key: (size, [a + by_m * b for a, b in zip(p, x_axis)],
                          times_quaternion(q, [0.0, math.sin(half), 0.0, math.cos(half)]))}


def with_swapped_tags(tags, first, second):
    return {**tags, first: tags[second], second: tags[first]}


def percentile(values, share):
    ordered = sorted(values)
    return ordered[min(len(ordered) - 1, round(share * (len(ordered) - 1)))] if ordered else math.nan
