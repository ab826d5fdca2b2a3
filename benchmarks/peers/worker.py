"""The life of a process that answers for one Python peer, in one way, and waits for its turn.

A peer's class has `name`, `question`, `computes` and `ways`, pairs of a label and a number of threads (0: all); for the
report also `package`, its name on PyPI, `scalar` and `describes`. One that is too slow for large scenes has
`most_triangles`, and rests in quick runs; `too_much` names scenes that are not for it, and why. It is made from a folder
of arrays and such a label. `call` is timed and returns an answer; `count`, its size, and `pairs`, its set, are read off
the clock.
"""

import gc
import importlib
import json
import os
import sys
import time

import numpy as np


def load(folder, which=""):
    """float64 vertices and int32 triangles of the first mesh, or of the second (`which` is "_b"), in the column order that
    the IPC Toolkit takes without a copy."""
    scalar = json.loads((folder / "description").read_text())["scalar" + which]
    vertices = np.fromfile(folder / ("vertices" + which), scalar).reshape(-1, 3).astype(float)
    triangles = np.fromfile(folder / ("triangles" + which), np.int32).reshape(-1, 3)
    return np.asfortranarray(vertices), np.asfortranarray(triangles)


def run(peer, seconds):
    """Calls until `seconds` are spent, at least once: the milliseconds of each call and the size of the answer."""
    times = []
    while not times or sum(times) < 1000 * seconds:
        begin = time.perf_counter()
        answer = peer.call()
        times.append(1000 * (time.perf_counter() - begin))
        size = peer.count(answer)
        del answer
    return {"ms": times, "size": size}


def compare(peer, folder):
    """How many of crumple's pairs the peer misses, and how many it has in addition."""
    ours = set(map(tuple, np.fromfile(folder / "pairs", np.int32).reshape(-1, 2).tolist()))
    theirs = peer.pairs(peer.call())
    return {"missing": len(ours - theirs), "extra": len(theirs - ours)}


def work(module, name, way, threads, folder):
    """Answers each line of standard input, `run SECONDS` or `pairs`, by a line of JSON; "ready" comes first."""
    if threads == 1:
        os.sched_setaffinity(0, {min(os.sched_getaffinity(0))})  # before the library starts its threads
    answers = os.fdopen(os.dup(1), "w")
    os.dup2(2, 1)  # what the library prints must not come between
    gc.disable()
    peer = getattr(importlib.import_module(module), name)(folder, way)
    print(json.dumps("ready"), file=answers, flush=True)
    for line in sys.stdin:
        request, *arguments = line.split()
        answer = run(peer, float(arguments[0])) if request == "run" else compare(peer, folder)
        print(json.dumps(answer), file=answers, flush=True)
