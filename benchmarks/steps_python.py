"""Times step sizes as solvers compute them against IPC Toolkit: steps that keep a share of the distance of each pair.

    python steps_python.py [--quick] [--json OUT]

Needs crumple's Python package and ipctk in one environment, which scripts/test_python.sh --all makes, and for real scenes the
frames below $CRUMPLE_DATA (default: ../shared/data beside the checkout); missing scenes are left out.

IPC Toolkit builds its candidates by LBVH, its default, and computes one step size for them, by additive CCD or Tight-Inclusion,
both with conservative_rescaling 0.8, as solvers use them; the faster one counts. Crumple's steps keep 0.2 of the distance of
each pair (min_distance_share). Its free step also verifies the rounded positions at the end of the step.

Further rows compare crumple with itself: first impacts that keep a share with first impacts without one; first impacts of two
sheets that slide in one plane with all impacts; and impacts and proximities in worlds whose bodies are clear of each other with
a search for intersections of the same worlds without motion.

All contestants use one thread and are warm. Times are medians of the thread's CPU time over rounds; the order of contestants is
reversed from round to round.
"""

from __future__ import annotations

import argparse
import functools
import json
import os
import sys
from pathlib import Path

import numpy as np
import rigid_scenes as scenes
from timed_rows import Row, judge, show

import crumple

try:
    import ipctk
except ImportError as error:
    sys.exit(f"steps_python.py compares with IPC Toolkit, which is not installed ({error}): pip install ipctk")

TOP = Path(__file__).resolve().parent.parent
DATA = Path(os.environ.get("CRUMPLE_DATA", TOP.parent / "shared" / "data"))
CCD, KICK = DATA / "scalable-ccd", DATA / "codim-ipc" / "Kick"
FRAMES = {"cloth_ball 92": ("cloth-ball/frames/cloth_ball{}.ply", 92), "funnel 227": ("cloth-funnel/frames/{}.ply", 227)}
KICK_FRAME = 60
SHARE = 0.2


def steps(quick):
    """Yields steps as (name, mesh at the start, vertices at the end)."""
    for triangles in (5_000,) if quick else (5_000, 50_000, 200_000):
        start, end = (crumple.make_scene("cloth", triangles=triangles, frame=frame) for frame in (30, 31))
        yield f"cloth of {len(start.faces):,}", crumple.Mesh(start.vertices, start.faces), end.vertices
    for name, (path, frame) in FRAMES.items():
        if (CCD / path.format(frame)).exists() and not quick:
            start, end = (crumple.read_mesh(CCD / path.format(k)) for k in (frame, frame + 1))
            yield f"{name}, {len(start.faces):,}", start, end.vertices
    if (KICK / "meta.json").exists() and not quick:
        meta = json.loads((KICK / "meta.json").read_text())
        frames = np.memmap(KICK / "verts.f32", np.float32, "r", shape=(meta["frames"], meta["verts"], 3))
        faces = np.fromfile(KICK / "faces.i32", np.int32).reshape(-1, 3)
        mesh = crumple.Mesh(np.array(frames[KICK_FRAME]), faces)
        yield f"kick {KICK_FRAME}, {len(faces):,}", mesh, np.array(frames[KICK_FRAME + 1])


def toolkit(mesh, end):
    """Maps the name of each method of IPC Toolkit to a function that computes its step size."""
    columns = np.asfortranarray
    start, faces = columns(mesh.vertices.astype(float)), columns(mesh.faces.astype(np.int32))
    end = columns(end.astype(float))
    surface = ipctk.CollisionMesh(start, columns(ipctk.edges(faces)), faces)
    tree, candidates = ipctk.LBVH(), ipctk.Candidates()
    methods = {
        "additive CCD": ipctk.AdditiveCCD(conservative_rescaling=1 - SHARE),
        "Tight-Inclusion": ipctk.TightInclusionCCD(conservative_rescaling=1 - SHARE),
    }

    def step(method):
        candidates.build(surface, start, end, 0.0, tree)
        return candidates.compute_collision_free_stepsize(surface, start, end, 0.0, method)

    return {name: lambda turn, method=method: step(method) for name, method in methods.items()}


def rows_of_step(name, mesh, end):
    moving, detector = mesh.moving_to(end), crumple.Detector(threads=1)
    peers = toolkit(mesh, end)

    def first(share):
        return lambda turn: detector.first_impact(moving, min_distance_share=share)

    def free(turn):
        return detector.free_step(moving, min_distance_share=SHARE)

    def toi(impact):
        return 1.0 if impact is None else impact.toi

    def compare(ours):
        return lambda way: f"{ours():.6g}, the peer's step is {peers[way](0):.6g}"

    exact = first(SHARE)
    return [
        Row(
            f"{name}: first impact, share {SHARE}",
            exact,
            {"crumple, share 0": first(0.0)},
            1,
            lambda way: f"{toi(exact(0)):.6g}, without a share {toi(first(0.0)(0)):.6g}",
        ),
        Row("the same", exact, peers, 1, compare(lambda: toi(exact(0)))),
        Row(f"{name}: free step, share {SHARE}", free, peers, 1, compare(lambda: free(0).share)),
    ]


