"""Parts of a mesh that is asked about motion or nearness: how they are made, and how each is answered."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from . import _core
from ._impacts import Impacts
from ._mesh import listing_of
from ._names import suggesting

if TYPE_CHECKING:
    from ._detector import Detector, GroupPairs, Wanted
    from ._motion import MotionWants
    from ._near import Nearby, NearWants


@suggesting
def partition_motion(
    self: Detector,
    vertices: Any,
    end: Any,
    faces: Any = None,
    *,
    count: int,
    min_distance: float = 0.0,
    min_distance_share: float = 0.0,
    weld: bool = False,
    groups: Any = None,
    edges: Any = None,
    points: Any = None,
) -> list[_core.Part]:
    """Cuts a mesh in motion into `count` (1 to 262144) overlapping, independent parts.

    Each part is answered by find_impacts(part), anywhere and without the mesh. The answers together have the rows of
    the whole answer, with its ids; no row is in two of them. Parts can be pickled, and depend only on the arguments.
    A part answers for what it was made: a minimum distance that is no larger, the same `weld`. Groups come along; which of
    them are wanted is asked of each part. Arguments and errors otherwise as of find_impacts.

    Cost: a look at each triangle, and copies; a part is about twice as large as one of `partition`. Source:
    Mainzer and Zachmann, sec. 1.1, for parts on several machines, and sec. 4, eqs. 2-4, for their centres.
    """
    rules = _core.rules_of_mesh("both", None)
    question = _core.Motion("impacts", min_distance, min_distance_share, weld, rules, False, False)
    mesh = listing_of(vertices, faces, groups, edges, points)
    return self._partition_motion(mesh, end, question, count, (edges, points))


@suggesting
def partition_near(
    self: Detector,
    vertices: Any,
    faces: Any = None,
    *,
    count: int,
    radius: float | None = None,
    radii: Any = None,
    weld: bool = False,
    rings: int = 0,
    rest: Any = None,
    groups: Any = None,
    edges: Any = None,
    points: Any = None,
) -> list[_core.Part]:
    """Cuts a mesh at rest into `count` (1 to 262144) overlapping, independent parts, as partition_motion does.

    Each part is answered by find_near(part, radius=r) for radii up to this one, or by find_near(part) if it was made
    with `radii`. It brings along what it was made with: radii, where the vertices are at rest, and neighbours up to
    `rings` edges away. Arguments and errors otherwise as of find_near.
    """
    from ._near import radius_of

    rules = _core.rules_of_mesh("both", None)
    radius = radius_of("partition_near", radius, radii is not None)
    question = _core.Near("pairs", radius, False, False, False, weld, rings, 0.0, rules, False)
    mesh = listing_of(vertices, faces, groups, edges, points)
    return self._partition_near(mesh, question, radii, rest, count, (edges, points))


def impacts_in_part(
    self: Detector,
    part: _core.Part,
    *,
    wants: MotionWants = "impacts",
    min_distance: float = 0.0,
    min_distance_share: float = 0.0,
    weld: bool = False,
    wanted: Wanted = "both",
    excluded_groups: GroupPairs | None = None,
    index: bool = False,
    copy: bool = False,
) -> Impacts:
    rules = _core.rules_of_mesh(wanted, excluded_groups)
    question = _core.Motion(wants, min_distance, min_distance_share, weld, rules, index, False)
    return Impacts(self._find_impacts_in_part(part, question, copy))


def near_in_part(
    self: Detector,
    part: _core.Part,
    *,
    radius: float | None = None,
    wants: NearWants = "pairs",
    strict: bool = False,
    closest: bool = False,
    least: bool = False,
    weld: bool = False,
    rings: int = 0,
    rest_radius: float = 0,
    wanted: Wanted = "both",
    excluded_groups: GroupPairs | None = None,
    index: bool = False,
    copy: bool = False,
) -> Nearby:
    from ._near import Nearby, radius_of

    rules = _core.rules_of_mesh(wanted, excluded_groups)
    radius = radius_of("find_near", radius, part.has_radii)
    question = _core.Near(wants, radius, strict, closest, least, weld, rings, rest_radius, rules, index)
    return Nearby(self._find_near_in_part(part, question, copy))


partition_motion.__qualname__ = "Detector.partition_motion"
partition_near.__qualname__ = "Detector.partition_near"
