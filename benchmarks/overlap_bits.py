"""Tests whether volumes of overlaps are the same bits in repeated runs, for permuted faces, and on one thread and two.

Contestants: crumple, Manifold and trueform, where installed. Each computes the volume of the overlap of two bodies from arrays,
in one process for each number of threads, in which their calls alternate.
"""

from __future__ import annotations

import importlib.util
import json
import os
import subprocess
import sys
import time
from importlib.metadata import version
from statistics import median

import numpy as np
from overlap_pairs import real_pairs

import crumple

RUNS = 10
PAIRS = ("ember016", "ember260", "ember406", "armadillo_twice", "dragon_twice")
PACKAGES = {"Manifold": "manifold3d", "trueform": "trueform"}


def crumple_volume(threads):
    detector = crumple.Detector(threads=threads)
    return lambda a, b: float(detector.overlaps(crumple.Mesh(*a), crumple.Mesh(*b)).volume.sum())


def manifold_volume(threads):
    import manifold3d

    def solid(vertices, faces):
        mesh = manifold3d.Mesh64(np.ascontiguousarray(vertices), np.ascontiguousarray(faces, np.uint64))
        made = manifold3d.Manifold(mesh)
        if made.status() != manifold3d.Error.NoError:
            raise ValueError(made.status())
        return made

    return lambda a, b: (solid(*a) ^ solid(*b)).volume()


def trueform_volume(threads):
    import trueform

    def volume(a, b):
        meshes = (trueform.Mesh(np.ascontiguousarray(f, np.int32), np.ascontiguousarray(v)) for v, f in (a, b))
        return float(trueform.volume(trueform.boolean_intersection(*meshes)[0]))

    return volume


CONTESTANTS = {"Crumple": crumple_volume, "Manifold": manifold_volume, "trueform": trueform_volume}


def permuted(body, rng):
    vertices, faces = body
    return vertices, np.ascontiguousarray(rng.permutation(faces))


def measure_pair(pair, contestants):
    """Returns volumes and milliseconds of each contestant: of RUNS runs, then of RUNS runs with permuted faces."""
    figures = {name: {"same": [], "permuted": [], "ms": []} for name in contestants}
    rng = np.random.default_rng(1)
    for run in range(RUNS):
        for what, bodies in (("same", pair.bodies), ("permuted", [permuted(body, rng) for body in pair.bodies])):
            for name, call in list(contestants.items())[:: 1 if run % 2 else -1]:
                if "refused" in figures[name]:
                    continue
                begin = time.perf_counter()
                try:
                    volume = call(*bodies)
                except Exception as error:
                    figures[name]["refused"] = str(error)
                    continue
                figures[name]["ms"].append(1000 * (time.perf_counter() - begin))
                figures[name][what].append(volume.hex())
    return figures


def work(threads):
    """Prints the figures of all pairs as JSON. Manifold and trueform use as many threads as the process has cores."""
    out = os.fdopen(os.dup(1), "w")
    os.dup2(2, 1)
    os.sched_setaffinity(0, sorted(os.sched_getaffinity(0))[:threads])
    names = [name for name in CONTESTANTS if name not in PACKAGES or importlib.util.find_spec(PACKAGES[name])]
    contestants = {name: CONTESTANTS[name](threads) for name in names}
    rows = {pair.name: {"exact": pair.exact, "figures": measure_pair(pair, contestants)} for pair in real_pairs(PAIRS)}
    json.dump(rows, out)


def distinct(*lists):
    return len({volume for volumes in lists for volume in volumes})


def error_of(volumes, exact):
    if exact is None:
        return "not known"
    worst = max(abs(float.fromhex(volume) - exact) for volume in volumes)
    return f"{worst / exact:.0e}" if worst else "exact"


def table():
    """Returns lines of Markdown, and the versions of the contestants."""
    runs = [
        json.loads(subprocess.run([sys.executable, __file__, str(n)], check=True, stdout=subprocess.PIPE).stdout) for n in (1, 2)
    ]
    lines = [
        "| bodies | library | volumes of 10 runs | of 10 permutations | on 1 and 2 threads, permuted or not | greatest error | ms, 1 thread "
        "| ms, 2 threads |",
        "|---|---|---|---|---|---|---|---|",
    ]
    for name, first in runs[0].items():
        for library, one in first["figures"].items():
            two = runs[1][name]["figures"][library]
            if refused := one.get("refused") or two.get("refused"):
                lines.append(f"| {name} | {library} | refused: {refused} |" + " |" * 5)
                continue
            every = [one["same"], one["permuted"], two["same"], two["permuted"]]
            times = []
            for figures, run in ((one, runs[0]), (two, runs[1])):
                ours = run[name]["figures"]["Crumple"]["ms"]
                ratio = median(t / o for t, o in zip(figures["ms"], ours))
                times.append(f"{median(figures['ms']):.3g}" + ("" if library == "Crumple" else f" ({ratio:.2g}x)"))
            cells = [distinct(one["same"]), distinct(one["permuted"]), distinct(*every)]
            error = error_of(sum(every, []), first["exact"])
            lines.append(f"| {name} | {library} | {' | '.join(map(str, cells))} | {error} | {' | '.join(times)} |")
    versions = {name: version(package) for name, package in PACKAGES.items() if importlib.util.find_spec(package)}
    return lines, {"Crumple": crumple.__version__, **versions}


if __name__ == "__main__":
    work(int(sys.argv[1]))
