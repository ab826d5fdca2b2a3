"""Results on ranks of MPI: crumple.mpi.Intersections, Impacts and Proximities."""

from __future__ import annotations

from typing import Any

from . import _features, _intersections
from ._errors import InvalidInput
from ._results import Request, int32

_ROWS = ("vertex_face", "edge_edge")


class _OfRank:
    """Base of what ranks have: rows of their own, and `any`, `count` and `first` over all ranks.

    The rows of all ranks, merged, are those of crumple.Detector.find for the whole scene. Numbers of triangles,
    vertices, edges and bodies are those over all ranks. Its arrays are read-only views.
    """

    def save(self, *_: Any, **__: Any) -> None:
        """Raises InvalidInput: the rows of one rank are not written."""
        raise InvalidInput("the rows of one rank are not saved")

    def __reduce__(self) -> Any:
        raise TypeError(f"cannot pickle a crumple.mpi.{type(self).__name__}: take its arrays")


class Intersections(_OfRank, _intersections.Intersections):
    """This rank's share of intersections: the pairs whose first triangle, or first body, it has brought, in order.

    `len(result)` is the number of this rank's rows, `count` that of all ranks; it is true if anything intersects on any
    rank.
    """

    def _check(self, name: str) -> None:
        if name not in ("pairs", "bodies", "count") and not name.startswith("contact"):
            raise InvalidInput(f"{name} is for one process")
        super()._check(name)

    def __repr__(self) -> str:
        found = f"{len(self)} colliding pairs here, {self._found.count} over all ranks"
        if self._request.output in ("any", "any_by_world"):
            found = "something collides" if self._found.any else "nothing collides"
        elif self._request.output == "body_pairs":
            found = f"{len(self)} colliding pairs of bodies here"
        elif self._request.output == "count":
            found = f"{self._found.count} colliding pairs over all ranks"
        return f"<crumple.mpi.Intersections: {found}, {self.statistics.milliseconds:.3g} ms>"


class _Features(_OfRank):
    """A vertex and an edge belong to the rank with the lowest triangle that names them."""

    def _check(self, name: str) -> None:
        if not name.startswith(_ROWS) and name not in ("edges", "edge_ids", "edge_bodies", "count"):
            raise InvalidInput(f"{name} is for one process")
        if name == "edge_bodies" and not self._request.of_bodies:  # type: ignore[attr-defined]
            raise InvalidInput("edge_bodies are for worlds, but the scene is one mesh")
        if name.startswith("edge"):
            self._check_output("edge_edges")  # type: ignore[attr-defined]
        super()._check(name)  # type: ignore[misc]

    edge_ids = int32(
        "(n,) int32: the numbers of the edges that these rows name, ascending: those of one process. The vertices of "
        "edges e are edges[numpy.searchsorted(edge_ids, e)]."
    )
    edge_bodies = int32("(n,) int32: of a world, the bodies of `edge_ids`, ascending; numbers ascend within each.")

    def __len__(self) -> int:
        """How many rows this rank has."""
        return len(self._found.vertex_faces) + len(self._found.edge_edges)  # type: ignore[attr-defined]

    def _description(self, found: str) -> str:
        if self._request.output == "pairs":  # type: ignore[attr-defined]
            found = f"{len(self)} {found} here, {self._found.count} over all ranks"  # type: ignore[attr-defined]
        ms = self.statistics.milliseconds  # type: ignore[attr-defined]
        return f"<crumple.mpi.{type(self).__name__}: {found}, {ms:.3g} ms>"


class Impacts(_Features, _features.Impacts):
    """This rank's share of the impacts of a step: those whose first feature is its own, in order.

    An edge of `first` has a number that only the rank whose rows name it can tell vertices for.
    """


class Proximities(_Features, _features.Proximities):
    """This rank's share of what is near: those pairs whose first feature is its own, in order."""


for _public in (Intersections, Impacts, Proximities):
    _public.__module__ = "crumple.mpi"
_RESULTS = {"intersections": Intersections, "impacts": Impacts, "proximities": Proximities}


def show(found: Any, query: Any, of_world: bool) -> Any:
    """The result of a query, of the extension module's."""
    listed = query.output in ("pairs", "contacts")
    options = frozenset({"closest"} if listed and getattr(query, "closest", False) else ())
    request = Request("world" if of_world else "mesh", of_world, query.output, options, (), False, False)
    return _RESULTS[query._call](found, request)
