"""Searches parts of a scene in several processes: parts are sent, and their results together are the whole result.

python parts_in_processes.py
"""

import multiprocessing
from concurrent.futures import ProcessPoolExecutor

import numpy as np

import crumple


def scene():
    return crumple.make_scene("cloth", triangles=50_000, frame=93)


def pairs_of(part):
    """Runs in any process: a part contains everything that the search needs."""
    return crumple.Detector(threads=1).intersections(part).pairs.copy()


def main():
    detector = crumple.Detector()
    parts = detector.partition(scene(), count=4)
    with ProcessPoolExecutor(2, mp_context=multiprocessing.get_context("spawn")) as pool:
        found = list(pool.map(pairs_of, parts))
    for part, pairs in zip(parts, found):
        print(f"{part}: {len(pairs)} pairs")

    pairs = np.concatenate(found)
    pairs = pairs[np.lexsort((pairs[:, 1], pairs[:, 0]))]
    assert (pairs == detector.intersections(scene()).pairs).all()
    print(f"together: {len(pairs)} pairs, each once, the same bytes as from one detector")


if __name__ == "__main__":
    main()
