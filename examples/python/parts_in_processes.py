"""Parts of a scene, answered by several processes: parts travel, and their answers together are the whole answer.

python parts_in_processes.py
"""

import multiprocessing
from concurrent.futures import ProcessPoolExecutor

import numpy as np

import crumple


def scene():
    return crumple.make_scene("cloth", triangles=50_000, frame=93)


def answer(part):
    """Runs anywhere: a part brings all that it takes."""
    return crumple.Detector(threads=1).find(part).pairs.copy()


def main():
    detector = crumple.Detector()
    parts = detector.partition(scene(), count=4)
    with ProcessPoolExecutor(2, mp_context=multiprocessing.get_context("spawn")) as pool:
        answers = list(pool.map(answer, parts))
    for part, pairs in zip(parts, answers):
        print(f"{part}: {len(pairs)} pairs")

    pairs = np.concatenate(answers)
    pairs = pairs[np.lexsort((pairs[:, 1], pairs[:, 0]))]
    assert (pairs == detector.find_self(scene()).pairs).all()
    print(f"together: {len(pairs)} pairs, each once, the same bytes as from one detector")


if __name__ == "__main__":
    main()
