"""What `doctor` and `calibrate` say of tags: the table to change when the programs' words change.

ACCUSED is a tag of which a statement says outright that it is faulty, in the words of ACCUSATIONS; DOUBTED one that any other statement
names together with a kind of fault ("a wrong size, a bend, or a tag that moved may be the cause"). The kinds' words are those of
bench/room_trials.py, with one for camera files added.
"""
import re

import room_trials

KEY = r"[A-Za-z]\w*/\d+"
KEYS = rf"((?:{KEY})(?:(?:, | and ){KEY})*)"
ACCUSATIONS = {
    "moved": rf"^{KEYS} (?:was|were) moved",
    "loose": rf"^{KEYS} hangs? loosely",
    "duplicate": rf"^{KEYS} (?:is|are) seen at two places(?!.*not used there)",
    "wrong_size": rf"^{KEYS} looks? [\d.]+ %",
    "bent": rf"^{KEYS} (?:is|are) bent",
    "contradicted": rf"^(?:left out: )?{KEYS}: (?:its|most of its|most) views.* contradict",
}
CAMERA_KINDS = ("focal", "camera_file")
CAMERA_WORDS = r"focal length|principal point|intrinsics|camera file"
CAMERA_FINDINGS = ("principal_point", "focal_lengths", "lens")  # of doctor


def keys_in(text):
    return set(re.findall(KEY, text)) - set(re.findall(r"/[\w./]*", text))


def accusations(statements):
    """{key: set of kinds}"""
    found = {}
    for text in statements:
        for kind, words in ACCUSATIONS.items():
            match = re.search(words, text)
            for key in re.findall(KEY, match[1]) if match else ():
                found.setdefault(key, set()).add(kind)
    return found


def doubts(statements, known):
    """Keys that statements with a fault's word name, of those that there are."""
    return set().union(*(keys_in(text) & known for text in statements if room_trials.kinds_in(text) - {"focal", "one_frame"}))


def is_camera_accused(statements):
    return any(re.search(CAMERA_WORDS, text, re.IGNORECASE) for text in statements)


def is_named(fault, culprits, statements):
    """Whether a statement names the fault: the tag and this kind alone; of a camera's fault, the camera's numbers."""
    if fault in CAMERA_KINDS:
        return is_camera_accused(statements)
    outright = accusations(statements)
    if any(outright.get(key, set()) == {fault} for key in culprits):
        return True
    return any(room_trials.kinds_in(text) == {fault} and keys_in(text) & set(culprits) for text in statements)
