"""What a search for impacts answers."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING, Any, ClassVar, Literal, NamedTuple

from . import _core
from ._errors import InvalidInput
from ._feature_result import FeatureResult

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray


class FirstImpact(NamedTuple):
    """The first impact of a step: that of least time as rounded, then the first in the order of the answer.

    Attributes:
        kind: "vertex_face", "edge_edge", "vertex_edge" or "vertex_vertex".
        pair: as a row of Impacts.vertex_faces, edge_edges, vertex_edges or vertex_vertices.
        bodies: of a world, the bodies of the pair; else None.
        toi: first time of contact in [0, 1], rounded down.
        start: whether they touch at the start.
    """

    kind: Literal["vertex_face", "edge_edge", "vertex_edge", "vertex_vertex"]
    pair: tuple[int, int]
    bodies: tuple[int, int] | None
    toi: float
    start: bool


class FreeStep(NamedTuple):
    """A share of a step that can be gone.

    Attributes:
        share: 0 to 1; 1: the whole step is free; 0: contact is at the start, or too near.
        positions: (n, 3), of the precision of the mesh: start + share (end - start), rounded.
    """

    share: float
    positions: NDArray[Any]


def _first(given: Any) -> FirstImpact | None:
    return None if given is None else FirstImpact(*given)


class Impacts(FeatureResult):
    """What touches what on its way, and when, as much as `wants` asked for: the same bytes wherever it is computed.

    Two lists, of vertices with faces and of edges with edges, sorted and unique; of worlds by body before vertex, face
    or edge. Where edges or points are listed two more, of what no face and no edge covers: vertices with edges of no
    face, and vertices with vertices of neither. A time is in [0, 1], the exact one rounded down: toi <= exact < next
    number.

    An answer is true if anything touches; `len(impacts)` is the number of impacts. What was not asked for is an
    InvalidInput that says how to ask. It outlives its detector, and no later call changes it. Its arrays are read-only
    views of the library's memory that keep that memory alive, or with `copy=True` writable arrays of their own. It can
    be copied and pickled: copy.copy shares the arrays, copy.deepcopy does not; unpickling checks that all of it fits
    together.
    """

    _find = "find_impacts"
    _write = staticmethod(_core.write_impacts)
    _wants = ("any", "any_by_world", "earliest", "impacts")
    _from: ClassVar = {
        "world_hit": 1,
        "first": 2,
        "world_first": 2,
        "edges": 2,
        "first_edge": 2,
        "points": 2,
        "first_point": 2,
    }

    @cached_property
    def vertex_face_toi(self) -> NDArray[np.float64]:
        """(k,) float64: when vertex and face first touch."""
        return self._array("vertex_face_toi")

    @cached_property
    def vertex_face_start(self) -> NDArray[np.bool_]:
        """(k,) bool: whether they touch at the start; then toi is 0. It may be 0 for a later contact as well."""
        return self._array("vertex_face_start")

    @cached_property
    def edge_edge_toi(self) -> NDArray[np.float64]:
        """(k,) float64: when the two edges first touch."""
        return self._array("edge_edge_toi")

    @cached_property
    def edge_edge_start(self) -> NDArray[np.bool_]:
        """(k,) bool: whether they touch at the start."""
        return self._array("edge_edge_start")

    @cached_property
    def vertex_edge_toi(self) -> NDArray[np.float64]:
        """(k,) float64: when vertex and edge first touch."""
        return self._array("vertex_edge_toi")

    @cached_property
    def vertex_edge_start(self) -> NDArray[np.bool_]:
        """(k,) bool: whether they touch at the start."""
        return self._array("vertex_edge_start")

    @cached_property
    def vertex_vertex_toi(self) -> NDArray[np.float64]:
        """(k,) float64: when the two vertices first touch."""
        return self._array("vertex_vertex_toi")

    @cached_property
    def vertex_vertex_start(self) -> NDArray[np.bool_]:
        """(k,) bool: whether they touch at the start."""
        return self._array("vertex_vertex_start")

    @cached_property
    def triangle_pairs(self) -> NDArray[np.int32]:
        """(k, 2) int32, with `triangle_pairs`: triangles, a < b, sorted; of worlds within their bodies."""
        return self._array("triangle_pairs")

    @cached_property
    def triangle_pair_bodies(self) -> NDArray[np.int32]:
        """(k, 2) int32: of a world, the bodies of the two triangles."""
        return self._array("triangle_pair_bodies")

    @cached_property
    def triangle_pair_toi(self) -> NDArray[np.float64]:
        """(k,) float64: when any of their features first touch; 0 where they intersect at the start."""
        return self._array("triangle_pair_toi")

    @cached_property
    def triangle_pair_start(self) -> NDArray[np.bool_]:
        """(k,) bool: whether they intersect, or some features touch, at the start."""
        return self._array("triangle_pair_start")

    @cached_property
    def triangle_offsets(self) -> NDArray[np.int64]:
        """(faces + 1,), with `index`: rows whose first triangle is t, of `triangle_pairs`."""
        return self._array("triangle_offsets")

    @cached_property
    def second_triangle_offsets(self) -> NDArray[np.int64]:
        """(faces + 1,), with `index`: the same for the second triangle, as ranges of `by_second_triangle`."""
        return self._array("second_triangle_offsets")

    @cached_property
    def by_second_triangle(self) -> NDArray[np.int64]:
        """(k,) int64, with `index`: positions in `triangle_pairs`, sorted by the second triangle, then by the first."""
        return self._array("by_second_triangle")

    def _array(self, name: str) -> Any:
        if "triangle" in name:
            self._check_wanted(name)
            if not self._answer.has_triangle_pairs:
                raise InvalidInput(f"{name} was not asked for: find_impacts(..., triangle_pairs=True)")
        return super()._array(name)

    @property
    def first(self) -> FirstImpact | None:
        """The first impact, of all worlds; None: the step is free. From wants="earliest" on."""
        self._check_wanted("first")
        return _first(self._answer.first)

    @property
    def world_first(self) -> list[FirstImpact | None]:
        """The first impact of each world. From wants="earliest" on."""
        self._check_wanted("world_first")
        return [_first(first) for first in self._answer.world_first]

    def __repr__(self) -> str:
        answer = self._answer
        if answer.wants in ("any", "any_by_world"):
            return self._told("something touches" if answer.any else "nothing touches")
        first = answer.first
        if answer.wants == "earliest":
            return self._told(f"first at {first[3]:.6g}" if first else "nothing touches")
        return self._told("impacts" if answer.count != 1 else "impact")
