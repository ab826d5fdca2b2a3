"""The results of queries about a step: impacts, the first one, a free step."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING, Any, ClassVar, Literal, NamedTuple

from . import _core
from ._features import FeatureResult

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray


class FirstImpact(NamedTuple):
    """The first impact of a step: that of least time as rounded, then the first in the order of the result.

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


class Impacts(FeatureResult):
    """What touches what on its way, and when, as much as `output` requested: the same bytes wherever it is computed.

    Two lists, of vertices with faces and of edges with edges, sorted and unique; of worlds by body before vertex, face
    or edge. Where edges or points are listed two more, of what no face and no edge covers: vertices with edges of no
    face, and vertices with vertices of neither. A time is in [0, 1], the exact one rounded down: toi <= exact < next
    number.

    It is true if anything touches; `len(impacts)` is the number of impacts.
    """

    _query = "ImpactQuery"
    _write = staticmethod(_core.write_impacts)
    _outputs = ("any", "any_by_world", "first", "pairs")
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

    def _check(self, name: str) -> None:
        if "triangle" in name:
            self._check_output(name)
            if "triangle_pairs" not in self._request.options:
                self._refuse(name, "triangle_pairs=True")
        super()._check(name)

    def _first(self, given: Any) -> FirstImpact | None:
        if given is None:
            return None
        first = FirstImpact(*given)
        return first if self._request.of_bodies else first._replace(bodies=None)

    @property
    def first(self) -> FirstImpact | None:
        """The first impact, of all worlds; None: the step is free. From output="first" on."""
        self._check_output("first")
        return self._first(self._found.first)

    @property
    def world_first(self) -> list[FirstImpact | None]:
        """The first impact of each world. From output="first" on."""
        self._check_output("world_first")
        return [self._first(first) for first in self._found.world_first]

    def __repr__(self) -> str:
        output, found = self._request.output, self._found
        if output in ("any", "any_by_world"):
            return self._description("something touches" if found.any else "nothing touches")
        if output == "first":
            return self._description(f"first at {found.first[3]:.6g}" if found.first else "nothing touches")
        return self._description("impacts" if found.count != 1 else "impact")
