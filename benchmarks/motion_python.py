"""Times motion and nearness (exact impacts of a step, near pairs) against IPC Toolkit, in one process, alternately.

    python motion_python.py [--quick] [--scene NAME] [--json OUT]

Needs crumple's Python package and ipctk in one environment, which scripts/test_python.sh --all makes, and the frames
below $CRUMPLE_DATA (default: ../shared/data beside the checkout). IPC Toolkit's meshes, edges and tree objects exist
before the clock starts; crumple gets NumPy arrays, and its measured time includes finding edges. Both are warm.

IPC Toolkit searches overlapping boxes (LBVH, its default) and then tests one candidate after the other, in C++. For
motion it computes one number, a step size up to the first contact, or whether there is a contact, by Tight-Inclusion or
additive CCD with their defaults. For nearness it computes distances. It makes no list of impacts and their times, so
crumple's whole list is compared with the step size. Both find the same candidates, vertices with faces and edges with
edges: crumple as sorted arrays, IPC Toolkit as its C++ objects. For distances, its boxes are inflated by half the
radius, as its own NormalCollisions does, which suffices for all pairs within the radius.

Every contestant is timed on one thread and on all. Times are medians over rounds: on one thread the CPU time of the
thread, which other load on the machine disturbs less; on all threads the wall-clock time. A ratio is computed for each
round; its median and quartiles are reported. The column "fastest" compares wall-clock times, of each contestant with
the number of threads with which it is faster. Steps and distances of the peer are compared with the exact ones.
"""

from __future__ import annotations

import argparse
import os
import platform
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from statistics import median, quantiles
from typing import Any

import figures
import merge_results
import numpy as np

import crumple

try:
    import ipctk
except ImportError as error:
    sys.exit(f"motion_python.py compares with IPC Toolkit, which is not installed ({error}): pip install ipctk")

TOP = Path(__file__).resolve().parent.parent
DATA = Path(os.environ.get("CRUMPLE_DATA", TOP.parent / "shared" / "data"))
THREADS = sorted({1, len(os.sched_getaffinity(0))})
LEAST_ROUNDS = 3


@dataclass
class Scene:
    name: str
    frame: str  # path of a file below scalable-ccd, with a placeholder for the frame number
    first: int  # number of the frame at the start of the step; the next frame is its end
    radius: float  # a quarter of the mean edge length of the first frame

    def path(self, step=0):
        return DATA / "scalable-ccd" / self.frame.format(self.first + step)


SCENES = [
    Scene("funnel 227", "cloth-funnel/frames/{}.ply", 227, 0.0047773383557796478),
    Scene("cloth_ball 92", "cloth-ball/frames/cloth_ball{}.ply", 92, 0.054098617285490036),
    Scene("n-body 18", "n-body-simulation/frames/balls16_{}.ply", 18, 0.020874753594398499),
]


@dataclass
class Contestant:
    name: str
    call: Callable[[], Any]
    tell: Callable[[Any], dict]  # returns the figures to report about a result


def ours(scene, mesh, end, threads):
    """Returns crumple's contestants. Queries about motion, nearness and candidates use one detector each, as in
    simulations."""
    step, near, boxes = (crumple.Detector(threads=threads) for _ in range(3))
    moving = mesh.moving_to(end)
    return [
        Contestant("impacts", lambda: step.impacts(moving), lambda a: {"toi": least_toi(a), "impacts": len(a)}),
        Contestant(
            "first", lambda: step.first_impact(moving), lambda first: {"toi": 1.0 if first is None else first.toi}
        ),
        Contestant("free", lambda: step.any(moving, crumple.ImpactQuery()), lambda touches: {"free": not touches}),
        Contestant(
            "near",
            lambda: near.proximities(mesh, radius=scene.radius),
            lambda a: {"pairs": len(a), "distances": least_distances(a, mesh, scene.radius)},
        ),
        Contestant("candidates", lambda: boxes.candidates(moving), lambda a: {"candidates": len(a)}),
    ]


def least_toi(impacts):
    return min((float(t.min()) for t in (impacts.vertex_face_toi, impacts.edge_edge_toi) if len(t)), default=1.0)


def least_distances(near, mesh, radius):
    """Returns for each vertex the least distance of the near pairs with a feature that has this vertex, or `radius`.

    Of a vertex-face pair these are the vertex and the face's corners, of a pair of edges their ends.
    """
    least = np.full(len(mesh.vertices), radius)
    for corners, squared in (
        (near.vertex_faces[:, :1], near.vertex_face_squared_distance),
        (mesh.faces[near.vertex_faces[:, 1]], near.vertex_face_squared_distance),
        (near.edges[near.edge_edges].reshape(-1, 4), near.edge_edge_squared_distance),
    ):
        for column in corners.T:
            np.minimum.at(least, column, np.sqrt(squared))
    return least


