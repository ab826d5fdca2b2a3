"""What the tests of motion and nearness share: a small scene, and how answers compare."""

from __future__ import annotations

import numpy as np

# A triangle that falls through another one.
START = np.array([[0, 0, 0], [4, 0, 0], [0, 4, 0], [1, 1, 1], [2, 1, 2], [1, 2, 2]], np.float64)
END = np.array([[0, 0, 0], [4, 0, 0], [0, 4, 0], [1, 1, -1], [2, 1, 0.5], [1, 2, 0.5]], np.float64)
FACES = np.array([[0, 1, 2], [3, 4, 5]], np.int32)

_OF_MOTION = [f"{kind}_{value}" for kind in ("vertex_face", "edge_edge") for value in ("toi", "start")]
_OF_NEARNESS = [
    f"{kind}_{value}" for kind in ("vertex_face", "edge_edge") for value in ("squared_distance", "touching")
]
LISTS = {
    "Impacts": ["vertex_faces", "edge_edges", *_OF_MOTION],
    "Nearby": ["vertex_faces", "edge_edges", *_OF_NEARNESS],
}
BODIES = ["vertex_face_bodies", "edge_edge_bodies", "world_hit"]
CLOSEST = ["vertex_face_type", "vertex_face_at", "edge_edge_type", "edge_edge_at"]
LEAST = ["vertex_distance", "face_distance", "edge_distance"]
INDEX = ["vertex_offsets", "face_offsets", "by_face", "edge_offsets", "second_edge_offsets", "by_second_edge"]


def assert_same(found, expected, more=()):
    """Two answers with everything listed, and with the arrays `more`."""
    for name in (*LISTS[type(expected).__name__], "edges", "first_edge", *more):
        np.testing.assert_array_equal(getattr(found, name), getattr(expected, name), name, strict=True)
    assert (found.any, found.count, len(found)) == (expected.any, expected.count, len(expected))


def check_index(found, vertices, faces):
    """Ranges of rows by either feature, as a search of the lists has them."""
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
