"""Times overlaps of bodies (docs/overlap.md) against Manifold's booleans, in one process, alternately.

    python overlaps_python.py [--quick] [--case NAME] [--threads N] [--backend cuda] [--json OUT]

Needs crumple's Python package and Manifold (pip install manifold3d) in one environment, and for real meshes the data
below $CRUMPLE_DATA (default: ../shared/data beside the checkout); rows whose data is missing are left out. Each number
of threads runs in a process of its own, which is limited to as many cores.

Manifold computes a boolean and its volume; crumple computes volume, centroid, normal, depth and torque. Manifold's
meshes are objects that exist before the clock starts, and it is given the pairs of bodies that crumple has to find.
Kinds of rows:

    deform      vertices move in each call: Manifold makes solids of the meshes, then the boolean
    before      named shapes under new poses: Manifold's solids exist before the clock starts. One contestant of
                Manifold transforms a solid and makes the boolean; another one only makes the boolean
    search      overlaps against crumple's own search for intersections of the same scene, both warm
    first call  the same with new detectors, which have not searched the triangles before
    poses       configurations of two bodies: crumple in one call, Manifold in a loop over a part of them
    contact     bodies that touch, whose volume is exactly 0: overlaps against crumple's search for intersections

A ratio is computed for each round (timed_rows.py). With the cpu backend on one thread, times are CPU times of the
process, which other load on the machine disturbs less; otherwise wall-clock times. With --backend cuda, crumple
searches and sums on a device, and the number of threads is that of the host's part. Volumes are compared with exact ones if these are known.
"""

from __future__ import annotations

import argparse
import itertools
import json
import os
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass
from importlib.metadata import version
from pathlib import Path
from statistics import median

import figures
import merge_results
import numpy as np
import rigid_scenes as scenes
from overlap_pairs import DATA, alternating, read_body, real_pairs, states_of
from timed_rows import Row, judge, show

import crumple

try:
    import manifold3d
except ImportError as error:
    sys.exit(f"overlaps_python.py compares with Manifold, which is not installed ({error}): pip install manifold3d")

SEARCH = "crumple, intersections"
@dataclass
class Setting:
    """Settings of a run in one process."""

    quick: bool
    threads: int
    backend: str

    @property
    def clock(self):
        return time.process_time if self.threads == 1 and self.backend == "cpu" else time.perf_counter

    def detector(self):
        return crumple.Detector(backend=self.backend, threads=self.threads)


def solid(vertices, faces):
    return manifold3d.Mesh64(np.ascontiguousarray(vertices, float), np.ascontiguousarray(faces, np.uint64))


def refused(pair):
    """Returns Manifold's reason for refusing to make a solid of one of the bodies; None if it accepts both."""
    states = [manifold3d.Manifold(solid(*body)).status() for body in pair.bodies]
    return next((f"{s}" for s in states if s != manifold3d.Error.NoError), None)


def volume_of(found):
    return float(found.volume.sum())


def relative(value, of):
    return abs(value - of) / abs(of) if of else abs(value)


def off(value, exact):
    return "exact" if value == exact else f"off by {relative(value, exact):.1e}"


def judge_volumes(ours, theirs, exact):
    if exact is not None:
        return f"volume {exact:.10g}: crumple {off(ours, exact)}, Manifold {off(theirs, exact)}"
    return f"volume {ours:.10g}, not known exactly; Manifold differs by {relative(theirs, ours):.1e}"


def deforming(pair, setting):
    states = states_of(pair.bodies)
    meshes = [[crumple.Mesh(*body) for body in bodies] for bodies in states]
    solids = [[solid(*body) for body in bodies] for bodies in states]
    detector = setting.detector()

    def ours(state):
        return detector.overlaps(*meshes[state])

    def theirs(state):
        a, b = map(manifold3d.Manifold, solids[state])
        return (a ^ b).volume()

    def compare(_):
        bent = relative(theirs(1), volume_of(ours(1)))
        return judge_volumes(volume_of(ours(0)), theirs(0), pair.exact) + f"; bent: they differ by {bent:.1e}"

    contestants = alternating(ours), {"Manifold, solids and boolean": alternating(theirs)}
    return Row(f"{pair.name}, deform", *contestants, 1, compare, clock=setting.clock)


