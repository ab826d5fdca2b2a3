"""Detector.find_near, of one mesh and of worlds, and its answer."""

from __future__ import annotations

from enum import IntEnum
from functools import cached_property
from typing import TYPE_CHECKING, Any, ClassVar, Literal, overload

from . import _core
from ._errors import InvalidInput, InvalidType
from ._feature_question import or_of_world
from ._feature_result import FeatureResult
from ._mesh import listing_of
from ._parts import near_in_part
from ._world_search import excluded_in, with_names

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from ._detector import Detector, GroupPairs, Wanted
    from ._world import World

NearWants = Literal["any", "any_by_world", "pairs"]


class VertexFaceType(IntEnum):
    """Which part of a face is closest to a vertex: of lowest dimension, then first in this order.

    E0 is the side from the face's first corner to the second, E1 from there to the third, E2 back: IPC Toolkit's names.
    """

    P_T0 = 0
    P_T1 = 1
    P_T2 = 2
    P_E0 = 3
    P_E1 = 4
    P_E2 = 5
    P_T = 6


class EdgeEdgeType(IntEnum):
    """Which parts of two edges are closest: of lowest dimension, then first in this order.

    EA and EB are the edges, EA0 is the first vertex of EA in `edges`: IPC Toolkit's names.
    """

    EA0_EB0 = 0
    EA0_EB1 = 1
    EA1_EB0 = 2
    EA1_EB1 = 3
    EA_EB0 = 4
    EA_EB1 = 5
    EA0_EB = 6
    EA1_EB = 7
    EA_EB = 8


class VertexEdgeType(IntEnum):
    """Which part of an edge is closest to a vertex: its first vertex in `edges`, its second one, or the edge."""

    P_E0 = 0
    P_E1 = 1
    P_E = 2


class VertexVertexType(IntEnum):
    """Which parts of two vertices are closest: there is one answer."""

    P_P = 0


_KINDS = ("vertex_face", "edge_edge", "vertex_edge", "vertex_vertex")
_CLOSEST = tuple(f"{kind}_{what}" for kind in _KINDS for what in ("type", "at"))
_LEAST = ("vertex_distance", "face_distance", "edge_distance")


