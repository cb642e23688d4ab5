#!/usr/bin/env python3
"""Reads a trajectory as evo does (evo/tools/file_interface.py: columns, order of the quaternion, nanoseconds), with
numpy alone, and prints a line for each pose: time in nanoseconds, as text where the file has it so, and the first three
rows of the matrix.

  judge_trajectories.py tum|euroc|kitti FILE [TIMES]
"""
import sys

import numpy as np


def rotation(w, x, y, z):
    """Of a quaternion, by Hamilton's products q * axis * q^-1."""
    def product(a, b):
        scalar = a[0] * b[0] - a[1:] @ b[1:]
        return np.r_[scalar, a[0] * b[1:] + b[0] * a[1:] + np.cross(a[1:], b[1:])]
    q = np.array([w, x, y, z]) / np.linalg.norm([w, x, y, z])
    conjugate = q * [1, -1, -1, -1]
    return np.stack([product(product(q, np.r_[0, axis]), conjugate)[1:] for axis in np.eye(3)], axis=1)


def rows_of(path, separator):
    with open(path, encoding="utf-8") as file:
        return [line.split(separator) for line in file if line.strip() and not line.startswith("#")]


def nanoseconds(seconds):
    whole, _, decimals = seconds.partition(".")
    return int(whole) * 10**9 + int((decimals + "0" * 9)[:9])


def main():
    kind, path, *times = sys.argv[1:]
    rows = rows_of(path, "," if kind == "euroc" else None)
    for i, row in enumerate(rows):
        numbers = np.array(row, dtype=float)
        if kind == "tum":
            time, matrix, position = nanoseconds(row[0]), rotation(numbers[7], *numbers[4:7]), numbers[1:4]
        elif kind == "euroc":
            assert len(row) == 17, "older versions of evo want 17 columns"
            time, matrix, position = int(row[0]), rotation(*numbers[4:8]), numbers[1:4]
        else:
            whole = numbers.reshape(3, 4)
            time = nanoseconds(rows_of(times[0], None)[i][0])
            matrix, position = whole[:, :3], whole[:, 3]
        print(time, *[repr(float(v)) for v in np.c_[matrix, position].ravel()])


if __name__ == "__main__":
    main()
