"""Self-contact lists in the layout of Newton's cloth solvers, exact and complete.

Notes
-----
Buffers have the length that is needed, so none overflows, no list is truncated, and no search is repeated. Lists are
the same in every run. Newton itself is not needed, and Warp only for `warp_arrays`. Positions must be in host memory.

Examples
--------
    from crumple.adapters.newton import SelfContactDetector

    detector = SelfContactDetector(model.tri_indices, model.edge_indices, model.particle_world)
    contacts = detector.detect(state.particle_q, radius)
    info = contacts.warp_arrays()                                # by the names of Newton's TriMeshCollisionInfo
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from .._arrays import host_array
from .._detector import Detector
from .._errors import InvalidInput
from .._mesh import Mesh
from .._queries import PairFilter, ProximityQuery

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from .._features import Proximities

__all__ = ["SelfContactDetector", "SelfContacts"]


class SelfContacts(NamedTuple):
    """Features nearer than the radius, listed by vertex, by triangle and by edge, with the names and layout of Newton.

    Attributes
    ----------
    vertex_colliding_triangles : (2 k,) ndarray of int32
        Entries of vertices. Two numbers per entry: the vertex and the triangle.
    triangle_colliding_vertices : (k,) ndarray of int32
        Entries of triangles. One number per entry: the vertex.
    edge_colliding_edges : (2 l,) ndarray of int32
        Entries of edges. Two numbers per entry: the edge and the other edge. Each pair is listed for both edges.
    *_offsets : ndarray of int32
        Vertex, triangle or edge i has the entries [offsets[i], offsets[i + 1]), in ascending order. An entry e of two
        numbers begins at index 2 e.
    *_count, *_buffer_sizes : ndarray of int32
        Number of entries of each vertex, triangle or edge.
    *_min_dist : ndarray of float32
        Least distance of each vertex, triangle or edge, rounded down; the radius if it has no entry.
    """

    vertex_colliding_triangles: NDArray[np.int32]
    vertex_colliding_triangles_offsets: NDArray[np.int32]
    vertex_colliding_triangles_buffer_sizes: NDArray[np.int32]
    vertex_colliding_triangles_count: NDArray[np.int32]
    vertex_colliding_triangles_min_dist: NDArray[np.float32]
    triangle_colliding_vertices: NDArray[np.int32]
    triangle_colliding_vertices_offsets: NDArray[np.int32]
    triangle_colliding_vertices_buffer_sizes: NDArray[np.int32]
    triangle_colliding_vertices_count: NDArray[np.int32]
    triangle_colliding_vertices_min_dist: NDArray[np.float32]
    edge_colliding_edges: NDArray[np.int32]
    edge_colliding_edges_offsets: NDArray[np.int32]
    edge_colliding_edges_buffer_sizes: NDArray[np.int32]
    edge_colliding_edges_count: NDArray[np.int32]
    edge_colliding_edges_min_dist: NDArray[np.float32]

    def warp_arrays(self, device: Any = "cpu") -> dict[str, Any]:
        """Returns the arrays as arrays of Warp, by name.

        Parameters
        ----------
        device : str or warp device, default "cpu"
            Device of the arrays. On the host they are not copied.

        Returns
        -------
        dict of str to warp.array
        """
        import warp

        arrays = {name: warp.from_dlpack(array) for name, array in self._asdict().items()}
        if warp.get_device(device).is_cpu:
            return arrays
        return {name: array.to(device) for name, array in arrays.items()}


class SelfContactDetector:
    """Finds the features of a cloth that are nearer than a radius: vertices and triangles, edges and edges.

    A pair counts if its distance is less than the radius, exactly, and it has no common vertex.

    Parameters
    ----------
    triangles : (m, 3) or (3 m,) array_like of int
        Indices of vertices; also a Warp array.
    edges : (n, 2) or (n, 4) array_like of int, optional
        The edges of the triangles, each once, in any order and direction. An (n, 4) array is Newton's edge_indices,
        whose last two columns are the ends. None: edges are numbered in lexicographic order.
    worlds : (v,) array_like of int, optional
        World of each vertex, as Newton's particle_world: features of two different worlds are not paired; -1 is in all
        worlds. Triangles lie in one world. None: all vertices are in the same world.
    **options
        Options of crumple.Detector.

    Raises
    ------
    InvalidInput
        If the shape of `edges` is wrong, or a triangle has vertices of several worlds. (`detect` raises it if they are
        not the edges of the triangles.)

    Notes
    -----
    If some vertices are in all worlds, and others are not, memory is proportional to the square of the number of
    worlds.
    """

    def __init__(self, triangles: Any, edges: Any = None, worlds: Any = None, **options: Any) -> None:
        self.detector = Detector(**options)
        self._triangles = host_array(triangles, "triangles").reshape(-1, 3)
        self._groups, self._filter = None, PairFilter()
        if worlds is not None:
            self._groups, self._filter = _groups(self._triangles, host_array(worlds, "worlds"))
        self._edges = None
        if edges is not None:
            listed = host_array(edges, "edges")
            if listed.ndim != 2 or listed.shape[1] not in (2, 4):
                raise InvalidInput(f"edges must have shape (n, 2) or (n, 4), not {listed.shape}")
            self._edges = np.sort(listed[:, -2:], axis=1)

    def detect(self, positions: Any, radius: float) -> SelfContacts:
        """Returns the lists for these positions.

        Parameters
        ----------
        positions : (n, 3) array_like of float32 or float64
            Positions in host memory; also a wp.array of vec3.
        radius : float
            Contact radius.

        Returns
        -------
        SelfContacts

        Raises
        ------
        InvalidInput, MemoryLimit
            As Detector.proximities, and if `edges` are not the edges of the triangles.

        Notes
        -----
        Cost: that of Detector.proximities, plus some 20 ns per entry.
        """
        query = ProximityQuery(radius=radius, strict=True, least=True, index=True, filter=self._filter)
        near = self.detector.find(Mesh(positions, self._triangles, self._groups), query)
        pairs, by_face = near.vertex_faces, near.by_face
        return SelfContacts(
            pairs.reshape(-1).copy(),
            *_counted(near.vertex_offsets),
            _least(near.vertex_distance, radius),
            pairs[by_face, 0],
            *_counted(near.face_offsets),
            _least(near.face_distance, radius),
            *self._edge_lists(near, radius),
        )

    def _edge_lists(self, near: Proximities, radius: float) -> tuple[Any, ...]:
        number = self._numbers(near.edges)
        pairs = number[near.edge_edges]
        both = np.concatenate([pairs, pairs[:, ::-1]])
        both = both[np.lexsort((both[:, 1], both[:, 0]))]
        offsets = np.concatenate([[0], np.cumsum(np.bincount(both[:, 0], minlength=len(number)))])
        least = np.empty(len(number))
        least[number] = near.edge_distance
        return both.reshape(-1), *_counted(offsets), _least(least, radius)

    def _numbers(self, edges: NDArray[np.int32]) -> NDArray[np.int32]:
        """Returns, for each edge of the triangles, its index in the `edges` that the caller passed."""
        if self._edges is None:
            return np.arange(len(edges), dtype=np.int32)
        order = np.lexsort((self._edges[:, 1], self._edges[:, 0]))
        if not np.array_equal(self._edges[order], edges):
            raise InvalidInput(
                f"edges must be the {len(edges)} edges of the triangles, each once{self._odd_one(edges)}"
            )
        return order.astype(np.int32)

    def _odd_one(self, edges: NDArray[np.int32]) -> str:
        wanted = set(map(tuple, edges.tolist()))
        for i, edge in enumerate(map(tuple, self._edges.tolist())):
            if edge not in wanted:
                return f", and edge {i}, {edge}, is not one of them, or is listed twice"
            wanted.remove(edge)
        return f", and {min(wanted)} is missing"


def _groups(triangles: NDArray[Any], worlds: NDArray[Any]) -> tuple[NDArray[Any] | None, PairFilter]:
    """Returns the group of each triangle, which is its world, and the filter that selects pairs by their worlds."""
    if worlds.ndim != 1 or worlds.dtype.kind not in "iu":
        raise InvalidInput(f"worlds must be one integer for each vertex, not {worlds.shape} of {worlds.dtype}")
    if triangles.size and (triangles.min() < 0 or triangles.max() >= len(worlds)):
        odd_one = triangles.min() if triangles.min() < 0 else triangles.max()
        raise InvalidInput(
            f"worlds has {len(worlds)} entries, but triangles use vertex {odd_one}; pass one entry for each vertex"
        )
    corners = worlds[triangles]
    odd = np.flatnonzero((corners != corners[:, :1]).any(axis=1))
    if len(odd):
        raise InvalidInput(
            f"triangle {odd[0]} has vertices of the worlds {corners[odd[0]].tolist()}; all vertices of a triangle must "
            "have the same world"
        )
    different = np.unique(corners[:, 0])
    if len(different) < 2:
        return None, PairFilter()
    if different[0] >= 0:
        return corners[:, 0], PairFilter(groups="within")
    own = different[different >= 0]
    a, b = np.triu_indices(len(own), 1)
    return corners[:, 0], PairFilter(excluded_groups=np.column_stack([own[a], own[b]]).astype(np.int32))


def _counted(offsets: NDArray[np.int64]) -> tuple[NDArray[np.int32], ...]:
    """Returns offsets, buffer sizes and counts of entries as int32, from offsets. Buffer sizes are equal to counts."""
    if offsets[-1] > np.iinfo(np.int32).max // 2:
        raise InvalidInput(f"{offsets[-1]} pairs do not fit int32; use a smaller radius")
    counts = np.diff(offsets).astype(np.int32)
    return offsets.astype(np.int32), counts, counts.copy()


def _least(distances: NDArray[np.float64], radius: float) -> NDArray[np.float32]:
    """Returns the smaller of each distance and the radius, rounded down to float32."""
    bounded = np.minimum(distances, radius)
    rounded = bounded.astype(np.float32)
    return np.where(rounded > bounded, np.nextafter(rounded, np.float32(0)), rounded)
