"""Times crumple from Python beside IPC Toolkit, MeshLib, trueform and libigl, in one process and taking turns.

    python one_process.py [--scene NAME] [--file MESH] [--triangles N] [--seconds S] [--json OUT]

Everybody is given arrays in the layout, type and memory order that they read without a conversion, made before the
clock starts; trees are built anew in each turn, as for a mesh that deforms; what a library hands out is what is timed.
So peers compute different things, and the table says which: yes or no, boxes, pairs. `missing` and `extra` compare the
pairs as sets with crumple's. Ratios are the medians of ratios within one round. Peers that are not installed are left
out.

benchmarks/peers_python.py is the race in processes of their own, where one library's threads cannot disturb another's;
here all share one process, as in a program that uses several.
"""

from __future__ import annotations

import argparse
import gc
import json
import os
import subprocess
import sys
import time
from statistics import median

import numpy as np

import crumple


class Crumple:
    name, computes = "crumple", "exact pairs, sorted"

    def __init__(self, vertices, faces):
        self.arrays, self.detector = (vertices, faces), crumple.Detector()

    def call(self):
        return self.detector.intersections(*self.arrays)

    def pairs(self, answer):
        return set(map(tuple, answer.pairs.tolist()))


class CrumpleContacts(Crumple):
    name, computes = "crumple, contacts", "exact pairs and where they meet"

    def call(self):
        return self.detector.intersections(*self.arrays, output="contacts")


class CrumpleAny(Crumple):
    name, computes = "crumple, any", "exact yes or no"
    pairs = None

    def call(self):
        return self.detector.any(self.arrays)


class IpcBoxes:
    """Neighbours are left out; no edges are given, so none are put into the tree."""

    name, computes = "IPC Toolkit, LBVH", "boxes that overlap"
    pairs = None

    def __init__(self, vertices, faces):
        import ipctk

        self.vertices = np.asfortranarray(vertices, dtype=float)
        self.faces = np.asfortranarray(faces)
        self.edges = np.asfortranarray(np.empty((0, 2), np.int32))
        self.tree = ipctk.LBVH()

    def call(self):
        self.tree.build(self.vertices, self.edges, self.faces)
        return self.tree.detect_face_face_candidates()


class IpcAny:
    name, computes = "IPC Toolkit, has_intersections", "yes or no, float64"
    pairs = None

    def __init__(self, vertices, faces):
        import ipctk

        self.vertices, faces = np.asfortranarray(vertices, dtype=float), np.asfortranarray(faces)
        self.mesh = ipctk.CollisionMesh(self.vertices, np.asfortranarray(ipctk.edges(faces)), faces)
        self.has_intersections, self.tree = ipctk.has_intersections, ipctk.LBVH()

    def call(self):
        return self.has_intersections(self.mesh, self.vertices, self.tree)


class MeshLib:
    """Holds float32. Its pairs equal the exact ones only with touchIsIntersection."""

    name, computes = "MeshLib", "pairs, float32"

    def __init__(self, vertices, faces):
        import meshlib.mrmeshnumpy as mrmeshnumpy
        import meshlib.mrmeshpy as mrmeshpy

        self.mesh = mrmeshnumpy.meshFromFacesVerts(faces, np.ascontiguousarray(vertices, np.float32))
        self.part, self.find = mrmeshpy.MeshPart(self.mesh), mrmeshpy.findSelfCollidingTriangles

    def call(self):
        self.mesh.invalidateCaches()
        return self.find(self.part, touchIsIntersection=True)

    def pairs(self, answer):
        return {tuple(sorted((p.aFace.get(), p.bFace.get()))) for p in answer}


class TrueformAny:
    name, computes = "trueform, has_self_intersections", "exact yes or no"
    pairs = None

    def __init__(self, vertices, faces):
        import trueform

        self.trueform, self.arrays = trueform, (faces, vertices)

    def call(self):
        return self.trueform.has_self_intersections(self.trueform.Mesh(*self.arrays))


class TrueformCurves(TrueformAny):
    name, computes = "trueform, self_intersection_curves", "exact curves, no pairs"

    def call(self):
        return self.trueform.self_intersection_curves(self.trueform.Mesh(*self.arrays))


class Libigl:
    """CGAL underneath."""

    name, computes = "libigl, remesh_self_intersections", "exact pairs (detect_only)"

    def __init__(self, vertices, faces):
        import igl.copyleft.cgal as cgal

        self.find = cgal.remesh_self_intersections
        self.arrays = np.ascontiguousarray(vertices, float), np.ascontiguousarray(faces, np.int64)

    def call(self):
        return self.find(*self.arrays, detect_only=True)[2]

    def pairs(self, answer):
        return {tuple(sorted(pair)) for pair in answer.tolist()}