def theirs(scene, mesh, end):
    columns = np.asfortranarray
    start, faces = columns(mesh.vertices.astype(float)), columns(mesh.faces.astype(np.int32))
    end = columns(end.astype(float))
    surface = ipctk.CollisionMesh(start, columns(ipctk.edges(faces)), faces)
    tree, candidates, collisions = ipctk.LBVH(), ipctk.Candidates(), ipctk.NormalCollisions()
    narrow = {"Tight-Inclusion": ipctk.TightInclusionCCD(), "additive CCD": ipctk.AdditiveCCD()}

    def step(method):
        candidates.build(surface, start, end, 0.0, tree)
        return candidates.compute_collision_free_stepsize(surface, start, end, 0.0, method)

    def free(method):
        candidates.build(surface, start, end, 0.0, tree)
        return candidates.is_step_collision_free(surface, start, end, 0.0, method)

    def distances():
        candidates.build(surface, start, 0.5 * scene.radius, tree)
        return candidates.compute_per_vertex_safe_distances(surface, start, scene.radius, 0.0)

    def active():
        collisions.build(surface, start, scene.radius, 0.0, tree)
        return collisions.compute_minimum_distance(surface, start)

    def boxes():
        candidates.build(surface, start, end, 0.0, tree)
        return len(candidates)

    made = [Contestant("candidates, LBVH", boxes, lambda n: {"candidates": n})]
    for name, method in narrow.items():
        made.append(
            Contestant(f"step, {name}", lambda m=method: step(m), lambda s: {"toi": s, "candidates": len(candidates)})
        )
        made.append(Contestant(f"free, {name}", lambda m=method: free(m), lambda f: {"free": bool(f)}))
    made.append(Contestant("safe distances", distances, lambda d: {"candidates": len(candidates), "distances": d}))
    made.append(Contestant("normal collisions", active, lambda d: {"collisions": len(collisions), "least": d**0.5}))
    return made


# Compared queries: title, crumple's contestant, the peer's contestant.
AGAINST = [
    ("all impacts, exact toi", "impacts", "step, Tight-Inclusion"),
    ("all impacts, exact toi", "impacts", "step, additive CCD"),
    ("first impact", "first", "step, Tight-Inclusion"),
    ("first impact", "first", "step, additive CCD"),
    ("is the step free", "free", "free, Tight-Inclusion"),
    ("is the step free", "free", "free, additive CCD"),
    ("all near pairs, squared distances", "near", "safe distances"),
    ("all near pairs, squared distances", "near", "normal collisions"),
    ("box candidates of the step", "candidates", "candidates, LBVH"),
]


def race(contestants, rounds, seconds):
    """Maps each contestant to its milliseconds (wall-clock time, CPU time of the thread) of each round, and to the
    figures of its result. The order of contestants is reversed from round to round."""
    times, told = {c.name: [] for c in contestants}, {}

    def turn(c, record):
        wall, own = time.perf_counter(), time.thread_time()
        answer = c.call()
        spent = time.perf_counter() - wall, time.thread_time() - own
        if record:
            times[c.name].append(tuple(1000 * s for s in spent))
        else:
            told[c.name] = c.tell(answer)

    for c in contestants:
        turn(c, False)
    begin = time.perf_counter()
    for r in range(rounds):
        if r >= LEAST_ROUNDS and time.perf_counter() - begin > seconds:
            break
        for c in contestants[:: 1 if r % 2 else -1]:
            turn(c, True)
    return times, told


def summary(values):
    lower, middle, upper = quantiles(values, method="inclusive")
    return {"median": middle, "lower_quartile": lower, "upper_quartile": upper, "minimum": min(values)}


def compare(mine, peer, exact, radius):
    """Describes how the figures of the peer's result differ from crumple's. `exact` is the exact first time of
    impact."""
    if mine.keys() == {"candidates"}:
        same = mine["candidates"] == peer["candidates"]
        return f"{mine['candidates']:,} candidates" + ("" if same else f", the peer has {peer['candidates']:,}")
    if "free" in peer:
        return "equal" if mine["free"] == peer["free"] else f"we say {mine['free']}, the peer {peer['free']}"
    if "toi" in peer:
        how = "equal" if peer["toi"] == exact else "LATE" if peer["toi"] > exact else f"{peer['toi'] / exact - 1:.0%}"
        return f"exact first toi {exact:.6g}, the peer's step {peer['toi']:.6g} ({how})"
    if "distances" in peer:
        off = np.abs(peer["distances"] - mine["distances"]).max() / radius
        return f"{mine['pairs']:,} pairs of {peer['candidates']:,} candidates; distances are off by {off:.0e} radii"
    least = mine["distances"].min()
    return f"the peer has {peer['collisions']:,}; least distance {least:.6g}, the peer's {peer['least']:.6g}"