def slides(quick):
    """Returns rows about two flat sheets that slide in one plane: sheets that lie on each other at the start, and sheets that
    lie next to each other at the start."""
    side, detector = 10 if quick else 40, crumple.Detector(threads=1)

    def sheets(apart, way):
        vertices, faces = scenes.sheets(side, apart)
        end = vertices.copy()
        end[len(end) // 2 :] += (way, -2.1, 0)
        return crumple.Mesh(vertices, faces), end

    rows = []
    for name, scene in (("over each other", sheets(0.37, 3.3)), ("next to each other", sheets(side + 0.2, -5.3))):
        mesh, end = scene
        moving = mesh.moving_to(end)
        name = f"two sheets of {side * side * 2:,} {name}, which slide in their plane"
        every = functools.partial(lambda moving, turn: detector.impacts(moving), moving)
        first = functools.partial(lambda moving, turn: detector.first_impact(moving), moving)
        found = functools.partial(lambda every, way: f"{len(every(0))} impacts", every)
        rows.append(Row(f"{name}: first impact", first, {"crumple, all impacts": every}, 1, found))
    # Leaves out Tight-Inclusion, which takes 31 s even for sheets of 32 triangles.
    peer = {"additive CCD": toolkit(*scene)["additive CCD"]}
    compare = lambda way: f"{first(0).toi:.6g}, the peer's step is {peer[way](0):.6g}"  # noqa: E731
    return [*rows, Row("the same", first, peer, 1, compare)]


def clear_worlds(quick):
    """Returns rows about those configurations of a chain of 9 links that are clear of obstacles, which have 40,000 triangles."""
    links, length, count = 9, 1.5, 50 if quick else 500
    vertices, faces = scenes.link(12, 21, length, 0.2)
    room = scenes.obstacles(40_000)
    free = np.random.default_rng(4).uniform(room.vertices.min(0), room.vertices.max(0), size=(20 * count, 3))
    poses = scenes.arm(len(free), links, length, free, 0.9).reshape(len(free), links, 3, 4)
    shapes = [*(crumple.Shape(vertices, faces, name=f"link {k}") for k in range(links))]
    shapes.append(crumple.Shape(room.vertices, room.faces, name="obstacles"))
    robot = crumple.World(shapes, worlds=[0] * links + [-1], self_collisions=False)
    allowed = crumple.PairFilter(excluded_bodies=[(a, b) for b in range(links) for a in range(b)])
    detector = crumple.Detector(threads=1)
    hit = detector.proximities(robot.configurations(poses), radius=0.05, output="any_by_world", filter=allowed).world_hit
    poses = poses[~np.asarray(hit, bool)][:count]
    later = poses.copy()
    later[:, :, :, 3] += 0.02
    world = robot.configurations(poses)
    moving, count = world.at(poses, later), len(poses)
    motion, nearness = {"min_distance": 0.01, "filter": allowed}, {"radius": 0.01, "filter": allowed}
    calls = {
        "impacts of each, yes or no": lambda turn: detector.impacts(moving, output="any_by_world", **motion),
        "proximities of each, yes or no": lambda turn: detector.proximities(world, output="any_by_world", **nearness),
        "all impacts": lambda turn: detector.impacts(moving, **motion),
        "first impact of each": lambda turn: detector.impacts(moving, output="first", **motion),
        "all proximities": lambda turn: detector.proximities(world, **nearness),
    }
    rest = {"crumple, intersections": lambda turn: detector.intersections(world, output="any_by_world", filter=allowed)}
    name = f"{count} configurations of {links} links and {len(room.faces):,} triangles, clear"
    return [
        Row(
            f"{name}: {what}",
            call,
            rest,
            1,
            lambda way, call=call: f"{np.sum(call(0).world_hit)} hit",
            a_turn=count,
        )
        for what, call in calls.items()
    ]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--quick", action="store_true", help="small scenes and few rounds, to check that everything works")
    parser.add_argument("--json", help="file for the figures")
    arguments = parser.parse_args()
    rounds, load = 3 if arguments.quick else 11, os.getloadavg()[0]
    ipctk.set_num_threads(1)
    print(f"crumple {crumple.__version__}, ipctk {ipctk.__version__}, {os.cpu_count()} processors, load {load:.1f}")
    figures = [judge(row, rounds, 30) for step in steps(arguments.quick) for row in rows_of_step(*step)]
    figures += [judge(row, rounds, 30) for row in [*slides(arguments.quick), *clear_worlds(arguments.quick)]]
    show(figures)
    if arguments.json:
        with open(arguments.json, "w") as file:
            json.dump(figures, file, indent=1)


if __name__ == "__main__":
    main()
