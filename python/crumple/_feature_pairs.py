"""Parts of a search: candidates, for a narrow phase of your own, and exact decisions, for a broad phase of your own."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, Any, Literal, NamedTuple

from . import _core
from ._errors import InvalidInput, InvalidType, suggesting
from ._features import LISTS, PairLists
from ._results import extension_of, file_name, int32

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

_KIND_OF = {name: kind for kind, name in LISTS.items()} | {f"{kind}_bodies": kind for kind in LISTS}


class Candidates(PairLists):
    """Which features have boxes that overlap, of the requested kinds: the same bytes wherever it is computed.

    A list for each kind, sorted and unique; of worlds by body before vertex, edge or face. IPC Toolkit's face-vertex,
    edge-face and edge-vertex candidates are `vertex_faces`, `edge_faces` and `vertex_edges` here.

    It is true if it lists anything; `len(candidates)` is the number of all.
    """

    _query = "CandidateQuery"

    def _check(self, name: str) -> None:
        kind = _KIND_OF.get(name)
        if name.endswith("_bodies") and not self._request.of_bodies:
            raise InvalidInput(f"{name} are for worlds, but the scene is one mesh")
        if kind is not None and kind not in self._request.kinds:
            self._refuse(name, f'kinds=["{kind}"]')

    edge_faces = int32("(k, 2) int32: each one of `edges` and a face without a common vertex.", (2,))
    face_faces = int32("(k, 2) int32: each two faces without a common vertex, the lower first.", (2,))
    vertex_edges = int32("(k, 2) int32: each a vertex and one of `edges` that does not name it.", (2,))
    vertex_vertices = int32("(k, 2) int32: each two vertices, the lower first.", (2,))
    edge_face_bodies = int32("(k, 2) int32, of a world: the edge's body and the face's.", (2,))
    face_face_bodies = int32("(k, 2) int32, of a world: the body of each of the two faces.", (2,))

    @property
    def kinds(self) -> tuple[str, ...]:
        """The requested kinds."""
        return self._request.kinds

    def __bool__(self) -> bool:
        """True if anything is listed."""
        return self._found.count > 0

    def save(self, path: str | os.PathLike[str]) -> None:
        """Writes the lists that were requested as .txt, .csv, .json or .npz, by extension (docs/feature_lists.md).

        Edges are named by their vertices in .txt and .csv; of worlds ids are body:id there. A file appears when it is
        complete; the old one stays until then. Ctrl-C waits until the file is written. Raises InvalidInput for other
        extensions; FileError.
        """
        name = file_name(path)
        if extension_of(name) not in (".txt", ".csv", ".json", ".npz"):
            raise InvalidInput(f"{name}: candidates are saved as .txt, .csv, .json or .npz")
        _core.write_candidates(path, self)

    def __repr__(self) -> str:
        of = ", ".join(f"{len(getattr(self._found, LISTS[kind]))} {kind}" for kind in self.kinds)
        found = "candidates" if self.count != 1 else "candidate"
        return f"<crumple.Candidates: {self.count} {found}, {of}, {self.statistics.milliseconds:.3g} ms>"


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
    approaching_only: bool = False,
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
        min_distance, min_distance_share, approaching_only: as of ImpactQuery.
        threads: 0: as many as the machine has.

    Raises InvalidInput, which names the argument, the pair and the point. Ctrl-C waits for the result. Cost: some
    0.3 us for a pair that is apart, 2 us for one that touches, 5 to 200 us where only rational arithmetic can tell.
    """
    points = _points_of(kind)
    rows = _rows(start, points, "start"), _rows(end, points, "end")
    return PairImpacts(*_core.pair_impacts(kind, *rows, min_distance, min_distance_share, approaching_only, threads))


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
