"""Bodies on ranks of MPI: crumple.mpi.Detector.find, and find_impacts and find_near of a crumple.World."""

from __future__ import annotations

import functools
from collections.abc import Callable
from typing import TYPE_CHECKING, Any, Literal

from . import _core
from ._errors import InvalidInput, InvalidType
from ._near import radius_of
from ._rank_results import Impacts, Nearby, WorldResult
from ._world import World

if TYPE_CHECKING:
    from ._detector import GroupPairs, Intersections, Neighbours, Wanted
    from ._world_search import Wants
    from .mpi import Detector


def _excluded(pairs: Any) -> Any:
    """(n, 2) int32, or None. Other ranks have the bodies, too: only numbers tell them."""
    if pairs is None:
        return None
    import numpy as np

    given = np.asarray(pairs)
    if given.size == 0:
        return np.empty((0, 2), np.int32)
    if given.ndim != 2 or given.shape[1] != 2 or given.dtype.kind not in "iu":
        raise InvalidInput("excluded must be (n, 2) integers, numbers of bodies over all ranks", element="option")
    limits = np.iinfo(np.int32)
    if given.min() < limits.min or given.max() > limits.max:
        raise InvalidInput("excluded names a body beyond those of int32", element="option")
    return np.ascontiguousarray(given, np.int32)


def or_of_world(of_world: Callable[..., Any], of_mesh: Callable[..., Any]) -> Callable[..., Any]:
    """The search of a mesh, which is `of_world` where it is given a World. Signature: that of meshes."""

    @functools.wraps(of_mesh)
    def search(self: Detector, *given: Any, **question: Any) -> Any:
        return (of_world if given and isinstance(given[0], World) else of_mesh)(self, *given, **question)

    return search


def find(
    self: Detector,
    world: World,
    *,
    body_ids: Any = None,
    wants: Wants = "pairs",
    neighbours: Neighbours = "geometric",
    intersections: Intersections = "all",
    weld: bool = False,
    bodies: Wanted = "both",
    groups: Wanted = "both",
    excluded: Any = None,
    excluded_groups: GroupPairs | None = None,
    poses: Any = None,
) -> WorldResult:
    """What collides in a world of which each rank brings bodies: on each rank what their triangles are first in.
    Collective.

    Args:
        world: a crumple.World of this rank's bodies, all in world 0. Its shapes list no edges or points, and have
            neither radii nor a shape at rest. Poses lie on the host.
        body_ids: (n,) int64, which bodies these are; over all ranks 0 to B - 1, each once. None on all ranks: those of
            rank 0, then those of rank 1, and so on.
        wants: "any": whether anything collides ("any_by_world" is the same, for ranks share one world); "body_pairs":
            which bodies; "count": how many pairs of triangles; "pairs": which; "contacts": and where they meet.
        neighbours, intersections, weld, bodies, groups, excluded_groups: the question, as of crumple.Detector.find, and
            the same on all ranks. Rules speak of bodies (World's self_collisions, too) or of groups, not of both.
        excluded: (n, 2) integers: pairs of bodies, by their numbers over all ranks, that are not tested.
        poses: instead of world.poses, for this call.

    Returns crumple.mpi.WorldResult. Where only poses or vertices have changed since the call before, little more than
    coordinates travels. Raises InvalidInput, which names the argument and the body, and MemoryLimit, on all ranks; see
    Detector. Cost: see Detector; each rank poses its bodies, and keeps a table of all.
    """

    def question() -> Any:
        return _core.Question(wants, neighbours, intersections, weld, bodies, groups, excluded_groups, False)

    return WorldResult(self._ask_world("find_world", (world, body_ids, poses, None, excluded), question))


def find_impacts(
    self: Detector,
    world: World,
    *,
    body_ids: Any = None,
    wants: Literal["any", "any_by_world", "earliest", "impacts"] = "impacts",
    min_distance: float = 0.0,
    min_distance_share: float = 0.0,
    weld: bool = False,
    bodies: Wanted = "both",
    groups: Wanted = "both",
    excluded: Any = None,
    excluded_groups: GroupPairs | None = None,
    poses: Any = None,
    end_poses: Any = None,
) -> Impacts:
    """find_impacts of bodies."""

    def question() -> Any:
        rules = _core.rules_of_world(bodies, groups, excluded_groups)
        return _core.Motion(wants, min_distance, min_distance_share, weld, rules, False, False)

    if end_poses is None:
        end_poses = getattr(world, "end_poses", None)
    return Impacts(self._ask_world("find_impacts_in_world", (world, body_ids, poses, end_poses, excluded), question))


def find_near(
    self: Detector,
    world: World,
    *,
    body_ids: Any = None,
    radius: float | None = None,
    wants: Literal["any", "any_by_world", "pairs"] = "pairs",
    strict: bool = False,
    closest: bool = False,
    weld: bool = False,
    bodies: Wanted = "both",
    groups: Wanted = "both",
    excluded: Any = None,
    excluded_groups: GroupPairs | None = None,
    poses: Any = None,
) -> Nearby:
    """find_near of bodies."""

    def question() -> Any:
        rules = _core.rules_of_world(bodies, groups, excluded_groups)
        distance = radius_of("find_near", radius, False)
        return _core.Near(wants, distance, strict, closest, False, weld, 0, 0, rules, False)

    return Nearby(self._ask_world("find_near_in_world", (world, body_ids, poses, None, excluded), question))


def share_of(share: Any, world: Any, body_ids: Any, poses: Any, end_poses: Any, excluded: Any) -> Any:
    """share(...), which is crumple._mpi.WorldShare, of what a call was given."""
    if not isinstance(world, World):
        raise InvalidType(f"world must be a crumple.World, not {type(world).__name__}", element="option")
    return share(world, body_ids, poses, end_poses, _excluded(excluded))


for _search in (find, find_impacts, find_near):
    _search.__qualname__ = f"Detector.{_search.__name__}"
