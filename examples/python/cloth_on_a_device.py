"""Simulates a cloth that stays on the device: each step finds on the device what the cloth would touch, and when.

With CuPy and a CUDA device, positions, queries and results are in device memory, on one stream; only a few numbers per
step reach the host. Otherwise the same lines run on NumPy arrays and another backend, with the same bytes.

    launch   enqueues an ImpactQuery on the stream, and returns at once
    wait     returns the impacts, in device memory; `first` is the first one

Vertices that would touch anything do not move in a step. This is repeated until the step is free of impacts, so nothing
ever passes through anything. The solver does not model a real fabric: it has springs along a grid, and gravity.

    python cloth_on_a_device.py [STEPS]
"""

import sys

import numpy as np

import crumple

try:
    import cupy as xp

    xp.cuda.runtime.getDeviceCount()
    detector = crumple.Detector(backend="cuda")
    on_device = True
except (ImportError, RuntimeError, crumple.BackendUnavailable):  # CuPy's errors about CUDA are RuntimeErrors
    xp, detector, on_device = np, crumple.Detector(), False

SIDE, SPACING, STEP = 25, 0.04, 1 / 120


def grid():
    """Returns a square cloth above a pyramid; the last five vertices are static."""
    i, j = np.meshgrid(np.arange(SIDE), np.arange(SIDE), indexing="ij")
    cloth = np.stack([SPACING * (i - SIDE / 2), SPACING * (j - SIDE / 2), 0.35 + 0.002 * (i + 2 * j)], -1)
    number = np.arange(SIDE * SIDE).reshape(SIDE, SIDE)
    a, b, c, d = (corner.ravel() for corner in (number[:-1, :-1], number[1:, :-1], number[1:, 1:], number[:-1, 1:]))
    pyramid = np.array([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0], [0.02, 0.01, 0.33]])
    sides = SIDE * SIDE + np.array([[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]])
    faces = np.concatenate([np.stack([a, b, c], -1), np.stack([a, c, d], -1), sides])
    springs = np.concatenate([np.stack([number[:-1].ravel(), number[1:].ravel()], -1),
                              np.stack([number[:, :-1].ravel(), number[:, 1:].ravel()], -1)])  # fmt: skip
    return np.concatenate([cloth.reshape(-1, 3), pyramid]), faces.astype(np.int32), springs


def impacts(start, end):
    """Returns all impacts of the step: vertices with faces, pairs of edges, the list of edges, and the first impact."""
    if not on_device:
        found = detector.impacts(start, end, faces)
        return found.vertex_faces, found.edge_edges, found.edges, found.first
    scene, stream = crumple.Mesh(start, faces).moving_to(end), xp.cuda.get_current_stream()
    found = detector.launch(scene, crumple.ImpactQuery(), stream=stream).wait()
    return *map(xp.asarray, (found.vertex_faces, found.edge_edges, found.edges)), found.first


def forces(x):
    """Returns the forces of springs along the grid, and of gravity."""
    along = x[springs[:, 1]] - x[springs[:, 0]]
    length = xp.linalg.norm(along, axis=1, keepdims=True)
    pull = 4e3 * (length - SPACING) * along / length
    force = xp.zeros_like(x)
    xp.add.at(force, springs[:, 0], pull)
    xp.add.at(force, springs[:, 1], -pull)
    force[:, 2] -= 9.81
    return force


vertices, faces, springs = map(xp.asarray, grid())
x, v = vertices, xp.zeros_like(vertices)
loose = xp.arange(len(x)) < SIDE * SIDE
queries = stopped = earliest = 0
for _ in range(int(sys.argv[1]) if len(sys.argv) > 1 else 60):
    v = (v + STEP * forces(x)) * 0.98 * loose[:, None]
    end = x + STEP * v
    while True:
        vertex_faces, edge_edges, edges, first = impacts(x, end)
        queries += 1
        if first is None:
            break
        earliest = min(earliest, first.toi) if earliest else first.toi
        touching = xp.concatenate([vertex_faces[:, 0], faces[vertex_faces[:, 1]].ravel(), edges[edge_edges].ravel()])
        still = touching[xp.any(end[touching] != x[touching], axis=1)]
        end[still] = x[still]
        v[still] = 0
        stopped += len(xp.unique(still))
    x = end

print(f"{'on the device' if on_device else 'on the host'}: {queries} queries, {stopped} times a vertex stayed")
print(f"{len(detector.intersections(x, faces))} pairs of triangles intersect in the end")
