"""Makes one world, runs `doctor`, `calibrate` and (of clean worlds) `detect` on it with default options, and judges what they say and write.

Default options but for --tag-sizes, which a user must give, and --family where the sizes file names other families than tag36h11.
"""
from dataclasses import dataclass, field
import json
import pathlib
import resource
import shutil
import signal
import subprocess
import tempfile

import numpy as np

import world_score
import world_words
from world_truth import Truth

MOST_CPU_S = 150  # of one program on one world: five times what a world may take in the mean
MOST_WAIT_S = 20 * MOST_CPU_S
FAULTS = ("wrong_size", "moved", "bent", "duplicate", "loose", "focal", "camera_file")


@dataclass
class Trials:
    program: pathlib.Path
    maker: pathlib.Path
    keep: pathlib.Path = None  # where worlds stay
    is_report: bool = False


@dataclass
class Outcome:
    seed: int
    fault: str
    kind: str = ""
    drawn: dict = field(default_factory=dict)
    culprits: list = field(default_factory=list)
    tags: int = 0
    joined: list = field(default_factory=list)
    verdict: str = ""  # doctor's
    status: int = -1  # calibrate's
    statements: list = field(default_factory=list)
    left_out: list = field(default_factory=list)
    accused: dict = field(default_factory=dict)  # sound tags, with the kinds
    doubted: list = field(default_factory=list)  # sound tags
    is_named: bool = False
    is_tag_named: bool = False
    is_camera_accused: bool = False
    map: dict = field(default_factory=dict)
    corners: np.ndarray = None
    good_views: int = 0
    missed_views: int = 0
    strangers: int = 0
    cpu_s: dict = field(default_factory=dict)
    failure: str = ""  # of the bench itself, or a program that did not end

    def lost(self):
        """Joined sound tags that are not in the map."""
        return sorted(set(self.joined) - set(self.culprits) - set(self.map.get("mapped", [])))

    def verdict_of_fault(self):
        """named; harmless: not named, and no tag of the map is off by over 3 sigmas (or there is no map); harmful."""
        if self.is_named:
            return "named"
        return "harmful" if self.map.get("over_3_sigma") else "harmless"


def limit_cpu():
    resource.setrlimit(resource.RLIMIT_CPU, (MOST_CPU_S, MOST_CPU_S + 1))


def run(outcome, name, *words):
    """(status, stdout, stderr); the CPU time goes into the outcome."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    done = subprocess.run([str(word) for word in words], capture_output=True, text=True, timeout=MOST_WAIT_S, preexec_fn=limit_cpu)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    outcome.cpu_s[name] = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    if done.returncode < 0:
        why = f"no end within {MOST_CPU_S} s of CPU" if done.returncode == -signal.SIGXCPU else f"signal {-done.returncode}"
        outcome.failure += f"{name}: {why}; "
    return done.returncode, done.stdout, done.stderr


def said(text):
    try:
        return json.loads(text)
    except json.JSONDecodeError:
        return {}


def judge(trials, outcome, folder):
    truth = Truth(folder)
    outcome.kind, outcome.drawn, outcome.tags = truth.kind, truth.drawn, len(truth.tags)
    outcome.culprits, outcome.joined = sorted(truth.culprits), sorted(truth.joined())
    families = [] if truth.families == ["tag36h11"] else [word for family in truth.families for word in ("--family", family)]
    common = ["--json", "--quiet", "--threads", "1", *families]

    _, text, _ = run(outcome, "doctor", trials.program, "doctor", folder, *common)
    doctor = said(text)
    outcome.verdict = doctor.get("verdict", "failed")

    output = folder / "calibrated.yaml"
    outcome.status, text, error = run(outcome, "calibrate", trials.program, "calibrate", folder, "--tag-sizes", folder / "tag_sizes.yaml", "--output",
                                      output, *common)
    summary = said(text)
    outcome.statements = summary.get("warnings", []) if outcome.status == 0 else [summary.get("error", {}).get("message", error.strip())]
    outcome.left_out = summary.get("left_out", [])
    accused = world_words.accusations(outcome.statements)
    outcome.accused = {key: sorted(kinds) for key, kinds in accused.items() if key not in truth.culprits and key in truth.places}
    outcome.doubted = sorted(world_words.doubts(outcome.statements, set(truth.places)) - set(accused) - truth.culprits)
    findings = [finding["text"] for finding in doctor.get("findings", []) if finding["about"] in world_words.CAMERA_FINDINGS]
    outcome.is_named = truth.fault != "none" and world_words.is_named(truth.fault, truth.culprits, outcome.statements + findings)
    outcome.is_camera_accused = world_words.is_camera_accused(outcome.statements + findings)
    outcome.is_tag_named = bool(truth.culprits & set(accused))
    if outcome.status == 0:
        outcome.map = world_score.judge_map(output, truth)

    if truth.fault == "none":
        status, _, _ = run(outcome, "detect", trials.program, "detect", folder, "--output", folder / "detections.csv", "--quiet", "--threads", "1", *families)
        if status == 0:
            outcome.corners, outcome.good_views, outcome.missed_views, outcome.strangers = world_score.corner_errors(folder / "detections.csv", truth)


def trial(trials, task):
    """The outcome of (seed, fault)."""
    seed, fault = task
    outcome = Outcome(seed, fault)
    folder = trials.keep / f"{seed}_{fault}" if trials.keep else pathlib.Path(tempfile.mkdtemp(prefix="world_"))
    try:
        status, _, error = run(outcome, "make", trials.maker, "--seed", seed, "--fault", fault, "--output", folder, *(["--report"] if trials.is_report else []))
        if status == 0:
            judge(trials, outcome, folder)
        else:
            outcome.failure += f"make: {error.strip()}"
    except subprocess.TimeoutExpired:
        outcome.failure += f"no end within {MOST_WAIT_S} s"
    except Exception as error:  # one world that cannot be judged must not end a run of 200; it is counted
        outcome.failure += f"{type(error).__name__}: {error}"
    finally:
        if trials.keep:
            (folder / "outcome.json").write_text(json.dumps({**vars(outcome), "corners": None}, indent=1, default=str) + "\n")
        else:
            shutil.rmtree(folder, ignore_errors=True)
    return outcome
