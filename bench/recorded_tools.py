"""What the recorded parts of bench/calibration have in common: calibrate on a folder of corners, and what it says in few words."""
import json


def calibrate(b, name, folder, *more, source=None):
    """(map file, what the command says)"""
    output = b.out / f"recorded_{name}.yaml"
    sizes = ["--tag-sizes", folder / "tag_sizes.yaml"] if (folder / "tag_sizes.yaml").exists() else []
    said = b.apriltrack("calibrate", "--detections", source or folder / "detections.csv", "--camera", folder / "camera.yaml", *sizes, *more,
                        "--output", output)[1]
    return output, json.loads(said)


def listed(keys):
    return ", ".join(key if isinstance(key, str) else str(key[1]) for key in keys) or "none"


def corrected(said):
    """What calibrate found wrong with cameras and detector."""
    return "; ".join(f"{c['camera']} {c['parameter']} {c['value']:+.4g} ({c['sigma']:.1g}) {c['unit'].replace('1', '')}".strip()
                     for c in said["corrections"]) or "nothing"
