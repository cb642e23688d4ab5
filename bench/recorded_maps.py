"""The part recorded of bench/calibration: maps from recorded corners and one recorded film, held against print, TagSLAM's own maps and WPIcal.

usage: bench/calibration SHARED --only recorded [--recordings NAME ...]
"""
import json

import numpy as np
import yaml

from engine_tools import VERDICTS, recordings
from recorded_reprojection import reprojection
from recorded_scores import board_error, distance, grid_error, halves_nees, read_map
from recorded_tools import calibrate, corrected, listed
from recorded_views import read_views, write_views

BLOCK_S = 20  # the halves of a recording: alternate blocks of so many seconds
INTRODUCTION = """
## Recorded corners, and a film

Default options. Pixels: rms per axis. Poses under a held map: bench/recorded_poses.py, which shares no code with the program.
"""


# Boards


def halves_of(b, detections):
    """Two files: the recording in blocks of BLOCK_S, by turns."""
    lines = detections.read_text().splitlines(True)
    times = [int(line.split(",", 1)[0]) for line in lines[1:]]
    files = [b.out / f"{detections.parent.name}_half_{half}.csv" for half in (1, 2)]
    for half, file in enumerate(files):
        file.write_text(lines[0] + "".join(line for time, line in zip(times, lines[1:]) if (time - min(times)) // (BLOCK_S * 10**9) % 2 == half))
    return files


def frames_by_tag(detections):
    rows = [line.split(",", 4) for line in detections.read_text().splitlines()[1:]]
    counts = {}
    for _, _, family, number, _ in rows:
        counts[family, int(number)] = counts.get((family, int(number)), 0) + 1
    return counts


def boards(b):
    print("\n### tagslam_13_boards: 16 printed boards, of which calibrate knows nothing\n")
    folder = b.data / "tagslam_13_boards"
    layout = yaml.safe_load(open(folder / "board_layout.yaml"))
    output, said = calibrate(b, "boards", folder)
    print(f"\nLeft out: {listed(said['left_out'])}. Corrected: {corrected(said)}.")
    errors = {"calibrate": board_error(read_map(output), layout), "TagSLAM, given the layout": board_error(read_map(folder / "reference_map.yaml"), layout)}
    recordings.table([{"map": name, "tags": e.tags, "boards": len(e.by_board), "within boards, mm rms": f"{e.rms_mm:.3f}",
                       "in plane": f"{e.in_plane_mm:.3f}", "out of it": f"{e.out_of_plane_mm:.3f}", "common scale": f"{e.scale:.5f}",
                       "worst board": "{}: {:.3f}".format(*max(e.by_board.items(), key=lambda item: item[1]))} for name, e in errors.items()])
    VERDICTS.at_most("recorded", "tagslam_13_boards: within boards, mm rms", 0.5, errors["calibrate"].rms_mm)
    of_layout = sum(map(len, layout.values()))
    VERDICTS.add("recorded", "tagslam_13_boards: tags judged", str(of_layout), str(errors["calibrate"].tags), errors["calibrate"].tags == of_layout)
    halves(b, folder)


def halves(b, folder):
    files = halves_of(b, folder / "detections.csv")
    counts = [frames_by_tag(file) for file in files]
    least = {key: min(count[key] for count in counts) for key in set(counts[0]) & set(counts[1])}
    held = max(sorted(least), key=least.get)
    print(f"\nHalves: blocks of {BLOCK_S} s by turns; {len(counts[0])} and {len(counts[1])} tags seen, {len(least)} in both; held is "
          f"{listed([held])}, of which the lesser half has most views.\n")
    made = [calibrate(b, f"half_{half}", folder, "--held-tag", "/".join(map(str, held)), source=file) for half, file in enumerate(files, 1)]
    maps = [read_map(output) for output, _ in made]
    nees = halves_nees(*maps)
    values, worst = np.array(list(nees.values())), max(nees, key=nees.get)
    for half, (_, said) in enumerate(made, 1):
        print(f"\nHalf {half}: left out {listed(said['left_out'])}; corrected {corrected(said)}.")
    apart = [np.linalg.norm(maps[0][key].T_map_tag[:3, 3] - maps[1][key].T_map_tag[:3, 3]) * 1e3 for key in nees]
    recordings.table([{"tags of both halves": len(nees), "nees/6 mean": f"{values.mean():.3f}", "median": f"{np.median(values):.3f}",
                       "5 / 95 %": f"{np.quantile(values, 0.05):.3f} / {np.quantile(values, 0.95):.3f}",
                       "worst": f"{listed([worst])}: {nees[worst]:.2f}", "centres apart, mm: median / worst": f"{np.median(apart):.2f} / {max(apart):.2f}"}])
    VERDICTS.add("recorded", f"tagslam_13_boards: two halves, nees/6 of {len(nees)} tags", "0.5 to 2", f"{values.mean():.3f}", 0.5 <= values.mean() <= 2)


# The grid


def bow_picture(title, values, columns=6):
    rows = np.reshape(values, (-1, columns))[::-1]
    return "\n".join([f"    {title}", *("    " + " ".join(f"{v:+6.2f}" for v in row) for row in rows)])


def likeness(a, b):
    return float(np.corrcoef(a, b)[0, 1])


def grid(b):
    print("\n### euroc_aprilgrid: a flat printed grid of 36 tags, of which the tags' size is given\n")
    folder = b.data / "euroc_aprilgrid"
    truth, errors = read_map(folder / "map.yaml"), {}
    for name, more in (("cam0", ("--camera-name", "cam0")), ("cam1", ("--camera-name", "cam1")), ("stereo", ())):
        output, said = calibrate(b, f"grid_{name}", folder, "--tag-size", "0.088", *more)
        errors[name] = grid_error(read_map(output), truth)
        print(f"\n{name}: left out {listed(said['left_out'])}; corrected {corrected(said)}.\n")
        VERDICTS.at_most("recorded", f"euroc_aprilgrid, {name}: mm rms over {errors[name].tags} tags", 0.8, errors[name].rms_mm)
        VERDICTS.add("recorded", f"euroc_aprilgrid, {name}: tags", str(len(truth)), str(errors[name].tags), errors[name].tags == len(truth))
    rms = lambda values: f"{np.sqrt((np.asarray(values)**2).mean()):.3f}"
    recordings.table([{"cameras": name, "mm rms": f"{e.rms_mm:.3f}", "with a scale": f"{e.scaled_rms_mm:.3f}", "scale of the map": f"{e.scale:.5f}",
                       "out of plane": rms(e.bow_mm), "of that a second-order surface": rms(e.bow_of_fit_mm),
                       "rest out of plane": rms(e.bow_mm - e.bow_of_fit_mm)} for name, e in errors.items()])
    if all(e.tags == len(truth) for e in errors.values()):
        print("Out of plane, mm, as the grid is seen (away from the viewer: +):\n")
        print("\n\n".join(bow_picture(name, e.bow_mm) for name, e in errors.items()))
        recordings.table([{"correlation of these shapes": f"{a} and {c}", "all": f"{likeness(errors[a].bow_mm, errors[c].bow_mm):.3f}",
                           "second-order surfaces": f"{likeness(errors[a].bow_of_fit_mm, errors[c].bow_of_fit_mm):.3f}"}
                          for a, c in (("cam0", "cam1"), ("cam0", "stereo"), ("cam1", "stereo"))])


# WPIcal's film


def field(b):
    print("\n### wpical_field: tags 3 and 4 in a film\n")
    folder, pair = b.data / "wpical_field", (("tag36h11", 3), ("tag36h11", 4))
    common = ["--camera", folder / "camera_wpilib.json", "--tag-size", "0.1651"]
    rows = []

    def row(name, *words):
        output = b.out / f"recorded_field_{len(rows)}.yaml"
        said = json.loads(b.apriltrack("calibrate", *words, *common, "--output", output)[1])
        mm, sigma_mm = distance(read_map(output), *pair)
        rows.append({"from": name, "3 to 4, mm": f"{mm:.2f}", "sigma": f"{sigma_mm:.2f}", "px rms": f"{said['residual_rms_px']:.3f}",
                     "corrected": corrected(said)})
        return mm

    mm = row("the film (default)", folder / "video.mp4")
    for response in ("srgb", "linear"):
        corners = b.out / f"recorded_field_{response}.csv"
        b.apriltrack("detect", folder / "video.mp4", "--response", response, "--output", corners)
        row(f"its corners, read as {response}", "--detections", corners)
        views, times_ns = read_views(corners, {"cam0": None}, pair)
        moved = b.out / f"recorded_field_{response}_moved.csv"
        write_views(moved, views.without_edge_offset([0.2]), times_ns, {"cam0": None}, pair)
        row("the same, all edges 0.2 px further out", "--detections", moved, "--edge-offset-sigma", "0")
    recordings.table(rows)
    VERDICTS.add("recorded", "wpical_field: 3 to 4, mm", "511.6 within 1", f"{mm:.2f}", abs(mm - 511.6) <= 1)


RECORDINGS = {"tagslam_13_boards": boards, "tagslam_16_accuracy": lambda b: reprojection(b, "tagslam_16_accuracy"),
              "tagslam_01": lambda b: reprojection(b, "tagslam_01"), "tagslam_02_stereo": lambda b: reprojection(b, "tagslam_02_stereo"),
              "euroc_aprilgrid": grid, "wpical_field": field}


def recorded(b):
    print(INTRODUCTION)
    for name in b.args.recordings or RECORDINGS:
        RECORDINGS[name](b)


PARTS = {"recorded": recorded}
