"""Detector.stream_impacts, stream_near and stream_candidates, of one mesh and of worlds."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import TYPE_CHECKING, Any, overload

from . import _core
from ._blocks import taker
from ._candidates import CandidateKind, Candidates, candidate_question
from ._core import Statistics
from ._feature_question import or_of_world
from ._impacts import Impacts
from ._mesh import listing_of
from ._near import Nearby, radius_of
from ._world_search import excluded_in, with_names

if TYPE_CHECKING:
    from ._detector import Detector, GroupPairs, Wanted
    from ._world import World


def _impacts_in_world(
    self: Detector,
    take: Callable[[Impacts], Any],
    world: World,
    *,
    block_rows: int = 1 << 18,
    min_distance: float = 0.0,
    min_distance_share: float = 0.0,
    weld: bool = False,
    bodies: Wanted = "both",
    groups: Wanted = "both",
    excluded: Any = None,
    excluded_groups: GroupPairs | None = None,
    poses: Any = None,
    end_poses: Any = None,
) -> Statistics:
    rules = _core.rules_of_world(bodies, groups, excluded_groups)
    question = _core.Motion("impacts", min_distance, min_distance_share, weld, rules, False, False)
    poses = world.poses if poses is None else poses
    end_poses = world.end_poses if end_poses is None else end_poses
    given = (taker(take, Impacts), world, poses, end_poses, question, excluded_in(world, excluded))
    return with_names(world, self._stream_impacts_in_world, *given, block_rows)


@overload
def stream_impacts(
    self: Detector,
    take: Callable[[Impacts], Any],
    vertices: Any,
    end: Any,
    faces: Any = None,
    *,
    block_rows: int = 1 << 18,
    min_distance: float = 0.0,
    min_distance_share: float = 0.0,
    weld: bool = False,
    groups: Any = None,
    edges: Any = None,
    points: Any = None,
    wanted: Wanted = "both",
    excluded_groups: GroupPairs | None = None,
) -> Statistics: ...


@overload
def stream_impacts(
    self: Detector,
    take: Callable[[Impacts], Any],
    world: World,
    /,
    *,
    block_rows: int = 1 << 18,
    min_distance: float = 0.0,
    min_distance_share: float = 0.0,
    weld: bool = False,
    bodies: Wanted = "both",
    groups: Wanted = "both",
    excluded: Any = None,
    excluded_groups: GroupPairs | None = None,
    poses: Any = None,
    end_poses: Any = None,
) -> Statistics: ...


@or_of_world(_impacts_in_world, 1)
def stream_impacts(
    self: Detector,
    take: Callable[[Impacts], Any],
    vertices: Any,
    end: Any,
    faces: Any = None,
    *,
    block_rows: int = 1 << 18,
    min_distance: float = 0.0,
    min_distance_share: float = 0.0,
    weld: bool = False,
    groups: Any = None,
    edges: Any = None,
    points: Any = None,
    wanted: Wanted = "both",
    excluded_groups: GroupPairs | None = None,
) -> Statistics:
    """Hands all impacts of a step over in blocks, for answers that exceed memory.

    Args:
        take: called with one crumple.Impacts after the other, which has the lists of the block; `len(block)` is how
            many rows these have. Edges and points are those of the whole answer. It tells of nothing else: `first`,
            `world_first` and `world_hit` are an InvalidInput. What it raises ends the call. It may run in another
            thread, but never in two at a time, and cannot call this detector.
        block_rows: most rows of a block, in all its lists, 1 to 2^40.

    Other arguments, also of worlds (`take` comes first), and errors as of find_impacts; there is no `index`, and there
    are no `triangle_pairs`. Returns the statistics of the call.

    Cost: as found, that of find_impacts; in order, up to about that of find_impacts for each block, so blocks should be
    large. Of several worlds the scene of each is made twice. Memory: that of a search without its rows, and some 100
    bytes for each row of a block; each block that you keep has its own copy of the edges.
    """
    rules = _core.rules_of_mesh(wanted, excluded_groups)
    question = _core.Motion("impacts", min_distance, min_distance_share, weld, rules, False, False)
    mesh = listing_of(vertices, faces, groups, edges, points)
    give = taker(take, Impacts)
    return self._stream_impacts(give, mesh, end, question, (edges, points), block_rows)


def _near_in_world(
    self: Detector,
    take: Callable[[Nearby], Any],
    world: World,
    *,
    block_rows: int = 1 << 18,
    radius: float | None = None,
    strict: bool = False,
    closest: bool = False,
    weld: bool = False,
    rings: int = 0,
    rest_radius: float = 0,
    bodies: Wanted = "both",
    groups: Wanted = "both",
    excluded: Any = None,
    excluded_groups: GroupPairs | None = None,
    poses: Any = None,
) -> Statistics:
    rules = _core.rules_of_world(bodies, groups, excluded_groups)
    radius = radius_of("stream_near", radius, any(shape.radii is not None for shape in world.shapes))
    question = _core.Near("pairs", radius, strict, closest, False, weld, rings, rest_radius, rules, False)
    poses = world.poses if poses is None else poses
    given = (taker(take, Nearby), world, poses, question, excluded_in(world, excluded))
    return with_names(world, self._stream_near_in_world, *given, block_rows)


@overload
def stream_near(
    self: Detector,
    take: Callable[[Nearby], Any],
    vertices: Any,
    faces: Any = None,
    *,
    block_rows: int = 1 << 18,
    radius: float | None = None,
    radii: Any = None,
    strict: bool = False,
    closest: bool = False,
    weld: bool = False,
    rings: int = 0,
    rest: Any = None,
    rest_radius: float = 0,
    groups: Any = None,
    edges: Any = None,
    points: Any = None,
    wanted: Wanted = "both",
    excluded_groups: GroupPairs | None = None,
) -> Statistics: ...


@overload
def stream_near(
    self: Detector,
    take: Callable[[Nearby], Any],
    world: World,
    /,
    *,
    block_rows: int = 1 << 18,
    radius: float | None = None,
    strict: bool = False,
    closest: bool = False,
    weld: bool = False,
    rings: int = 0,
    rest_radius: float = 0,
    bodies: Wanted = "both",
    groups: Wanted = "both",
    excluded: Any = None,
    excluded_groups: GroupPairs | None = None,
    poses: Any = None,
) -> Statistics: ...


@or_of_world(_near_in_world, 1)
def stream_near(
    self: Detector,
    take: Callable[[Nearby], Any],
    vertices: Any,
    faces: Any = None,
    *,
    block_rows: int = 1 << 18,
    radius: float | None = None,
    radii: Any = None,
    strict: bool = False,
    closest: bool = False,
    weld: bool = False,
    rings: int = 0,
    rest: Any = None,
    rest_radius: float = 0,
    groups: Any = None,
    edges: Any = None,
    points: Any = None,
    wanted: Wanted = "both",
    excluded_groups: GroupPairs | None = None,
) -> Statistics:
    """Hands all near pairs over in blocks: find_near as stream_impacts is find_impacts.

    `take` is called with one crumple.Nearby after the other. There is no `least`, and no `index`. Other arguments, also
    of worlds, errors, cost and memory as of these two.
    """
    rules = _core.rules_of_mesh(wanted, excluded_groups)
    radius = radius_of("stream_near", radius, radii is not None)
    question = _core.Near("pairs", radius, strict, closest, False, weld, rings, rest_radius, rules, False)
    mesh = listing_of(vertices, faces, groups, edges, points)
    give = taker(take, Nearby)
    return self._stream_near(give, mesh, question, radii, rest, (edges, points), block_rows)


def _candidates_in_world(
    self: Detector,
    take: Callable[[Candidates], Any],
    world: World,
    *,
    block_rows: int = 1 << 18,
    kinds: CandidateKind | Iterable[CandidateKind] = ("vertex_face", "edge_edge"),
    inflation: float = 0.0,
    weld: bool = False,
    bodies: Wanted = "both",
    groups: Wanted = "both",
    excluded: Any = None,
    excluded_groups: GroupPairs | None = None,
    poses: Any = None,
    end_poses: Any = None,
) -> Statistics:
    question = candidate_question(kinds, inflation, weld, _core.rules_of_world(bodies, groups, excluded_groups))
    poses = world.poses if poses is None else poses
    end_poses = world.end_poses if end_poses is None else end_poses
    given = (taker(take, Candidates), world, poses, end_poses, question, excluded_in(world, excluded))
    return with_names(world, self._stream_candidates_in_world, *given, block_rows)


@overload
def stream_candidates(
    self: Detector,
    take: Callable[[Candidates], Any],
    vertices: Any,
    faces: Any = None,
    *,
    end: Any = None,
    block_rows: int = 1 << 18,
    kinds: CandidateKind | Iterable[CandidateKind] = ("vertex_face", "edge_edge"),
    inflation: float = 0.0,
    weld: bool = False,
    groups: Any = None,
    edges: Any = None,
    points: Any = None,
    wanted: Wanted = "both",
    excluded_groups: GroupPairs | None = None,
) -> Statistics: ...


@overload
def stream_candidates(
    self: Detector,
    take: Callable[[Candidates], Any],
    world: World,
    /,
    *,
    block_rows: int = 1 << 18,
    kinds: CandidateKind | Iterable[CandidateKind] = ("vertex_face", "edge_edge"),
    inflation: float = 0.0,
    weld: bool = False,
    bodies: Wanted = "both",
    groups: Wanted = "both",
    excluded: Any = None,
    excluded_groups: GroupPairs | None = None,
    poses: Any = None,
    end_poses: Any = None,
) -> Statistics: ...


@or_of_world(_candidates_in_world, 1)
def stream_candidates(
    self: Detector,
    take: Callable[[Candidates], Any],
    vertices: Any,
    faces: Any = None,
    *,
    end: Any = None,
    block_rows: int = 1 << 18,
    kinds: CandidateKind | Iterable[CandidateKind] = ("vertex_face", "edge_edge"),
    inflation: float = 0.0,
    weld: bool = False,
    groups: Any = None,
    edges: Any = None,
    points: Any = None,
    wanted: Wanted = "both",
    excluded_groups: GroupPairs | None = None,
) -> Statistics:
    """Hands all candidates over in blocks: find_candidates as stream_impacts is find_impacts.

    `take` is called with one crumple.Candidates after the other. Other arguments, also of worlds, errors, cost and
    memory as of these two.
    """
    question = candidate_question(kinds, inflation, weld, _core.rules_of_mesh(wanted, excluded_groups))
    mesh = listing_of(vertices, faces, groups, edges, points)
    give = taker(take, Candidates)
    return self._stream_candidates(give, mesh, end, question, (edges, points), block_rows)
