"""Times distances of bodies (docs/nearest.md) against Coal's `distance`, in one process, alternately.

    python nearest_python.py [--quick] [--json OUT]

Needs crumple's Python package and Coal in one environment, which scripts/test_python.sh --all makes. Both get the same
pairs and poses; timed_rows.py measures times and computes ratios. Both are called from Python, on one thread. Coal's
trees (OBBRSS), transforms and requests are made before the clock starts. Crumple's shapes are named, so that it caches their
trees; its measured time includes reading poses from NumPy arrays. Coal is queried for an unsigned distance, and also returns
the nearest points; it computes in float64 with rounding errors. Crumple decides exactly, for posed vertices that are rounded
to float32, and returns the first of the closest pairs of triangles.
"""

from __future__ import annotations

import argparse
import json
import os

import numpy as np
import rigid_scenes as scenes
from timed_rows import Row, judge, show
from worlds_python import coal, transforms, tree

import crumple


def distance_request():
    made = coal.DistanceRequest()
    made.enable_signed_distance = False
    return made


def pair(name, first, second, poses):
    """Returns a row: the distance of two bodies under each of n pairs of poses, an array (n, 2, 3, 4); one call per pair."""
    shapes = [crumple.Shape(*mesh, name=f"{name} {i}") for i, mesh in enumerate((first, second))]
    detector, world = crumple.Detector(threads=1), crumple.World(shapes)
    trees = tree(*first), tree(*second)
    given = [tuple(transforms(p)) for p in poses]
    asked = distance_request()

    def ours(i):
        return detector.distances(world.at(poses[i]))

    def theirs(i):
        result = coal.DistanceResult()
        coal.distance(trees[0], given[i][0], trees[1], given[i][1], asked, result)
        return result

    def compare(_):
        mine = np.array([ours(i).distance[0] for i in range(len(poses))])
        peer = np.array([max(0.0, theirs(i).min_distance) for i in range(len(poses))])
        touching = sum(bool(ours(i).touching[0]) for i in range(len(poses)))
        return f"{touching} of {len(poses)} touch; distances differ by up to {np.abs(mine - peer).max():.0e}"

    return Row(name, ours, {"Coal": theirs}, len(poses), compare)


def around(n, least, most, seed):
    """Returns (n, 2, 3, 4) poses of two bodies: random rotations, origins at distances from `least` to `most`."""
    random = np.random.default_rng(seed)
    poses = scenes.poses_of(scenes.rotations(random, 2 * n), np.zeros((2 * n, 3))).reshape(n, 2, 3, 4)
    away = random.normal(size=(n, 3))
    away /= np.linalg.norm(away, axis=1, keepdims=True)
    poses[:, 1, :, 3] = away * np.exp(random.uniform(np.log(least), np.log(most), size=(n, 1)))
    return poses


def pairs_of_bodies(quick):
    n = 10 if quick else 100
    ball, link = scenes.ball(16), scenes.link(25, 41, 1.5, 0.2)
    cloth = scenes.cloth(20_000 if quick else 200_000)
    sheet = cloth.vertices, cloth.faces
    thousands = f"{round(len(cloth.faces), -3):,}"
    touching = np.tile(np.eye(3, 4), (n, 2, 1, 1))
    touching[:, 0] = scenes.on_the_cloth(cloth, n, 1.0)
    clear = touching.copy()
    clear[:, 0, 2, 3] = float(cloth.vertices[:, 2].max()) + 1 + np.linspace(0.05, 3, n)
    return [
        pair("balls of 5,120 triangles, nearly touching", ball, ball, around(n, 2.001, 2.1, 5)),
        pair("balls of 5,120, some radii apart", ball, ball, around(n, 2.1, 20, 6)),
        pair("rods of 2,000", link, link, around(n, 2.2, 5, 7)),
        pair(f"ball of 5,120 above a cloth of {thousands}", ball, sheet, clear),
        pair("the same, in the cloth", ball, sheet, touching),
    ]


