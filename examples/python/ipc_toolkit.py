"""Uses Crumple within the IPC Toolkit: the toolkit's own calls, with an exact broad phase and exact times.

In the IPC Toolkit, Python classes can derive from BroadPhase. The class in crumple.adapters.ipctk returns only pairs
that really come near each other, instead of pairs whose boxes overlap, so the narrow phase has almost nothing to do.
Other functions of this module compute exact times of impact, instead of times with a margin before the contact.

    python ipc_toolkit.py
"""

import ipctk
import numpy as np

import crumple
from crumple.adapters.ipctk import BroadPhase, compute_collision_free_stepsize


def main():
    first, second = (crumple.make_scene("cloth", triangles=20_000, frame=frame) for frame in (36, 37))
    start, end = (np.asfortranarray(mesh.vertices, dtype=float) for mesh in (first, second))
    faces = np.asfortranarray(first.faces)
    mesh = ipctk.CollisionMesh(start, np.asfortranarray(ipctk.edges(faces)), faces)

    candidates, steps = ipctk.Candidates(), {}
    for broad_phase in (ipctk.LBVH(), BroadPhase()):
        name = broad_phase.name()
        candidates.build(mesh, start, end, 0.0, broad_phase)
        steps[name] = ipctk.compute_collision_free_stepsize(mesh, start, end, broad_phase=broad_phase)
        intersects = ipctk.has_intersections(mesh, start, broad_phase)
        words = "intersects at the start" if intersects else "clean at the start"
        print(f"{name:8} {len(candidates):7} candidates, step {steps[name]:.6f}, {words}")

    exact = compute_collision_free_stepsize(candidates, mesh, start, end)
    print(f"exact    {exact:.6f}")
    assert steps["LBVH"] <= steps["Crumple"] <= exact == crumple.first_impact(start, end, faces).toi


if __name__ == "__main__":
    main()
