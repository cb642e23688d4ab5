"""What a rendered world really is: world.json as the judge needs it, and which tags can be mapped at all.

A view of a tag is GOOD that a detector can be expected to read: the whole print in the image with nothing before it, its shortest side
12 px and more, under less than 75 degrees, blurred by 3 px at most. Two tags are LINKED that two frames and more show in good views
together. A tag is JOINED that belongs to the largest set of tags that links hold together, and has a good view beside another tag of it in
three frames and more.
"""
import json

import numpy as np

LEAST_SIDE_PX, MOST_ANGLE_DEG, MOST_BLUR_PX = 12.0, 75.0, 3.0
LINK_FRAMES, LEAST_FRAMES = 2, 3


class Truth:
    def __init__(self, folder):
        world = json.loads((folder / "world.json").read_text())
        self.seed, self.kind, self.fault, self.drawn = world["seed"], world["kind"], world["fault"], world["drawn"]
        self.culprits, self.tags, self.frames = set(world["culprits"]), world["tags"], world["frames"]
        self.cells_across = {tag["key"]: tag["cells_across"] for tag in self.tags}
        self.places = {}  # by key: the true poses in the map's frame; several of a tag that moved or hangs twice
        for tag in self.tags:
            self.places.setdefault(tag["key"], []).extend(matrix(tag[k]) for k in ("T_map_tag_first", "T_map_tag_last"))
        self.families = sorted({key.split("/")[0] for key in self.places})

    def joined(self):
        """Keys of the tags that this recording joins."""
        frames = [sorted({v["tag"] for v in frame["views"] if is_good(v)}) for frame in self.frames]
        together = np.zeros((len(self.tags), len(self.tags)), int)
        for shown in frames:
            together[np.ix_(shown, shown)] += 1
        links, left, largest = together >= LINK_FRAMES, set(range(len(self.tags))), set()
        while left:
            part = {left.pop()}
            while True:
                more = set(np.flatnonzero(links[sorted(part)].any(0))) - part
                if not more:
                    break
                part |= more
            left -= part
            largest = max(largest, part, key=len)
        counts = {tag: sum(tag in shown and len(largest & set(shown)) > 1 for shown in frames) for tag in largest}
        return {self.tags[tag]["key"] for tag, count in counts.items() if count >= LEAST_FRAMES}

    def views(self):
        """(timestamp_ns, view) of every tag in every frame."""
        return [(frame["timestamp_ns"], view) for frame in self.frames for view in frame["views"]]


def is_good(view):
    return (view["visible_fraction"] >= 1.0 and view["shortest_side_px"] >= LEAST_SIDE_PX and view["view_angle_deg"] < MOST_ANGLE_DEG
            and view["blur_px"] <= MOST_BLUR_PX)


def matrix(numbers):
    """4 x 4 of [x y z qx qy qz qw]."""
    x, y, z, w = np.array(numbers[3:]) / np.linalg.norm(numbers[3:])
    T = np.eye(4)
    T[:3, :3] = [[1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)], [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
                 [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)]]
    T[:3, 3] = numbers[:3]
    return T
