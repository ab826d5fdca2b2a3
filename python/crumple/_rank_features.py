"""Motion and nearness on ranks of MPI: crumple.mpi.Detector.find_impacts, its short forms, and find_near."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Literal

from . import _core
from ._errors import InvalidInput
from ._near import radius_of
from ._rank_results import Impacts, Nearby

if TYPE_CHECKING:
    from ._detector import GroupPairs, Wanted
    from .mpi import Detector


def _check_wants(wants: Any) -> None:
    if wants == "any_by_world":
        raise InvalidInput('wants="any_by_world" is asked of a world, and ranks share one mesh')


def find_impacts(
    self: Detector,
    vertices: Any,
    end: Any,
    faces: Any = None,
    groups: Any = None,
    *,
    triangle_ids: Any = None,
    vertex_ids: Any = None,
    wants: Literal["any", "earliest", "impacts"] = "impacts",
    min_distance: float = 0.0,
    min_distance_share: float = 0.0,
    weld: bool = False,
    wanted: Wanted = "both",
    excluded_groups: GroupPairs | None = None,
) -> Impacts:
    """What touches what while every vertex goes straight from where it is to `end`, and when: exactly. Collective.

    Args:
        vertices, faces, groups, triangle_ids, vertex_ids: what this rank brings, at the start; as of find_self.
        end: (n, 3) float32 or float64: where this rank's vertices are at the end; copies of a vertex are equal there,
            too. Or find_impacts(mesh, end).
        wants: how much is made: "any", whether anything touches; "earliest", the first impact; "impacts", all of them.
            For the first two no rows travel.
        min_distance, min_distance_share, weld, wanted, excluded_groups: the question, as of crumple.Detector.find_impacts,
            and the same on all ranks. Pairs of triangles, listed edges and points, and offsets are for one process.

    Of bodies: find_impacts(world), with a crumple.World of this rank's and poses at the end of the step; body_ids,
        bodies, groups, excluded, excluded_groups, poses: as `find` has them; end_poses: instead of world.end_poses.

    Returns crumple.mpi.Impacts: each impact on one rank, the one whose triangle owns its first feature. Parts of the
    scene are made for one question: another minimum distance, or a question of another kind, begins them anew.

    Raises InvalidInput, which names the argument and the place, and MemoryLimit, on all ranks; see Detector.
    Cost: see Detector. What an impact is: docs/motion.md.
    """

    def question() -> Any:
        _check_wants(wants)
        rules = _core.rules_of_mesh(wanted, excluded_groups)
        return _core.Motion(wants, min_distance, min_distance_share, weld, rules, False, False)

    return Impacts(self._ask("find_impacts", (vertices, faces, groups, triangle_ids, vertex_ids), question, end=(end,)))


def time_of_first_impact(
    self: Detector,
    vertices: Any,
    end: Any,
    faces: Any = None,
    groups: Any = None,
    *,
    triangle_ids: Any = None,
    vertex_ids: Any = None,
    min_distance: float = 0.0,
    min_distance_share: float = 0.0,
    weld: bool = False,
    wanted: Wanted = "both",
    excluded_groups: GroupPairs | None = None,
) -> float | None:
    """When anything first touches, on any rank, in [0, 1] and rounded down; None: nothing does. Collective.

    Arguments and errors as of find_impacts, whose answer to wants="earliest" tells also which pair it is.
    """
    first = find_impacts(
        self,
        vertices,
        end,
        faces,
        groups,
        triangle_ids=triangle_ids,
        vertex_ids=vertex_ids,
        wants="earliest",
        min_distance=min_distance,
        min_distance_share=min_distance_share,
        weld=weld,
        wanted=wanted,
        excluded_groups=excluded_groups,
    ).first
    return None if first is None else first.toi


def is_free(
    self: Detector,
    vertices: Any,
    end: Any,
    faces: Any = None,
    groups: Any = None,
    *,
    triangle_ids: Any = None,
    vertex_ids: Any = None,
    min_distance: float = 0.0,
    min_distance_share: float = 0.0,
    weld: bool = False,
    wanted: Wanted = "both",
    excluded_groups: GroupPairs | None = None,
) -> bool:
    """Whether nothing touches from the start to the end, on any rank. Collective.

    Each rank stops at the first impact that it finds. Arguments and errors as of find_impacts.
    """
    return not find_impacts(
        self,
        vertices,
        end,
        faces,
        groups,
        triangle_ids=triangle_ids,
        vertex_ids=vertex_ids,
        wants="any",
        min_distance=min_distance,
        min_distance_share=min_distance_share,
        weld=weld,
        wanted=wanted,
        excluded_groups=excluded_groups,
    ).any


def find_near(
    self: Detector,
    vertices: Any,
    faces: Any = None,
    groups: Any = None,
    *,
    triangle_ids: Any = None,
    vertex_ids: Any = None,
    radius: float | None = None,
    wants: Literal["any", "pairs"] = "pairs",
    strict: bool = False,
    closest: bool = False,
    weld: bool = False,
    wanted: Wanted = "both",
    excluded_groups: GroupPairs | None = None,
) -> Nearby:
    """What is near what: pairs of features whose distance is at most `radius`, and their distances. Collective.

    Args:
        vertices, faces, groups, triangle_ids, vertex_ids: what this rank brings; as of find_self.
        radius: Euclidean, 0 or more, in the units of the coordinates.
        wants: "any": whether anything is near, for which no rows travel; "pairs": all pairs.
        strict, closest, weld, wanted, excluded_groups: as of crumple.Detector.find_near, and the same on all ranks.
            Radii of vertices, shapes at rest, rings, least distances, listed edges and points, and offsets are for one
            process.

    Of bodies: find_near(world, radius=r), as they are at the start of a step; body_ids, bodies, groups, excluded,
        excluded_groups, poses: as `find` has them.

    Returns crumple.mpi.Nearby: each pair on one rank, the one whose triangle owns its first feature. Raises
    InvalidInput, which names the argument and the place, and MemoryLimit, on all ranks; see Detector.
    Cost: see Detector. What nearness is: docs/nearness.md.
    """

    def question() -> Any:
        _check_wants(wants)
        rules = _core.rules_of_mesh(wanted, excluded_groups)
        distance = radius_of("find_near", radius, False)
        return _core.Near(wants, distance, strict, closest, False, weld, 0, 0, rules, False)

    return Nearby(self._ask("find_near", (vertices, faces, groups, triangle_ids, vertex_ids), question))


for _search in (find_impacts, time_of_first_impact, is_free, find_near):
    _search.__qualname__ = f"Detector.{_search.__name__}"
