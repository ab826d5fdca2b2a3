"""Times IPC Toolkit's own calls with its broad phase and with crumple.adapters.ipctk, in one process, alternately.

    python ipctk_adapters.py [--quick] [--scene NAME] [--json OUT]

Requirements, scenes, rounds and clocks are those of motion_python.py. Meshes and edges exist before the clock starts.
The measured time includes building trees, making Python objects of candidates, and all of crumple's work. Uses all
threads.
"""

from __future__ import annotations

import argparse
import os
import sys
from statistics import median

import figures
import ipctk
import merge_results
import numpy as np
from motion_python import SCENES, Contestant, race, summary

import crumple
from crumple.adapters import ipctk as adapter


def contestants(scene):
    columns = np.asfortranarray
    mesh, end = crumple.read_mesh(scene.path()), crumple.read_mesh(scene.path(1)).vertices
    start, end, faces = columns(mesh.vertices.astype(float)), columns(end.astype(float)), columns(mesh.faces)
    surface = ipctk.CollisionMesh(start, columns(ipctk.edges(faces)), faces)
    boxes, exact = ipctk.LBVH(), adapter.BroadPhase()
    candidates = ipctk.Candidates()
    detector = crumple.Detector()

    def step(broad_phase):
        candidates.build(surface, start, end, 0.0, broad_phase)
        return candidates.compute_collision_free_stepsize(surface, start, end)

    def exact_step(broad_phase):
        candidates.build(surface, start, end, 0.0, broad_phase)
        return adapter.compute_collision_free_stepsize(candidates, surface, start, end)

    def near(broad_phase):
        collisions = ipctk.NormalCollisions()
        collisions.build(surface, start, scene.radius, 0.0, broad_phase)
        return collisions

    def first_toi():
        first = detector.first_impact(start, end, faces)
        return 1.0 if first is None else first.toi

    def told(toi):
        return {"step": toi, "candidates": len(candidates)}

    def told_near(collisions):
        return {"collisions": len(collisions)}

    return [
        Contestant("step: boxes, Tight-Inclusion", lambda: step(boxes), told),
        Contestant("step: BroadPhase, Tight-Inclusion", lambda: step(exact), told),
        Contestant("step: boxes, exact", lambda: exact_step(boxes), told),
        Contestant("step: BroadPhase, exact", lambda: exact_step(exact), told),
        Contestant("step: first_impact", first_toi, lambda t: {"step": t}),
        Contestant(
            "intersects: boxes", lambda: ipctk.has_intersections(surface, start, boxes), lambda b: {"answer": b}
        ),
        Contestant(
            "intersects: BroadPhase", lambda: ipctk.has_intersections(surface, start, exact), lambda b: {"answer": b}
        ),
        Contestant("barrier: boxes", lambda: near(boxes), told_near),
        Contestant("barrier: BroadPhase", lambda: near(exact), told_near),
        Contestant(
            "barrier: normal_collisions",
            lambda: adapter.normal_collisions(surface, start, scene.radius, detector=detector),
            told_near,
        ),
    ]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--quick", action="store_true", help="the smallest scene, few rounds, to check that everything works")
    parser.add_argument("--scene", action="append", choices=[s.name for s in SCENES], help="may be repeated")
    parser.add_argument("--json", help="file for the figures")
    arguments = parser.parse_args()
    chosen = [s for s in SCENES if s.name in (arguments.scene or [])] or SCENES[: 1 if arguments.quick else 2]
    if missing := [s.path() for s in chosen if not s.path().exists()]:
        sys.exit(f"ipctk_adapters.py: {missing[0]} is missing; set CRUMPLE_DATA to the folder that contains scalable-ccd")
    ipctk.set_logger_level(ipctk.off)
    load, records = os.getloadavg()[0], []
    for scene in chosen:
        times, told = race(contestants(scene), *((3, 5) if arguments.quick else (9, 60)))
        for name, rounds in times.items():
            wall = [wall for wall, _ in rounds]
            print(f"{scene.name:14} {name:34} {median(wall):9.4g} ms  {told[name]}", flush=True)
            records.append({"scene": scene.name, "contestant": name, "wall_ms": summary(wall), **told[name]})
    versions = {"crumple": crumple.__version__, "ipctk": ipctk.__version__}
    print(f"{versions}, {os.cpu_count()} processors, load {load:.1f} at the start")
    if arguments.json:
        figures.write(arguments.json, {**merge_results.origin(), "versions": versions, "times": records})


if __name__ == "__main__":
    main()
