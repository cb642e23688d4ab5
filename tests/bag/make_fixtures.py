#!/usr/bin/python3
"""Writes the bags of tests/bag/data with other projects' own writers.

  make_fixtures.py FOLDER            all of them
  make_fixtures.py --ros1 FOLDER     ROS 1 bags only, which need no node

ROS 1 bags: python3-rosbag and python3-sensor-msgs (Debian). MCAP files, and the CDR messages of SQLite files:
make_fixtures.mjs beside this file, by @mcap/core and @foxglove/rosmsg2-serialization, which node finds by $NODE_PATH
(build/judges/node_modules after `scripts/setup --judges`). The recording that all of them hold is described in recording.h.
"""
import base64
import json
import pathlib
import shutil
import sqlite3
import subprocess
import sys

import genpy
import rosbag
from geometry_msgs.msg import Vector3
from sensor_msgs.msg import CameraInfo, Image
from std_msgs.msg import String

WIDTH, HEIGHT, STEP, FRAMES = 16, 12, 20, 8
BASE, MS = 1700000000123456789, 1000000


def time_of(ns):
    return genpy.Time(ns // 1000000000, ns % 1000000000)


def pixels(k):
    rows = (bytes((7 * x + 13 * y + 31 * k) & 255 for x in range(WIDTH)) + b"\xee" * (STEP - WIDTH) for y in range(HEIGHT))
    return b"".join(rows)


def ros1_messages():
    for k in range(FRAMES):
        stamp = BASE + k * 100 * MS
        log = stamp + (15 + k % 3) * MS
        image = Image(height=HEIGHT, width=WIDTH, encoding="mono8", step=STEP, data=pixels(k))
        info = CameraInfo(height=HEIGHT, width=WIDTH, distortion_model="plumb_bob",
                          D=[-0.25, 0.125, 0.0009765625, -0.001953125, 0.0625], K=[20.5, 0, 7.25, 0, 21.5, 5.75, 0, 0, 1],
                          R=[1, 0, 0, 0, 1, 0, 0, 0, 1], P=[19, 0, 7, 0, 0, 20, 6, 0, 0, 0, 1, 0])
        for message in (image, info):
            message.header.seq, message.header.stamp, message.header.frame_id = k, time_of(stamp), "camera_optical"
        yield "/camera/image_raw", image, log
        if k in (0, 5):
            yield "/camera/camera_info", info, log + 1000
        if k % 3 == 0:
            yield "/notes", String(data=f"note {k}"), log + 2000
        for i in range(5 * k, 5 * k + 5):
            at = BASE + i * 20 * MS
            yield "/gyro", Vector3(x=i, y=0.5, z=-0.25), at + MS


def write_ros1(path, compression):
    with rosbag.Bag(str(path), "w", compression=compression, chunk_threshold=1500) as bag:
        for topic, message, log in ros1_messages():
            bag.write(topic, message, time_of(log))


def list_chunks(path):
    """Where chunks begin and end, and when their messages were logged, as rosbag sees it."""
    with rosbag.Bag(str(path)) as bag:
        for info in bag._chunks:
            header = bag._chunk_headers[info.pos]
            times = sorted(entry.time.to_nsec() - BASE for index in bag._connection_indexes.values() for entry in index
                           if entry.chunk_pos == info.pos)
            yield f"{path.name},{info.pos},{header.data_pos + header.compressed_size},{' '.join(map(str, times))}"


def write_sqlite(path, messages, pack=None):
    path.unlink(missing_ok=True)
    database = sqlite3.connect(path)
    database.executescript("""
        PRAGMA page_size = 1024; VACUUM;
        CREATE TABLE schema(schema_version INTEGER PRIMARY KEY, ros_distro TEXT NOT NULL);
        CREATE TABLE metadata(id INTEGER PRIMARY KEY, metadata_version INTEGER NOT NULL, metadata TEXT NOT NULL);
        CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT NOT NULL, type TEXT NOT NULL,
            serialization_format TEXT NOT NULL, offered_qos_profiles TEXT NOT NULL);
        CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER NOT NULL, timestamp INTEGER NOT NULL, data BLOB NOT NULL);
        CREATE INDEX timestamp_idx ON messages (timestamp ASC);
        INSERT INTO schema VALUES (3, 'humble');
    """)
    ids = {}
    for one in messages:
        if one["topic"] not in ids:
            cursor = database.execute("INSERT INTO topics (name, type, serialization_format, offered_qos_profiles) "
                                      "VALUES (?, ?, 'cdr', '')", (one["topic"], one["type"]))
            ids[one["topic"]] = cursor.lastrowid
        data = base64.b64decode(one["data"])
        database.execute("INSERT INTO messages (topic_id, timestamp, data) VALUES (?, ?, ?)",
                         (ids[one["topic"]], int(one["log"]), pack(data) if pack else data))
    database.commit()
    database.close()


def write_metadata(folder, storage, files, compression=("", "")):
    names = "\n".join(f"    - {name}" for name in files)
    (folder / "metadata.yaml").write_text(f"""rosbag2_bagfile_information:
  version: 5
  storage_identifier: {storage}
  duration:
    nanoseconds: 780000000
  starting_time:
    nanoseconds_since_epoch: {BASE}
  message_count: 53
  topics_with_message_count:
    - topic_metadata:
        name: /camera/image_raw
        type: sensor_msgs/msg/Image
        serialization_format: cdr
        offered_qos_profiles: "- history: 3\\n  depth: 0\\n  reliability: 1"
      message_count: {FRAMES}
  compression_format: "{compression[0]}"
  compression_mode: "{compression[1]}"
  relative_file_paths:
{names}
""")


def zstd(data):
    return subprocess.run(["zstd", "-q", "-c"], input=data, stdout=subprocess.PIPE, check=True).stdout


def make_folder(path):
    shutil.rmtree(path, ignore_errors=True)
    path.mkdir()
    return path


def main():
    here, out = pathlib.Path(__file__).resolve().parent, pathlib.Path(sys.argv[-1])
    out.mkdir(parents=True, exist_ok=True)
    for name, compression in (("plain", "none"), ("bz2", "bz2"), ("lz4", "lz4")):
        write_ros1(out / f"{name}.bag", compression)
    if sys.argv[1] == "--ros1":
        return
    lines = [line for name in ("plain", "bz2", "lz4") for line in list_chunks(out / f"{name}.bag")]
    told = subprocess.run(["node", here / "make_fixtures.mjs", out], stdout=subprocess.PIPE, check=True).stdout
    of_mcap = out / "chunks_of_mcap.csv"
    header = "file,begin,end,log_times_ns\n"
    (out / "chunks.csv").write_text(header + "\n".join(lines) + "\n" + of_mcap.read_text())
    of_mcap.unlink()
    messages = [json.loads(line) for line in told.decode().splitlines()]
    write_sqlite(out / "plain.db3", messages)
    half = len(messages) // 2
    split = make_folder(out / "split")
    write_sqlite(split / "split_0.db3", messages[:half])
    write_sqlite(split / "split_1.db3", messages[half:])
    write_metadata(split, "sqlite3", ["split_0.db3", "split_1.db3"])
    packed = make_folder(out / "packed_messages")
    write_sqlite(packed / "packed_messages_0.db3", messages, zstd)
    write_metadata(packed, "sqlite3", ["packed_messages_0.db3"], ("zstd", "MESSAGE"))
    whole = make_folder(out / "packed_file")
    (whole / "packed_file_0.db3.zstd").write_bytes(zstd((out / "plain.db3").read_bytes()))
    write_metadata(whole, "sqlite3", ["packed_file_0.db3.zstd"], ("zstd", "FILE"))


if __name__ == "__main__":
    main()
