"""Measures the overhead of Python in searches of a world: microseconds of a warm call beyond the library's own time.

    python worlds.py [--calls N]

Balls of 80 triangles, named, clear of each other, on one thread: there is next to nothing to search, so what is left is
what a call costs. Medians. The last lines time what is made once: worlds of many bodies, and their configurations.
"""

from __future__ import annotations

import argparse
import gc
import itertools
import time
from statistics import median

import numpy as np

import crumple


def ball(around=10, across=5):
    u, v = np.meshgrid(2 * np.pi * np.arange(around) / around, np.pi * np.arange(across) / (across - 1), indexing="ij")
    vertices = np.stack([np.sin(v) * np.cos(u), np.sin(v) * np.sin(u), np.cos(v)], axis=-1).reshape(-1, 3)
    a = (across * np.arange(around)[:, None] + np.arange(across - 1)).ravel()
    n = len(vertices)
    return vertices, np.concatenate(
        [np.stack([a, a + 1, (a + across + 1) % n], 1), np.stack([a, (a + across + 1) % n, (a + across) % n], 1)]
    )


def in_a_row(bodies):
    poses = np.tile(np.eye(3, 4), (bodies, 1, 1))
    poses[:, 0, 3] = 3 * np.arange(bodies)
    return poses


def beyond(call, calls):
    """(microseconds of Python, microseconds of the library): medians."""
    python, library, clock, result = [], [], time.perf_counter, None
    for _ in range(calls):
        begin = clock()
        result = call()
        seconds = clock() - begin
        library.append(1e3 * result.statistics.milliseconds)
        python.append(1e6 * seconds - library[-1])
    return median(python[calls // 10 :]), median(library[calls // 10 :])


def tell(what, figures):
    print(f"  {what:58} {figures[0]:8.1f} us over C++, which takes {figures[1]:8.1f}")


def calls_of(detector, shape, bodies):
    names = [f"link {i}" for i in range(bodies)]
    world = crumple.World([shape], [0] * bodies, poses=in_a_row(bodies), names=names)
    poses = in_a_row(bodies)
    square = np.concatenate([poses, np.broadcast_to([0, 0, 0, 1.0], (bodies, 1, 4))], axis=1)
    pairs = np.stack([np.arange(bodies - 1), np.arange(1, bodies)], axis=1).astype(np.int32)
    named = [set(pair) for pair in itertools.pairwise(names)]
    by_index, by_name = (crumple.PairFilter(excluded_bodies=excluded) for excluded in (pairs, named))
    excluded = f'output="any", {bodies - 1} excluded'
    return {
        'output="any"': lambda: detector.intersections(world, output="any"),
        'output="pairs"': lambda: detector.intersections(world),
        'output="any", at poses (n, 3, 4)': lambda: detector.intersections(world.at(poses), output="any"),
        'output="any", at poses (n, 4, 4)': lambda: detector.intersections(world.at(square), output="any"),
        f"{excluded} as an array": lambda: detector.intersections(world, output="any", filter=by_index),
        f"{excluded} by name": lambda: detector.intersections(world, output="any", filter=by_name),
    }


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--calls", type=int, default=10_000)
    calls = parser.parse_args().calls
    gc.disable()
    detector, shape = crumple.Detector(threads=1), crumple.Shape(*ball(), name="ball")
    for bodies in (2, 10):
        for what, call in calls_of(detector, shape, bodies).items():
            tell(f"{bodies} bodies, {what}", beyond(call, calls))
    base = crumple.World([shape], [0] * 11, worlds=[0] * 10 + [-1], poses=in_a_row(11))
    poses = np.tile(in_a_row(10), (1000, 1, 1, 1))
    many = base.configurations(poses)
    tell(
        '1000 configurations of 10 bodies, output="any_by_world"',
        beyond(lambda: detector.intersections(many, output="any_by_world"), 200),
    )

    def milliseconds(make):
        times = []
        for _ in range(20):
            begin = time.perf_counter()
            make()
            times.append(1e3 * (time.perf_counter() - begin))
        return median(times)

    ids = np.zeros(10_000, int)
    print(f"  World of 10000 bodies: {milliseconds(lambda: crumple.World([shape], ids)):.2f} ms")
    print(f"  1000 configurations of 10 bodies: {milliseconds(lambda: base.configurations(poses)):.2f} ms")


if __name__ == "__main__":
    main()
