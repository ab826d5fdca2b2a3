"""Worker process that runs one Python peer, in one configuration, each time it gets a request.

A peer's class has `name`, `question`, `computes` and `ways`, pairs of a label and a number of threads (0: all); for the
report also `package`, its name on PyPI, `scalar` and `describes`. A class that is too slow for large scenes has
`most_triangles`: it is left out of larger scenes and of quick runs. `too_much` maps scenes that the class cannot handle
to reasons. The class is constructed from a folder of arrays and a label. `call` is timed and returns a result. `count`
returns the number of pairs in a result, or 0 or 1 for a yes or no, and `pairs` the set of its pairs; neither is timed.
A class whose pairs cannot be compared has no `pairs`, or None.
"""

import gc
import importlib
import json
import os
import sys
import time

import numpy as np


def load(folder, which=""):
    """Returns float64 vertices and int32 triangles of the first mesh (if `which` is empty) or of the second one (if it
    is "_b"), in column-major order, which IPC Toolkit accepts without a copy. `folder` may also be a dictionary of the
    two arrays by the value of `which`."""
    if isinstance(folder, dict):
        return tuple(map(np.asfortranarray, folder[which]))
    scalar = json.loads((folder / "description").read_text())["scalar" + which]
    vertices = np.fromfile(folder / ("vertices" + which), scalar).reshape(-1, 3).astype(float)
    triangles = np.fromfile(folder / ("triangles" + which), np.int32).reshape(-1, 3)
    return np.asfortranarray(vertices), np.asfortranarray(triangles)


def run(peer, seconds):
    """Calls the peer at least once, and until `seconds` of calls have passed. Returns the milliseconds of each call and
    the result's size."""
    times = []
    while not times or sum(times) < 1000 * seconds:
        begin = time.perf_counter()
        answer = peer.call()
        times.append(1000 * (time.perf_counter() - begin))
        size = peer.count(answer)
        del answer
    return {"ms": times, "size": size}


def compare(peer, folder):
    """Returns how many of crumple's pairs the peer misses, and how many it has in addition. If the folder has a file
    `promised`, only its pairs can be missing."""
    ours, promised = (
        set(map(tuple, np.fromfile(folder / name, np.int32).reshape(-1, 2).tolist()))
        for name in ("pairs", "promised" if (folder / "promised").exists() else "pairs")
    )
    theirs = peer.pairs(peer.call())
    return {"missing": len(promised - theirs), "extra": len(theirs - ours)}


def work(module, name, way, threads, folder):
    """Prints "ready", then responds to each line of standard input, `run SECONDS` or `pairs`, with a line of JSON."""
    if threads == 1:
        os.sched_setaffinity(0, {min(os.sched_getaffinity(0))})  # before the library starts its threads
    answers = os.fdopen(os.dup(1), "w")
    os.dup2(2, 1)  # keeps output of the library out of the responses
    gc.disable()
    peer = getattr(importlib.import_module(module), name)(folder, way)
    print(json.dumps("ready"), file=answers, flush=True)
    for line in sys.stdin:
        request, *arguments = line.split()
        answer = run(peer, float(arguments[0])) if request == "run" else compare(peer, folder)
        print(json.dumps(answer), file=answers, flush=True)
