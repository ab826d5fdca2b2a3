"""Exact decisions about pairs of features that are given, for those who have a broad phase of their own."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

from . import _core
from ._errors import InvalidInput
from ._names import suggesting

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


def _impacts(decide: Any, points: int, start: Any, end: Any, options: dict[str, Any]) -> PairImpacts:
    return PairImpacts(*decide(_rows(start, points, "start"), _rows(end, points, "end"), **options))


@suggesting
def vertex_face_impacts(
    start: Any, end: Any, *, min_distance: float = 0.0, min_distance_share: float = 0.0, threads: int = 0
) -> PairImpacts:
    """Whether and when vertices touch faces while all points go straight from their start to their end: exactly.

    Each pair is decided as Detector.find_impacts decides it. Nothing is known of a mesh, so pairs that have a vertex in
    common touch at the start.

    Args:
        start, end: (k, 4, 3) float64 or float32, on the host: the vertex, then the face's three corners.
        min_distance, min_distance_share: as of Detector.find_impacts.
        threads: 0: as many as the machine has.

    Raises InvalidInput, which names the argument, the pair and the point. Ctrl-C waits for the answer. Cost: some
    0.3 us for a pair that is apart, 2 us for one that touches, 5 to 200 us where only rational arithmetic can tell.
    """
    options = {"min_distance": min_distance, "min_distance_share": min_distance_share, "threads": threads}
    return _impacts(_core.vertex_face_impacts, 4, start, end, options)


@suggesting
def edge_edge_impacts(
    start: Any, end: Any, *, min_distance: float = 0.0, min_distance_share: float = 0.0, threads: int = 0
) -> PairImpacts:
    """The same of two edges: (k, 4, 3), the ends of the one, then those of the other. See vertex_face_impacts."""
    options = {"min_distance": min_distance, "min_distance_share": min_distance_share, "threads": threads}
    return _impacts(_core.edge_edge_impacts, 4, start, end, options)


@suggesting
def vertex_edge_impacts(
    start: Any, end: Any, *, min_distance: float = 0.0, min_distance_share: float = 0.0, threads: int = 0
) -> PairImpacts:
    """The same of a vertex and an edge: (k, 3, 3), the vertex, then the edge's ends. See vertex_face_impacts."""
    options = {"min_distance": min_distance, "min_distance_share": min_distance_share, "threads": threads}
    return _impacts(_core.vertex_edge_impacts, 3, start, end, options)


@suggesting
def vertex_vertex_impacts(
    start: Any, end: Any, *, min_distance: float = 0.0, min_distance_share: float = 0.0, threads: int = 0
) -> PairImpacts:
    """The same of two vertices: (k, 2, 3). See vertex_face_impacts."""
    options = {"min_distance": min_distance, "min_distance_share": min_distance_share, "threads": threads}
    return _impacts(_core.vertex_vertex_impacts, 2, start, end, options)


def _distances(decide: Any, size: int, points: Any, threads: int) -> PairDistances:
    return PairDistances(*decide(_rows(points, size, "points"), threads))


@suggesting
def vertex_face_distances(points: Any, *, threads: int = 0) -> PairDistances:
    """How far apart vertices and faces are, and where they are closest: exact, then rounded.

    Args:
        points: (k, 4, 3) float64 or float32, on the host: the vertex, then the face's three corners.
        threads: 0: as many as the machine has.

    Raises InvalidInput, which names the argument, the pair and the point. Ctrl-C waits for the answer. Cost: some
    0.6 us a pair, microseconds where only rational arithmetic can tell.
    """
    return _distances(_core.vertex_face_distances, 4, points, threads)


@suggesting
def edge_edge_distances(points: Any, *, threads: int = 0) -> PairDistances:
    """The same of two edges: (k, 4, 3), the ends of the one, then those of the other. See vertex_face_distances."""
    return _distances(_core.edge_edge_distances, 4, points, threads)


@suggesting
def vertex_edge_distances(points: Any, *, threads: int = 0) -> PairDistances:
    """The same of a vertex and an edge: (k, 3, 3), the vertex, then the edge's ends. See vertex_face_distances."""
    return _distances(_core.vertex_edge_distances, 3, points, threads)


@suggesting
def vertex_vertex_distances(points: Any, *, threads: int = 0) -> PairDistances:
    """The same of two vertices: (k, 2, 3). See vertex_face_distances."""
    return _distances(_core.vertex_vertex_distances, 2, points, threads)