def built_before(pair, setting):
    shapes = [crumple.Shape(*body, name=f"{pair.name} {k}") for k, body in enumerate(pair.bodies)]
    world, detector = crumple.World(shapes), setting.detector()
    poses = np.tile(np.eye(3, 4), (2, 2, 1, 1))  # [state, body]: the second body is rotated by 0.001 or by -0.001
    for state, angle in enumerate((0.001, -0.001)):
        poses[state, 1, :2, :2] = [[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]]
    a, b = (manifold3d.Manifold(solid(*body)) for body in pair.bodies)

    def ours(state):
        world.poses = poses[state]
        return detector.overlaps(world)

    def transformed(state):
        return (a ^ b.transform(poses[state, 1])).volume()

    def compare(_):
        turned = relative(transformed(0), volume_of(ours(0)))
        unposed = volume_of(detector.overlaps(world.at(np.tile(np.eye(3, 4), (2, 1, 1)))))
        return judge_volumes(unposed, (a ^ b).volume(), pair.exact) + f"; turned: they differ by {turned:.1e}"

    theirs = {
        "Manifold, transform and boolean": alternating(transformed),
        "Manifold, boolean alone": lambda turn: (a ^ b).volume(),
    }
    return Row(f"{pair.name}, before", alternating(ours), theirs, 1, compare, clock=setting.clock)


def beside_search(name, states, setting):
    """Returns a row that compares overlaps with a search for intersections. Calls are warm, and alternate between the
    states."""
    meshes = [[crumple.Mesh(*body) for body in bodies] for bodies in states]
    mine, search = setting.detector(), setting.detector()

    def ours(state):
        return mine.overlaps(*meshes[state % len(meshes)])

    def theirs(state):
        return search.intersections(*meshes[state % len(meshes)])

    def compare(_):
        found = ours(0)
        rows = f"volume {volume_of(found):.10g}, " if len(found) else "no row, "
        return rows + f"{len(theirs(0).pairs):,} pairs, {found.statistics.rational_tests:,} rational tests"

    return Row(name, alternating(ours), {SEARCH: alternating(theirs)}, 1, compare, clock=setting.clock)


def first_call(pair, setting):
    meshes = [crumple.Mesh(*body) for body in pair.bodies]

    def ours(turn):
        detector = setting.detector()
        return detector, detector.overlaps(*meshes)

    def theirs(turn):
        detector = setting.detector()
        return detector, detector.intersections(*meshes)

    return Row(f"{pair.name}, first call", ours, {SEARCH: theirs}, 1, lambda _: "new detectors", clock=setting.clock)


def pairs_of_meshes(setting, names):
    if setting.quick and not names:
        names = ["ember016"]
    for pair in real_pairs(names):
        if why := refused(pair):
            print(f"{pair.name}: Manifold refuses it ({why}), so only crumple is timed")
        else:
            yield deforming(pair, setting)
            yield built_before(pair, setting)
        yield beside_search(f"{pair.name}, search", states_of(pair.bodies), setting)
        yield first_call(pair, setting)


def balls_of_the_scene(truth):
    """Returns the bodies of a file that contains many, and the exact overlap volumes of some pairs of them."""
    path = DATA / truth["file"]
    runs = json.loads((path.parent.parent.parent / "derived" / "n-body-simulation_components.json").read_text())
    vertices, faces = read_body(truth)
    first, start = ([row[1] for row in runs[name]] for name in ("vertex_runs", "triangle_runs"))
    cut = zip(first, [*first[1:], len(vertices)], start, [*start[1:], len(faces)])
    bodies = [(vertices[v:w], faces[t:u] - v) for v, w, t, u in cut]
    return bodies, {(a, b): float.fromhex(volume) for a, b, volume, *_ in truth["rows"]}


