"""Shares of ranks of MPI: crumple.mpi.MeshShare and WorldShare."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from ._errors import InvalidInput, InvalidType
from ._mesh import Mesh, mesh_of
from ._world import World

if TYPE_CHECKING:
    from . import _mpi


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
        from . import _mpi

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
        from . import _mpi

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


for _public in (MeshShare, WorldShare):
    _public.__module__ = "crumple.mpi"
