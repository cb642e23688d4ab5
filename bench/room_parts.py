"""The parts of bench/calibration that try random rooms: montecarlo, outliers, faults. bench/make_room makes any of their rooms again."""
import collections
import math
import re
import statistics

import engine_tools as tools
import room_faults
import room_trials
from engine_tools import VERDICTS, recordings

ROOMS = {"montecarlo": 100, "outliers": 150, "flips": 100, "faults": 300}
QUICK_ROOMS = 16
FAULTS = list(room_trials.KIND_WORDS)
SIGMA_BINS = ((0.05, 0.10), (0.10, 0.15), (0.15, 0.20), (0.20, 0.25), (0.25, 0.30))
VIEW_BINS = ((0, 25), (25, 50), (50, 80), (80, math.inf))
EVIDENCE_BINS = ((8, 15), (15, 30), (30, 60), (60, 120), (120, 300), (300, math.inf))
MAP_EVIDENCE_BINS = ((0, 8), *EVIDENCE_BINS)
PX_BINS = ((0, 0.5), (0.5, 1), (1, 2), (2, 5), (5, 20), (20, math.inf))
LISTED = 10
OUTLIERS_INTRODUCTION = """
## Outliers, and tags that two poses fit

Outliers: of each room 10 % of the corners, or 10 % of the views as a whole, or 5 % of each, by 3 to 50 px or (of a third of the views)
corners in a turned order. Flips: tags of 8 to 12 cm on one wall, 2 to 7 m off and nearly square to them, by lenses of 14 to 32 degrees,
noise of 0.15 to 0.3 px. A tag of a map is flipped that is turned by over 10 degrees, displaced that is off by over 5 sigma and a tenth of
its distance; silently so where neither the flag `weak` nor a warning on few tags says so. Misfit: by how much chi squared its views, the
cameras known, speak against the map's pose; inf: they fit nowhere about it.
"""


FAULTS_INTRODUCTION = """
## Planted faults

One fault a room, as bench/room_faults.py says. Named: a warning or the error names the tag and this kind of fault, and no other kind.
Evidence, in sigmas: what no pose of the tag explains, the cameras' poses known; of a map: what no map without a fault explains, whatever the
poses (bench/room_maps.py). Of wrong sizes, duplicates, moves, bends and loose tags those with less than 8 of the latter hide behind the cameras'
poses (a tag that is seen beside one copy of an id alone lies, for all that is seen, beside the other), and are counted apart.
"""


def tried(b, kind, number, held="first", scorer=None):
    """Outcomes of seeds in turn, the commands printed once for all of them."""
    number = b.args.rooms or (QUICK_ROOMS if b.args.quick else number)
    trials = room_trials.Trials(b.program, scorer, b.args.processes, held)
    first, last = b.args.first_room, b.args.first_room + number - 1
    print(f"    # for SEED in {first} to {last}: bench/make_room --kind {kind} --seed SEED --output OUT")
    words = " ".join(room_trials.command("apriltrack", b.out))
    print(f"    {b.shown([words])}{'' if held == 'first' else f' --held-tag (the one {held} seen)'}", flush=True)
    return room_trials.run(trials, kind, range(first, last + 1))


def quantiles(values, *shares, digits=2):
    return " / ".join(f"{tools.percentile(values, share):.{digits}f}" for share in shares) if values else "-"


def mean(values):
    known = [value for value in values if not math.isnan(value)]
    return statistics.fmean(known) if known else math.nan


def in_bin(value, limits):
    return limits[0] <= value and (value < limits[1] or limits[1] == math.inf)


def bin_text(limits):
    return f"{limits[0]:g}+" if limits[1] == math.inf else f"{limits[0]:g} to {limits[1]:g}"


def seeds_of(outcomes):
    listed = " ".join(str(o.seed) for o in outcomes[:LISTED])
    return (listed + (" ..." if len(outcomes) > LISTED else "")) or "-"


def nees(outcome):
    return outcome.score.get("nees_over_6", {}).get("mean", math.nan)


