"""Measures how soon calls end after Ctrl-C: for each query, the median and the longest latency of many stops.

    python stop_latency.py [--quick] [--stops N] [--only NAME]

Needs crumple's Python package, and an idle machine. A timer's signal (SIGALRM, handled like SIGINT) is due at a time that is
drawn uniformly from the duration of the whole call. The latency is the time from then until the call raises
KeyboardInterrupt. Every other stop is in the first call of a new detector, which allocates memory; the others are in later
calls of one detector, which reuse its memory.
"""

from __future__ import annotations

import argparse
import os
import signal
import time

import numpy as np
import rigid_scenes as scenes

import crumple


def moving(triangles):
    start, end = (crumple.make_scene("cloth", triangles=triangles, frame=frame) for frame in (30, 36))
    return crumple.Mesh(start.vertices, start.faces).moving_to(end.vertices)


def robots(count):
    links = 8
    vertices, faces = scenes.link(25, 41, 1.5, 0.2)
    room = scenes.obstacles(200_000)
    free = np.random.default_rng(4).uniform(room.vertices.min(0), room.vertices.max(0), size=(count, 3))
    poses = scenes.arm(count, links, 1.5, free, 0.9)
    shapes = [*(crumple.Shape(vertices, faces) for _ in range(links)), crumple.Shape(room.vertices, room.faces)]
    return crumple.World(shapes, worlds=[0] * links + [-1], self_collisions=False).configurations(poses)


def calls(quick):
    """Maps names of queries to functions of a detector that run them; without `quick`, each takes about a second or more."""
    size = 20_000 if quick else 1_000_000
    cloth = crumple.make_scene("cloth", triangles=size)
    mesh, step = crumple.Mesh(cloth.vertices, cloth.faces), moving(size // 2)
    edge = float(np.linalg.norm(cloth.vertices[cloth.faces[0, 0]] - cloth.vertices[cloth.faces[0, 1]]))
    world = robots(20 if quick else 400)
    bodies = crumple.make_scene("bodies", triangles=size // 2)
    ball, count = scenes.ball(50), 4 if quick else 24
    grid = np.tile(np.eye(3, 4), (count, 1, 1))
    grid[:, 0, 3] = 0.7 * np.arange(count)
    balls = crumple.World([crumple.Shape(*ball)], bodies=[0] * count).at(grid)
    return {
        "intersections": lambda d: d.intersections(mesh, output="contacts"),
        "intersections of bodies": lambda d: d.intersections(bodies.vertices, bodies.faces),
        "impacts": lambda d: d.impacts(step),
        "impacts, share": lambda d: d.impacts(step, min_distance_share=0.2),
        "first impact": lambda d: d.first_impact(step, min_distance_share=0.2),
        "free step": lambda d: d.free_step(step, min_distance_share=0.2),
        "proximities": lambda d: d.proximities(mesh, radius=edge),
        "proximities, 8 rings": lambda d: d.proximities(mesh, radius=edge, rings=8),
        "candidates": lambda d: d.candidates(mesh, inflation=edge / 2),
        "worlds": lambda d: d.intersections(world),
        "distances": lambda d: d.distances(world),
        "clearances": lambda d: d.distances(world, output="nearest"),
        "overlaps": lambda d: d.overlaps(balls, gradient=True, curves=True),
    }


def latency(call, after):
    """Returns the seconds from the time at which the signal is due, `after` seconds after the start of the call, to the
    exception; None if the call ends before."""
    sent = []

    def interrupt(*_):
        sent.append(time.perf_counter())
        raise KeyboardInterrupt

    due = time.perf_counter() + after
    signal.signal(signal.SIGALRM, interrupt)
    signal.setitimer(signal.ITIMER_REAL, after)
    try:
        call()
    except KeyboardInterrupt:
        return time.perf_counter() - due
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
    return None


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--quick", action="store_true", help="small scenes and few stops, to check that everything works")
    parser.add_argument("--stops", type=int, help="number of stops per query")
    parser.add_argument("--only", help="only queries whose names contain this")
    arguments = parser.parse_args()
    stops = arguments.stops or (5 if arguments.quick else 100)
    random = np.random.default_rng(1)
    print(f"crumple {crumple.__version__}, {os.cpu_count()} processors, load {os.getloadavg()[0]:.1f}, {stops} stops each")
    print(f"{'query':<26} {'whole call':>11} {'median':>9} {'worst':>9}   at")
    for name, call in calls(arguments.quick).items():
        if arguments.only and arguments.only not in name:
            continue
        detector = crumple.Detector(threads=1)
        begin = time.perf_counter()
        call(detector)
        whole = time.perf_counter() - begin
        found = []
        for k in range(stops):
            after = random.uniform(0.001, whole)
            used = crumple.Detector(threads=1) if k % 2 else detector
            measured = latency(lambda used=used, call=call: call(used), after)
            if measured is not None:
                found.append((measured, after / whole))
        worst, moment = max(found)
        middle = sorted(found)[len(found) // 2][0]
        print(f"{name:<26} {whole:9.2f} s {1e3 * middle:6.1f} ms {1e3 * worst:6.1f} ms   {moment:.0%}", flush=True)


if __name__ == "__main__":
    main()
