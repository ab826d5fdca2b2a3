"""Classes of crumple.mpi: local meshes and worlds that each rank provides, and results.

They are LocalMesh and LocalWorld, and Intersections, Impacts, Proximities and Overlaps.
"""

from __future__ import annotations

from typing import Any

from . import _features, _intersections, _mpi, _overlaps
from ._errors import InvalidInput, InvalidType
from ._mesh import Mesh, mesh_of
from ._results import Request, Result, int32
from ._scene import options_in_result
from ._world import World


class LocalMesh:
    """Local mesh of a rank (MPI process): some triangles of the scene, with all of their vertices.

    Parameters
    ----------
    mesh : mesh
        Anything that crumple.as_mesh takes. Its faces are indices of this rank's vertices. May be empty.
    triangle_ids : (m,) array_like of int64, optional
        Id of each local triangle. Over all N triangles of all ranks, the ids are 0 to N - 1, each exactly once. None on
        all ranks: triangles are numbered rank by rank.
    vertex_ids : (n,) array_like of int64, optional
        Id of each local vertex. Several ranks may have the same vertex (ghost vertices): its coordinates must be equal
        bit by bit, and triangles of different ranks that share it are adjacent. None on all ranks: vertices are
        numbered rank by rank, without ghost vertices.

    Notes
    -----
    The calls that use a local mesh validate it, so their errors reach all ranks.
    """

    def __init__(self, mesh: Any, triangle_ids: Any = None, vertex_ids: Any = None) -> None:
        self.mesh, self.triangle_ids, self.vertex_ids = mesh, triangle_ids, vertex_ids

    def _scene(self) -> Mesh:
        return mesh_of(self.mesh)

    def _borrow(self, ranks: _mpi.Detector, mesh: Mesh) -> Any:
        return _mpi.LocalMesh(ranks, mesh, self.triangle_ids, self.vertex_ids)


class LocalWorld:
    """Local bodies of a rank (MPI process). All ranks share one world, so all bodies are in world 0.

    Parameters
    ----------
    world : World
        Bodies of this rank. Shapes must not have edges, points, radii or a rest shape. Poses must be in host memory.
    body_ids : (n,) array_like of int64, optional
        Id of each local body. Over all B bodies of all ranks, the ids are 0 to B - 1, each exactly once. None on all
        ranks: bodies are numbered rank by rank.

    Notes
    -----
    The calls that use local bodies validate them, so their errors reach all ranks.
    """

    def __init__(self, world: World, body_ids: Any = None) -> None:
        self.world, self.body_ids = world, body_ids

    def _scene(self) -> World:
        if not isinstance(self.world, World):
            raise InvalidType(f"world must be a crumple.World, not {type(self.world).__name__}", element="option")
        return self.world

    def _borrow(self, _: _mpi.Detector, world: World) -> Any:
        return _mpi.LocalWorld(world, self.body_ids)


def local_of(scene: Any, triangle_ids: Any, vertex_ids: Any, body_ids: Any) -> LocalMesh | LocalWorld:
    if isinstance(scene, World):
        if triangle_ids is not None or vertex_ids is not None:
            raise InvalidType("triangle_ids and vertex_ids are for meshes, but the scene is a crumple.World")
        return LocalWorld(scene, body_ids)
    if body_ids is not None:
        raise InvalidType("body_ids are for a crumple.World, but the scene is a mesh")
    if not isinstance(scene, Mesh):
        raise InvalidType(f"each rank must pass one mesh or a crumple.World, not {type(scene).__name__}")
    return LocalMesh(scene, triangle_ids, vertex_ids)


def excluded_of_ranks(pairs: Any) -> Any:
    """Returns excluded pairs of bodies as (n, 2) int32 ids over all ranks, or None. Refuses names, which are local."""
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
        raise InvalidInput("excluded_bodies names a body that does not fit int32", element="option")
    return np.ascontiguousarray(given, np.int32)


_ROWS = ("vertex_face", "edge_edge")


class _OfRank(Result):
    """Base class of results of ranks: local rows, with `any`, `count` and `first` over all ranks.

    The rows of all ranks, merged, are those of crumple.Detector.find for the whole scene. Ids of triangles, vertices,
    edges and bodies count over all ranks. Arrays are read-only views.
    """

    def save(self, *_: Any, **__: Any) -> None:
        """Raises InvalidInput: the rows of one rank cannot be saved."""
        raise InvalidInput("the rows of one rank cannot be saved")

    def __reduce__(self) -> Any:
        raise TypeError(f"cannot pickle a crumple.mpi.{type(self).__name__}: use its arrays")