class Nearby(FeatureResult):
    """What is near what, and how near, as much as `wants` asked for: the same bytes wherever it is computed.

    Two lists, of vertices with faces and of edges with edges, sorted and unique; of worlds by body before vertex, face
    or edge. A squared distance is the exact one, rounded to the nearest float64: infinite beyond the largest.

    An answer is true if anything is near; `len(nearby)` is the number of pairs. All else, lifetimes, copies and pickles
    included, as of Impacts.
    """

    _find = "find_near"
    _write = staticmethod(_core.write_near)
    _wants = ("any", "any_by_world", "pairs")
    _from: ClassVar = {"world_hit": 1}

    @cached_property
    def vertex_face_squared_distance(self) -> NDArray[np.float64]:
        """(k,) float64: the squared distance of vertex and face."""
        return self._array("vertex_face_squared_distance")

    @cached_property
    def vertex_face_touching(self) -> NDArray[np.bool_]:
        """(k,) bool: whether their distance is 0 exactly. A squared distance may also be rounded to 0."""
        return self._array("vertex_face_touching")

    @cached_property
    def edge_edge_squared_distance(self) -> NDArray[np.float64]:
        """(k,) float64: the squared distance of the two edges."""
        return self._array("edge_edge_squared_distance")

    @cached_property
    def edge_edge_touching(self) -> NDArray[np.bool_]:
        """(k,) bool: whether their distance is 0 exactly."""
        return self._array("edge_edge_touching")

    def _array(self, name: str) -> Any:
        answer = self._answer
        if name in _LEAST and answer.of_world:
            raise InvalidInput(f"{name} is made for one mesh alone, but this was asked of a world")
        for option, names in (("closest", _CLOSEST), ("least", _LEAST)):
            if name in names and not getattr(answer, f"has_{option}"):
                self._check_wanted(name)
                raise InvalidInput(f"{name} was not asked for: find_near(..., {option}=True)")
        return super()._array(name)

    @cached_property
    def vertex_face_type(self) -> NDArray[np.uint8]:
        """(k,) uint8, with `closest`: a VertexFaceType each."""
        return self._array("vertex_face_type")

    @cached_property
    def vertex_face_at(self) -> NDArray[np.float64]:
        """(k, 2), with `closest`: (u, v) of the face's point a + u (b - a) + v (c - a) that is closest, rounded."""
        return self._array("vertex_face_at")

    @cached_property
    def edge_edge_type(self) -> NDArray[np.uint8]:
        """(k,) uint8, with `closest`: an EdgeEdgeType each."""
        return self._array("edge_edge_type")

    @cached_property
    def edge_edge_at(self) -> NDArray[np.float64]:
        """(k, 2), with `closest`: (s, t) of the edges' points a + s (b - a) and c + t (d - c), rounded."""
        return self._array("edge_edge_at")

    @cached_property
    def vertex_edge_squared_distance(self) -> NDArray[np.float64]:
        """(k,) float64: the squared distance of vertex and edge."""
        return self._array("vertex_edge_squared_distance")

    @cached_property
    def vertex_edge_touching(self) -> NDArray[np.bool_]:
        """(k,) bool: whether their distance is 0 exactly."""
        return self._array("vertex_edge_touching")

    @cached_property
    def vertex_vertex_squared_distance(self) -> NDArray[np.float64]:
        """(k,) float64: the squared distance of the two vertices."""
        return self._array("vertex_vertex_squared_distance")

    @cached_property
    def vertex_vertex_touching(self) -> NDArray[np.bool_]:
        """(k,) bool: whether their distance is 0 exactly."""
        return self._array("vertex_vertex_touching")

    @cached_property
    def vertex_edge_type(self) -> NDArray[np.uint8]:
        """(k,) uint8, with `closest`: a VertexEdgeType each."""
        return self._array("vertex_edge_type")

    @cached_property
    def vertex_edge_at(self) -> NDArray[np.float64]:
        """(k, 2), with `closest`: (s, 0) of the edge's point a + s (b - a), rounded."""
        return self._array("vertex_edge_at")

    @cached_property
    def vertex_vertex_type(self) -> NDArray[np.uint8]:
        """(k,) uint8, with `closest`: a VertexVertexType each, 0."""
        return self._array("vertex_vertex_type")

    @cached_property
    def vertex_vertex_at(self) -> NDArray[np.float64]:
        """(k, 2), with `closest`: zeros."""
        return self._array("vertex_vertex_at")

    @cached_property
    def vertex_distance(self) -> NDArray[np.float64]:
        """(vertices,), with `least`: each one's least distance, over the pairs listed; rounded down; or infinite.

        Of listed points in their order.
        """
        return self._array("vertex_distance")

    @cached_property
    def face_distance(self) -> NDArray[np.float64]:
        """(faces,), with `least`: the same of each face."""
        return self._array("face_distance")

    @cached_property
    def edge_distance(self) -> NDArray[np.float64]:
        """(n,), with `least`: the same of each of `edges`."""
        return self._array("edge_distance")

    def __repr__(self) -> str:
        found = "pairs" if self._answer.count != 1 else "pair"
        if self._answer.wants != "pairs":
            found = "something is near" if self._answer.any else "nothing is near"
        return self._told(found)


def radius_of(search: str, radius: float | None, radii: bool) -> float:
    """The radius as given, or 0 beside radii of vertices."""
    if radius is None:
        if not radii:
            raise InvalidType(f"{search} needs a radius, or radii of the vertices")
        return 0.0
    if radii:
        raise InvalidInput("radius is not asked for beside radii")
    return radius


def _near_in_world(
    self: Detector,
    world: World,
    *,
    radius: float | None = None,
    wants: NearWants = "pairs",
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
    copy: bool = False,
) -> Nearby:
    rules = _core.rules_of_world(bodies, groups, excluded_groups)
    radius = radius_of("find_near", radius, any(shape.radii is not None for shape in world.shapes))
    question = _core.Near(wants, radius, strict, closest, False, weld, rings, rest_radius, rules, False)
    poses = world.poses if poses is None else poses
    excluded = excluded_in(world, excluded)
    return Nearby(with_names(world, self._find_near_in_world, world, poses, question, excluded, copy))


