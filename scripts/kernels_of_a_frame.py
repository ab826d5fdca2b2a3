#!/usr/bin/env python3
"""Prints the kernels of a frame in the order of their launches, from the output of `ncu --csv --metrics ...`: time in
microseconds, registers, launch shape, occupancy and bytes of each, and their total time. With the benchmark's figures it
also prints by how much the frame takes longer than its kernels: the time of memsets, copies and gaps between kernels.
Usage: kernels_of_a_frame.py CSV [--scene NAME --figures cuda.json]"""

import argparse
import csv
import json
import sys

UNITS = {"nsecond": 1e-3, "ns": 1e-3, "usecond": 1, "us": 1, "msecond": 1e3, "ms": 1e3, "second": 1e6, "s": 1e6,
         "byte": 1, "Kbyte": 1e3, "Mbyte": 1e6, "Gbyte": 1e9, "byte/block": 1, "Kbyte/block": 1e3}
COLUMNS = {"us": "gpu__time_duration.sum", "registers": "launch__registers_per_thread",
           "blocks": "launch__grid_size", "threads": "launch__block_size", "shared": "launch__shared_mem_per_block",
           "may hold %": "sm__maximum_warps_per_active_cycle_pct",
           "holds %": "sm__warps_active.avg.pct_of_peak_sustained_active", "instructions": "smsp__inst_executed.sum",
           "L2 bytes": "lts__t_bytes.sum", "DRAM bytes": "dram__bytes.sum"}


def read(path):
    """Returns (name, {metric: value}) of each launch, in order."""
    with open(path, newline="", encoding="utf-8", errors="replace") as file:
        lines = [line for line in file if line.startswith('"')]  # leaves out messages of ncu and of the program
    launches = {}
    for row in csv.DictReader(lines):
        _, metrics = launches.setdefault(int(row["ID"]), (row["Kernel Name"], {}))
        try:
            value = float(row["Metric Value"].replace(",", ""))
        except ValueError:
            continue  # n/a
        metrics[row["Metric Name"]] = value * UNITS.get(row["Metric Unit"], 1)
    return [launches[key] for key in sorted(launches)]


def gaps(path, scene, kernels, count):
    """Yields lines about the difference between the time of a frame (one CUDA graph), which the benchmark measured for the
    scene, and the time of its kernels: `kernels` microseconds in total, of `count` kernels."""
    with open(path, encoding="utf-8") as file:
        figures = json.load(file)
    for figure in figures["scenes"]:
        if figure["scene"] != scene:
            continue
        frame, nodes = 1e3 * figure["device"]["median"], figure["bounds"][-1]["nodes"]
        yield f"frame by events: {frame:.1f} us, {nodes} nodes; beyond its kernels {frame - kernels:.1f} us, " \
              f"{(frame - kernels) / nodes:.2f} us a node"
        yield f"a further empty kernel in a graph: {1e3 * figures['limits']['node_milliseconds']:.2f} us " \
              f"({count} kernels were timed)"


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("csv")
    parser.add_argument("--scene")
    parser.add_argument("--figures")
    arguments = parser.parse_args()
    launches = read(arguments.csv)
    if not launches:
        print(f"{arguments.csv}: no kernel was timed", file=sys.stderr)
        return 1
    width = max(len(name) for name, _ in launches)
    columns = [column for column, metric in COLUMNS.items() if any(metric in m for _, m in launches)]
    print(" " * width, *(f"{column:>12}" for column in columns))
    for name, metrics in launches:
        values = [metrics.get(COLUMNS[column]) for column in columns]
        print(f"{name:<{width}}", *("           -" if v is None else f"{v:12.2f}" if v < 1000 else f"{v:12.0f}" for v in values))
    whole = sum(metrics.get(COLUMNS["us"], 0) for _, metrics in launches)
    print(f"{len(launches)} kernels: {whole:.1f} us")
    if arguments.figures and arguments.scene:
        try:
            for line in gaps(arguments.figures, arguments.scene, whole, len(launches)):
                print(line)
        except (OSError, ValueError, KeyError) as error:
            print(f"without the benchmark's figures: {error!r}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