def many_balls(setting):
    """Yields rows of a scene of many balls. Crumple has to find the overlapping pairs; Manifold is given them."""
    path = DATA / "gt-overlap" / "balls16_18.json"
    if not path.exists() or not (DATA / json.loads(path.read_text())["file"]).exists():
        print(f"balls are left out: {path}, or the scene that it names, is missing")
        return
    bodies, exact = balls_of_the_scene(json.loads(path.read_text()))
    states = states_of(bodies)
    worlds = [crumple.World([crumple.Shape(*body) for body in state]) for state in states]
    query = {"open": "skip"}
    named = crumple.World([crumple.Shape(*body, name=f"ball {k}") for k, body in enumerate(bodies)])
    poses = np.tile(np.eye(3, 4), (2, len(bodies), 1, 1))
    poses[1, ::2, :, 3] = 2**-12 * np.ptp(bodies[0][0], axis=0).max()
    deform, before = setting.detector(), setting.detector()

    def posed(state):
        named.poses = poses[state]
        return before.overlaps(named, **query)

    # The normals of all bodies point inwards. Manifold expects outward normals, so their faces are reversed for it.
    pairs = [tuple(map(int, row)) for row in deform.overlaps(worlds[0], **query).bodies]
    used = sorted(set(itertools.chain(*pairs)))
    solids = [{k: solid(state[k][0], state[k][1][:, ::-1]) for k in used} for state in states]
    made = {k: manifold3d.Manifold(solids[0][k]) for k in used}

    def booleans(of):
        return [(of[a] ^ of[b]).volume() for a, b in pairs]

    def built(state):
        return booleans({k: manifold3d.Manifold(mesh) for k, mesh in solids[state].items()})

    def compare(found, volumes):
        ours = dict(zip(map(tuple, found.bodies.tolist()), found.volume.tolist()))
        theirs = dict(zip(pairs, volumes))
        apart = max(relative(theirs[p], ours[p]) for p in pairs)
        right = [sum(v[p] == exact[p] for p in exact) for v in (ours, theirs)]
        worst = max(relative(theirs[p], exact[p]) for p in exact)
        return (
            f"{len(ours)} pairs, which differ by up to {apart:.1e}; of {len(exact)} exact volumes crumple has "
            f"{right[0]}, Manifold {right[1]} (off by up to {worst:.1e})"
        )

    yield Row(
        f"{len(pairs)} pairs among {len(bodies)} balls, deform",
        alternating(lambda state: deform.overlaps(worlds[state], **query)),
        {"Manifold, solids and booleans": alternating(built)},
        1,
        lambda _: compare(deform.overlaps(worlds[0], **query), built(0)),
        clock=setting.clock,
    )
    yield Row(
        f"{len(pairs)} pairs among {len(bodies)} balls, before",
        alternating(posed),
        {"Manifold, booleans alone": lambda turn: booleans(made)},
        1,
        lambda _: compare(posed(0), booleans(made)),
        clock=setting.clock,
    )


