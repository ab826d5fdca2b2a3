"""Detector.find_impacts and its short forms, of one mesh and of worlds."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Literal, overload

from . import _core
from ._errors import InvalidType
from ._feature_question import or_of_world
from ._impacts import FreeStep, Impacts
from ._mesh import listing_of
from ._names import suggesting
from ._parts import impacts_in_part
from ._world import World
from ._world_search import excluded_in, with_names

if TYPE_CHECKING:
    from ._detector import Detector, GroupPairs, Wanted

MotionWants = Literal["any", "any_by_world", "earliest", "impacts"]


def _impacts_in_world(
    self: Detector,
    world: World,
    *,
    wants: MotionWants = "impacts",
    min_distance: float = 0.0,
    min_distance_share: float = 0.0,
    weld: bool = False,
    bodies: Wanted = "both",
    groups: Wanted = "both",
    excluded: Any = None,
    excluded_groups: GroupPairs | None = None,
    poses: Any = None,
    end_poses: Any = None,
    triangle_pairs: bool = False,
    copy: bool = False,
) -> Impacts:
    rules = _core.rules_of_world(bodies, groups, excluded_groups)
    question = _core.Motion(wants, min_distance, min_distance_share, weld, rules, False, triangle_pairs)
    poses = world.poses if poses is None else poses
    end_poses = world.end_poses if end_poses is None else end_poses
    excluded = excluded_in(world, excluded)
    return Impacts(with_names(world, self._find_impacts_in_world, world, poses, end_poses, question, excluded, copy))


@overload
def find_impacts(
    self: Detector,
    vertices: Any,
    end: Any,
    faces: Any = None,
    *,
    wants: MotionWants = "impacts",
    min_distance: float = 0.0,
    min_distance_share: float = 0.0,
    weld: bool = False,
    groups: Any = None,
    edges: Any = None,
    points: Any = None,
    wanted: Wanted = "both",
    excluded_groups: GroupPairs | None = None,
    index: bool = False,
    triangle_pairs: bool = False,
    copy: bool = False,
) -> Impacts: ...


@overload
def find_impacts(
    self: Detector,
    world: World,
    /,
    *,
    wants: MotionWants = "impacts",
    min_distance: float = 0.0,
    min_distance_share: float = 0.0,
    weld: bool = False,
    bodies: Wanted = "both",
    groups: Wanted = "both",
    excluded: Any = None,
    excluded_groups: GroupPairs | None = None,
    poses: Any = None,
    end_poses: Any = None,
    triangle_pairs: bool = False,
    copy: bool = False,
) -> Impacts: ...


@overload
def find_impacts(
    self: Detector,
    part: _core.Part,
    /,
    *,
    wants: MotionWants = "impacts",
    min_distance: float = 0.0,
    min_distance_share: float = 0.0,
    weld: bool = False,
    wanted: Wanted = "both",
    excluded_groups: GroupPairs | None = None,
    index: bool = False,
    copy: bool = False,
) -> Impacts: ...


@or_of_world(_impacts_in_world, of_part=impacts_in_part)
def find_impacts(
    self: Detector,
    vertices: Any,
    end: Any,
    faces: Any = None,
    *,
    wants: MotionWants = "impacts",
    min_distance: float = 0.0,
    min_distance_share: float = 0.0,
    weld: bool = False,
    groups: Any = None,
    edges: Any = None,
    points: Any = None,
    wanted: Wanted = "both",
    excluded_groups: GroupPairs | None = None,
    index: bool = False,
    triangle_pairs: bool = False,
    copy: bool = False,
) -> Impacts:
    """What touches what while every vertex goes straight from where it is to `end`, and when: exactly.

    Of one mesh: find_impacts(vertices, end, faces), or find_impacts(mesh, end). An impact is a vertex and a face that
    does not name it, or two edges without a common vertex, that have a point in common at some time in [0, 1], closed
    and degenerate ones included. What runs through a face without touching vertex or edge is none: an intersection.

    Args:
        vertices: (n, 3) float32 or float64, at the start; or a mesh, and then no `faces`. All arrays on the host, or
            all in CUDA memory, where the cuda backend reads them.
        end: (n, 3): where they are at the end. If one of both is float64, all is computed in float64.
        faces: (m, 3) integers, or flat: three a triangle.
        wants: how much is made; all but the last end as soon as they may. "any": whether anything touches;
            "any_by_world": in which worlds; "earliest": the first impact; "impacts": all of them.
        min_distance: features touch where their distance is at most this, in the units of the coordinates.
        min_distance_share: or at most this share, in [0, 1), of the pair's own distance at the start, if that is more.
        weld: vertices at equal positions at the start and at the end count as one: their features are neighbours.
        groups: (m,) integers that fit int32, one a triangle; a vertex or edge is in the group of its lowest triangle.
        wanted: which pairs, by their groups: "both", "between" different groups, "within" one.
        excluded_groups: pairs of groups that are not tested against each other: an array or any iterable.
        edges: (k, 2) integers: what is meant by edges, instead of those of the faces. Rows name them by their place.
        points: (k,) indices of vertices: what is meant by vertices, instead of those that a face or an edge names. Rows
            name them by their place. With either, `faces` may be left out: rods, hair, particles.
        index: also make offsets by vertex, face and edge, where impacts are wanted.
        triangle_pairs: also find pairs of triangles that intersect at the start, and those of whose features some pair
            is an impact; `any` and `world_hit` count them, `first` stays that of features.
        copy: the answer gets writable arrays of its own instead of read-only views.

    Of a world (crumple.World): find_impacts(world). Shapes tell by `end`, bodies by `end_poses`, where they go.
        bodies, groups: which pairs, by their bodies and by their groups: "both", "between", "within".
        excluded, excluded_groups: pairs of bodies and of groups, as Detector.find has them.
        poses, end_poses: instead of those of the world, for this call.

    Of a part (crumple.Part, see partition_motion): find_impacts(part) has the rows that the part owns, with the ids of
    the mesh. Its edges and points are those of the whole; offsets count by position in the part.

    Raises InvalidInput, which names the argument and the place; MemoryLimit.
    What an impact is: docs/motion.md.
    """
    rules = _core.rules_of_mesh(wanted, excluded_groups)
    question = _core.Motion(wants, min_distance, min_distance_share, weld, rules, index, triangle_pairs)
    mesh = listing_of(vertices, faces, groups, edges, points)
    return Impacts(self._find_impacts(mesh, end, question, copy, (edges, points)))


def _first_in_world(self: Detector, world: World, **question: Any) -> float | None:
    first = find_impacts(self, world, wants="earliest", **question).first
    return None if first is None else first.toi


@overload
def time_of_first_impact(
    self: Detector,
    vertices: Any,
    end: Any,
    faces: Any = None,
    *,
    min_distance: float = 0.0,
    min_distance_share: float = 0.0,
    weld: bool = False,
    groups: Any = None,
    edges: Any = None,
    points: Any = None,
    wanted: Wanted = "both",
    excluded_groups: GroupPairs | None = None,
) -> float | None: ...


@overload
def time_of_first_impact(
    self: Detector,
    world: World,
    /,
    *,
    min_distance: float = 0.0,
    min_distance_share: float = 0.0,
    weld: bool = False,
    bodies: Wanted = "both",
    groups: Wanted = "both",
    excluded: Any = None,
    excluded_groups: GroupPairs | None = None,
    poses: Any = None,
    end_poses: Any = None,
) -> float | None: ...


@or_of_world(_first_in_world, of_part=_first_in_world)
def time_of_first_impact(
    self: Detector,
    vertices: Any,
    end: Any,
    faces: Any = None,
    *,
    min_distance: float = 0.0,
    min_distance_share: float = 0.0,
    weld: bool = False,
    groups: Any = None,
    edges: Any = None,
    points: Any = None,
    wanted: Wanted = "both",
    excluded_groups: GroupPairs | None = None,
) -> float | None:
    """When anything first touches on its way, in [0, 1] and rounded down; None: nothing does, and the step is free.

    Arguments, also of worlds, and errors as of find_impacts, whose answer to wants="earliest" has it all: `first` tells
    which pair it is and whether it touches at the start, `world_first` the same of each world.
    """
    first = find_impacts(
        self,
        vertices,
        end,
        faces,
        wants="earliest",
        min_distance=min_distance,
        min_distance_share=min_distance_share,
        weld=weld,
        groups=groups,
        edges=edges,
        points=points,
        wanted=wanted,
        excluded_groups=excluded_groups,
    ).first
    return None if first is None else first.toi


def _free_in_world(self: Detector, world: World, **question: Any) -> bool:
    return not find_impacts(self, world, wants="any", **question).any


@overload
def is_free(
    self: Detector,
    vertices: Any,
    end: Any,
    faces: Any = None,
    *,
    min_distance: float = 0.0,
    min_distance_share: float = 0.0,
    weld: bool = False,
    groups: Any = None,
    edges: Any = None,
    points: Any = None,
    wanted: Wanted = "both",
    excluded_groups: GroupPairs | None = None,
    triangle_pairs: bool = False,
) -> bool: ...


@overload
def is_free(
    self: Detector,
    world: World,
    /,
    *,
    min_distance: float = 0.0,
    min_distance_share: float = 0.0,
    weld: bool = False,
    bodies: Wanted = "both",
    groups: Wanted = "both",
    excluded: Any = None,
    excluded_groups: GroupPairs | None = None,
    poses: Any = None,
    end_poses: Any = None,
    triangle_pairs: bool = False,
) -> bool: ...


@or_of_world(_free_in_world, of_part=_free_in_world)
def is_free(
    self: Detector,
    vertices: Any,
    end: Any,
    faces: Any = None,
    *,
    min_distance: float = 0.0,
    min_distance_share: float = 0.0,
    weld: bool = False,
    groups: Any = None,
    edges: Any = None,
    points: Any = None,
    wanted: Wanted = "both",
    excluded_groups: GroupPairs | None = None,
    triangle_pairs: bool = False,
) -> bool:
    """Whether nothing touches from the start to the end, both included; stops at the first impact found.

    Arguments, also of worlds, and errors as of find_impacts. What intersects from start to end without touching
    is free in this sense, unless `triangle_pairs` asks for that, too.
    """
    return not find_impacts(
        self,
        vertices,
        end,
        faces,
        wants="any",
        min_distance=min_distance,
        min_distance_share=min_distance_share,
        weld=weld,
        groups=groups,
        edges=edges,
        points=points,
        wanted=wanted,
        excluded_groups=excluded_groups,
        triangle_pairs=triangle_pairs,
    ).any


def find_free_step(
    self: Detector,
    vertices: Any,
    end: Any,
    faces: Any = None,
    *,
    min_distance: float = 0.0,
    min_distance_share: float = 0.0,
    weld: bool = False,
    groups: Any = None,
    edges: Any = None,
    points: Any = None,
    wanted: Wanted = "both",
    excluded_groups: GroupPairs | None = None,
    triangle_pairs: bool = False,
) -> FreeStep:
    """A share of the step, and positions there, for which is_free holds as they are rounded.

    vertices + toi * (end - vertices), computed in floating point, is another motion than the one whose toi that is. The
    share is somewhat less than the first time of contact, by 2**-16 of it if that does; 0 where contact is at the start
    or too near. With `min_distance` features keep that distance, with `triangle_pairs` the share is 0 where triangles
    intersect at the start. Of one mesh; arguments and errors as of find_impacts.

    Cost: two or three calls of is_free.
    """
    if isinstance(vertices, World):
        raise InvalidType("find_free_step takes a mesh, not a crumple.World")
    rules = _core.rules_of_mesh(wanted, excluded_groups)
    question = _core.Motion("any", min_distance, min_distance_share, weld, rules, False, triangle_pairs)
    mesh = listing_of(vertices, faces, groups, edges, points)
    return FreeStep(*self._find_free_step(mesh, end, question, (edges, points)))


find_free_step.__qualname__ = "Detector.find_free_step"
find_free_step = suggesting(find_free_step)
