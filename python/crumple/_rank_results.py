"""What ranks of MPI answer: crumple.mpi.Result, WorldResult, Impacts and Nearby."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING, Any, ClassVar

from ._errors import InvalidInput
from ._impacts import FirstImpact
from ._result import Contacts

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from . import _mpi


class Result:
    """This rank's rows of an answer: the pairs whose first triangle it has brought, in lexicographic order.

    The rows of all ranks, merged, are what crumple.Detector.find_self gives for the whole scene. A result outlives its
    detector, and no later call changes it. Its arrays are read-only views that keep their memory alive.

    `len(result)` is the number of this rank's pairs, and a result without any is false.
    """

    def __init__(self, answer: _mpi.Answer) -> None:
        self._answer = answer

    @cached_property
    def pairs(self) -> NDArray[np.int32]:
        """(k, 2) int32: colliding pairs, first < second, sorted. Triangles have their numbers over all ranks."""
        return self._answer.pairs

    @cached_property
    def contacts(self) -> Contacts | None:
        """Where these pairs meet, or None if `contacts=True` was not asked for."""
        a = self._answer
        return Contacts(a.contact_kinds, a.contact_offsets, a.contact_points) if a.has_contacts else None

    @property
    def total(self) -> int:
        """How many pairs there are over all ranks."""
        return self._answer.total

    @property
    def statistics(self) -> _mpi.Statistics:
        """What the call did on this rank."""
        return self._answer.statistics

    def __len__(self) -> int:
        """How many pairs of this rank."""
        return len(self._answer)

    def __repr__(self) -> str:
        ms = self.statistics.milliseconds
        return f"<crumple.mpi.Result: {len(self)} colliding pairs here, {self.total} over all ranks, {ms:.3g} ms>"


class WorldResult:
    """This rank's rows of an answer for a world: those whose first body it has brought.

    Rows are in the order of first body, its triangle, second body, its triangle. Merged by first body, the rows of all
    ranks are what crumple.Detector.find gives for the whole world. Bodies have their numbers over all ranks, triangles
    count within their bodies. What was not asked for is an InvalidInput that says how to ask. A result is true if
    anything collides on any rank; `len(result)` is the number of this rank's rows. It outlives its detector, and its
    arrays are read-only views.
    """

    def __init__(self, answer: _mpi.WorldAnswer) -> None:
        self._answer = answer

    def _asked(self, name: str, *wants: str) -> Any:
        if self._answer.wants not in wants:
            raise InvalidInput(f'{name} was not asked for: find(..., wants="{wants[0]}")')
        return getattr(self._answer, name)

    @property
    def any(self) -> bool:
        """Whether anything collides, on any rank."""
        return self._answer.any

    @property
    def count(self) -> int:
        """How many pairs of triangles collide, over all ranks. From wants="count" on."""
        return self._asked("count", "count", "pairs", "contacts")

    @cached_property
    def bodies(self) -> NDArray[np.int32]:
        """(k, 2) int32: the bodies of each pair of triangles; of wants="body_pairs" the colliding ones, each once."""
        return self._asked("bodies", "body_pairs", "pairs", "contacts")

    @cached_property
    def pairs(self) -> NDArray[np.int32]:
        """(k, 2) int32: the colliding triangles, as they count within their bodies. From wants="pairs" on."""
        return self._asked("pairs", "pairs", "contacts")

    @cached_property
    def contacts(self) -> Contacts | None:
        """Where these pairs meet, or None if wants="contacts" was not asked for."""
        a = self._answer
        return Contacts(a.contact_kinds, a.contact_offsets, a.contact_points) if a.wants == "contacts" else None

    @property
    def statistics(self) -> _mpi.Statistics:
        """What the call did on this rank."""
        return self._answer.statistics

    def __len__(self) -> int:
        """How many rows of this rank."""
        return len(self._answer)

    def __bool__(self) -> bool:
        """Whether anything collides, on any rank."""
        return self._answer.any

    def __repr__(self) -> str:
        found = {
            "any": _whether(self.any, "collides"),
            "any_by_world": _whether(self.any, "collides"),
            "body_pairs": f"{len(self)} pairs of bodies here",
            "count": f"{self._answer.count} colliding pairs",
        }.get(self._answer.wants, f"{len(self)} colliding pairs here, {self._answer.count} over all ranks")
        return f"<crumple.mpi.WorldResult: {found}, {self.statistics.milliseconds:.3g} ms>"


class _Features:
    """Base of Impacts and Nearby."""

    _find: ClassVar[str]  # the search
    _all: ClassVar[str]  # what is wanted where rows are

    def __init__(self, answer: Any) -> None:
        self._answer = answer

    def _rows(self, name: str) -> Any:
        if self._answer.wants != self._all:
            raise InvalidInput(f'{name} was not asked for: {self._find}(..., wants="{self._all}")')
        return getattr(self._answer, name)

    def _of_world(self, name: str) -> Any:
        if not self._answer.of_world:
            raise InvalidInput(f"{name} is told of a crumple.World, and this was asked of a mesh")
        return self._rows(name)

    @cached_property
    def vertex_faces(self) -> NDArray[np.int32]:
        """(k, 2) int32: each a vertex of this rank and a face that does not name it, sorted; numbers over all ranks."""
        return self._rows("vertex_faces")

    @cached_property
    def edge_edges(self) -> NDArray[np.int32]:
        """(k, 2) int32: each an edge of this rank and a higher one without a common vertex, sorted; see `edge_ids`."""
        return self._rows("edge_edges")

    @cached_property
    def vertex_face_bodies(self) -> NDArray[np.int32]:
        """(k, 2) int32: of a world, the bodies of each vertex and face, whose numbers then count within them."""
        return self._of_world("vertex_face_bodies")

    @cached_property
    def edge_edge_bodies(self) -> NDArray[np.int32]:
        """(k, 2) int32: of a world, the bodies of the two edges, whose numbers then count within them."""
        return self._of_world("edge_edge_bodies")

    @cached_property
    def edge_bodies(self) -> NDArray[np.int32]:
        """(n,) int32: of a world, the bodies of `edge_ids`, ascending; numbers ascend within each."""
        return self._of_world("edge_bodies")

    @cached_property
    def edge_ids(self) -> NDArray[np.int32]:
        """(n,) int32: the numbers of the edges that these rows name, ascending: those of one process.

        The vertices of edges e are edges[numpy.searchsorted(edge_ids, e)].
        """
        return self._rows("edge_ids")

    @cached_property
    def edges(self) -> NDArray[np.int32]:
        """(n, 2) int32: the vertices of each of `edge_ids`, the lower first; numbers over all ranks."""
        return self._rows("edges")

    @property
    def any(self) -> bool:
        """Whether there is anything over all ranks."""
        return self._answer.any

    @property
    def total(self) -> int:
        """How many pairs of features there are over all ranks."""
        return self._rows("total")

    @property
    def statistics(self) -> _mpi.Statistics:
        """What the call did on this rank."""
        return self._answer.statistics

    def __len__(self) -> int:
        """How many pairs of features of this rank."""
        return len(self.vertex_faces) + len(self.edge_edges)

    def __bool__(self) -> bool:
        """Whether there is anything over all ranks."""
        return self._answer.any

    def _told(self, found: str) -> str:
        if self._answer.wants == self._all:
            found = f"{len(self)} {found} here, {self.total} over all ranks"
        return f"<crumple.mpi.{type(self).__name__}: {found}, {self.statistics.milliseconds:.3g} ms>"


class Impacts(_Features):
    """This rank's share of the impacts of a step: those whose first feature is its own, in order.

    A vertex and an edge belong to the rank with the lowest triangle that names them. The rows of all ranks, merged, are
    those of crumple.Detector.find_impacts for the whole scene. What was not asked for is an InvalidInput that says how
    to ask. An answer is true if anything touches on any rank; `len(impacts)` is the number of this rank's rows. It
    outlives its detector, and its arrays are read-only views.
    """

    _find = "find_impacts"
    _all = "impacts"

    @cached_property
    def vertex_face_toi(self) -> NDArray[np.float64]:
        """(k,) float64: when vertex and face first touch, rounded down."""
        return self._rows("vertex_face_toi")

    @cached_property
    def vertex_face_start(self) -> NDArray[np.bool_]:
        """(k,) bool: whether they touch at the start."""
        return self._rows("vertex_face_start")

    @cached_property
    def edge_edge_toi(self) -> NDArray[np.float64]:
        """(k,) float64: when the two edges first touch, rounded down."""
        return self._rows("edge_edge_toi")

    @cached_property
    def edge_edge_start(self) -> NDArray[np.bool_]:
        """(k,) bool: whether they touch at the start."""
        return self._rows("edge_edge_start")

    @property
    def first(self) -> FirstImpact | None:
        """The first impact over all ranks, as a crumple.FirstImpact; None: the step is free. From wants="earliest" on.

        An edge of its pair has a number that only the rank whose rows name it can tell vertices for.
        """
        if self._answer.wants == "any":
            raise InvalidInput('first was not asked for: find_impacts(..., wants="earliest")')
        first = self._answer.first
        return None if first is None else FirstImpact(*first)

    def __repr__(self) -> str:
        if self._answer.wants == "earliest" and self._answer.any:
            return self._told(f"first at {self._answer.first[3]:.6g}")
        return self._told("impacts" if self._answer.wants == "impacts" else _whether(self._answer.any, "touches"))


class Nearby(_Features):
    """This rank's share of what is near: those pairs whose first feature is its own, in order.

    The rows of all ranks, merged, are those of crumple.Detector.find_near for the whole scene. An answer is true if
    anything is near on any rank. All else as of Impacts.
    """

    _find = "find_near"
    _all = "pairs"

    def _closest(self, name: str) -> Any:
        if self._answer.wants == self._all and not self._answer.has_closest:
            raise InvalidInput(f"{name} was not asked for: find_near(..., closest=True)")
        return self._rows(name)

    @cached_property
    def vertex_face_squared_distance(self) -> NDArray[np.float64]:
        """(k,) float64: the squared distance of vertex and face, rounded to the nearest number."""
        return self._rows("vertex_face_squared_distance")

    @cached_property
    def vertex_face_touching(self) -> NDArray[np.bool_]:
        """(k,) bool: whether their distance is 0 exactly."""
        return self._rows("vertex_face_touching")

    @cached_property
    def edge_edge_squared_distance(self) -> NDArray[np.float64]:
        """(k,) float64: the squared distance of the two edges, rounded to the nearest number."""
        return self._rows("edge_edge_squared_distance")

    @cached_property
    def edge_edge_touching(self) -> NDArray[np.bool_]:
        """(k,) bool: whether their distance is 0 exactly."""
        return self._rows("edge_edge_touching")

    @cached_property
    def vertex_face_type(self) -> NDArray[np.uint8]:
        """(k,) uint8, with `closest`: a crumple.VertexFaceType each."""
        return self._closest("vertex_face_type")

    @cached_property
    def vertex_face_at(self) -> NDArray[np.float64]:
        """(k, 2), with `closest`: (u, v) of the face's point a + u (b - a) + v (c - a) that is closest, rounded."""
        return self._closest("vertex_face_at")

    @cached_property
    def edge_edge_type(self) -> NDArray[np.uint8]:
        """(k,) uint8, with `closest`: a crumple.EdgeEdgeType each."""
        return self._closest("edge_edge_type")

    @cached_property
    def edge_edge_at(self) -> NDArray[np.float64]:
        """(k, 2), with `closest`: (s, t) of the edges' points a + s (b - a) and c + t (d - c), rounded."""
        return self._closest("edge_edge_at")

    def __repr__(self) -> str:
        return self._told("near pairs" if self._answer.wants == self._all else _whether(self._answer.any, "is near"))


def _whether(any_: bool, what: str) -> str:
    return f"{'something' if any_ else 'nothing'} {what}"


for _public in (Result, WorldResult, Impacts, Nearby):
    _public.__module__ = "crumple.mpi"