def nees_row(name, outcomes):
    values = [nees(o) for o in outcomes if not math.isnan(nees(o))]
    return {"rooms": name, "maps": len(values), "nees/6: mean": f"{mean(values):.3f}", "5 / 25 / 50 / 75 / 95 %":
            quantiles(values, 0.05, 0.25, 0.5, 0.75, 0.95)}


def montecarlo(b):
    print("\n## Honesty: random rooms\n\nNoise of 0.05 to 0.3 px; of 0.05 px more that each tag keeps, but in the rooms `unbiased`.\n")
    scorer = b.tools / "score_map.py"
    rows, by_held = [], {}
    for held in ("first", "most", "least"):
        by_held[held] = tried(b, "clean", ROOMS["montecarlo"], held, scorer)
        rows.append(nees_row({"first": "held: the least id (default)"}.get(held, f"held: the tag {held} seen"), by_held[held]))
    outcomes = by_held["first"]
    for limits in SIGMA_BINS:
        rows.append(nees_row(f"noise {bin_text(limits)} px", [o for o in outcomes if in_bin(o.sigma_px, limits)]))
    for limits in VIEW_BINS:
        rows.append(nees_row(f"{bin_text(limits)} views a tag", [o for o in outcomes if in_bin(o.views / o.tags_there, limits)]))
    rows.append(nees_row("unbiased", tried(b, "unbiased", ROOMS["montecarlo"], "first", scorer)))
    recordings.table(rows)
    without = [o for o in outcomes if o.status]
    short = [o for o in outcomes if o.status == 0 and o.tags_mapped < o.tags_there]
    warned = [o for o in outcomes if o.status == 0 and o.statements]
    found = {"no map": without, "tags missing": short, "warnings": warned, "a tag in a wrong place": [o for o in outcomes if o.wrong]}
    recordings.table([{"of the first row": what, "rooms": len(some), "seeds": seeds_of(some)} for what, some in found.items()])
    words([o for o in outcomes if o.statements])
    figure = mean([nees(o) for o in outcomes])
    VERDICTS.add("montecarlo", f"nees/6, mean of {len(outcomes) - len(without)} maps", "0.85 to 1.15", f"{figure:.3f}", 0.85 <= figure <= 1.15)
    VERDICTS.add("montecarlo", "rooms without a map", "0", str(len(without)), not without)


def without_names(text):
    """What kind of statement it is."""
    return re.sub(r"\d+(\.\d+)?", "#", re.sub(r"tag36h11/\d+( \(\d+ of \d+\))?(, |( with )?tag36h11/\d+( \(\d+ of \d+\))?)*", "TAGS", text))


def words(outcomes):
    """What was said, how often, of which seeds."""
    said = collections.defaultdict(list)
    for o in outcomes:
        for text in {without_names(text) for text in o.statements}:
            said[text].append(o)
    rows = [{"status": some[0].status, "words": text[:150], "rooms": len(some), "for example": ", ".join(f"{o.kind} {o.seed}" for o in (some if some[0].is_crash() else some[:3]))}
            for text, some in sorted(said.items(), key=lambda item: -len(item[1]))]
    if rows:
        recordings.table(rows)


def wrong_row(o):
    """Of a map with tags in wrong places, the worst of them told in full: the one that is silent, or most plainly wrong."""
    worst = max(o.wrong, key=lambda tag: (tag.is_silent(), min(tag.misfit, 1e9), tag.degrees))
    return {"kind": o.kind, "seed": o.seed,
            "tags wrong / silently / mapped": f"{len(o.wrong)} / {sum(tag.is_silent() for tag in o.wrong)} / {o.tags_mapped}",
            "the plainest": worst.tag, "degrees": f"{worst.degrees:.1f}", "mm (sigma)": f"{worst.mm:.0f} ({worst.sigma_mm:.0f})",
            "views of px": f"{worst.views} of {worst.edge_px:.0f}", "weak": worst.is_weak, "spoken of": worst.is_spoken_of,
            "misfit": f"{worst.misfit:.1f}"}


