"""Runs `apriltrack calibrate` on random rooms, several at a time, and judges what it says and writes against what was planted.

usage: outcomes = room_trials.run(room_trials.Trials(program), "moved", range(1, 301))

An outcome knows status, words, the accepted map's errors, and which tags of it are wrong. The words are judged by KIND_WORDS alone:
the table to change when the program's words change. Needs python3-numpy and python3-yaml.
"""
from dataclasses import dataclass, field
import functools
import json
import multiprocessing
import pathlib
import re
import resource
import signal
import subprocess
import tempfile
import time

import numpy as np
import yaml

import room_faults
import room_fits
import room_maps

# What a complaint must say to have named a kind of fault.
KIND_WORDS = {
    "wrong_size": r"\bsizes?\b",
    "duplicate": r"two places|places at once|not one tag|duplicate|\bcopies\b",
    "moved": r"\bmoved\b",
    "bent": r"\bben[dt]\b|not flat|\bcurled\b|\btwisted\b",
    "loose": r"\bloose\b|\bmoves\b|\bflaps\b",
    "one_frame": r"fewer than \d+ frames|\bone frame\b|single frame|never seen together",
    "focal": r"focal length|intrinsics",
}
# Kinds whose fault is the camera's, not a tag's.
TAGLESS = ("focal",)
WRONG_DEG, WRONG_SHARE, WRONG_SIGMAS = 10.0, 0.1, 5.0
MAX_NAMED_SHARE = 1 / 3  # a warning that names more of the map's tags says nothing of one
OUTPUT = "calibrated.yaml"
MOST_CPU_S = 120  # not of the clock: whatever else the machine does makes no crash of a slow room
MOST_WAIT_S = 20 * MOST_CPU_S  # where something waits for ever


@dataclass
class WrongTag:
    tag: int
    degrees: float
    mm: float
    sigma_mm: float
    views: int
    edge_px: float
    is_weak: bool  # flagged so in the map
    misfit: float  # by how much its views fit the map's pose worse than the true one (chi squared, cameras known)
    is_spoken_of: bool = False  # by a warning that does not name every other tag, too

    def is_flipped(self):
        return self.degrees > WRONG_DEG

    def is_silent(self):
        return not self.is_weak and not self.is_spoken_of


@dataclass
class Outcome:
    kind: str
    seed: int
    status: int
    statements: list  # warnings, or the error
    left_out: list  # ids
    seconds: float
    culprits: list
    size: str
    signal_px: float
    evidence: float
    sigma_px: float
    views: int
    tags_there: int = 0
    map_evidence: float = float("nan")  # in sigmas: what no map without a fault explains
    is_tag_named: bool = False
    kinds_said: set = field(default_factory=set)  # all kinds that statements on the culprit name
    is_kind_said_alone: bool = False  # by one statement on the culprit that names no other kind
    accused: list = field(default_factory=list)  # other tags that a statement of some kind names
    wrong: list = field(default_factory=list)  # WrongTag: those without a fault of which the map tells a wrong place
    is_culprit_mapped: bool = False
    sound_mm: float = float("nan")  # rms of the tags that have no fault
    sound_nees: float = float("nan")  # over 6, their mean
    tags_mapped: int = 0
    score: dict = field(default_factory=dict)  # the independent scorer's, where it is asked for

    def is_crash(self):
        return self.status not in (0, 1, 2, 3)

    def is_named(self):
        return self.is_tag_named and self.is_kind_said_alone

    def complaints(self):
        return [text for text in self.statements if kinds_in(text)]

    def is_silently_wrong(self):
        """A map with a tag in a wrong place that is neither flagged weak nor spoken of."""
        return any(tag.is_silent() for tag in self.wrong)


def kinds_in(text):
    return {kind for kind, words in KIND_WORDS.items() if re.search(words, text, re.IGNORECASE)}


def tags_in(text):
    return {int(number) for number in re.findall(r"tag36h11/(\d+)", text)}


def command(program, folder):
    return [str(program), "calibrate", "--detections", str(folder / "detections.csv"), "--camera", str(folder / "camera.yaml"), "--tag-sizes",
            str(folder / "tag_sizes.yaml"), "--output", str(folder / OUTPUT), "--json", "--quiet", "--threads", "1"]