@overload
def find_near(
    self: Detector,
    vertices: Any,
    faces: Any = None,
    *,
    radius: float | None = None,
    radii: Any = None,
    wants: NearWants = "pairs",
    strict: bool = False,
    closest: bool = False,
    least: bool = False,
    weld: bool = False,
    rings: int = 0,
    rest: Any = None,
    rest_radius: float = 0,
    groups: Any = None,
    edges: Any = None,
    points: Any = None,
    wanted: Wanted = "both",
    excluded_groups: GroupPairs | None = None,
    index: bool = False,
    copy: bool = False,
) -> Nearby: ...


@overload
def find_near(
    self: Detector,
    world: World,
    /,
    *,
    radius: float | None = None,
    wants: NearWants = "pairs",
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
    copy: bool = False,
) -> Nearby: ...


@overload
def find_near(
    self: Detector,
    part: _core.Part,
    /,
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
) -> Nearby: ...


@or_of_world(_near_in_world, of_part=near_in_part)
def find_near(
    self: Detector,
    vertices: Any,
    faces: Any = None,
    *,
    radius: float | None = None,
    radii: Any = None,
    wants: NearWants = "pairs",
    strict: bool = False,
    closest: bool = False,
    least: bool = False,
    weld: bool = False,
    rings: int = 0,
    rest: Any = None,
    rest_radius: float = 0,
    groups: Any = None,
    edges: Any = None,
    points: Any = None,
    wanted: Wanted = "both",
    excluded_groups: GroupPairs | None = None,
    index: bool = False,
    copy: bool = False,
) -> Nearby:
    """What is near what: all pairs of features whose distance is at most `radius`, and their distances, exactly.

    Of one mesh: find_near(vertices, faces, radius=r), or find_near(mesh, radius=r). Features are a vertex and a face
    that does not name it, or two edges without a common vertex. Two triangles that run through each other need not have
    features that are near.

    Args:
        vertices: (n, 3) float32 or float64; or a mesh, and then no `faces`. All arrays on the host, or
            all in CUDA memory, where the cuda backend reads them.
        faces: (m, 3) integers, or flat: three a triangle.
        radius: Euclidean, 0 or more, in the units of the coordinates.
        radii: (n,) float64 or float32, instead of `radius`: one a vertex, such as half the thickness of a cloth. An
            edge or a face has the largest of its vertices'; features are near whose distance is at most the sum of
            both, in real numbers.
        wants: how much is made; the first two end as soon as they may. "any": whether anything is near;
            "any_by_world": in which worlds; "pairs": all pairs.
        strict: distances less than the radius, or the sum of radii, not equal to it.
        closest: also tell where the features of each pair are closest.
        least: also tell the least distance of each vertex, face and edge. Pairs that `rings` or `rest` leave out do not
            count, so that with these it is no bound for a step.
        weld: vertices at equal positions count as one: their features are neighbours.
        rings: neighbours, which are never near, are also those from one of whose vertices at most so many edges lead
            to one of the other's: Newton's topological filter. Kept while the edges stay the same.
        rest: (n, 3) float32 or float64: where the vertices are at rest.
        rest_radius: features whose distance at rest is at most this are not near.
        groups, edges, points, wanted, excluded_groups, index, copy: as find_impacts has them.

    Of a world (crumple.World): find_near(world, radius=r), as it is at the start of a step.
        bodies, groups, excluded, excluded_groups, poses: as find_impacts has them. There is no `least`, and no `index`.
        Radii and vertices at rest are those of its shapes; what is close at rest is within a body.

    Raises InvalidInput, which names the argument and the place; MemoryLimit.
    What nearness is: docs/nearness.md.
    """
    rules = _core.rules_of_mesh(wanted, excluded_groups)
    radius = radius_of("find_near", radius, radii is not None)
    question = _core.Near(wants, radius, strict, closest, least, weld, rings, rest_radius, rules, index)
    mesh = listing_of(vertices, faces, groups, edges, points)
    return Nearby(self._find_near(mesh, question, radii, rest, copy, (edges, points)))
