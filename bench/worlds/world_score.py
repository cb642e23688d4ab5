"""Judges a calibrated map, and the corners that were found, against the truth of a world; independent of the program's own code."""
import csv

import numpy as np
import yaml

import room_trials
from world_truth import matrix

FLIPPED_DEG = 10.0
CHI2_6_999, CHI2_6_3_SIGMAS = 22.458, 20.062  # of six degrees of freedom: 99.9 %, and the 99.73 % of 3 sigmas
STRAY_PX = 5.0  # a corner farther off is of another tag, or of clutter
MIN_RMS_ALIGNED = 3  # sound tags, for an alignment of the map


def read_map(path):
    """By key: (T_map_tag, covariance or None, flags)."""
    file = yaml.load(path.read_text(), getattr(yaml, "CSafeLoader", yaml.SafeLoader))
    tags = {}
    for tag in file["tags"]:
        p, o = tag["pose"]["position"], tag["pose"]["orientation"]
        T = matrix([p["x"], p["y"], p["z"], o["x"], o["y"], o["z"], o["w"]])
        covariance = np.array(tag["covariance"]).reshape(6, 6) if "covariance" in tag else None
        key = f"{tag.get('family', file.get('default_family', 'tag36h11'))}/{tag['id']}"
        tags[key] = (T, covariance, tag.get("statistics", {}).get("flags", []))
    return tags


def normalised_errors(found, places):
    """By key: xi' P^-1 xi of T_held_tag, six degrees of freedom, against the nearest of the tag's true places."""
    held = next((key for key, (_, P, _) in found.items() if P is not None and not P.any()), None)
    if held is None or held not in places:
        return {}
    errors = {}
    for key, (T, P, _) in found.items():
        if key == held or P is None or key not in places:
            continue
        estimate = np.linalg.inv(found[held][0]) @ T
        errors[key] = min(6 * room_trials.normalised_error(np.linalg.inv(at) @ true, estimate, P) for at in places[held] for true in places[key])
    return errors


def judge_map(path, truth):
    """What is right and wrong of the tags in the map."""
    found = {key: tag for key, tag in read_map(path).items() if key in truth.places}
    errors = normalised_errors(found, truth.places)
    sound = sorted(set(found) - truth.culprits)
    judged = {"mapped": sorted(found), "flagged": sorted(key for key, tag in found.items() if "weak" in tag[2]), "flipped": [], "off_mm": {},
              "wrong_claims": sorted(key for key, e in errors.items() if e > CHI2_6_999 and key not in truth.culprits),
              "over_3_sigma": sorted(key for key, e in errors.items() if e > CHI2_6_3_SIGMAS),
              "nees_over_6": {key: e / 6 for key, e in errors.items() if key not in truth.culprits}}
    if len(sound) < MIN_RMS_ALIGNED:
        return judged
    A, B = np.array([truth.places[key][0] for key in sound]), np.array([found[key][0] for key in sound])
    aligned = room_trials.robust_alignment(A, B) @ B
    turned = np.degrees(np.arccos(np.clip((np.einsum("nij,nij->n", A[:, :3, :3], aligned[:, :3, :3]) - 1) / 2, -1, 1)))
    off_mm = 1e3 * np.linalg.norm(A[:, :3, 3] - aligned[:, :3, 3], axis=1)
    judged.update(flipped=[key for key, angle in zip(sound, turned) if angle > FLIPPED_DEG], off_mm=dict(zip(sound, off_mm)),
                  rms_mm=float(np.sqrt((off_mm**2).mean())), rms_deg=float(np.sqrt((turned**2).mean())))
    return judged


def read_detections(path):
    """{(timestamp_ns, key): corners (4, 2)}; the last of several."""
    with open(path) as file:
        return {(int(row["timestamp_ns"]), f"{row['family']}/{row['id']}"): np.array([[float(row[f"c{i}{axis}"]) for axis in "xy"] for i in range(4)])
                for row in csv.DictReader(file)}


def corner_errors(path, truth):
    """Rows (cell width px, view angle deg, blur px, rms of the four corners px, four offsets of the edges along their outward normals px, view
    is good) of detections of whole, sound tags; how many good views were missed; how many detections are of nothing."""
    from world_truth import is_good
    found = read_detections(path)
    rows, missed, good, seen = [], 0, 0, set()
    for timestamp_ns, view in truth.views():
        key = view["key"]
        seen.add((timestamp_ns, key))
        if view["visible_fraction"] < 1.0 or key in truth.culprits:
            continue
        good += is_good(view)
        corners = found.get((timestamp_ns, key))
        if corners is None:
            missed += is_good(view)
            continue
        true = np.array(view["corners_px"]).reshape(4, 2)
        error = corners - true
        rms = np.sqrt((error**2).sum(1).mean())
        if rms > STRAY_PX:
            missed += is_good(view)
            continue
        along = np.roll(true, -1, 0) - true
        outward = np.stack([along[:, 1], -along[:, 0]], 1) / np.linalg.norm(along, axis=1, keepdims=True)
        outward *= np.sign(((true + 0.5 * along - true.mean(0)) * outward).sum(1, keepdims=True))
        offsets = ((error + np.roll(error, -1, 0)) / 2 * outward).sum(1)
        cell_px = view["shortest_side_px"] / truth.cells_across[key]
        rows.append([cell_px, view["view_angle_deg"], view["blur_px"], rms, *offsets, is_good(view)])
    strangers = len(set(found) - seen)
    return np.array(rows).reshape(-1, 9), good, missed, strangers
