"""Detector.find_impacts and its short forms, of one mesh and of worlds, and their answer."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING, Any, ClassVar, Literal, NamedTuple, overload

from . import _core
from ._errors import InvalidType
from ._feature_question import or_of_world
from ._feature_result import FeatureResult
from ._mesh import listing_of
from ._names import suggesting
from ._world import World
from ._world_search import excluded_in, with_names

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from ._detector import Detector, GroupPairs, Wanted

MotionWants = Literal["any", "any_by_world", "earliest", "impacts"]


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


def _impacts_in_world(
    self: Detector,
    world: World,
    *,
    wants: MotionWants = "impacts",
    separation: float = 0.0,
    separation_share: float = 0.0,
    weld: bool = False,
    bodies: Wanted = "both",
    groups: Wanted = "both",
    excluded: Any = None,
    excluded_groups: GroupPairs | None = None,
    poses: Any = None,
    end_poses: Any = None,
    copy: bool = False,
) -> Impacts:
    rules = _core.rules_of_world(bodies, groups, excluded_groups)
    question = _core.Motion(wants, separation, separation_share, weld, rules, False)
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
    separation: float = 0.0,
    separation_share: float = 0.0,
    weld: bool = False,
    groups: Any = None,
    edges: Any = None,
    points: Any = None,
    wanted: Wanted = "both",
    excluded_groups: GroupPairs | None = None,
    index: bool = False,
    copy: bool = False,
) -> Impacts: ...


@overload
def find_impacts(
    self: Detector,
    world: World,
    /,
    *,
    wants: MotionWants = "impacts",
    separation: float = 0.0,
    separation_share: float = 0.0,
    weld: bool = False,
    bodies: Wanted = "both",
    groups: Wanted = "both",
    excluded: Any = None,
    excluded_groups: GroupPairs | None = None,
    poses: Any = None,
    end_poses: Any = None,
    copy: bool = False,
) -> Impacts: ...


@or_of_world(_impacts_in_world)
def find_impacts(
    self: Detector,
    vertices: Any,
    end: Any,
    faces: Any = None,
    *,
    wants: MotionWants = "impacts",
    separation: float = 0.0,
    separation_share: float = 0.0,
    weld: bool = False,
    groups: Any = None,
    edges: Any = None,
    points: Any = None,
    wanted: Wanted = "both",
    excluded_groups: GroupPairs | None = None,
    index: bool = False,
    copy: bool = False,
) -> Impacts:
    """What touches what while every vertex goes straight from where it is to `end`, and when: exactly.

    Of one mesh: find_impacts(vertices, end, faces), or find_impacts(mesh, end). An impact is a vertex and a face that
    does not name it, or two edges without a common vertex, that have a point in common at some time in [0, 1], closed
    and degenerate ones included. What runs through a face without touching vertex or edge is none: an intersection.

    Args:
        vertices: (n, 3) float32 or float64, at the start; or a mesh, and then no `faces`. On the host.
        end: (n, 3): where they are at the end. If one of both is float64, all is computed in float64.
        faces: (m, 3) integers, or flat: three a triangle.
        wants: how much is made; all but the last end as soon as they may. "any": whether anything touches;
            "any_by_world": in which worlds; "earliest": the first impact; "impacts": all of them.
        separation: features touch where their distance is at most this, in the units of the coordinates.
        separation_share: or at most this share, in [0, 1), of the pair's own distance at the start, if that is more.
        weld: vertices at equal positions at the start and at the end count as one: their features are neighbours.
        groups: (m,) integers that fit int32, one a triangle; a vertex or edge is in the group of its lowest triangle.
        wanted: which pairs, by their groups: "both", "between" different groups, "within" one.
        excluded_groups: pairs of groups that are not tested against each other: an array or any iterable.
        edges: (k, 2) integers: what is meant by edges, instead of those of the faces. Rows name them by their place.
        points: (k,) indices of vertices: what is meant by vertices, instead of those that a face or an edge names. Rows
            name them by their place. With either, `faces` may be left out: rods, hair, particles.
        index: also make offsets by vertex, face and edge, where impacts are wanted.
        copy: the answer gets writable arrays of its own instead of read-only views.

    Of a world (crumple.World): find_impacts(world). Shapes tell by `end`, bodies by `end_poses`, where they go.
        bodies, groups: which pairs, by their bodies and by their groups: "both", "between", "within".
        excluded, excluded_groups: pairs of bodies and of groups, as Detector.find has them.
        poses, end_poses: instead of those of the world, for this call.

    Raises InvalidInput, which names the argument and the place; MemoryLimit; BackendUnavailable on a detector of the
    cuda backend. What an impact is: docs/motion.md.
    """
    rules = _core.rules_of_mesh(wanted, excluded_groups)
    question = _core.Motion(wants, separation, separation_share, weld, rules, index)
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
    separation: float = 0.0,
    separation_share: float = 0.0,
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
    separation: float = 0.0,
    separation_share: float = 0.0,
    weld: bool = False,
    bodies: Wanted = "both",
    groups: Wanted = "both",
    excluded: Any = None,
    excluded_groups: GroupPairs | None = None,
    poses: Any = None,
    end_poses: Any = None,
) -> float | None: ...


@or_of_world(_first_in_world)
def time_of_first_impact(
    self: Detector,
    vertices: Any,
    end: Any,
    faces: Any = None,
    *,
    separation: float = 0.0,
    separation_share: float = 0.0,
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
        separation=separation,
        separation_share=separation_share,
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
    separation: float = 0.0,
    separation_share: float = 0.0,
    weld: bool = False,
    groups: Any = None,
    edges: Any = None,
    points: Any = None,
    wanted: Wanted = "both",
    excluded_groups: GroupPairs | None = None,
) -> bool: ...


@overload
def is_free(
    self: Detector,
    world: World,
    /,
    *,
    separation: float = 0.0,
    separation_share: float = 0.0,
    weld: bool = False,
    bodies: Wanted = "both",
    groups: Wanted = "both",
    excluded: Any = None,
    excluded_groups: GroupPairs | None = None,
    poses: Any = None,
    end_poses: Any = None,
) -> bool: ...


@or_of_world(_free_in_world)
def is_free(
    self: Detector,
    vertices: Any,
    end: Any,
    faces: Any = None,
    *,
    separation: float = 0.0,
    separation_share: float = 0.0,
    weld: bool = False,
    groups: Any = None,
    edges: Any = None,
    points: Any = None,
    wanted: Wanted = "both",
    excluded_groups: GroupPairs | None = None,
) -> bool:
    """Whether nothing touches from the start to the end, both included; stops at the first impact found.

    Arguments, also of worlds, and errors as of find_impacts. What intersects from start to end without touching
    is free in this sense: see there.
    """
    return not find_impacts(
        self,
        vertices,
        end,
        faces,
        wants="any",
        separation=separation,
        separation_share=separation_share,
        weld=weld,
        groups=groups,
        edges=edges,
        points=points,
        wanted=wanted,
        excluded_groups=excluded_groups,
    ).any


def find_free_step(
    self: Detector,
    vertices: Any,
    end: Any,
    faces: Any = None,
    *,
    separation: float = 0.0,
    separation_share: float = 0.0,
    weld: bool = False,
    groups: Any = None,
    edges: Any = None,
    points: Any = None,
    wanted: Wanted = "both",
    excluded_groups: GroupPairs | None = None,
) -> FreeStep:
    """A share of the step, and positions there, for which is_free holds as they are rounded.

    vertices + toi * (end - vertices), computed in floating point, is another motion than the one whose toi that is. The
    share is somewhat less than the first time of contact, by 2**-16 of it if that does; 0 where contact is at the start
    or too near. With `separation` features keep that distance. Of one mesh; arguments and errors as of find_impacts.

    Cost: two or three calls of is_free.
    """
    if isinstance(vertices, World):
        raise InvalidType("find_free_step takes a mesh, not a crumple.World")
    rules = _core.rules_of_mesh(wanted, excluded_groups)
    question = _core.Motion("any", separation, separation_share, weld, rules, False)
    mesh = listing_of(vertices, faces, groups, edges, points)
    return FreeStep(*self._find_free_step(mesh, end, question, (edges, points)))


find_free_step.__qualname__ = "Detector.find_free_step"
find_free_step = suggesting(find_free_step)