class Intersections(_OfRank, _intersections.Intersections):
    """Local rows of intersections: pairs whose first triangle or first body this rank has provided, in order.

    `len(result)` is the number of local rows, and `count` the number of rows of all ranks. `bool(result)` is True if
    anything intersects on any rank.
    """

    def _check(self, name: str) -> None:
        if name not in ("pairs", "bodies", "count") and not name.startswith("contact"):
            raise InvalidInput(f"{name} is not supported on ranks")
        super()._check(name)

    def __repr__(self) -> str:
        found = f"{len(self)} colliding pairs on this rank, {self._found.count} over all ranks"
        if self._request.output in ("any", "any_by_world"):
            found = "something collides" if self._found.any else "nothing collides"
        elif self._request.output == "body_pairs":
            found = f"{len(self)} colliding pairs of bodies on this rank"
        elif self._request.output == "count":
            found = f"{self._found.count} colliding pairs over all ranks"
        return f"<crumple.mpi.Intersections: {found}, {self.statistics.milliseconds:.3g} ms>"


class _Features(_OfRank, _features.FeatureResult):
    """Base class of results about features. A vertex or edge belongs to the rank of its lowest triangle."""

    def _check(self, name: str) -> None:
        if not name.startswith(_ROWS) and name not in ("edges", "edge_ids", "edge_bodies", "count"):
            raise InvalidInput(f"{name} is not supported on ranks")
        if name == "edge_bodies" and not self._request.of_bodies:
            raise InvalidInput("edge_bodies are for worlds, but the scene is one mesh")
        if name.startswith("edge"):
            self._check_output("edge_edges")
        super()._check(name)

    edge_ids = int32(
        "(n,) int32: numbers over all ranks of the edges in local rows, ascending; those of one process. Edges e have "
        "the vertices edges[numpy.searchsorted(edge_ids, e)]."
    )
    edge_bodies = int32("(n,) int32, for worlds: bodies of `edge_ids`, ascending; numbers ascend within each.")

    def __len__(self) -> int:
        """Number of local rows."""
        return len(self._found.vertex_faces) + len(self._found.edge_edges)

    def _description(self, found: str) -> str:
        if self._request.output == "pairs":
            found = f"{len(self)} {found} on this rank, {self._found.count} over all ranks"
        ms = self.statistics.milliseconds
        return f"<crumple.mpi.{type(self).__name__}: {found}, {ms:.3g} ms>"


class Impacts(_Features, _features.Impacts):
    """Local rows of the impacts of a step: those whose first feature belongs to this rank, in order.

    Edges in `first` have ids over all ranks. Only the rank whose rows contain such an edge has its vertices.
    """


class Proximities(_Features, _features.Proximities):
    """Local rows of near pairs: those whose first feature belongs to this rank, in order."""


class Overlaps(_OfRank, _overlaps.Overlaps):
    """Local rows of overlaps: those whose first body this rank has provided, in order, with all of their lists.

    `len(result)` is the number of local rows, and `count` the number of rows of all ranks. `body_volume` and `is_solid`
    are about the local bodies, in their order; `skipped` has those of the skipped bodies that are local.
    """

    def _check(self, name: str) -> None:
        if name == "world_hit" or name.startswith("part_"):
            raise InvalidInput(f"{name} is not supported on ranks")
        super()._check(name)

    @property
    def part(self) -> None:
        """None: ranks find overlaps of whole scenes."""
        return None

    def __len__(self) -> int:
        """Number of local rows."""
        return len(self._found.bodies)

    def __repr__(self) -> str:
        found = f"{len(self)} pairs of bodies on this rank, {self._found.count} over all ranks"
        if self._request.output in ("any", "any_by_world"):
            found = f"any: {self.any}"
        return f"<crumple.mpi.Overlaps: {found}, {self.statistics.milliseconds:.3g} ms>"


for _public in (LocalMesh, LocalWorld, Intersections, Impacts, Proximities, Overlaps):
    _public.__module__ = "crumple.mpi"
_RESULTS = {"intersections": Intersections, "impacts": Impacts, "proximities": Proximities, "overlaps": Overlaps}


def show(found: Any, query: Any, of_world: bool) -> Any:
    """Makes the result of a query from the result of the extension module, `found`."""
    listed = query.output in ("pairs", "contacts")
    options = options_in_result(query) if listed else frozenset()
    request = Request("world" if of_world else "mesh", of_world, query.output, options, (), False, False)
    return _RESULTS[query._call](found, request)