def limit_cpu():
    resource.setrlimit(resource.RLIMIT_CPU, (MOST_CPU_S, MOST_CPU_S + 1))


def calibrate(program, folder, *more):
    """(status, what it said: its summary, or the error's text, seconds)"""
    begin = time.monotonic()
    done = subprocess.run([*command(program, folder), *more], capture_output=True, text=True, timeout=MOST_WAIT_S, preexec_fn=limit_cpu)
    if done.returncode == -signal.SIGXCPU:
        return done.returncode, f"no end within {MOST_CPU_S} s of CPU", time.monotonic() - begin
    said = json.loads(done.stdout) if done.returncode == 0 else done.stderr.strip()
    return done.returncode, said, time.monotonic() - begin


def read_map(path):
    """By id: (T_map_tag, covariance or None, flags)."""
    tags = {}
    for tag in yaml.load(path.read_text(), getattr(yaml, "CSafeLoader", yaml.SafeLoader))["tags"]:
        p, o = tag["pose"]["position"], tag["pose"]["orientation"]
        x, y, z, w = np.array([o[k] for k in "xyzw"]) / np.linalg.norm([o[k] for k in "xyzw"])
        T = np.eye(4)
        T[:3, :3] = [[1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
                     [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
                     [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)]]
        T[:3, 3] = [p[k] for k in "xyz"]
        covariance = np.array(tag["covariance"]).reshape(6, 6) if "covariance" in tag else None
        tags[tag["id"]] = (T, covariance, tag.get("statistics", {}).get("flags", []))
    return tags


def alignment(A, B):
    """The rigid T that takes poses B to poses A best, as the scorer of SHARED weighs places and rotations."""
    a, b = A[:, :3, 3], B[:, :3, 3]
    spread2 = max(((a - a.mean(0))**2).sum(1).mean(), 1e-18)
    M = (a - a.mean(0)).T @ (b - b.mean(0)) / spread2 / len(a) + 0.01 * np.einsum("nij,nkj->ik", A[:, :3, :3], B[:, :3, :3]) / len(a)
    U, _, V = np.linalg.svd(M)
    T = np.eye(4)
    T[:3, :3] = U @ np.diag([1, 1, np.linalg.det(U @ V)]) @ V
    T[:3, 3] = a.mean(0) - T[:3, :3] @ b.mean(0)
    return T


def robust_alignment(A, B):
    """Of the tags that agree: those that a first alignment leaves far off do not take part in the second."""
    chosen = np.ones(len(A), bool)
    for _ in range(5):
        T = alignment(A[chosen], B[chosen])
        aligned = T @ B
        off = np.linalg.norm(A[:, :3, 3] - aligned[:, :3, 3], axis=1) / 0.05 + room_fits.angles_deg(A, aligned) / 2
        chosen = off <= max(3 * np.median(off), 1e-9)
    return T


def normalised_error(true, estimate, covariance):
    """Of T_held_tag, over 6."""
    D = np.linalg.inv(estimate) @ true
    angle = np.arccos(np.clip((np.trace(D[:3, :3]) - 1) / 2, -1, 1))
    turn = np.array([D[2, 1] - D[1, 2], D[0, 2] - D[2, 0], D[1, 0] - D[0, 1]]) * (0.5 if angle < 1e-6 else angle / (2 * np.sin(angle)))
    xi = np.concatenate([D[:3, 3], turn])
    return xi @ np.linalg.solve(covariance, xi) / 6


def judge_map(case, folder, outcome):
    """A tag is wrong that is turned by over 10 degrees, or off by over 5 sigma and a tenth of the distance it is seen from."""
    room, found = case.room, read_map(folder / OUTPUT)
    truth = {int(number): T for number, T in reversed(list(zip(room.ids, room.T_world_tag)))}
    outcome.tags_mapped = len(found)
    outcome.is_culprit_mapped = any(tag in found for tag in case.culprits)
    keys = [key for key in found if key in truth and key not in case.culprits]
    if len(keys) < 2:
        return
    A, B = np.array([truth[key] for key in keys]), np.array([found[key][0] for key in keys])
    aligned = robust_alignment(A, B) @ B
    off, turned = np.linalg.norm(A[:, :3, 3] - aligned[:, :3, 3], axis=1), room_fits.angles_deg(A, aligned)
    eyes = np.linalg.inv(room.T_camera_world)[:, :3, 3]
    for i, key in enumerate(keys):
        mine = room.ids[case.views.tag] == key
        distance = np.median(np.linalg.norm(eyes[case.views.frame[mine]] - truth[key][:3, 3], axis=1))
        covariance, flags = found[key][1:]
        sigma = np.sqrt(np.trace(covariance[:3, :3])) if covariance is not None else 0.0
        if turned[i] > WRONG_DEG or off[i] > max(WRONG_SHARE * distance, WRONG_SIGMAS * sigma):
            edges = np.linalg.norm(case.views.pixels[mine] - np.roll(case.views.pixels[mine], 1, 1), axis=-1)
            outcome.wrong.append(WrongTag(key, turned[i], 1e3 * off[i], 1e3 * sigma, int(mine.sum()), edges.mean(), "weak" in flags,
                                          room_fits.misfit(room, case.views, key, aligned[i])))
    outcome.sound_mm = 1e3 * float(np.sqrt((off**2).mean()))
    held = next((key for key in keys if found[key][1] is not None and not found[key][1].any()), None)
    if held is not None:
        outcome.sound_nees = float(np.mean([
            normalised_error(np.linalg.inv(truth[held]) @ truth[key], np.linalg.inv(found[held][0]) @ found[key][0], found[key][1])
            for key in keys if key != held]))


def judge_words(case, outcome):
    """A statement is on the culprit that mentions it; of a fault of no tag, any."""
    on_it = [text for text in outcome.statements if case.kind in TAGLESS or tags_in(text) & set(case.culprits)]
    complaints = [text for text in on_it if kinds_in(text)]
    outcome.is_tag_named = bool(complaints)
    outcome.kinds_said = set().union(*map(kinds_in, complaints))
    outcome.is_kind_said_alone = any(kinds_in(text) == {case.kind} for text in complaints)
    for wrong in outcome.wrong:
        wrong.is_spoken_of = any(wrong.tag in tags_in(text) and len(tags_in(text)) <= MAX_NAMED_SHARE * outcome.tags_mapped
                                 for text in outcome.statements)
    outcome.accused = sorted(set().union(*(tags_in(text) for text in outcome.statements if kinds_in(text))) - set(case.culprits))


@dataclass
class Trials:
    """How rooms are tried."""
    program: pathlib.Path
    scorer: pathlib.Path = None  # tools/score_map.py, to score maps by it, too
    processes: int = 2
    held: str = "first"  # tag to hold: first (of the smallest key, the default), most or least (seen)


def held_tag(case, held):
    if held == "first":
        return []
    numbers, counts = np.unique(case.room.ids[case.views.tag], return_counts=True)
    return ["--held-tag", str(numbers[counts.argmax() if held == "most" else counts.argmin()])]


def trial(trials, kind, seed):
    case = room_faults.make(kind, seed)
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        case.write(folder)
        try:
            status, said, seconds = calibrate(trials.program, folder, *held_tag(case, trials.held))
        except subprocess.TimeoutExpired:
            status, said, seconds = -1, f"no end within {MOST_WAIT_S} s", float(MOST_WAIT_S)
        statements, left_out = ([said], []) if status else (said["warnings"], [int(key.split("/")[1]) for key in said["left_out"]])
        outcome = Outcome(kind, seed, status, statements, left_out, seconds, case.culprits, case.size, case.signal_px, case.evidence,
                          case.room.sigma_px, len(case.views.frame), len(set(case.room.ids)))
        if kind in (*room_faults.WITH_EVIDENCE, "duplicate"):
            outcome.map_evidence = room_maps.evidence(case.room, case.exact_views)
        if status == 0:
            judge_map(case, folder, outcome)
        if status == 0 and trials.scorer:
            scored = subprocess.run(["/usr/bin/python3", trials.scorer, folder / "map.yaml", folder / OUTPUT], capture_output=True, text=True)
            outcome.score = json.loads(scored.stdout)
    judge_words(case, outcome)
    return outcome


def run(trials, kind, seeds):
    """Outcomes in the order of seeds."""
    with multiprocessing.Pool(trials.processes) as pool:
        return pool.map(functools.partial(trial, trials, kind), seeds, chunksize=4)