def outlier_row(kind, outcomes):
    maps = [o for o in outcomes if o.status == 0]
    wrong = [tag for o in maps for tag in o.wrong]
    return {"rooms": kind, "number": len(outcomes), "maps": len(maps), "refused (1)": sum(o.status == 1 for o in outcomes),
            "crashes": sum(o.is_crash() for o in outcomes), "tags in maps": sum(o.tags_mapped for o in maps),
            "flipped": sum(tag.is_flipped() for tag in wrong), "displaced only": sum(not tag.is_flipped() for tag in wrong),
            "silently": sum(tag.is_silent() for tag in wrong), "maps with these": sum(o.is_silently_wrong() for o in maps),
            "nees/6 median": quantiles([o.sound_nees for o in maps if not math.isnan(o.sound_nees)], 0.5),
            "mm rms median": quantiles([o.sound_mm for o in maps if not math.isnan(o.sound_mm)], 0.5)}


def outliers(b):
    print(OUTLIERS_INTRODUCTION)
    by_kind = {"outliers": tried(b, "outliers", ROOMS["outliers"]), "outliers_flips": tried(b, "outliers_flips", ROOMS["outliers"]),
               "flips": tried(b, "flips", ROOMS["flips"])}
    recordings.table([outlier_row(kind, outcomes) for kind, outcomes in by_kind.items()])
    together = sum(by_kind.values(), [])
    if wrong := sorted((o for o in together if o.wrong), key=lambda o: (not o.is_silently_wrong(), -len(o.wrong))):
        recordings.table([wrong_row(o) for o in wrong])
    words([o for o in together if o.status])
    flipped = sum(tag.is_flipped() for o in together for tag in o.wrong)
    silent = sum(tag.is_flipped() and tag.is_silent() for o in together for tag in o.wrong)
    maps = sum(o.status == 0 for o in together)
    VERDICTS.add("outliers", f"flipped tags in {maps} accepted maps", "0", f"{flipped} ({silent} silently)", not flipped)
    crashes = [o for o in together if o.is_crash()]
    VERDICTS.add("outliers", f"crashes in {len(together)} rooms", "0", str(len(crashes)), not crashes)


def share(outcomes, is_counted):
    return f"{sum(map(is_counted, outcomes))}/{len(outcomes)}" if outcomes else "-"


def fault_row(kind, outcomes):
    maps = [o for o in outcomes if o.status == 0]
    return {"fault": kind, "rooms": len(outcomes), "refused (1)": sum(o.status == 1 for o in outcomes),
            "crashes": sum(o.is_crash() for o in outcomes),
            "tag left out": share(outcomes, lambda o: bool(set(o.culprits) & set(o.left_out))),
            "tag named": share(outcomes, lambda o: o.is_tag_named), "kind among others": share(outcomes, lambda o: kind in o.kinds_said),
            "tag and kind": share(outcomes, lambda o: o.is_named()),
            "of those that a map cannot hide": share(list(filter(is_seen, outcomes)), lambda o: o.is_named()), "others accused": share(outcomes, lambda o: bool(o.accused)),
            "in the map, in silence": share(outcomes, lambda o: o.is_culprit_mapped and not o.is_tag_named),
            "maps with sound tags silently wrong": sum(o.is_silently_wrong() for o in maps),
            "sound tags: nees/6, mm rms (medians)": f"{quantiles([o.sound_nees for o in maps if not math.isnan(o.sound_nees)], 0.5)}, "
                                                    f"{quantiles([o.sound_mm for o in maps if not math.isnan(o.sound_mm)], 0.5)}",
            "s mean / max": f"{statistics.fmean(o.seconds for o in outcomes):.2f} / {max(o.seconds for o in outcomes):.1f}"}


def by_size(kind, outcomes, value, bins, is_counted):
    binned = {bin_text(limits): [o for o in outcomes if in_bin(value(o), limits)] for limits in bins}
    return {"fault": kind, **{name: share(some, is_counted) for name, some in binned.items()}}