def judge(scene, rounds, seconds):
    """Returns records of one scene: the times of each contestant, and the ratios."""
    mesh, end = crumple.read_mesh(scene.path()), crumple.read_mesh(scene.path(1)).vertices
    peers = theirs(scene, mesh, end)
    times, told, records = {}, {}, []
    for threads in THREADS:
        ipctk.set_num_threads(threads)
        contestants = ours(scene, mesh, end, threads) + peers
        times[threads], told = race(contestants, rounds, seconds)
        for c in contestants:
            wall, own = zip(*times[threads][c.name])
            numbers = {k: v for k, v in told[c.name].items() if k != "distances"}
            records.append(
                {"scene": scene.name, "contestant": c.name, "threads": threads, "rounds": len(wall), **numbers}
                | {"wall_ms": summary(wall)}
                | ({"own_ms": summary(own)} if threads == 1 else {})
            )
    exact = told["impacts"]["toi"]
    ratios = []
    for question, mine, peer in AGAINST:
        row = {"scene": scene.name, "question": question, "crumple": mine, "peer": peer}
        for threads in THREADS:
            clock = 1 if threads == 1 else 0
            a, b = ([t[clock] for t in times[threads][name]] for name in (mine, peer))
            row[f"threads_{threads}"] = {
                "crumple_ms": median(a),
                "peer_ms": median(b),
                "ratio": summary([y / x for x, y in zip(a, b)]),
                "ratio_of_minima": min(b) / min(a),
            }
        best = [min(median(t[0] for t in times[n][name]) for n in THREADS) for name in (mine, peer)]
        row["fastest"] = {"crumple_ms": best[0], "peer_ms": best[1], "ratio": best[1] / best[0]}
        row["answers"] = compare(told[mine], told[peer], exact, scene.radius)
        ratios.append(row)
    return records, ratios


def show(ratios):
    header = ["frames", "question", "peer"]
    for threads in THREADS:
        header += [f"{threads} thread{'s' * (threads > 1)}, ms", "peer, ms", "ratio (quartiles; of minima)"]
    rows = [[*header, "fastest", "answers"]]
    for r in ratios:
        row = [r["scene"], r["question"], r["peer"]]
        for threads in THREADS:
            t = r[f"threads_{threads}"]
            q = t["ratio"]
            spread = f"({q['lower_quartile']:.2f} - {q['upper_quartile']:.2f}; {t['ratio_of_minima']:.2f})"
            row += [f"{t['crumple_ms']:.3g}", f"{t['peer_ms']:.3g}", f"{q['median']:.2f} {spread}"]
        rows.append([*row, f"{r['fastest']['ratio']:.2f}", r["answers"]])
    widths = [max(map(len, column)) for column in zip(*rows)]
    for row in rows:
        print("  ".join(cell.ljust(w) for cell, w in zip(row, widths)).rstrip(), flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--quick", action="store_true", help="the smallest scene, few rounds, to check that everything works")
    parser.add_argument("--scene", action="append", choices=[s.name for s in SCENES], help="may be repeated")
    parser.add_argument("--json", help="file for the figures")
    arguments = parser.parse_args()
    rounds, seconds = (3, 5) if arguments.quick else (15, 120)
    chosen = [s for s in SCENES if s.name in (arguments.scene or [])] or SCENES[: 1 if arguments.quick else None]
    if missing := [s.path() for s in chosen if not s.path().exists()]:
        sys.exit(f"motion_python.py: {missing[0]} is missing; set CRUMPLE_DATA to the folder that contains scalable-ccd")
    ipctk.set_logger_level(ipctk.off)  # ipctk logs each contact that exists at the start of a step
    versions = {"crumple": crumple.__version__, "ipctk": ipctk.__version__}
    versions |= {"numpy": np.__version__, "python": platform.python_version()}
    load = os.getloadavg()[0]
    print(f"{versions}, {os.cpu_count()} processors, load {load:.1f}")
    times, ratios = [], []
    for scene in chosen:
        records, rows = judge(scene, rounds, seconds)
        show(rows)
        times += records
        ratios += rows
    result = {**merge_results.origin(), "versions": versions, "load_at_start": load, "times": times, "ratios": ratios}
    print(f"load {result['machine']['load_at_end']:.1f} at the end")
    if arguments.json:
        figures.write(arguments.json, result)


if __name__ == "__main__":
    main()
