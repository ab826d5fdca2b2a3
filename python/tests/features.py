"""Helpers for tests of motion and nearness: a small scene, comparisons of results, and results with changed members."""

from __future__ import annotations

import numpy as np

import crumple
from conftest import soup
from crumple._results import Request

# A step in which one triangle falls through another one.
START = np.array([[0, 0, 0], [4, 0, 0], [0, 4, 0], [1, 1, 1], [2, 1, 2], [1, 2, 2]], np.float64)
END = np.array([[0, 0, 0], [4, 0, 0], [0, 4, 0], [1, 1, -1], [2, 1, 0.5], [1, 2, 0.5]], np.float64)
FACES = np.array([[0, 1, 2], [3, 4, 5]], np.int32)

_KINDS = ("vertex_face", "edge_edge", "vertex_edge", "vertex_vertex")
_PAIRS = ["vertex_faces", "edge_edges", "vertex_edges", "vertex_vertices"]
CANDIDATE_KINDS = ("vertex_face", "edge_edge", "edge_face", "face_face", "vertex_edge", "vertex_vertex")
LISTS = {
    "Candidates": [*_PAIRS, "edge_faces", "face_faces"],
    "Impacts": [*_PAIRS, *(f"{kind}_{value}" for kind in _KINDS for value in ("toi", "start"))],
    "Proximities": [*_PAIRS, *(f"{kind}_{value}" for kind in _KINDS for value in ("squared_distance", "touching"))],
}
TRIANGLES = [
    *("triangle_pairs", "triangle_pair_toi", "triangle_pair_start", "triangle_pair_bodies"),
    *("triangle_offsets", "second_triangle_offsets", "by_second_triangle"),
]
BODIES = [*(f"{kind}_bodies" for kind in _KINDS), "world_hit"]
CLOSEST = [f"{kind}_{what}" for kind in _KINDS for what in ("type", "at")]
LEAST = ["vertex_distance", "face_distance", "edge_distance"]
INDEX = [
    *("vertex_offsets", "face_offsets", "by_face"),
    *("edge_offsets", "second_edge_offsets", "by_second_edge"),
    *("vertex_edge_offsets", "edge_vertex_offsets", "by_edge"),
    *("vertex_vertex_offsets", "second_vertex_offsets", "by_second_vertex"),
]


def assert_same(found, expected, more=()):
    """Checks that two results have the same lists, and the same contents of the arrays named in `more`."""
    for name in (*LISTS[type(expected).__name__], "edges", "first_edge", "points", "first_point", *more):
        np.testing.assert_array_equal(getattr(found, name), getattr(expected, name), name, strict=True)
    assert (found.any, found.count, len(found)) == (expected.any, expected.count, len(expected))


def restored(result, **changes):
    """Returns a result restored from the changed state of `result`.

    `changes`: functions that map old to new contents, by the name of an array or value, of an attribute of the request,
    or of a part of the scene.
    """
    restore, (kind, asked, state, *given) = result.__reduce__()
    asked = Request(*asked)._asdict()
    scene = dict(zip(("first", "second", "ids", "ids_second"), given))
    for name, change in changes.items():
        parts = asked if name in asked else scene if name in scene else state
        parts[name] = change(parts[name])
    return restore(kind, tuple(asked.values()), state, *scene.values())


def check_index(found, vertices, faces):
    """Checks that the offsets give, for each first and each second feature, the rows that contain it."""
    edges = len(found.edges)
    for pairs, offsets, second_offsets, by_second, firsts, seconds in (
        (found.vertex_faces, found.vertex_offsets, found.face_offsets, found.by_face, vertices, faces),
        (found.edge_edges, found.edge_offsets, found.second_edge_offsets, found.by_second_edge, edges, edges),
    ):
        assert len(pairs) and len(offsets) == firsts + 1 and len(second_offsets) == seconds + 1
        for i in range(firsts):
            np.testing.assert_array_equal(np.arange(offsets[i], offsets[i + 1]), np.flatnonzero(pairs[:, 0] == i))
        for i in range(seconds):
            rows = by_second[second_offsets[i] : second_offsets[i + 1]]
            np.testing.assert_array_equal(rows, np.flatnonzero(pairs[:, 1] == i))


def moving(seed, triangles=14, far=0.4, size=0.5, dtype=np.float64):
    """Returns (vertices, end, faces) of a soup whose vertices move in random directions."""
    mesh = soup(triangles, size=size, seed=seed, dtype=dtype)
    steps = np.random.default_rng(seed + 1000).normal(size=mesh.vertices.shape)
    return mesh.vertices, (mesh.vertices + far * steps).astype(dtype), mesh.faces


def falling_world(**others):
    shapes = [crumple.Shape(START[:3], FACES[:1]), crumple.Shape(START[3:], FACES[:1], end=END[3:])]
    return crumple.World(shapes, names=["floor", "chip"], **others)
