"""Exact broad phase, narrow phase, step sizes and normal collisions for the IPC Toolkit (pip install ipctk).

Notes
-----
docs/coming_from_ipc_toolkit.md explains which class to use. Works with ipctk 1.6.

Examples
--------
    from crumple.adapters.ipctk import BroadPhase

    ipctk.compute_collision_free_stepsize(mesh, v0, v1, broad_phase=BroadPhase())
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import ipctk
import numpy as np

from .._detector import Detector
from .._errors import InvalidInput
from .._feature_pairs import pair_impacts
from .._mesh import Mesh
from .._stencils import stencils

if TYPE_CHECKING:
    from collections.abc import Iterator

    from .._feature_pairs import PairImpacts, PairKind

__all__ = [
    "BroadPhase",
    "NarrowPhaseCCD",
    "compute_collision_free_stepsize",
    "is_step_collision_free",
    "normal_collisions",
]


def _in_space(vertices: Any) -> np.ndarray:
    """Returns a new (n, 3) float64 array. Vertices of shape (n, 2) get z = 0."""
    vertices = np.array(vertices, np.float64, order="C")
    return np.pad(vertices, ((0, 0), (0, 3 - vertices.shape[1])))


def _may_collide(may: Any, of_first: np.ndarray, of_second: np.ndarray) -> np.ndarray:
    """Returns for each pair True if `may` accepts a vertex of the first and a vertex of the second feature."""
    allowed = np.zeros(len(of_first), bool)
    for v in of_first.T:
        for w in of_second.T:
            unresolved = np.flatnonzero(~allowed)
            if len(unresolved):
                allowed[unresolved] = list(map(may, v[unresolved].tolist(), w[unresolved].tolist()))
    return allowed


class BroadPhase(ipctk.BroadPhase):
    """Broad phase without false candidates: lists exactly the pairs at most twice the inflation radius apart.

    Parameters
    ----------
    boxes : bool, default False
        If True, lists the pairs whose inflated boxes overlap instead, as ipctk's own broad phases do. Uses
        Detector.candidates, whose lists are complete and without rounding (docs/candidates.md).
    **options
        Options of crumple.Detector.

    Notes
    -----
    The broad phases of the IPC Toolkit return all pairs whose boxes, inflated by the radius, overlap. Any two features
    within twice the radius have such boxes, but most pairs with such boxes are further apart. This class returns only
    pairs that are within twice the radius, at the given time or at some time of the step: some hundred times fewer. If
    a CCD of ipctk keeps a share of the distance (conservative_rescaling), it does so for these pairs only. So choose a
    radius of at least half the distance that has to be kept.

    Also finds edges without a face, and vertices without an edge or a face. Calls `can_vertices_collide` for the pairs
    that it finds. Edge-face candidates, for has_intersections, are an edge of one and the face of the other of two
    triangles that intersect; face-face candidates are faces that intersect. Both are found at one time only, not for a
    step. Lists are sorted, and the same on every machine.

    Cost: that of Detector.proximities, impacts or candidates, plus about a microsecond per candidate to make a Python
    object.
    """

    def __init__(self, *, boxes: bool = False, **options: Any) -> None:
        super().__init__()
        self.boxes = boxes
        self.detector = Detector(**options)
        self.clear()

    def name(self) -> str:
        return "Crumple"

    def build(self, *given: Any) -> None:
        """Sets the mesh to search, at one time or during a step.

        build(vertices, edges, faces, inflation_radius=0) or build(vertices_t0, vertices_t1, edges, faces,
        inflation_radius=0).

        Parameters
        ----------
        *given
            One or two (n, 3) or (n, 2) arrays of vertices, (k, 2) edges, (m, 3) faces, and optionally the inflation
            radius.

        Raises
        ------
        InvalidInput
            If an edge is listed twice, or names a vertex twice.
        TypeError
            If the number of arrays is wrong.
        """
        self.clear()
        *arrays, radius = given if np.ndim(given[-1]) == 0 else (*given, 0.0)
        if len(arrays) not in (3, 4):
            raise TypeError(f"build takes three or four arrays and a radius, not {len(arrays)} arrays")
        self._start = _in_space(arrays[0])
        self._end = _in_space(arrays[1]) if len(arrays) == 4 else None
        self._edges = np.array(arrays[-2], np.int64).reshape(-1, 2)
        self._faces = np.array(arrays[-1], np.int64).reshape(-1, 3)
        self._within = 2.0 * float(radius)
        keys = self._keys(self._edges)
        self._order = np.argsort(keys, kind="stable")
        self._sorted = keys[self._order]
        self._check_edges()

    def clear(self) -> None:
        self._start, self._end, self._within = np.empty((0, 3)), None, 0.0
        self._edges, self._faces = np.empty((0, 2), np.int64), np.empty((0, 3), np.int64)
        self._order = self._sorted = np.empty(0, np.int64)
        self._found: Any = None

    def detect_face_vertex_candidates(self) -> list[Any]:
        vertex, face = self._pairs("vertex_face").T
        return self._made(ipctk.FaceVertexCandidate, face, vertex, self._faces[face], vertex[:, None])

    def detect_edge_edge_candidates(self) -> list[Any]:
        a, b = self._pairs("edge_edge").T
        return self._made(ipctk.EdgeEdgeCandidate, a, b, self._edges[a], self._edges[b])

    def detect_edge_vertex_candidates(self) -> list[Any]:
        vertex, edge = self._pairs("vertex_edge").T
        return self._made(ipctk.EdgeVertexCandidate, edge, vertex, self._edges[edge], vertex[:, None])

    def detect_vertex_vertex_candidates(self) -> list[Any]:
        a, b = self._pairs("vertex_vertex").T
        return self._made(ipctk.VertexVertexCandidate, a, b, a[:, None], b[:, None])

    def detect_edge_face_candidates(self) -> list[Any]:
        edge, face = self._pairs("edge_face").T
        return self._made(ipctk.EdgeFaceCandidate, edge, face, self._edges[edge], self._faces[face])

    def detect_face_face_candidates(self) -> list[Any]:
        a, b = self._pairs("face_face").T
        return self._made(ipctk.FaceFaceCandidate, a, b, self._faces[a], self._faces[b])

    def _pairs(self, kind: str) -> np.ndarray:
        """Returns the pairs of a kind, such as "vertex_face", as (k, 2) indices of features without a common vertex."""
        return self._overlapping(kind) if self.boxes else getattr(self, f"_near_{kind}")()

    def _overlapping(self, kind: Any) -> np.ndarray:
        found = self.detector.candidates(
            self._start,
            self._faces,
            end=self._end,
            edges=self._edges,
            points=np.arange(len(self._start)),
            kinds=kind,
            inflation=self._within / 2,
        )
        name = "vertex_vertices" if kind == "vertex_vertex" else f"{kind}s"
        return getattr(found, name).astype(np.int64)

    def _near_vertex_face(self) -> np.ndarray:
        return self._features().vertex_faces

    def _near_edge_edge(self) -> np.ndarray:
        found = self._features()
        numbers = self._numbers(found.edges)[found.edge_edges]
        return np.sort(numbers[(numbers >= 0).all(axis=1)], axis=1)

    def _near_vertex_edge(self) -> np.ndarray:
        return self._search(self._edges[:, [0, 1, 1]]).vertex_faces

    def _near_vertex_vertex(self) -> np.ndarray:
        pairs = self._search(np.empty((0, 3), np.int64), all_vertices=True).vertex_faces
        return pairs[pairs[:, 0] < pairs[:, 1]]

    def _near_edge_face(self) -> np.ndarray:
        faces, pairs = self._intersecting()
        # If two triangles intersect, an edge of one of them meets the other triangle. It is not known which edge, so
        # all edges of both triangles are listed, each with the face of the other triangle.
        both = np.concatenate([pairs, pairs[:, ::-1]])
        both = both[both[:, 1] < len(self._faces)]
        edge = self._numbers(faces[both[:, 0]][:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2))
        listed = np.stack([edge, np.repeat(both[:, 1], 3)], axis=1)[edge >= 0]
        return self._apart(np.unique(listed, axis=0), self._edges)

    def _near_face_face(self) -> np.ndarray:
        pairs = self._intersecting()[1]
        return self._apart(pairs[(pairs < len(self._faces)).all(axis=1)], self._faces)

    def _apart(self, pairs: np.ndarray, corners: np.ndarray) -> np.ndarray:
        """Returns the pairs without a common vertex. A pair is a feature f, with vertices corners[f], and a face."""
        return pairs[(corners[pairs[:, 0]][:, :, None] != self._faces[pairs[:, 1]][:, None, :]).all(axis=(1, 2))]

    def _keys(self, ends: np.ndarray) -> np.ndarray:
        """Returns a number for each edge, given by its two ends. It does not depend on the direction of the edge."""
        return ends.min(axis=-1) * np.int64(len(self._start)) + ends.max(axis=-1)

    def _check_edges(self) -> None:
        point = np.flatnonzero(self._edges[:, 0] == self._edges[:, 1])
        if len(point):
            raise InvalidInput(f"edge {point[0]} names vertex {self._edges[point[0], 0]} twice")
        again = np.flatnonzero(self._sorted[1:] == self._sorted[:-1])
        if len(again):
            raise InvalidInput(f"edges {self._order[again[0]]} and {self._order[again[0] + 1]} are the same edge")

    def _numbers(self, edges: np.ndarray) -> np.ndarray:
        """Returns the index of each of `edges` among the edges passed to build(), or -1 if it is not one of them."""
        if not len(self._edges):
            return np.full(len(edges), -1)
        keys = self._keys(edges.astype(np.int64))
        place = np.searchsorted(self._sorted, keys).clip(max=len(self._sorted) - 1)
        return np.where(self._sorted[place] == keys, self._order[place], -1)

    def _loose_edges(self) -> np.ndarray:
        """Returns a degenerate triangle (a, b, b) for each edge (a, b) that is not an edge of a face."""
        sides = self._keys(self._faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2))
        return self._edges[~np.isin(self._keys(self._edges), sides)][:, [0, 1, 1]]

    def _features(self) -> Any:
        """Returns near features of the faces and of edges without a face. Caches them: two lists use this search."""
        if self._found is None:
            self._found = self._search(self._faces, self._loose_edges())
        return self._found

    def _search(self, faces: np.ndarray, more: Any = None, all_vertices: bool = False) -> Any:
        """Returns near features of the triangles `faces` and `more`.

        Vertices in no triangle become degenerate triangles. Vertex-face pairs are listed for the faces of `faces` only
        or, with `all_vertices`, for all triangles.
        """
        named = np.zeros(len(self._start), bool)
        parts = [faces] if more is None else [faces, more]
        for part in parts:
            named[part.ravel()] = True
        single = np.flatnonzero(~named)
        parts.append(np.stack([single] * 3, axis=1))
        every = np.concatenate(parts)
        if self._end is None:
            found = self.detector.proximities(self._start, every, radius=self._within)
        else:
            found = self.detector.impacts(self._start, self._end, every, min_distance=self._within)
        return _Found(found, len(every) if all_vertices else len(faces))

    def _intersecting(self) -> tuple[np.ndarray, np.ndarray]:
        if self._end is not None:
            raise NotImplementedError(
                "edge-face and face-face candidates of a step are not supported: build with positions at one time"
            )
        faces = np.concatenate([self._faces, self._loose_edges()])
        return faces, self.detector.intersections(self._start, faces).pairs.astype(np.int64)

    def _made(self, kind: Any, first: Any, second: Any, of_first: np.ndarray, of_second: np.ndarray) -> list[Any]:
        """Makes candidates of class `kind` from pairs of features, unless none of their vertices may collide.

        `of_first`, `of_second`: vertices of the first and second feature of each pair, for can_vertices_collide.
        """
        allowed = _may_collide(self.can_vertices_collide, of_first, of_second)
        return list(map(kind, first[allowed].tolist(), second[allowed].tolist()))


class _Found:
    """Lists of a search. Vertex-face pairs are those with one of the first `faces` triangles."""

    def __init__(self, found: Any, faces: int) -> None:
        pairs = found.vertex_faces
        self.vertex_faces = pairs[pairs[:, 1] < faces].astype(np.int64)
        self.edge_edges, self.edges = found.edge_edges, found.edges


class NarrowPhaseCCD(ipctk.NarrowPhaseCCD):
    """Exact continuous collision detection of one pair at a time, without false positives.

    Parameters
    ----------
    min_distance_share : float, default 0
        Share of a pair's distance at the start that must be kept, in [0, 1). The CCDs of ipctk keep a share of 1 -
        conservative_rescaling by bounds of their own, which is similar, but not the same.

    Raises
    ------
    InvalidInput
        If ipctk uses more than one thread.

    Notes
    -----
    `min_distance` is an exact distance (docs/motion.md). The time that is returned is the first time of contact,
    rounded down; infinite if there is none up to `tmax`.

    Call ipctk.set_num_threads(1) before you make an object, and do not change the number afterwards: candidates call
    their narrow phase from all threads of ipctk while one of them holds the GIL, so any narrow phase written in Python
    would deadlock. Cost: a Python call per pair, some 30 us. The function compute_collision_free_stepsize of this
    module has neither drawback.
    """

    def __init__(self, min_distance_share: float = 0.0) -> None:
        super().__init__()
        if ipctk.get_num_threads() != 1:
            raise InvalidInput(
                "call ipctk.set_num_threads(1) before NarrowPhaseCCD, which would hang with more threads"
            )
        self.min_distance_share = min_distance_share

    def point_triangle_ccd(
        self,
        p_t0: Any,
        t0_t0: Any,
        t1_t0: Any,
        t2_t0: Any,
        p_t1: Any,
        t0_t1: Any,
        t1_t1: Any,
        t2_t1: Any,
        min_distance: float = 0.0,
        tmax: float = 1.0,
    ) -> tuple[bool, float]:
        start, end = [p_t0, t0_t0, t1_t0, t2_t0], [p_t1, t0_t1, t1_t1, t2_t1]
        return self._ccd("vertex_face", start, end, min_distance, tmax)

    def edge_edge_ccd(
        self,
        ea0_t0: Any,
        ea1_t0: Any,
        eb0_t0: Any,
        eb1_t0: Any,
        ea0_t1: Any,
        ea1_t1: Any,
        eb0_t1: Any,
        eb1_t1: Any,
        min_distance: float = 0.0,
        tmax: float = 1.0,
    ) -> tuple[bool, float]:
        start, end = [ea0_t0, ea1_t0, eb0_t0, eb1_t0], [ea0_t1, ea1_t1, eb0_t1, eb1_t1]
        return self._ccd("edge_edge", start, end, min_distance, tmax)

    def point_edge_ccd(
        self,
        p_t0: Any,
        e0_t0: Any,
        e1_t0: Any,
        p_t1: Any,
        e0_t1: Any,
        e1_t1: Any,
        min_distance: float = 0.0,
        tmax: float = 1.0,
    ) -> tuple[bool, float]:
        return self._ccd("vertex_edge", [p_t0, e0_t0, e1_t0], [p_t1, e0_t1, e1_t1], min_distance, tmax)

    def point_point_ccd(
        self, p0_t0: Any, p1_t0: Any, p0_t1: Any, p1_t1: Any, min_distance: float = 0.0, tmax: float = 1.0
    ) -> tuple[bool, float]:
        return self._ccd("vertex_vertex", [p0_t0, p1_t0], [p0_t1, p1_t1], min_distance, tmax)

    def _ccd(self, kind: PairKind, start: Any, end: Any, min_distance: float, tmax: float) -> tuple[bool, float]:
        options = {"min_distance": min_distance, "min_distance_share": self.min_distance_share, "threads": 1}
        toi = float(pair_impacts(kind, [_in_space(start)], [_in_space(end)], **options).toi[0])
        return (True, toi) if toi <= tmax else (False, float("inf"))


def _numbers(candidates: list[Any], *names: str) -> Iterator[np.ndarray]:
    for name in names:
        yield np.array([getattr(candidate, name) for candidate in candidates], np.int64)


def _impacts(candidates: Any, mesh: Any, t0: Any, t1: Any, options: dict[str, Any]) -> Iterator[PairImpacts]:
    """Yields the PairImpacts of each list of candidates (face-vertex, edge-edge, ...) that is not empty."""
    t0, t1, edges, faces = _in_space(t0), _in_space(t1), mesh.edges, mesh.faces
    lists: tuple[tuple[PairKind, Any, tuple[str, ...], tuple[Any, ...]], ...] = (
        ("vertex_face", candidates.fv_candidates, ("vertex_id", "face_id"), (None, faces)),
        ("edge_edge", candidates.ee_candidates, ("edge0_id", "edge1_id"), (edges, edges)),
        ("vertex_edge", candidates.ev_candidates, ("vertex_id", "edge_id"), (None, edges)),
        ("vertex_vertex", candidates.vv_candidates, ("vertex0_id", "vertex1_id"), (None, None)),
    )
    for kind, listed, names, corners in lists:
        if listed:
            numbers = zip(_numbers(listed, *names), corners)
            points = np.column_stack([number if of is None else of[number] for number, of in numbers])
            yield pair_impacts(kind, t0[points], t1[points], **options)


def compute_collision_free_stepsize(
    candidates: Any,
    mesh: Any,
    vertices_t0: Any,
    vertices_t1: Any,
    min_distance: float = 0.0,
    *,
    min_distance_share: float = 0.0,
    threads: int = 0,
) -> float:
    """Returns the first time of contact of the candidates, decided exactly, or 1 if none of them touches.

    Replaces candidates.compute_collision_free_stepsize.

    Parameters
    ----------
    candidates : ipctk.Candidates
        Candidates of any broad phase.
    mesh : ipctk.CollisionMesh
        Mesh.
    vertices_t0, vertices_t1 : (n, 3) or (n, 2) array_like
        Positions at the start and at the end.
    min_distance : float, default 0
        Largest distance that counts as contact, exactly.
    min_distance_share : float, default 0
        As for NarrowPhaseCCD. If `min_distance` is given, too, the larger of both distances applies.
    threads : int, default 0
        Number of threads; 0: as many as the machine has.

    Returns
    -------
    float
        Time in [0, 1], rounded down.

    Raises
    ------
    InvalidInput
        If an argument is invalid.

    Notes
    -----
    Cost: one to two microseconds per candidate, mostly to read ipctk's objects. Without candidates, use
    crumple.first_impact, which needs none.
    """
    options = {"min_distance": min_distance, "min_distance_share": min_distance_share, "threads": threads}
    times = [impacts.toi.min() for impacts in _impacts(candidates, mesh, vertices_t0, vertices_t1, options)]
    return float(min([1.0, *times]))


def is_step_collision_free(
    candidates: Any,
    mesh: Any,
    vertices_t0: Any,
    vertices_t1: Any,
    min_distance: float = 0.0,
    *,
    min_distance_share: float = 0.0,
    threads: int = 0,
) -> bool:
    """True if no candidate touches during the step, both ends included.

    Parameters
    ----------
    candidates, mesh, vertices_t0, vertices_t1, min_distance, min_distance_share, threads
        As for compute_collision_free_stepsize.

    Returns
    -------
    bool

    Raises
    ------
    InvalidInput
        If an argument is invalid.
    """
    options = {"min_distance": min_distance, "min_distance_share": min_distance_share, "threads": threads}
    return not any(impacts.hit.any() for impacts in _impacts(candidates, mesh, vertices_t0, vertices_t1, options))


#: Factor in the mollifier's threshold: ipctk mollifies two edges e and f if |e x f|**2 < 1e-3 |e'|**2 |f'|**2.
_PARALLEL = 1e-3


def normal_collisions(
    mesh: Any,
    vertices: Any,
    dhat: float,
    dmin: float = 0.0,
    *,
    area_weighting: bool = False,
    detector: Detector | None = None,
) -> Any:
    """Returns the collisions that ipctk.NormalCollisions.build makes, from near pairs and stencils of crumple.

    Parameters
    ----------
    mesh : ipctk.CollisionMesh
        Mesh in space, with its rest positions, edges and can_collide.
    vertices : (n, 3) array_like
        Positions.
    dhat : float
        Activation distance of the barrier.
    dmin : float, default 0
        Minimum distance: pairs nearer than dmin + dhat are listed.
    area_weighting : bool, default False
        As NormalCollisions.use_area_weighting.
    detector : Detector, optional
        Detector to use; None: a new one. Keep one for repeated calls.

    Returns
    -------
    ipctk.NormalCollisions
        Of the type IPC. Lists are sorted by vertices, and the same on every machine.

    Raises
    ------
    InvalidInput
        If the mesh is not in space, or an argument is invalid.

    Notes
    -----
    Distances and types are decided exactly. For collision sets of the other types (IMPROVED_MAX_APPROX, OGC), call
    `build` of ipctk with a BroadPhase of this module. Cost: that of Detector.proximities and stencils, plus some
    microseconds for each object of ipctk; in total as long as ipctk's own `build` or up to 2.3 times as long.
    """
    if mesh.dim != 3:
        raise InvalidInput(f"normal_collisions needs a mesh in 3 dimensions, not {mesh.dim}")
    every = np.arange(mesh.num_vertices)
    scene = Mesh(_in_space(vertices), mesh.faces, edges=mesh.edges, points=every)
    near = (detector or Detector()).proximities(scene, radius=dhat + dmin, strict=True, closest=True)
    rows = stencils(scene, near, rest=mesh.rest_positions, reduced=True, parallel=_PARALLEL)

    weights = _weights_of_pairs(mesh, near, area_weighting)
    weight = np.bincount(rows.row_of_pair, weights, len(rows))
    source = np.empty(len(weight), np.int64)
    source[rows.row_of_pair[::-1]] = np.arange(len(weights))[::-1]  # the first pair of each row
    collisions = ipctk.NormalCollisions()
    collisions.use_area_weighting = area_weighting

    def made(kind: str, collision: Any, *columns: np.ndarray) -> list[Any]:
        of_kind = weight[rows.rows(kind)]
        used = np.flatnonzero(of_kind)
        listed = list(map(collision, *(column[used].tolist() for column in columns)))
        for i in np.flatnonzero(of_kind[used] != 1).tolist():  # by default, weights are 1
            listed[i].weight = of_kind[used[i]]
        for one in listed if dmin else ():
            one.dmin = dmin
        return listed

    vertex, other = rows.vertices[rows.rows("vertex_vertex")].T[:2]
    collisions.vv_collisions = made("vertex_vertex", ipctk.VertexVertexNormalCollision, vertex, other)

    vertex, *ends = rows.vertices[rows.rows("vertex_edge")].T[:3].astype(np.int64)
    keys = np.sort(mesh.edges, axis=1) @ [mesh.num_vertices, 1]
    order = np.argsort(keys)
    edge = order[np.searchsorted(keys[order], ends[0] * mesh.num_vertices + ends[1])] if len(order) else vertex
    collisions.ev_collisions = made("vertex_edge", ipctk.EdgeVertexNormalCollision, edge, vertex)

    a, b = near.edge_edges[source[rows.rows("edge_edge")] - len(near.vertex_faces)].T
    squares = ((mesh.rest_positions[mesh.edges[:, 1]] - mesh.rest_positions[mesh.edges[:, 0]]) ** 2).sum(axis=1)
    types = np.array([ipctk.EdgeEdgeDistanceType(i) for i in range(9)])[rows.type[rows.rows("edge_edge")]]
    threshold = _PARALLEL * squares[a] * squares[b]
    collisions.ee_collisions = made("edge_edge", ipctk.EdgeEdgeNormalCollision, a, b, threshold, types)

    vertex, face = near.vertex_faces[source[rows.rows("vertex_face")]].T
    collisions.fv_collisions = made("vertex_face", ipctk.FaceVertexNormalCollision, face, vertex)
    return collisions


def _weights_of_pairs(mesh: Any, near: Any, area_weighting: bool) -> np.ndarray:
    """Returns the weight of each pair of all lists: 1 or an area, and 0 if the pair may not collide."""
    vertex_faces, edge_edges, vertex_edges, vertices = (
        near.vertex_faces, near.edge_edges, near.vertex_edges, near.vertex_vertices
    )  # fmt: skip
    may, edges = mesh.can_collide, mesh.edges
    allowed = np.concatenate([
        _may_collide(may, vertex_faces[:, :1], mesh.faces[vertex_faces[:, 1]]),
        _may_collide(may, edges[edge_edges[:, 0]], edges[edge_edges[:, 1]]),
        # ipctk has no pairs of edges and ends of rods.
        _may_collide(may, vertex_edges[:, :1], edges[vertex_edges[:, 1]])
        & np.isin(vertex_edges[:, 0], mesh.codim_vertices),
        _may_collide(may, vertices[:, :1], vertices[:, 1:]),
    ])  # fmt: skip
    if not area_weighting:
        return allowed.astype(float)
    of_vertex, of_edge = mesh.vertex_areas, mesh.edge_areas
    areas = (0.25 * of_vertex[vertex_faces[:, 0]], 0.25 * of_edge[edge_edges].sum(axis=1),
             0.5 * of_vertex[vertex_edges[:, 0]], 0.5 * of_vertex[vertices].sum(axis=1))  # fmt: skip
    return allowed * np.concatenate(areas)
