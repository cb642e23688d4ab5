"""Figures over many worlds, as Markdown and as JSON; and, of odd seeds, world by world."""
import collections

import numpy as np

CELL_BINS = ((0, 1.5), (1.5, 2), (2, 3), (3, 5), (5, 8), (8, np.inf))
ANGLE_BINS = ((0, 30), (30, 45), (45, 55), (55, 65), (65, 75), (75, 90))
TIME_PARTS = ("make", "doctor", "calibrate", "detect")


def table(rows):
    if not rows:
        return ""
    heads = list(rows[0])
    lines = ["| " + " | ".join(heads) + " |", "|" + "---|" * len(heads)]
    lines += ["| " + " | ".join(str(row[head]) for head in heads) + " |" for row in rows]
    return "\n".join(lines) + "\n"


def quantile(values, share):
    return float(np.quantile(values, share)) if len(values) else float("nan")


def figures_of_maps(outcomes):
    """Of clean worlds."""
    maps = [o for o in outcomes if o.status == 0]
    joined, tags = sum(len(o.joined) for o in outcomes), sum(o.tags for o in outcomes)
    lost = sum(len(o.lost()) for o in outcomes)
    nees = [value for o in maps for value in o.map["nees_over_6"].values()]
    rms = [o.map["rms_mm"] for o in maps if "rms_mm" in o.map]
    return {
        "worlds": len(outcomes), "without a map": len(outcomes) - len(maps), "failed": sum(bool(o.failure) for o in outcomes),
        "tags": tags, "joined": joined, "mapped of those joined": (joined - lost) / max(joined, 1),
        "mapped": sum(len(o.map["mapped"]) for o in maps), "worlds with all joined tags": sum(not o.lost() for o in maps),
        "sound tags accused": sum(len(o.accused) for o in outcomes), "worlds that accuse": sum(bool(o.accused) for o in outcomes),
        "worlds that accuse the sound camera": sum(o.is_camera_accused for o in outcomes), "sound tags doubted": sum(len(o.doubted) for o in outcomes), "left out, joined": sum(len(set(o.left_out) & set(o.joined)) for o in outcomes),
        "flipped": sum(len(o.map["flipped"]) for o in maps), "wrong claims": sum(len(o.map["wrong_claims"]) for o in maps),
        "worlds with wrong claims": sum(bool(o.map["wrong_claims"]) for o in maps),
        "rms mm: median, 90 %, max": [quantile(rms, q) for q in (0.5, 0.9, 1.0)],
        "rms deg: median, 90 %, max": [quantile([o.map["rms_deg"] for o in maps if "rms_deg" in o.map], q) for q in (0.5, 0.9, 1.0)],
        "nees/6: median, mean": [quantile(nees, 0.5), float(np.mean(nees)) if nees else float("nan")],
    }


def doctor_against_calibrate(outcomes):
    """Rows: doctor's verdict; columns: what calibrate made of it."""
    counts = collections.Counter((o.verdict, outcome_of(o)) for o in outcomes)
    kinds = ("whole, no accusation", "tags lost", "sound tag accused", "no map")
    return [{"doctor": verdict, **{kind: counts[verdict, kind] for kind in kinds}} for verdict in sorted({o.verdict for o in outcomes})]


def outcome_of(outcome):
    if outcome.status != 0:
        return "no map"
    if outcome.accused:
        return "sound tag accused"
    return "tags lost" if outcome.lost() else "whole, no accusation"


def corner_rows(outcomes):
    """By cell width, of views below 55 degrees; and by angle, of cells of 2 px and more."""
    found = [o.corners for o in outcomes if o.corners is not None and len(o.corners)]
    all_rows = np.concatenate(found) if found else np.zeros((0, 9))
    rows = []
    for title, column, bins, chosen in (("cell px", 0, CELL_BINS, all_rows[:, 1] < 55), ("angle deg", 1, ANGLE_BINS, all_rows[:, 0] >= 2)):
        for low, high in bins:
            some = all_rows[chosen & (all_rows[:, column] >= low) & (all_rows[:, column] < high)]
            rows.append({"bin": f"{title} {low:g} to {high:g}", "views": len(some), "median px": f"{quantile(some[:, 3], 0.5):.3f}",
                         "95 % px": f"{quantile(some[:, 3], 0.95):.3f}", "edges' bias px": f"{some[:, 4:8].mean():+.4f}" if len(some) else "-"})
    return rows


def figures_of_corners(outcomes):
    found = [o.corners for o in outcomes if o.corners is not None and len(o.corners)]
    all_rows = np.concatenate(found) if found else np.zeros((0, 9))
    good, missed = sum(o.good_views for o in outcomes), sum(o.missed_views for o in outcomes)
    return {"detections of whole tags": len(all_rows), "good views": good, "good views missed": missed / max(good, 1),
            "detections of nothing": sum(o.strangers for o in outcomes), "median px": quantile(all_rows[:, 3], 0.5), "95 % px": quantile(all_rows[:, 3], 0.95),
            "edges' bias px": float(all_rows[:, 4:8].mean()) if len(all_rows) else float("nan")}