def configurations(setting):
    """Yields rows about many configurations of two named bodies, about half of which overlap. Crumple computes volumes
    and normals of all in one call; Manifold computes the volumes of a twentieth of them in a loop."""
    count = 1_000 if setting.quick else 10_000
    some = count // 20
    vertices, faces = scenes.ball(5)
    ball = vertices.astype(float), faces
    poses = scenes.beside_each_other(count, (1, 3))
    for name, other in (("two balls of 500", ball), ("ball of 500 and box of 12", scenes.box(2.0))):
        shapes = [crumple.Shape(*body, name=f"{name} {k}") for k, body in enumerate((ball, other))]
        world, detector = crumple.World(shapes).configurations(poses), setting.detector()
        a, b = (manifold3d.Manifold(solid(*body)) for body in (ball, other))

        def ours(turn, world=world, detector=detector):
            found = detector.overlaps(world)
            return found.bodies, found.volume, found.normal

        def theirs(turn, a=a, b=b):
            return [(a.transform(p) ^ b.transform(q)).volume() for p, q in poses[:some]]

        def compare(_, ours=ours, theirs=theirs):
            rows, volumes, _ = ours(0)
            mine = np.zeros(count)
            mine[rows[:, 0] // 2] = volumes
            apart = np.abs(mine[:some] - theirs(0)).max()
            return f"{len(rows):,} overlap; volumes of {some} differ by up to {apart:.1e}"

        title = f"{name}, {count:,} poses"
        peers = {"Manifold, transforms and boolean": theirs}
        yield Row(title, ours, peers, 1, compare, count, clock=setting.clock, peer_a_turn=some)


def contact(setting):
    """Yields rows of bodies that touch. Volumes and area vectors are exactly 0; only rational arithmetic proves it."""
    vertices = 10_000 if setting.quick else 100_000
    for name, bodies in (
        ("tents that share a ridge", scenes.tents(vertices // 3)),
        ("sphere and its mirror image", scenes.mirrored(*scenes.ball(round((vertices / 10) ** 0.5)))),
    ):
        yield beside_search(f"{name}, {len(bodies[0][0]):,} vertices each, contact", [bodies], setting)


KINDS = ("deform", "before", "search", "first call", "poses", "contact")


def kind_of(name):
    return next(kind for kind in KINDS if name.endswith(kind))


GROUPS = {"balls": many_balls, "poses": configurations, "contact": contact}


def measure(setting, names):
    groups = [make(setting) for name, make in GROUPS.items() if not names or name in names]
    rows = []
    for row in itertools.chain(pairs_of_meshes(setting, names), *groups):
        figure = judge(row, 3 if setting.quick else 11, 5 if setting.quick else 40)
        if figure["peer"] == SEARCH:
            figure["answers"] += f"; {1 / figure['ratio']:.2f} times the search"
        rows.append({"kind": kind_of(row.name)} | figure)
    if not rows:
        sys.exit(f"overlaps_python.py: no case is named {' or '.join(names)}, or its files are missing")
    return rows


def summarise(rows):
    for kind in KINDS:
        ratios = [row["ratio"] for row in rows if row["kind"] == kind]
        if len(ratios) > 1:
            print(f"{kind}: median ratio {median(ratios):.2f} of {len(ratios)}, least {min(ratios):.2f}")


def run(setting, names):
    """Measures in this process, on the first setting.threads of the cores that it may use."""
    cores = sorted(os.sched_getaffinity(0))
    if len(cores) < setting.threads:
        sys.exit(f"overlaps_python.py: {setting.threads} threads need as many cores, and this process has {len(cores)}")
    os.sched_setaffinity(0, cores[: setting.threads])
    load = os.getloadavg()[0]
    print(f"\nbackend: {setting.backend}, threads: {setting.threads}, cores {cores[: setting.threads]}, load {load:.1f}", flush=True)
    rows = measure(setting, names)
    show(rows)
    summarise(rows)
    print(f"load {os.getloadavg()[0]:.1f} at the end", flush=True)
    return {"backend": setting.backend, "threads": setting.threads, "load_at_start": load, "load_at_end": os.getloadavg()[0], "rows": rows}


def run_apart(threads, arguments):
    """Runs the measurements in a new process, since Manifold's first call fixes its number of threads: one per core."""
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder) / "run.json"
        command = [sys.executable, __file__, "--threads", str(threads), "--backend", arguments.backend]
        command += ["--json", str(out)]
        command += ["--quick"] * arguments.quick + [f"--case={name}" for name in arguments.case or []]
        subprocess.run(command, check=True)
        return json.loads(out.read_text())["runs"]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--quick", action="store_true", help="few scenes and rounds, to check that everything works")
    parser.add_argument(
        "--case", action="append", help="a pair of meshes, balls, poses or contact; may be repeated; else all"
    )
    parser.add_argument("--threads", type=int, action="append", help="may be repeated; else 1 and 2")
    parser.add_argument("--backend", choices=("cpu", "cuda"), default="cpu", help="backend of crumple")
    parser.add_argument("--json", help="file for the figures")
    arguments = parser.parse_args()
    threads = arguments.threads or [1, 2]
    versions = {"crumple": crumple.__version__, "manifold3d": version("manifold3d"), "numpy": np.__version__}
    if len(threads) == 1:
        runs = [run(Setting(arguments.quick, threads[0], arguments.backend), arguments.case)]
    else:
        print(f"{versions}, {os.cpu_count()} processors")
        runs = [r for n in threads for r in run_apart(n, arguments)]
    if arguments.json:
        figures.write(arguments.json, {**merge_results.origin(), "versions": versions, "runs": runs})


if __name__ == "__main__":
    main()
