"""Ranks of MPI: crumple.mpi.MeshShare and WorldShare, which each brings, and Intersections, Impacts, Proximities."""

from __future__ import annotations

from typing import Any

from . import _features, _intersections, _mpi
from ._errors import InvalidInput, InvalidType
from ._mesh import Mesh, mesh_of
from ._results import Request, Result, int32
from ._world import World


class MeshShare:
    """One rank's share of a mesh: triangles with all vertices that they name.

    The calls that take it check it, so that their errors reach all ranks.

    Args:
        mesh: what crumple.as_mesh takes; its faces count in this rank's vertices. May be empty.
        triangle_ids: (m,) int64, which triangles these are; over all ranks 0 to N - 1, each once. None on all ranks:
            those of rank 0, then those of rank 1, and so on.
        vertex_ids: (n,) int64, the same of the vertices. Ranks may have copies of a vertex, equal bit by bit; they make
            triangles of different ranks neighbours. None on all ranks: no rank has a copy of another's.
    """

    def __init__(self, mesh: Any, triangle_ids: Any = None, vertex_ids: Any = None) -> None:
        self.mesh, self.triangle_ids, self.vertex_ids = mesh, triangle_ids, vertex_ids

    def _scene(self) -> Mesh:
        return mesh_of(self.mesh)

    def _borrow(self, ranks: _mpi.Detector, mesh: Mesh) -> Any:
        return _mpi.Share(ranks, mesh, self.triangle_ids, self.vertex_ids)


class WorldShare:
    """One rank's share of a world: bodies, all in world 0.

    The calls that take it check it, so that their errors reach all ranks.

    Args:
        world: a crumple.World of this rank's bodies. Its shapes list no edges or points, and have neither radii nor a
            shape at rest. Poses lie on the host.
        body_ids: (n,) int64, which bodies these are; over all ranks 0 to B - 1, each once. None on all ranks: those of
            rank 0, then those of rank 1, and so on.
    """

    def __init__(self, world: World, body_ids: Any = None) -> None:
        self.world, self.body_ids = world, body_ids

    def _scene(self) -> World:
        if not isinstance(self.world, World):
            raise InvalidType(f"world must be a crumple.World, not {type(self.world).__name__}", element="option")
        return self.world

    def _borrow(self, _: _mpi.Detector, world: World) -> Any:
        return _mpi.WorldShare(world, self.body_ids)


def share_of(scene: Any, triangle_ids: Any, vertex_ids: Any, body_ids: Any) -> MeshShare | WorldShare:
    if isinstance(scene, World):
        if triangle_ids is not None or vertex_ids is not None:
            raise InvalidType("triangle_ids and vertex_ids are for meshes, but the scene is a crumple.World")
        return WorldShare(scene, body_ids)
    if body_ids is not None:
        raise InvalidType("body_ids are for a crumple.World, but the scene is a mesh")
    if not isinstance(scene, Mesh):
        raise InvalidType(f"each rank brings one mesh or a crumple.World, not {type(scene).__name__}")
    return MeshShare(scene, triangle_ids, vertex_ids)


def excluded_of_ranks(pairs: Any) -> Any:
    """(n, 2) int32, or None. Other ranks have the bodies, too: only numbers tell them."""
    if pairs is None:
        return None
    import numpy as np

    given = np.asarray(pairs)
    if given.size == 0:
        return np.empty((0, 2), np.int32)
    if given.ndim != 2 or given.shape[1] != 2 or given.dtype.kind not in "iu":
        raise InvalidInput(
            "excluded_bodies must be (n, 2) integers, numbers of bodies over all ranks", element="option"
        )
    limits = np.iinfo(np.int32)
    if given.min() < limits.min or given.max() > limits.max:
        raise InvalidInput("excluded_bodies names a body beyond those of int32", element="option")
    return np.ascontiguousarray(given, np.int32)


_ROWS = ("vertex_face", "edge_edge")


class _OfRank(Result):
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


class _Features(_OfRank, _features.FeatureResult):
    """A vertex and an edge belong to the rank with the lowest triangle that names them."""

    def _check(self, name: str) -> None:
        if not name.startswith(_ROWS) and name not in ("edges", "edge_ids", "edge_bodies", "count"):
            raise InvalidInput(f"{name} is for one process")
        if name == "edge_bodies" and not self._request.of_bodies:
            raise InvalidInput("edge_bodies are for worlds, but the scene is one mesh")
        if name.startswith("edge"):
            self._check_output("edge_edges")
        super()._check(name)

    edge_ids = int32(
        "(n,) int32: the numbers of the edges that these rows name, ascending: those of one process. The vertices of "
        "edges e are edges[numpy.searchsorted(edge_ids, e)]."
    )
    edge_bodies = int32("(n,) int32: of a world, the bodies of `edge_ids`, ascending; numbers ascend within each.")

    def __len__(self) -> int:
        """How many rows this rank has."""
        return len(self._found.vertex_faces) + len(self._found.edge_edges)

    def _description(self, found: str) -> str:
        if self._request.output == "pairs":
            found = f"{len(self)} {found} here, {self._found.count} over all ranks"
        ms = self.statistics.milliseconds
        return f"<crumple.mpi.{type(self).__name__}: {found}, {ms:.3g} ms>"


class Impacts(_Features, _features.Impacts):
    """This rank's share of the impacts of a step: those whose first feature is its own, in order.

    An edge of `first` has a number that only the rank whose rows name it can tell vertices for.
    """


class Proximities(_Features, _features.Proximities):
    """This rank's share of what is near: those pairs whose first feature is its own, in order."""


for _public in (MeshShare, WorldShare, Intersections, Impacts, Proximities):
    _public.__module__ = "crumple.mpi"
_RESULTS = {"intersections": Intersections, "impacts": Impacts, "proximities": Proximities}


def show(found: Any, query: Any, of_world: bool) -> Any:
    """The result of a query, of the extension module's."""
    listed = query.output in ("pairs", "contacts")
    options = frozenset({"closest"} if listed and getattr(query, "closest", False) else ())
    request = Request("world" if of_world else "mesh", of_world, query.output, options, (), False, False)
    return _RESULTS[query._call](found, request)