def robot(quick):
    """Returns a row: the distances of a robot's links to obstacles, for many configurations. Crumple computes all in one call;
    Coal is called in a loop, whose overhead is subtracted."""
    links, length, count = 8, 1.5, 20 if quick else 200
    mesh = scenes.link(25, 41, length, 0.2)
    room = scenes.obstacles(20_000 if quick else 200_000)
    free = np.random.default_rng(4).uniform(room.vertices.min(0), room.vertices.max(0), size=(count, 3))
    poses = scenes.arm(count, links, length, free, 0.9)
    shapes = [*(crumple.Shape(*mesh, name=f"nearest link {k}") for k in range(links))]
    shapes.append(crumple.Shape(room.vertices, room.faces, name="nearest obstacles"))
    base = crumple.World(shapes, worlds=[0] * links + [-1])
    world = base.configurations(poses)
    excluded = [(a, b) for a in range(links) for b in range(a)]
    detector = crumple.Detector(threads=1)
    link_tree, room_tree, point = tree(*mesh), tree(room.vertices, room.faces), tree(np.eye(3), np.array([[0, 1, 2]]))
    given, identity, asked = transforms(poses), coal.Transform3s.Identity(), distance_request()

    def ours(_):
        return detector.distances(world, filter=crumple.PairFilter(excluded_bodies=excluded))

    def loop(first, second):
        def run(_):
            found = []
            for place in given:
                result = coal.DistanceResult()
                found.append(coal.distance(first, place, second, identity, asked, result))
            return found

        return run

    theirs = loop(link_tree, room_tree)

    def compare(_):
        mine, peer = ours(0), np.maximum(theirs(0), 0)
        off = np.abs(mine.distance - peer).max()
        return f"{int(mine.touching.sum())} of {len(mine)} touch; distances differ by up to {off:.0e}"

    name = f"link of 2,000 to obstacles of {len(room.faces):,} triangles, less Coal's loop"
    return [Row(name, ours, {"Coal": theirs}, 1, compare, a_turn=len(given), less=loop(point, point))]


def clearances(quick):
    """Returns a row: the least distance from obstacles of each configuration of a chain of 9 links. Crumple computes all in one
    call. Coal is called in a loop over the links, with or without the least distance so far as a bound of the next search."""
    links, length, count = 9, 1.5, 50 if quick else 500
    mesh, room = scenes.link(12, 21, length, 0.2), scenes.obstacles(40_000)
    free = np.random.default_rng(4).uniform(room.vertices.min(0), room.vertices.max(0), size=(count, 3))
    poses = scenes.arm(count, links, length, free, 0.9).reshape(count, links, 3, 4)
    shapes = [*(crumple.Shape(*mesh, name=f"clear link {k}") for k in range(links))]
    shapes.append(crumple.Shape(room.vertices, room.faces, name="clear obstacles"))
    world = crumple.World(shapes, worlds=[0] * links + [-1], self_collisions=False).configurations(poses)
    allowed = crumple.PairFilter(excluded_bodies=[(a, b) for b in range(links) for a in range(b)])
    link_tree, room_tree = tree(*mesh), tree(room.vertices, room.faces)
    given, identity, asked = [transforms(p) for p in poses], coal.Transform3s.Identity(), distance_request()

    def ours(detector):
        return lambda _: detector.distances(world, output="nearest", filter=allowed)

    def by_hand(_):
        found = []
        for places in given:
            result = coal.DistanceResult()
            for place in places:
                coal.distance(link_tree, place, room_tree, identity, asked, result)
            found.append(result.min_distance)
        return found

    def separately(_):
        results = [[coal.DistanceResult() for _ in places] for places in given]
        return [
            min(coal.distance(link_tree, place, room_tree, identity, asked, result) for place, result in zip(*of))
            for of in zip(given, results)
        ]

    def compare(_):
        mine, peer = ours(crumple.Detector(threads=1))(0), np.maximum(by_hand(0), 0)
        return f"{int(mine.touching.sum())} of {len(mine)} touch; distances differ by up to {np.abs(mine.distance - peer).max():.0e}"

    theirs = {"Coal, bounded by the links before": by_hand, "Coal": separately}
    name = f"clearance of {links} links of {len(mesh[1])} to obstacles of {len(room.faces):,}, {count} configurations"
    return [Row(name, ours(crumple.Detector(threads=1)), theirs, 1, compare, a_turn=count)]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--quick", action="store_true", help="small scenes and few rounds, to check that everything works")
    parser.add_argument("--json", help="file for the figures")
    arguments = parser.parse_args()
    load = os.getloadavg()[0]
    print(f"crumple {crumple.__version__}, Coal {coal.__version__}, {os.cpu_count()} processors, load {load:.1f}")
    figures = []
    for make in (pairs_of_bodies, robot, clearances):
        figures += [judge(row, 3 if arguments.quick else 11) for row in make(arguments.quick)]
    show(figures)
    if arguments.json:
        with open(arguments.json, "w") as file:
            json.dump(figures, file, indent=1)


if __name__ == "__main__":
    main()
