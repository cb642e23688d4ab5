#!/usr/bin/env python3
"""How far two trajectories of one recording lie apart, as the same program gives them on two machines: in metres, and in the sigmas
that the first one claims.

  bench/pose_differences.py ONE.tum OTHER.tum --frames-csv ONE.csv [--most-m METRES] [--most-median-sigma NUMBER]

Status 1 where they have other times, or lie further apart than the limits say.
"""
import argparse
import csv
import math
import statistics
import sys


def read_tum(path):
    with open(path) as lines:
        rows = [line.split() for line in lines if line.strip() and not line.startswith("#")]
    return {row[0]: [float(word) for word in row[1:8]] for row in rows}


def timestamp_ns(text):
    seconds, _, fraction = text.partition(".")
    return int(seconds) * 10**9 + int(fraction.ljust(9, "0")[:9])


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("one")
    parser.add_argument("other")
    parser.add_argument("--frames-csv", required=True)
    parser.add_argument("--most-m", type=float, default=math.inf)
    parser.add_argument("--most-median-sigma", type=float, default=math.inf)
    options = parser.parse_args()
    one, other = read_tum(options.one), read_tum(options.other)
    with open(options.frames_csv) as table:
        sigma_m = {int(row["timestamp_ns"]): float(row["sigma_position_m"]) for row in csv.DictReader(table) if row["sigma_position_m"]}
    if not one or one.keys() != other.keys():
        print(f"{len(one)} and {len(other)} poses, not of the same frames")
        return 1
    apart_m = {time: math.dist(one[time][:3], other[time][:3]) for time in one}
    in_sigmas = [apart_m[time] / sigma_m[timestamp_ns(time)] for time in one]
    median_sigma = statistics.median(in_sigmas)
    print(f"{len(one)} poses: median {statistics.median(apart_m.values()):.2g} m, at most {max(apart_m.values()):.2g} m; "
          f"in claimed sigmas median {median_sigma:.2g}, at most {max(in_sigmas):.2g}")
    return int(max(apart_m.values()) > options.most_m or median_sigma > options.most_median_sigma)


sys.exit(main())