KINDS = [Crumple, CrumpleContacts, CrumpleAny, IpcBoxes, IpcAny, MeshLib, TrueformAny, TrueformCurves, Libigl]


def enter(mesh):
    contestants = []
    for kind in KINDS:
        try:
            contestants.append(kind(mesh.vertices, mesh.faces))
        except ImportError as error:
            print(f"{kind.name} is left out: {error}")
    return contestants


def milliseconds(contestant):
    begin = time.perf_counter()
    answer = contestant.call()
    elapsed = 1000 * (time.perf_counter() - begin)
    del answer
    return elapsed


def race(contestants, seconds):
    """A list of rounds; in each, everybody's milliseconds. The order is reversed from round to round."""
    for c in contestants:
        milliseconds(c), milliseconds(c)
    rounds, end = [], time.perf_counter() + seconds
    while len(rounds) < 5 or (time.perf_counter() < end and len(rounds) < 50):
        order = contestants if len(rounds) % 2 else contestants[::-1]
        times = {c.name: milliseconds(c) for c in order}
        rounds.append([times[c.name] for c in contestants])
    return rounds


def judge(contestants, rounds):
    ours = contestants[0].pairs(contestants[0].call())
    rows = []
    for i, c in enumerate(contestants):
        times = [r[i] for r in rounds]
        row = {
            "name": c.name,
            "computes": c.computes,
            "milliseconds": median(times),
            "minimum": min(times),
            "ratio": median(r[i] / r[0] for r in rounds),
        }
        if c.pairs and i:
            theirs = c.pairs(c.call())
            row.update(missing=len(ours - theirs), extra=len(theirs - ours))
        rows.append(row)
    return rows


def overhead(mesh, threads):
    """Microseconds of a warm call in Python beyond the library's own time, which the library takes itself: median and
    least of the differences, call by call. What the call before has found is dropped meanwhile."""
    detector, (vertices, faces, _) = crumple.Detector(threads=threads), mesh
    beyond, clock, result = [], time.perf_counter, None
    for _ in range(200):
        begin = clock()
        result = detector.intersections(vertices, faces)
        seconds = clock() - begin
        beyond.append(1e6 * seconds - 1e3 * result.statistics.milliseconds)
    return {
        "triangles": len(faces),
        "threads": threads or os.cpu_count(),
        "median": median(beyond[5:]),
        "least": min(beyond[5:]),
    }


def import_milliseconds():
    """Returns the median time of `import crumple`, without the start of the interpreter, over 21 new interpreters."""
    program = "import time; t = time.perf_counter(); import crumple; print(1000 * (time.perf_counter() - t))"
    run = [sys.executable, "-c", program]
    return median(float(subprocess.run(run, capture_output=True, check=True, text=True).stdout) for _ in range(21))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--scene", default="cloth", help="procedural scene, last frame")
    parser.add_argument("--file", help="a mesh file instead")
    parser.add_argument("--triangles", type=int, default=0)
    parser.add_argument("--seconds", type=float, default=20, help="length of the race")
    parser.add_argument("--json", help="file for the figures")
    arguments = parser.parse_args()
    if arguments.file:
        mesh = crumple.read_mesh(arguments.file)
    else:
        mesh = crumple.make_scene(arguments.scene, triangles=arguments.triangles)
    gc.disable()
    soups = [crumple.make_scene("soup", triangles=n) for n in (10, 2_000)]
    beyond = [overhead(m, threads) for m in (*soups, mesh) for threads in (1, 0)]  # before peers start their threads
    contestants = enter(mesh)
    busy = os.getloadavg()[0]
    rows = judge(contestants, race(contestants, arguments.seconds))
    print(
        f"{arguments.file or arguments.scene}: {len(mesh.faces)} triangles, {mesh.vertices.dtype}, "
        f"{os.cpu_count()} processors, load {busy:.1f} before the race"
    )
    for row in rows:
        difference = f"{row['missing']} missing, {row['extra']} extra" if "missing" in row else ""
        print(
            f"  {row['name']:34} {row['computes']:32} {row['milliseconds']:9.2f} ms {row['ratio']:7.1f}x  {difference}"
        )
    for o in beyond:
        print(
            f"  a warm call in {o['triangles']} triangles, threads: {o['threads']}: {o['median']:.1f} us over C++ "
            f"(least {o['least']:.1f})"
        )
    importing = import_milliseconds()
    print(f"  import crumple: {importing:.0f} ms")
    if arguments.json:
        with open(arguments.json, "w") as file:
            figures = {"rows": rows, "overhead_microseconds": beyond, "import_milliseconds": importing}
            json.dump({"triangles": len(mesh.faces), **figures}, file, indent=1)


if __name__ == "__main__":
    main()