def worse_than_clean_twins(some, clean):
    """Of maps with a fault that is not named: by how many mm the farthest sound tag is off beyond that of the same seed's clean world. It asks
    nothing of what maps claim."""
    twins = {o.seed: max(o.map["off_mm"].values()) for o in clean if o.map.get("off_mm")}
    unnamed = [o for o in some if o.verdict_of_fault() != "named" and o.map.get("off_mm") and o.seed in twins]
    return [max(o.map["off_mm"].values()) - twins[o.seed] for o in unnamed]


def fault_rows(outcomes, clean):
    rows = []
    for fault in [*sorted({o.fault for o in outcomes}), "all"]:
        some = [o for o in outcomes if fault in ("all", o.fault)]
        counts = collections.Counter(o.verdict_of_fault() for o in some)
        blamed = counts["named"] + counts["harmful"]
        rows.append({"fault": fault, "worlds": len(some), "named": counts["named"], "harmless": counts["harmless"], "missed and harmful": counts["harmful"],
                     "score": f"{counts['named'] / blamed:.2f}" if blamed else "-", "tag accused, of any kind": sum(o.is_tag_named for o in some),
                     "sound tags accused": sum(len(o.accused) for o in some), "no map": sum(o.status != 0 for o in some), "of them named": sum(o.status != 0 and o.is_named for o in some),
                     "unnamed, mm beyond the clean twin: median, most": shown([quantile(worse_than_clean_twins(some, clean), q) for q in (0.5, 1.0)])})
    return rows


def times(outcomes):
    parts = {part: [o.cpu_s[part] for o in outcomes if part in o.cpu_s] for part in TIME_PARTS}
    return {"core-seconds a world": sum(sum(o.cpu_s.values()) for o in outcomes) / max(len(outcomes), 1),
            "most": max((sum(o.cpu_s.values()) for o in outcomes), default=0.0),
            "by part, mean": {part: float(np.mean(values)) for part, values in parts.items() if values}}


def shown(value):
    if isinstance(value, float):
        return f"{value:.4g}"
    if isinstance(value, list):
        return ", ".join(map(shown, value))
    if isinstance(value, dict):
        return ", ".join(f"{key} {shown(one)}" for key, one in value.items())
    return str(value)


def listed(figures):
    return table([{"what": key, "figure": shown(value)} for key, value in figures.items()])


def aggregates(outcomes):
    clean, faulty = ([o for o in outcomes if (o.fault == "none") is is_clean] for is_clean in (True, False))
    return {"clean": figures_of_maps(clean) if clean else {}, "doctor": doctor_against_calibrate(clean), "corners": figures_of_corners(clean) if clean else {},
            "corner_bins": corner_rows(clean) if clean else [], "faults": fault_rows(faulty, clean) if faulty else [], "time": times(outcomes)}


def markdown(found):
    text = ""
    for title, part in (("Clean worlds", "clean"), ("Corners of `detect`", "corners"), ("Time", "time")):
        if found[part]:
            text += f"\n## {title}\n\n{listed(found[part])}"
    for title, part in (("Doctor's verdict against calibrate", "doctor"), ("Corners by size and angle", "corner_bins"), ("Planted faults", "faults")):
        if found[part]:
            text += f"\n## {title}\n\n{table(found[part])}"
    return text


def of_world(outcome):
    """One line, of an odd seed."""
    drawn = outcome.drawn
    lens, motion = drawn.get("lens", {}), drawn.get("motion", {})
    return {"seed": outcome.seed, "fault": outcome.fault, "kind": outcome.kind, "tags": outcome.tags, "joined": len(outcome.joined),
            "mapped": len(outcome.map.get("mapped", [])), "lost": " ".join(outcome.lost()), "accused": shown(outcome.accused),
            "flipped": " ".join(outcome.map.get("flipped", [])), "wrong": len(outcome.map.get("wrong_claims", [])),
            "mm": f"{outcome.map.get('rms_mm', float('nan')):.2f}", "nees": f"{np.mean(list(outcome.map.get('nees_over_6', {}).values()) or [np.nan]):.2f}",
            "verdict": outcome.verdict, "fault found": outcome.verdict_of_fault() if outcome.fault != "none" else "-",
            "lens": f"{lens.get('width')}x{lens.get('height')} {lens.get('model')} {lens.get('fov_deg', 0):.0f}", "motion": motion.get("carrier"),
            "cpu_s": f"{sum(outcome.cpu_s.values()):.0f}", "failure": outcome.failure}