def is_seen(outcome):
    """Whether no map without a fault explains the views: else nobody can tell, as no camera's pose is known."""
    return not outcome.map_evidence < room_faults.MIN_EVIDENCE


def faults(b):
    print(FAULTS_INTRODUCTION)
    outcomes = {kind: tried(b, kind, ROOMS["faults"]) for kind in FAULTS}
    recordings.table([fault_row(kind, of_kind) for kind, of_kind in outcomes.items()])
    unexplained = "evidence, in sigmas: what no pose of the tag explains"
    by_evidence = (unexplained, lambda o: o.evidence, EVIDENCE_BINS, room_faults.WITH_EVIDENCE)
    by_map = ("evidence of a map, in sigmas: what no map without a fault explains", lambda o: o.map_evidence, MAP_EVIDENCE_BINS,
              (*room_faults.WITH_EVIDENCE, "duplicate"))
    by_px = ("the fault's rms in px", lambda o: o.signal_px, PX_BINS, [kind for kind in FAULTS if kind != "one_frame"])
    for title, value, bins, kinds in (by_evidence, by_map, by_px):
        for what, is_counted in (("Tag named", lambda o: o.is_tag_named), ("Tag and kind named", lambda o: o.is_named())):
            print(f"\n{what}, by {title}:\n")
            recordings.table([by_size(kind, outcomes[kind], value, bins, is_counted) for kind in kinds])
    print("\nNot named, the plainest first, and sound tags silently wrong:\n")
    recordings.table([{"fault": kind, "no tag named": plainest(of_kind, lambda o: not o.is_tag_named),
                       "kind not named": plainest(of_kind, lambda o: o.is_tag_named and not o.is_named()),
                       "silently wrong": seeds_of([o for o in of_kind if o.is_silently_wrong()])} for kind, of_kind in outcomes.items()])
    words([o for of_kind in outcomes.values() for o in of_kind])
    false_alarms(b)
    for kind, of_kind in outcomes.items():
        seen = list(filter(is_seen, of_kind))
        VERDICTS.at_least("faults", f"{kind}: share named, of all {len(of_kind)}", 0.95, sum(o.is_named() for o in of_kind) / len(of_kind))
        if len(seen) < len(of_kind):
            VERDICTS.at_least("faults", f"{kind}: share named, of the {len(seen)} that a map cannot hide", 0.95,
                              sum(o.is_named() for o in seen) / len(seen))
    crashes = sum(o.is_crash() for of_kind in outcomes.values() for o in of_kind)
    VERDICTS.add("faults", "crashes", "0", str(crashes), not crashes)


def plainest(outcomes, is_chosen):
    return seeds_of(sorted(filter(is_chosen, outcomes), key=lambda o: -(o.signal_px if math.isnan(o.evidence) else o.evidence)))


def false_alarms(b):
    print("\nWithout a fault:\n")
    outcomes = tried(b, "clean", ROOMS["faults"])
    alarms = [o for o in outcomes if o.status or o.complaints()]
    doubtful = [o for o in outcomes if o.left_out and o not in alarms]
    recordings.table([{"rooms": len(outcomes), "refused, or a fault named": len(alarms), "seeds": seeds_of(alarms),
                       "tags left out, for two poses fit them": len(doubtful), "their seeds": seeds_of(doubtful),
                       "maps with a tag in a wrong place": seeds_of([o for o in outcomes if o.wrong]),
                       "silently": seeds_of([o for o in outcomes if o.is_silently_wrong()])}])
    words([o for o in outcomes if o.statements])
    VERDICTS.at_most("faults", "false alarms in clean rooms: refused, or a fault named, share", 0.02, len(alarms) / len(outcomes))
    VERDICTS.at_most("faults", "the same, or a tag left out, share", 0.02, (len(alarms) + len(doubtful)) / len(outcomes))


PARTS = {"montecarlo": montecarlo, "outliers": outliers, "faults": faults}
