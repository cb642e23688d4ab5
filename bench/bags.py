#!/usr/bin/python3
"""Writes bags of pictures for bench_bags: one of each format, and one that is larger than any memory.

  bench/bags.py FOLDER [--megabytes 600] [--large-gigabytes 20]

Pictures are 1440 x 1080 of 8 bits: a gradient with noise of four grey levels, which packs about as camera pictures do. ROS 1 bags are written by
python3-rosbag where it is installed; packers are the programs lz4 and zstd. The large one is an MCAP file of black pictures whose pixels are
holes of the file: it takes some MB of disk.
"""
import argparse
import pathlib
import sqlite3
import struct
import subprocess

import numpy as np

WIDTH, HEIGHT = 1440, 1080
MAGIC = b"\x89MCAP0\r\n"


def pictures(count):
    random = np.random.default_rng(1)
    noise = random.integers(0, 4, (8, HEIGHT, WIDTH), dtype=np.uint8)
    ramp = (np.arange(WIDTH)[None, :] // 8 + np.arange(HEIGHT)[:, None] // 16).astype(np.uint8)
    for k in range(count):
        yield (ramp + noise[k % 8] + k).astype(np.uint8).tobytes()


def text(value):
    return struct.pack("<I", len(value)) + value


def cdr_start(k):
    """An Image in CDR before its pixels."""
    stamp = 1_000_000_000 + k * 33_333_333
    out = b"\0\1\0\0" + struct.pack("<II", stamp // 10**9, stamp % 10**9) + text(b"cam\0")
    out += struct.pack("<II", HEIGHT, WIDTH) + text(b"mono8\0") + b"\0"
    out += b"\0" * (-(len(out) - 4) % 4)
    return out + struct.pack("<II", WIDTH, WIDTH * HEIGHT)


def record(op, content):
    return bytes([op]) + struct.pack("<Q", len(content)) + content


def message_start(k, size):
    time = 1_000_000_000 + k * 33_333_333
    return bytes([5]) + struct.pack("<QHIQQ", 22 + size, 1, k, time, time)


class McapFile:
    """Chunks of given bytes, with indices; crc 0 says that there is none."""

    def __init__(self, path):
        self.file = open(path, "wb")
        self.channel = record(3, struct.pack("<H", 1) + text(b"sensor_msgs/msg/Image") + text(b"ros2msg") + text(b""))
        self.channel += record(4, struct.pack("<HH", 1, 1) + text(b"/image") + text(b"cdr") + text(b""))
        self.file.write(MAGIC + record(1, text(b"ros2") + text(b"bench")) + self.channel)
        self.chunks, self.count = [], 0

    def begin_chunk(self, packed_size, unpacked_size, compression, first, last):
        self.offset = self.file.tell()
        head = struct.pack("<QQQI", first, last, unpacked_size, 0) + text(compression) + struct.pack("<Q", packed_size)
        self.file.write(bytes([6]) + struct.pack("<Q", len(head) + packed_size) + head)
        self.sizes = (len(head) + packed_size + 9, compression, packed_size, unpacked_size, first, last)

    def end_chunk(self, entries):
        index = record(7, struct.pack("<H", 1) + text(b"".join(struct.pack("<QQ", time, at) for time, at in entries)))
        at = self.file.tell()
        self.file.write(index)
        length, compression, packed, unpacked, first, last = self.sizes
        self.chunks.append(record(8, struct.pack("<QQQQ", first, last, self.offset, length) +
                                  text(struct.pack("<HQ", 1, at)) + struct.pack("<Q", len(index)) + text(compression) +
                                  struct.pack("<QQ", packed, unpacked)))
        self.count += len(entries)

    def close(self):
        self.file.write(record(15, b"\0\0\0\0"))
        start = self.file.tell()
        self.file.write(self.channel + b"".join(self.chunks))
        self.file.write(record(11, struct.pack("<QHIIIIQQ", self.count, 1, 1, 0, 0, len(self.chunks), 0, 0) +
                               text(struct.pack("<HQ", 1, self.count))))
        self.file.write(record(2, struct.pack("<QQI", start, 0, 0)) + MAGIC)
        self.file.close()


PACKERS = {b"": None, b"lz4": ["lz4", "-q", "-c"], b"zstd": ["zstd", "-q", "-c"]}


def write_mcap(path, compression, count):
    out = McapFile(path)
    for k, pixels in enumerate(pictures(count)):
        body = cdr_start(k) + pixels
        chunk = message_start(k, len(body)) + body
        command = PACKERS[compression]
        packed = subprocess.run(command, input=chunk, stdout=subprocess.PIPE, check=True).stdout if command else chunk
        time = 1_000_000_000 + k * 33_333_333
        out.begin_chunk(len(packed), len(chunk), compression, time, time)
        out.file.write(packed)
        out.end_chunk([(time, 0)])
    out.close()


def write_large(path, count):
    out = McapFile(path)
    for k in range(count):
        start = cdr_start(k)
        head = message_start(k, len(start) + WIDTH * HEIGHT) + start
        time = 1_000_000_000 + k * 33_333_333
        out.begin_chunk(len(head) + WIDTH * HEIGHT, len(head) + WIDTH * HEIGHT, b"", time, time)
        out.file.write(head)
        out.file.seek(WIDTH * HEIGHT, 1)
        out.end_chunk([(time, 0)])
    out.close()


def write_sqlite(path, count):
    path.unlink(missing_ok=True)
    database = sqlite3.connect(path)
    database.executescript("CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT, type TEXT, serialization_format TEXT,"
                           "offered_qos_profiles TEXT);"
                           "CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER, timestamp INTEGER, data BLOB);"
                           "INSERT INTO topics VALUES (1, '/image', 'sensor_msgs/msg/Image', 'cdr', '');")
    for k, pixels in enumerate(pictures(count)):
        database.execute("INSERT INTO messages (topic_id, timestamp, data) VALUES (1, ?, ?)", (k, cdr_start(k) + pixels))
    database.commit()
    database.close()


def write_ros1(folder, count):
    try:
        import genpy
        import rosbag
        from sensor_msgs.msg import Image
    except ImportError:
        print("no ROS 1 bags: python3-rosbag and python3-sensor-msgs are not installed")
        return
    for compression in ("none", "lz4", "bz2"):
        with rosbag.Bag(str(folder / f"{compression}.bag"), "w", compression=compression) as bag:
            for k, pixels in enumerate(pictures(count if compression != "bz2" else count // 8)):
                image = Image(height=HEIGHT, width=WIDTH, encoding="mono8", step=WIDTH, data=pixels)
                image.header.stamp = genpy.Time(1 + k // 30, k % 30 * 33_333_333)
                bag.write("/image", image, image.header.stamp)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--megabytes", type=int, default=600)
    parser.add_argument("--large-gigabytes", type=int, default=20)
    options = parser.parse_args()
    options.folder.mkdir(parents=True, exist_ok=True)
    count = options.megabytes * 10**6 // (WIDTH * HEIGHT)
    for compression in PACKERS:
        write_mcap(options.folder / f"{(compression or b'none').decode()}.mcap", compression, count)
    write_sqlite(options.folder / "any.db3", count)
    write_ros1(options.folder, count)
    write_large(options.folder / "large.mcap", options.large_gigabytes * 10**9 // (WIDTH * HEIGHT))


if __name__ == "__main__":
    main()
