"""Times the parts of overlaps that are computed on request (docs/overlap.md): regions, depths, withdrawals, unions.

    python overlap_parts_python.py [--quick] [--case NAME] [--threads N] [--json OUT]

Needs crumple's Python package, libigl and trimesh (pip install libigl trimesh rtree) in one environment, and the data below
$CRUMPLE_DATA (overlap_pairs.py). Vertices move between two states from call to call. Kinds of rows:

    regions, extents, unions, withdrawal, first_free    the query with this part against the query without it; a first
                free motion includes the withdrawal along the same direction
    depths      the query with depths of vertices, against the signed distances of libigl, which builds a tree in each
                call, and of trimesh, from the vertices that crumple found to be inside. For trimesh, of 300 of them

A ratio is the peer's time divided by crumple's, for each round (timed_rows.py). On one thread, times are CPU times.
"""

from __future__ import annotations

import argparse
import os
import sys
import time
from importlib.metadata import version

import crumple
import figures
import igl
import merge_results
import numpy as np
import trimesh
from overlap_pairs import alternating, real_pairs, states_of
from timed_rows import Row, judge, show

import crumple

PARTS = {
    "extents": {"extents": True},
    "regions": {"regions": True},
    "unions": {"unions": True},
    "withdrawal": {"directions": [(1.0, 0.5, 0.25)]},
    "first_free": {"directions": [(1.0, 0.5, 0.25)], "first_free": True},
}
CASES = ("ember016", "ember260", "armadillo_twice", "dragon_twice", "dragon_shark", "lucy_twice")
SAMPLE = 300


def part_row(pair, part, threads, clock):
    meshes = [[crumple.Mesh(*body) for body in bodies] for bodies in states_of(pair.bodies)]
    with_it, without = crumple.Detector(threads=threads), crumple.Detector(threads=threads)

    def compare(_):
        found = with_it.overlaps(*meshes[0], **PARTS[part])
        count = f"{len(found.region_volume)} regions" if part == "regions" else f"{len(found)} rows"
        return f"{count}, {found.statistics.pairs:,} pairs of bodies"

    ours = alternating(lambda state: with_it.overlaps(*meshes[state], **PARTS[part]))
    plain = alternating(lambda state: without.overlaps(*meshes[state]))
    return Row(f"{pair.name}, {part}", ours, {"the query without it": plain}, 1, compare, clock=clock)


def depth_row(pair, threads, clock):
    bodies = states_of(pair.bodies)
    meshes = [[crumple.Mesh(*body) for body in state] for state in bodies]
    detector = crumple.Detector(threads=threads)

    def ours(state):
        return detector.overlaps(*meshes[state], depths=True)

    inside = []  # by state and body: the vertices inside the other one
    for state in range(2):
        found = ours(state)
        inside.append([found.depth_vertices[found.depth_vertices[:, 0] == b, 1].copy() for b in range(2)])

    def by_libigl(state):
        return [
            igl.signed_distance(bodies[state][b][0][inside[state][b]], *bodies[state][1 - b]) for b in range(2)
        ]

    solids = [[trimesh.Trimesh(*body, process=False) for body in state] for state in bodies]

    def by_trimesh(state):
        points = bodies[state][0][0][inside[state][0][:SAMPLE]]
        return trimesh.proximity.signed_distance(solids[state][1], points)

    def compare(name):
        found = ours(0)
        own = found.depth_vertices[:, 0] == 0
        theirs = -by_libigl(0)[0][0] if name == "libigl" else by_trimesh(0)
        mine = found.depths[own][: len(theirs)]
        worst = np.abs(mine - theirs).max() / mine.max() if len(mine) else 0.0
        return f"{len(found.depths):,} vertices; {name} is off by up to {worst:.0e} of the greatest depth"

    first = Row(f"{pair.name}, depths", alternating(ours), {"libigl": alternating(by_libigl)}, 1, compare, clock=clock)
    share = max(min(SAMPLE, len(inside[0][0])), 1) / max(sum(map(len, inside[0])), 1)
    second = Row(
        f"{pair.name}, depths",
        alternating(ours),
        {"trimesh": alternating(by_trimesh)},
        1,
        compare,
        clock=clock,
        peer_a_turn=share,
    )
    return [first, second]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--quick", action="store_true", help="one pair and few rounds, to check that everything works")
    parser.add_argument("--case", action="append", help="a pair of meshes; may be repeated; else all")
    parser.add_argument("--threads", type=int, default=1)
    parser.add_argument("--json", help="file for the figures")
    arguments = parser.parse_args()
    cores = sorted(os.sched_getaffinity(0))[: arguments.threads]
    os.sched_setaffinity(0, cores)
    clock = time.process_time if arguments.threads == 1 else time.perf_counter
    names = arguments.case or (CASES[:1] if arguments.quick else CASES)
    load, rows = os.getloadavg()[0], []
    for pair in real_pairs(names):
        made = [part_row(pair, part, arguments.threads, clock) for part in PARTS]
        made += depth_row(pair, arguments.threads, clock)
        rows += [judge(row, 3 if arguments.quick else 11, 5 if arguments.quick else 20) for row in made]
    if not rows:
        sys.exit(f"overlap_parts_python.py: no case is named {' or '.join(names)}, or its files are missing")
    show(rows)
    if arguments.json:
        versions = {"crumple": crumple.__version__} | {name: version(name) for name in ("libigl", "trimesh", "numpy")}
        run = {"threads": arguments.threads, "load_at_start": load, "load_at_end": os.getloadavg()[0], "rows": rows}
        figures.write(arguments.json, {**merge_results.origin(), "versions": versions, "runs": [run]})


if __name__ == "__main__":
    main()
