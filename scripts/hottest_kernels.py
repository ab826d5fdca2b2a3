#!/usr/bin/env python3
"""Kernels by the time that they took, from `ncu --csv --metrics gpu__time_duration.sum`: a line each of name, share of the
whole in percent, launches, microseconds a launch; the longest first. Usage: hottest_kernels.py FILE"""

import csv
import sys
from collections import defaultdict

NANOSECONDS = {"nsecond": 1, "ns": 1, "usecond": 1e3, "us": 1e3, "msecond": 1e6, "ms": 1e6, "second": 1e9, "s": 1e9}


def main() -> int:
    with open(sys.argv[1], newline="", encoding="utf-8", errors="replace") as file:
        lines = [line for line in file if line.startswith('"')]  # between ncu's own messages and the program's
    times = defaultdict(list)
    for row in csv.DictReader(lines):
        if row["Metric Name"] == "gpu__time_duration.sum":
            value = float(row["Metric Value"].replace(",", ""))
            times[row["Kernel Name"]].append(value * NANOSECONDS[row["Metric Unit"]])
    if not times:
        print(f"{sys.argv[1]}: no kernel was timed", file=sys.stderr)
        return 1
    whole = sum(map(sum, times.values()))
    for name, values in sorted(times.items(), key=lambda item: -sum(item[1])):
        share, each = 100 * sum(values) / whole, sum(values) / len(values) / 1e3
        print(f"{name:<40} {share:5.1f} % {len(values):5d} launches {each:9.1f} us")
    return 0


if __name__ == "__main__":
    sys.exit(main())
