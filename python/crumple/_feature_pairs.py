"""Candidate pairs for callers that have a narrow phase, and exact decisions for callers that have a broad phase."""

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
    """Result of a CandidateQuery: pairs of features whose inflated boxes overlap, of the requested kinds.

    `bool(candidates)` is True if there is any, and `len(candidates)` is the number of all.

    Notes
    -----
    There is one list for each kind. Each pair occurs once. Lists are sorted by first feature, then second; for worlds
    by body before each feature. Every backend, instruction set and thread count gives the same bytes. The face-vertex,
    edge-face and edge-vertex candidates of IPC Toolkit are `vertex_faces`, `edge_faces` and `vertex_edges`.
    """

    _query = "CandidateQuery"

    def _check(self, name: str) -> None:
        kind = _KIND_OF.get(name)
        if name.endswith("_bodies") and not self._request.of_bodies:
            raise InvalidInput(f"{name} are for worlds, but the scene is one mesh")
        if kind is not None and kind not in self._request.kinds:
            self._refuse(name, f'kinds=["{kind}"]')

    edge_faces = int32("(k, 2) int32: one of `edges` and a face without a common vertex.", (2,))
    face_faces = int32("(k, 2) int32: two faces without a common vertex, the lower first.", (2,))
    vertex_edges = int32("(k, 2) int32: a vertex and one of `edges` that does not name it.", (2,))
    vertex_vertices = int32("(k, 2) int32: two vertices, the lower first.", (2,))
    edge_face_bodies = int32("(k, 2) int32, for worlds and two meshes: bodies of the edge and the face.", (2,))
    face_face_bodies = int32("(k, 2) int32, for worlds and two meshes: bodies of the two faces.", (2,))

    @property
    def kinds(self) -> tuple[str, ...]:
        """Requested kinds."""
        return self._request.kinds

    def __bool__(self) -> bool:
        """True if anything is listed."""
        return self._found.count > 0

    def save(self, path: str | os.PathLike[str]) -> None:
        """Writes the requested lists to a file (docs/feature_lists.md).

        In .txt and .csv, edges are given by their two vertices, and ids of worlds have the form body:id.

        Parameters
        ----------
        path : str or os.PathLike
            File; its extension, .txt, .csv, .json or .npz, selects the format.

        Raises
        ------
        InvalidInput
            If the extension is another one.
        FileError
            If the file cannot be written.

        Notes
        -----
        The file appears when it is complete; an existing file stays until then. Ctrl-C waits until the file is written.
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
    """Result of pair_impacts: one element per pair.

    Attributes
    ----------
    hit : (k,) ndarray of bool
        True if the features touch at some time in [0, 1].
    toi : (k,) ndarray of float64
        First time at which they touch, computed exactly and rounded down; infinite if there is none.
    start : (k,) ndarray of bool
        True if the features touch at the start; `toi` is 0 then. `toi` may also be 0 for a later contact, because it is
        rounded down.
    """

    hit: NDArray[np.bool_]
    toi: NDArray[np.float64]
    start: NDArray[np.bool_]


class PairDistances(NamedTuple):
    """Result of pair_distances: one element per pair.

    Attributes
    ----------
    squared_distance : (k,) ndarray of float64
        Exact squared distance, rounded to the nearest float64; infinite if it overflows.
    touching : (k,) ndarray of bool
        True if the distance is 0 exactly.
    type : (k,) ndarray of uint8
        Closest parts of the features, by kind: a VertexFaceType, EdgeEdgeType, VertexEdgeType or VertexVertexType. EA0
        and E0 are the ends that were given first.
    at : (k, 2) ndarray of float64
        Parameters of the closest points: (u, v) of the point a + u (b - a) + v (c - a) of a face a, b, c; (s, t) of the
        points a + s (b - a) and c + t (d - c) of edges a, b and c, d; (t, 0) of the point a + t (b - a) of an edge a,
        b; (0, 0) for two vertices. Computed exactly, then rounded.
    """

    squared_distance: NDArray[np.float64]
    touching: NDArray[np.bool_]
    type: NDArray[np.uint8]
    at: NDArray[np.float64]


def _rows(given: Any, points: int, name: str) -> NDArray[np.float64]:
    """Returns the points of k pairs as (k * points, 3) contiguous float64, from (k, points, 3) float64 or float32."""
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
    """Decides for each pair of features if and when they touch, while their points move straight from start to end.

    Each decision is exact, and the same as that of Detector.impacts. The function does not know a mesh, so features
    with a common vertex touch at the start.

    Parameters
    ----------
    kind : {"vertex_face", "edge_edge", "vertex_edge", "vertex_vertex"}
        Kind of all pairs.
    start, end : (k, p, 3) array_like of float64 or float32
        Points of each pair at the start and at the end, in host memory. "vertex_face": the vertex, then the three
        corners of the face (p = 4); "edge_edge": the two ends of each edge (p = 4); "vertex_edge": the vertex, then the
        two ends of the edge (p = 3); "vertex_vertex": two vertices (p = 2).
    min_distance, min_distance_share, approaching_only
        As for ImpactQuery.
    threads : int, default 0
        Number of threads; 0: as many as the machine has.

    Returns
    -------
    PairImpacts

    Raises
    ------
    InvalidInput
        If an argument is invalid. Names the argument, the pair and the point.

    Notes
    -----
    Ctrl-C waits for the result. Cost per pair: about 0.3 us if the features stay apart, 2 us if they touch, 5 to 200 us
    if only rational arithmetic can decide.
    """
    points = _points_of(kind)
    rows = _rows(start, points, "start"), _rows(end, points, "end")
    return PairImpacts(*_core.pair_impacts(kind, *rows, min_distance, min_distance_share, approaching_only, threads))


@suggesting
def pair_distances(kind: PairKind, points: Any, *, threads: int = 0) -> PairDistances:
    """Finds the distance of each pair of features, and where they are closest: computed exactly, then rounded.

    Parameters
    ----------
    kind : {"vertex_face", "edge_edge", "vertex_edge", "vertex_vertex"}
        Kind of all pairs.
    points : (k, p, 3) array_like of float64 or float32
        Points of each pair, in the same form as `start` of pair_impacts.
    threads : int, default 0
        Number of threads; 0: as many as the machine has.

    Returns
    -------
    PairDistances

    Raises
    ------
    InvalidInput
        If an argument is invalid. Names the argument, the pair and the point.

    Notes
    -----
    Ctrl-C waits for the result. Cost per pair: about 0.6 us, and microseconds if only rational arithmetic can decide.
    """
    return PairDistances(*_core.pair_distances(kind, _rows(points, _points_of(kind), "points"), threads))
