"""Exact decisions about pairs of features that are given, for those who have a broad phase of their own."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Literal, NamedTuple

from . import _core
from ._errors import InvalidInput, InvalidType, suggesting

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray


class PairImpacts(NamedTuple):
    """What pairs of features do on their way, an element a pair.

    Attributes:
        hit: (k,) bool: whether they touch at some time in [0, 1].
        toi: (k,) float64: the first such time, the exact one rounded down; infinite without one.
        start: (k,) bool: whether they touch at the start; then toi is 0. It may be 0 for a later contact as well.
    """

    hit: NDArray[np.bool_]
    toi: NDArray[np.float64]
    start: NDArray[np.bool_]


class PairDistances(NamedTuple):
    """How far apart pairs of features are, an element a pair.

    Attributes:
        squared_distance: (k,) float64: the exact one, rounded to the nearest number; infinite beyond the largest.
        touching: (k,) bool: whether the distance is 0 exactly.
        type: (k,) uint8: which parts are closest: a VertexFaceType, an EdgeEdgeType or a VertexEdgeType, whose EA0 and
            E0 are the first end given, or a VertexVertexType.
        at: (k, 2) float64: (u, v) of the face's point a + u (b - a) + v (c - a); (s, t) of the edges' points
            a + s (b - a) and c + t (d - c); (t, 0) of the one edge's a + t (b - a); (0, 0) of two vertices.
    """

    squared_distance: NDArray[np.float64]
    touching: NDArray[np.bool_]
    type: NDArray[np.uint8]
    at: NDArray[np.float64]


def _rows(given: Any, points: int, name: str) -> NDArray[np.float64]:
    """(k * points, 3) of float64, without gaps: float32 converts without loss."""
    import numpy as np

    from ._arrays import host_array

    array = host_array(given, name)
    if array.shape == (0,):  # an empty list
        array = array.reshape(0, points, 3)
    if array.ndim != 3 or array.shape[1:] != (points, 3):
        raise InvalidInput(f"{name} must have shape (pairs, {points}, 3), not {array.shape}")
    if array.dtype.kind not in "fiu" or array.dtype.itemsize > 8:
        raise InvalidInput(f"{name} must be float64 or float32, not {array.dtype}")
    return np.ascontiguousarray(array, np.float64).reshape(-1, 3)


PairKind = Literal["vertex_face", "edge_edge", "vertex_edge", "vertex_vertex"]
_POINTS = {"vertex_face": 4, "edge_edge": 4, "vertex_edge": 3, "vertex_vertex": 2}


def _points_of(kind: Any) -> int:
    if not isinstance(kind, str):
        raise InvalidType(f"kind must be a string, not {type(kind).__name__}")
    if kind not in _POINTS:
        raise InvalidInput(f"kind must be one of {', '.join(_POINTS)}, not {kind!r}")
    return _POINTS[kind]


@suggesting
def pair_impacts(
    kind: PairKind,
    start: Any,
    end: Any,
    *,
    min_distance: float = 0.0,
    min_distance_share: float = 0.0,
    threads: int = 0,
) -> PairImpacts:
    """True if and when features of pairs touch while all points go straight from their start to their end: exactly.

    Each pair is decided as Detector.impacts decides it. Nothing is known of a mesh, so pairs that have a vertex in
    common touch at the start.

    Args:
        kind: "vertex_face", "edge_edge", "vertex_edge" or "vertex_vertex".
        start, end: float64 or float32, on the host. (k, 4, 3): the vertex, then the face's three corners; or the ends
            of the one edge, then those of the other. (k, 3, 3): the vertex, then the edge's ends. (k, 2, 3): two
            vertices.
        min_distance, min_distance_share: as of ImpactQuery.
        threads: 0: as many as the machine has.

    Raises InvalidInput, which names the argument, the pair and the point. Ctrl-C waits for the result. Cost: some
    0.3 us for a pair that is apart, 2 us for one that touches, 5 to 200 us where only rational arithmetic can tell.
    """
    points = _points_of(kind)
    rows = _rows(start, points, "start"), _rows(end, points, "end")
    return PairImpacts(*_core.pair_impacts(kind, *rows, min_distance, min_distance_share, threads))


@suggesting
def pair_distances(kind: PairKind, points: Any, *, threads: int = 0) -> PairDistances:
    """How far apart features of pairs are, and where they are closest: exact, then rounded.

    Args:
        kind, points: as kind and start of pair_impacts.
        threads: 0: as many as the machine has.

    Raises InvalidInput, which names the argument, the pair and the point. Ctrl-C waits for the result. Cost: some
    0.6 us a pair, microseconds where only rational arithmetic can tell.
    """
    return PairDistances(*_core.pair_distances(kind, _rows(points, _points_of(kind), "points"), threads))
