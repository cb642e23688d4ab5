"""Of the part recorded of bench/calibration: our map against TagSLAM's, each held while the cameras' poses are solved anew."""
import numpy as np

import recorded_poses
from engine_tools import VERDICTS, recordings
from recorded_scores import read_map
from recorded_tools import calibrate, corrected, listed
from recorded_views import CAUCHY_PX, corners_of, errors_px, fitted, read_rig, read_views

CUT = 6  # times the median: a view whose worst corner lies farther off under every map and camera is no view of the tag there


class HeldMap:
    """One map in one camera and one reading of the corners."""

    def __init__(self, tags, keys, rig, views):
        self.rig, self.views = rig, views
        self.sizes, self.T_map_tag = np.array([tags[key].size_m for key in keys]), np.array([tags[key].T_map_tag for key in keys])

    def corners(self):
        return corners_of(self.sizes, self.T_map_tag)

    def solve(self, start=None):
        """Robustly; from another solution's poses, or from the corners alone."""
        if start is None:
            self.poses = recorded_poses.solved(self.rig, self.views, self.sizes, self.T_map_tag)
        else:
            self.poses = fitted(self.rig, self.views, self.corners(), start, CAUCHY_PX)[0]
        return self

    def worst_px(self):
        return np.linalg.norm(errors_px(self.rig, self.views, self.corners(), self.poses), axis=-1).max(1)

    def plain_rms_px(self, kept):
        views = self.views.chosen(kept)
        poses, _ = fitted(self.rig, views, self.corners(), self.poses)
        return float(np.sqrt((errors_px(self.rig, views, self.corners(), poses)**2).mean()))

    def least_rms_px(self, kept):
        """Of any map of these tags."""
        views = self.views.chosen(kept)
        T_map_tag, poses = recorded_poses.least_squares(self.rig, views, self.sizes, self.T_map_tag, self.poses)
        return float(np.sqrt((errors_px(self.rig, views, corners_of(self.sizes, T_map_tag), poses)**2).mean()))


def edge_offsets(rig, said):
    found = {c["camera"]: c["value"] for c in said["corrections"] if c["parameter"] == "edge offset"}
    return [found.get(name, 0.0) for name in rig]


def held_maps(b, folder, output, said, keys):
    """{(corners, camera): (HeldMap of ours, of theirs)}; the first is as the files are."""
    ours, theirs = read_map(output), read_map(folder / "reference_map.yaml")
    rigs = {"the file's": read_rig(folder / "camera.yaml")}
    if "camera" in said:
        rigs["refined with our map"] = read_rig(output.with_suffix(".camera.yaml"))
    views = read_views(folder / "detections.csv", rigs["the file's"], keys)[0]
    readings = {"as read": views}
    if any(edge_offsets(rigs["the file's"], said)):
        readings["edge offset removed"] = views.without_edge_offset(edge_offsets(rigs["the file's"], said))
    found, start = {}, {}
    for reading, corners in readings.items():
        for camera, rig in rigs.items():
            pair = [HeldMap(tags, keys, rig, corners).solve(start.get(i)) for i, tags in enumerate((ours, theirs))]
            for i, one in enumerate(pair):
                start.setdefault(i, one.poses)
            found[reading, camera] = pair
    return found


def kept_views(worst_px):
    """Which views count, and the limit in px. worst_px: (fits, V), each view's worst corner under each map and camera."""
    least = np.min(worst_px, 0)
    limit_px = CUT * np.median(least)
    return least <= limit_px, limit_px


def reprojection(b, name):
    print(f"\n### {name}: maps held, camera poses solved anew\n")
    folder = b.data / name
    output, said = calibrate(b, name, folder)
    keys = sorted(set(read_map(output)) & set(reference := read_map(folder / "reference_map.yaml")))
    missing = sorted(set(reference) - set(keys))
    found = held_maps(b, folder, output, said, keys)
    first = next(iter(found))
    kept, limit_px = kept_views([one.worst_px() for pair in found.values() for one in pair])
    print(f"\nLeft out: {listed(said['left_out'])}. Corrected: {corrected(said)}.\n\n{len(kept)} views of the {len(keys)} tags of both maps; "
          f"{(~kept).sum()} are dropped, whose worst corner lies over {limit_px:.2f} px off under both maps and every camera.")
    rms_px = {how: [one.plain_rms_px(kept) for one in pair] for how, pair in found.items()}
    recordings.table([{"corners": reading, "camera": camera, "our map, px": f"{ours:.4f}", "TagSLAM's map, px": f"{theirs:.4f}",
                       "the least that any map leaves, px": f"{found[reading, camera][1].least_rms_px(kept):.4f}"}
                      for (reading, camera), (ours, theirs) in rms_px.items()])
    verdict_of_reprojection(name, said, rms_px, first)
    if "camera" in said:
        is_told = is_as_told(read_rig(folder / "camera.yaml"), read_rig(output.with_suffix(".camera.yaml")), said)
        VERDICTS.add("recorded", f"{name}: the camera written has the corrections that are told", "yes", "yes" if is_told else "no", is_told)
    VERDICTS.add("recorded", f"{name}: tags of TagSLAM's map that ours has not", "none", listed(missing), not missing)


def is_as_told(given, refined, said):
    """Whether the refined camera differs from the given one by the corrections that were told, of focal length and centre."""
    found = {"focal length": lambda name: refined[name].intrinsics[0] / given[name].intrinsics[0] - 1,
             "cx": lambda name: refined[name].intrinsics[2] - given[name].intrinsics[2],
             "cy": lambda name: refined[name].intrinsics[3] - given[name].intrinsics[3]}
    return all(np.isclose(found[c["parameter"]](c["camera"]), c["value"], rtol=0.02, atol=1e-5) for c in said["corrections"] if c["parameter"] in found)


def verdict_of_reprojection(name, said, rms_px, first):
    """The map as it is handed over: with the camera written beside it, if there is one, as `track` would be given both."""
    theirs = rms_px[first][1]
    handed_over = ("as read", "refined with our map") if "camera" in said else first
    words = "own camera" if "camera" in said else "camera of the file"
    VERDICTS.add("recorded", f"{name}: px rms, own map, {words}, against TagSLAM's in the file's", f"<= {theirs:.4f}", f"{rms_px[handed_over][0]:.4f}",
                 rms_px[handed_over][0] <= theirs)
    reading, camera = list(rms_px)[-1]
    if reading != "as read":  # TagSLAM's map was made of the corners as read: the better of its two figures is the opponent
        theirs = min(rms_px[first][1], rms_px[reading, first[1]][1])
        VERDICTS.add("recorded", f"{name}: the same, with the edge offset that is told removed, against the better of TagSLAM's", f"<= {theirs:.4f}",
                     f"{rms_px[reading, camera][0]:.4f}", rms_px[reading, camera][0] <= theirs)
