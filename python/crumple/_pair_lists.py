"""What all answers have in common that list pairs of features: their arrays, as NumPy views."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray
    from typing_extensions import Self

    from ._core import Statistics


class PairLists:
    """Base of Impacts, Nearby and Candidates."""

    def __init__(self, answer: Any) -> None:
        self._answer = answer

    def _check_listed(self, name: str) -> None:
        """Raises InvalidInput, which says how to ask, for what was not asked for."""
        raise NotImplementedError

    def _array(self, name: str) -> Any:
        self._check_listed(name)
        array = getattr(self._answer, name)
        return array.copy() if self._answer.copy else array

    @cached_property
    def vertex_faces(self) -> NDArray[np.int32]:
        """(k, 2) int32: each a vertex and a face that does not name it, sorted; of worlds within their bodies."""
        return self._array("vertex_faces")

    @cached_property
    def vertex_face_bodies(self) -> NDArray[np.int32]:
        """(k, 2) int32, of a world: the vertex's body and the face's."""
        return self._array("vertex_face_bodies")

    @cached_property
    def edge_edges(self) -> NDArray[np.int32]:
        """(k, 2) int32: each two of `edges` without a common vertex, sorted; of worlds within their bodies."""
        return self._array("edge_edges")

    @cached_property
    def edge_edge_bodies(self) -> NDArray[np.int32]:
        """(k, 2) int32, of a world: the body of each of the two edges."""
        return self._array("edge_edge_bodies")

    @cached_property
    def edges(self) -> NDArray[np.int32]:
        """(n, 2) int32: the vertices of each edge, the lower first; each edge once, in lexicographic order.

        Or as they were listed (`edges`).
        Of a world those of body b are edges[first_edge[b]:first_edge[b + 1]], and an edge counts within its body.
        """
        return self._array("edges")

    @cached_property
    def first_edge(self) -> NDArray[np.int64]:
        """(bodies + 1,) int64: where each body's edges begin in `edges`; one mesh is one body."""
        return self._array("first_edge")

    @cached_property
    def points(self) -> NDArray[np.int32]:
        """(n,) int32: the vertices that were listed as points, in their order; then rows name vertices by place here.

        Of a world those of body b are points[first_point[b]:first_point[b + 1]]; a body without any names its vertices.
        """
        return self._array("points")

    @cached_property
    def first_point(self) -> NDArray[np.int64]:
        """(bodies + 1,) int64: where each body's listed points begin in `points`."""
        return self._array("first_point")

    @cached_property
    def vertex_edge_bodies(self) -> NDArray[np.int32]:
        """(k, 2) int32, of a world: the vertex's body and the edge's."""
        return self._array("vertex_edge_bodies")

    @cached_property
    def vertex_vertex_bodies(self) -> NDArray[np.int32]:
        """(k, 2) int32, of a world: the body of each of the two vertices."""
        return self._array("vertex_vertex_bodies")

    @property
    def statistics(self) -> Statistics:
        """Counts and times of the stages."""
        return self._answer.statistics

    def __len__(self) -> int:
        """How many pairs of features are listed; 0 where they were not asked for."""
        return self._answer.count

    def __copy__(self) -> Self:
        return type(self)(self._answer)
