"""Self-contact lists as Newton's cloth solvers read them, exact and complete.

    from crumple.adapters.newton import SelfContactDetector

    detector = SelfContactDetector(model.tri_indices, model.edge_indices)
    contacts = detector.detect(state.particle_q, radius)
    info = contacts.warp_arrays()                                # by the names of Newton's TriMeshCollisionInfo

Buffers are as long as they must be, so none overflows, nothing is truncated and nothing runs twice; lists are the same
every time. Newton is not needed for it, and Warp for warp_arrays alone. Positions lie on the host.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from .._arrays import host_array
from .._detector import Detector
from .._errors import InvalidInput

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from .._features import Proximities

__all__ = ["SelfContactDetector", "SelfContacts"]


class SelfContacts(NamedTuple):
    """What is nearer than the radius, by vertex, by triangle and by edge; names and layout are Newton's.

    Element i's entries are [offsets[i], offsets[i + 1]), in ascending order; counts and buffer sizes are their number.
    Of vertices and edges an entry is two numbers, the element's own and the other's, so entry k is at 2k and 2k + 1;
    of triangles it is one, the vertex. An edge pair is listed from both sides. A least distance is rounded down to
    float32, and the radius where there is none. All int32 but the distances.
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
        """The same as arrays of Warp, by name: on the host without a copy, on a device with one."""
        import warp

        arrays = {name: warp.from_dlpack(array) for name, array in self._asdict().items()}
        if warp.get_device(device).is_cpu:
            return arrays
        return {name: array.to(device) for name, array in arrays.items()}


class SelfContactDetector:
    """Finds what is nearer than a radius in a cloth: vertices and triangles, edges and edges.

    A pair counts where its distance is less than the radius, exactly, unless it has a vertex in common.

    Args:
        triangles: (m, 3) integers, or flat; an array of Warp as well.
        edges: (n, 2), or (n, 4) as Newton's edge_indices, whose last two columns are the ends. Each edge of the
            triangles once, in any order and direction. None: in lexicographic order.
        options: those of crumple.Detector.

    Raises InvalidInput for edges that are not those of the triangles, and, in `detect`, as Detector.proximities does.
    """

    def __init__(self, triangles: Any, edges: Any = None, **options: Any) -> None:
        self.detector = Detector(**options)
        self._triangles = host_array(triangles, "triangles").reshape(-1, 3)
        self._edges = None
        if edges is not None:
            listed = host_array(edges, "edges")
            if listed.ndim != 2 or listed.shape[1] not in (2, 4):
                raise InvalidInput(f"edges must have shape (n, 2) or (n, 4), not {listed.shape}")
            self._edges = np.sort(listed[:, -2:], axis=1)

    def detect(self, positions: Any, radius: float) -> SelfContacts:
        """The lists for these positions, (n, 3) of float32 or float64: a wp.array of vec3 on the host, or NumPy's.

        Cost: that of Detector.proximities, and some 20 ns an entry.
        """
        near = self.detector.proximities(positions, self._triangles, radius=radius, strict=True, least=True, index=True)
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
        """Which of the listed edges each of those of the triangles is."""
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
                return f", and edge {i}, {edge}, is none of them, or listed again"
            wanted.remove(edge)
        return f", and {min(wanted)} is missing"


def _counted(offsets: NDArray[np.int64]) -> tuple[NDArray[np.int32], ...]:
    """Offsets, buffer sizes and counts."""
    if offsets[-1] > np.iinfo(np.int32).max // 2:
        raise InvalidInput(f"{offsets[-1]} pairs are more than int32 can count: a smaller radius has fewer")
    counts = np.diff(offsets).astype(np.int32)
    return offsets.astype(np.int32), counts, counts.copy()


def _least(distances: NDArray[np.float64], radius: float) -> NDArray[np.float32]:
    """At most the radius, rounded down."""
    bounded = np.minimum(distances, radius)
    rounded = bounded.astype(np.float32)
    return np.where(rounded > bounded, np.nextafter(rounded, np.float32(0)), rounded)
