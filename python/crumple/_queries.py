"""Queries: the type says what is searched for, and gives the type of the result.

A query is declared here once. Its members are the keywords of the method of Detector that asks it, and what the
extension module reads (python/src/queries.cpp). FuzzyCMeans is an option of detectors.
"""

from __future__ import annotations

import functools
import inspect
import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass, fields
from difflib import get_close_matches
from typing import Any, ClassVar, Literal

from ._errors import Function, InvalidType

Scope = Literal["both", "between", "within"]
CandidateKind = Literal["vertex_face", "edge_edge", "edge_face", "face_face", "vertex_edge", "vertex_vertex"]


@dataclass(frozen=True, kw_only=True)
class PairFilter:
    """Which pairs a query is about.

    Args:
        bodies: pairs "between" bodies, "within" one, or "both"; "both" where the scene is no world.
        groups: the same for groups, which compare across bodies and meshes.
        excluded_bodies: pairs of bodies of a world that are not tested against each other, by name or index: an
            iterable of sets ({"arm", "hand"}; {"arm"}: the arm and itself) or pairs, or an array (k, 2) of integers.
        excluded_groups: the same for groups, by number: an array or any iterable of pairs.
    """

    bodies: Scope = "both"
    groups: Scope = "both"
    excluded_bodies: Any = None
    excluded_groups: Any = None

    _indices: ClassVar[Any] = None  # of an object: (columns of a world, excluded_bodies by its indices)

    def __post_init__(self) -> None:
        """Takes a constant copy of excluded pairs that are no array, so that their indices can be kept."""
        pairs = self.excluded_bodies
        if isinstance(pairs, Iterable) and not isinstance(pairs, (str, bytes)) and not hasattr(pairs, "dtype"):
            object.__setattr__(self, "excluded_bodies", tuple(map(_constant, pairs)))

    def __getstate__(self) -> dict[str, Any]:
        """The members: pickles and copies have nothing else."""
        return members_of(self)


def _constant(pair: Any) -> Any:
    if isinstance(pair, set):
        return frozenset(pair)
    return tuple(pair) if isinstance(pair, list) else pair


def members_of(value: Any) -> dict[str, Any]:
    return {field.name: getattr(value, field.name) for field in fields(value)}


class Query:
    """Base of all queries."""

    filter: PairFilter
    _call: ClassVar[str]  # the name of its calls, and of the method of Detector
    _deliveries: ClassVar[frozenset[str]] = frozenset({"find", "supports"})
    _methods: ClassVar[dict[str, str]]  # of the extension module's detector, by delivery
    _read: ClassVar[Any] = None  # of an object: the query as the extension module has read it
    _requests: ClassVar[Any] = None  # of an object: the requests of its results, by what they depend on

    def __init_subclass__(cls) -> None:
        cls._methods = {delivery: f"_{delivery}_{cls._call}" for delivery in cls._deliveries}

    def __getstate__(self) -> dict[str, Any]:
        """The members: pickles and copies have nothing else."""
        return members_of(self)


_OF_PAIRS = frozenset({"find", "supports", "any", "stream", "partition", "launch"})


@dataclass(frozen=True, kw_only=True)
class IntersectionQuery(Query):
    """Pairs of triangles that intersect -> Intersections.

    Args:
        output: how much is made; what is less than all pairs ends as soon as it is known. "any": whether anything
            intersects; "any_by_world": in which worlds; "body_pairs": which bodies; "count": how many pairs; "pairs":
            all of them; "contacts": and where each pair meets.
        neighbours: pairs that share a vertex. "geometric": they intersect only if they meet outside the hull of what
            they share (a fold counts, a hinge does not); "skip": never reported.
        kind: "all": touching counts; "proper": only if an edge strictly crosses an interior.
        weld: vertices at equal positions count as one, also those of different meshes and bodies.
        containment: a body inside another one counts in the outputs "any", "any_by_world" and "body_pairs", never as
            pairs of triangles; a body pair then says so (`Intersections.inside`). Two bodies count if their surfaces
            meet, or else if a component of one has a vertex at which the winding number of the other's surface is not
            0. Of worlds and two meshes, with `kind` "all", with the cpu and the reference backend.
        open: with `containment`, bodies whose surfaces are not closed are an "error" in pairs whose boxes overlap and
            whose surfaces do not meet, or nothing lies inside them, and Intersections.skipped names them ("skip").
        filter: which pairs.
        index: of worlds, also make offsets by world and by body, and hit flags; those of meshes are always there.

    What an intersection is: docs/contract.md. Source: D. Mainzer, G. Zachmann, "Collision Detection Based on Fuzzy
    Scene Subdivision", Algorithm 1.
    """

    output: Literal["any", "any_by_world", "body_pairs", "count", "pairs", "contacts"] = "pairs"
    neighbours: Literal["geometric", "skip"] = "geometric"
    kind: Literal["all", "proper"] = "all"
    weld: bool = False
    containment: bool = False
    open: Literal["error", "skip"] = "error"
    filter: PairFilter = PairFilter()
    index: bool = False

    _call: ClassVar[str] = "intersections"
    _deliveries: ClassVar[frozenset[str]] = _OF_PAIRS


@dataclass(frozen=True, kw_only=True)
class ImpactQuery(Query):
    """Features that touch while every vertex goes straight from the start of a step to its end, and when -> Impacts.

    An impact is a vertex and a face that does not name it, or two edges without a common vertex, that have a point in
    common at some time in [0, 1], closed and degenerate ones included. What runs through a face without touching vertex
    or edge is none: an intersection.

    Args:
        output: how much is made; all but the last end as soon as they may. "any": whether anything touches;
            "any_by_world": in which worlds; "first": the first impact; "pairs": all impacts.
        min_distance: features touch where their distance is at most this, in the units of the coordinates.
        min_distance_share: or at most this share, in [0, 1), of the pair's own distance at the start, if that is more.
        approaching_only: leave out features that touch at the start, by the minimum distance if there is one, and come
            no nearer than they start. If they do come nearer, `toi` is the last moment before that. Features at a
            distance of 0 cannot come nearer: they are left out wherever they go.
        weld: vertices at equal positions at the start and at the end count as one: their features are neighbours.
        filter: which pairs; a vertex or edge is in the group of its lowest triangle.
        index: of one mesh, also make offsets by vertex, face and edge.
        triangle_pairs: also find pairs of triangles that intersect at the start, and those of whose features some pair
            is an impact; `any` and `world_hit` count them, `first` stays that of features.

    What an impact is: docs/motion.md.
    """

    output: Literal["any", "any_by_world", "first", "pairs"] = "pairs"
    min_distance: float = 0.0
    min_distance_share: float = 0.0
    approaching_only: bool = False
    weld: bool = False
    filter: PairFilter = PairFilter()
    index: bool = False
    triangle_pairs: bool = False

    _call: ClassVar[str] = "impacts"
    _deliveries: ClassVar[frozenset[str]] = _OF_PAIRS


@dataclass(frozen=True, kw_only=True)
class FirstImpactQuery(Query):
    """The first impact of a step, of all worlds -> FirstImpact, or None.

    Args:
        min_distance, min_distance_share, approaching_only, weld, filter: as ImpactQuery has them.
    """

    min_distance: float = 0.0
    min_distance_share: float = 0.0
    approaching_only: bool = False
    weld: bool = False
    filter: PairFilter = PairFilter()

    _call: ClassVar[str] = "first_impact"


@dataclass(frozen=True, kw_only=True)
class FreeStepQuery(Query):
    """A share of a step, with positions, on the way to which nothing touches, as they are rounded -> FreeStep.

    vertices + toi * (end - vertices), computed in floating point, is another motion than the one whose toi that is.
    Where something touches, what `held` names stops short of the time of contact, by 2**-16 of it if that suffices; the
    share is 0 if they touch at the start, or too soon. All else goes on. Features that touch while they rest at the
    start hold their whole world there; with `approaching_only` they do not, and if they would come nearer, what `held`
    names stays at the start. Cost: one to three times that of a FirstImpactQuery; with held="bodies" and "vertices" that of all impacts for
    each round of a few.

    Args:
        held: what is held back where something touches: all of its "worlds" (a mesh is one), the two "bodies", or the
            "vertices" of the two features. All else goes on.
        min_distance, min_distance_share, approaching_only, weld, filter: as ImpactQuery has them.
        triangle_pairs: the share is 0 where triangles intersect at the start.
    """

    held: Literal["worlds", "bodies", "vertices"] = "worlds"
    min_distance: float = 0.0
    min_distance_share: float = 0.0
    approaching_only: bool = False
    weld: bool = False
    filter: PairFilter = PairFilter()
    triangle_pairs: bool = False

    _call: ClassVar[str] = "free_step"


@dataclass(frozen=True, kw_only=True)
class ProximityQuery(Query):
    """Features whose distance is at most a radius, and their distances -> Proximities.

    Features are a vertex and a face that does not name it, or two edges without a common vertex. Two triangles that run
    through each other need not have features that are near.

    Args:
        output: how much is made; the first two end as soon as they may. "any": whether anything is near;
            "any_by_world": in which worlds; "pairs": all pairs.
        radius: Euclidean, 0 or more, in the units of the coordinates.
        radii: (n,) float64 or float32, instead of `radius`: one a vertex, such as half the thickness of a cloth. An
            edge or a face has the largest of its vertices'; features are near whose distance is at most the sum of
            both, in real numbers. Of one mesh; shapes of a world have their own.
        strict: distances less than the radius, or the sum of radii, not equal to it.
        closest: also tell where the features of each pair are closest.
        least: also tell the least distance of each vertex, face and edge of one mesh. It counts pairs that `rings` or
            `rest` leave out of the lists, so that it can bound a step; with these it takes a second search.
        weld: vertices at equal positions count as one: their features are neighbours.
        rings: neighbours, which are never near, are also those from one of whose vertices at most so many edges lead
            to one of the other's: Newton's topological filter. Kept while the edges stay the same.
        rest: (n, 3) float32 or float64: where the vertices are at rest. Of one mesh; shapes of a world have their own.
        rest_radius: features whose distance at rest is at most this are not near.
        filter: which pairs; a vertex or edge is in the group of its lowest triangle.
        index: of one mesh, also make offsets by vertex, face and edge.

    A scene that moves is searched as it is at the start. What nearness is: docs/nearness.md.
    """

    output: Literal["any", "any_by_world", "pairs"] = "pairs"
    radius: float | None = None
    radii: Any = None
    strict: bool = False
    closest: bool = False
    least: bool = False
    weld: bool = False
    rings: int = 0
    rest: Any = None
    rest_radius: float = 0.0
    filter: PairFilter = PairFilter()
    index: bool = False

    _call: ClassVar[str] = "proximities"
    _deliveries: ClassVar[frozenset[str]] = _OF_PAIRS


@dataclass(frozen=True, kw_only=True)
class CandidateQuery(Query):
    """Features whose boxes overlap, for a narrow phase of one's own -> Candidates.

    A box has the axes of the coordinates and holds where the feature's vertices are at the start and, of a scene that
    moves, at the end. Two features are a candidate if they have no vertex in common and on every axis the gap between
    their boxes is at most twice `inflation`, in real numbers: it is a definition, so nothing is missed and nothing is
    more than that.

    Args:
        kinds: which lists are made, one name or several.
        inflation: by how much each box is grown on all sides, 0 or more, in the units of the coordinates.
        weld: vertices at equal positions at the start and at the end count as one, for "in common".
        filter: which pairs.

    More: docs/candidates.md.
    """

    kinds: CandidateKind | Iterable[CandidateKind] = ("vertex_face", "edge_edge")
    inflation: float = 0.0
    weld: bool = False
    filter: PairFilter = PairFilter()

    _call: ClassVar[str] = "candidates"
    _deliveries: ClassVar[frozenset[str]] = frozenset({"find", "supports", "stream", "launch"})


@dataclass(frozen=True, kw_only=True)
class DistanceQuery(Query):
    """Distances of the bodies of a world, each pair of them, and where they are closest -> Distances.

    Bodies are sets of triangles, not volumes: a body inside another one is as far from it as their surfaces. Shapes
    that are named are remembered; then a pair takes some microseconds to some ten.

    Args:
        output: "pairs": a row for each pair of bodies; "nearest": a row for each world, with its nearest pair of bodies,
            which costs less. Pairs among bodies that are in all worlds belong to no world then, and have no row.
        radius: only pairs of bodies at most so far apart are listed, exactly: 0 or more, or infinite.
        filter: which pairs of triangles count; those within a body never do.

    With the cpu and the reference backend. More: docs/nearest.md.
    """

    output: Literal["nearest", "pairs"] = "pairs"
    radius: float = math.inf
    filter: PairFilter = PairFilter()

    _call: ClassVar[str] = "distances"


@dataclass(frozen=True, kw_only=True)
class OverlapQuery(Query):
    """How much closed bodies of a world overlap, where, and which way out -> Overlaps.

    Surfaces are closed: each edge is named as often in one direction as in the other. Triangles are counter-clockwise
    seen from outside.

    Args:
        output: "any": whether any two bodies overlap; "any_by_world": in which worlds; "body_pairs": which bodies, and
            their relation; "pairs": all numbers.
        min_volume: only pairs of bodies whose overlap has at least this volume, in magnitude, as it is rounded.
        open: a body whose surface is not closed is an "error", which names an edge, or its pairs have no rows and
            Overlaps.skipped names it ("skip"); or they have a row where surfaces meet, with the relation UNDEFINED, and
            without numbers but for the contact area and curves ("curves").
        weld: vertices of a shape at equal positions are one, which closes seams, as of STL files.
        self_overlaps: also the overlap of each body with itself, whatever its self_collisions: rows (i, i), volumes of
            bodies, and whether they are solids. Always of a scene that is one mesh.
        gradient: also the derivatives of volumes by the vertices.
        curves: also the curves in which surfaces cross; not of a body with itself.
        windings: also winding numbers at the vertices.
        filter: which pairs of bodies.

    With the cpu and the reference backend. More: docs/overlap.md.
    """

    output: Literal["any", "any_by_world", "body_pairs", "pairs"] = "pairs"
    min_volume: float = 0.0
    open: Literal["error", "skip", "curves"] = "error"
    weld: bool = False
    self_overlaps: bool = False
    gradient: bool = False
    curves: bool = False
    windings: bool = False
    filter: PairFilter = PairFilter()

    _call: ClassVar[str] = "overlaps"
    _deliveries: ClassVar[frozenset[str]] = frozenset({"find", "supports", "any"})


_PLAIN = {query: query() for query in Query.__subclasses__()}
_SIMPLE = frozenset({str, bool, int, float, type(None)})
_made: dict[Any, Query] = {}
_keywords = {query: {f.name for f in fields(query)} for query in _PLAIN}  # of each method, for suggestions


def query_of(query: type[Query], options: dict[str, Any]) -> Query:
    """A query with these members; the same object for the same words and numbers, which saves microseconds."""
    if not options:
        return _PLAIN[query]
    types = tuple(map(type, options.values()))
    key = (query, types, tuple(options.items())) if _SIMPLE.issuperset(types) else None  # with types: True is not 1
    made = _made.get(key)
    if made is None:
        for name in options:
            if name not in _keywords[query]:
                close = get_close_matches(name, _keywords[query], n=1)
                meant = f". Did you mean '{close[0]}'?" if close else ""
                raise TypeError(f"Detector.{query._call}() got an unexpected keyword argument '{name}'{meant}")
        made = query(**options)
        if key is not None:
            if len(_made) >= 256:
                _made.clear()
            _made[key] = made
    return made


def keywords_of(query: type[Query]) -> Callable[[Function], Function]:
    """Gives a method whose keywords are its own and, as **options for query_of, the members of a query, a signature
    that has them all."""

    def with_members(method: Function) -> Function:
        signature = inspect.signature(method)
        own = [p for p in signature.parameters.values() if p.kind is not inspect.Parameter.VAR_KEYWORD]
        members = [
            inspect.Parameter(f.name, inspect.Parameter.KEYWORD_ONLY, default=f.default, annotation=f.type)
            for f in fields(query)  # type: ignore[arg-type]
        ]
        method.__signature__ = signature.replace(parameters=[*own, *members])  # type: ignore[attr-defined]
        _keywords[query] |= {parameter.name for parameter in own[1:]}
        return method

    return with_members


@dataclass(frozen=True)
class FuzzyCMeans:
    """How fuzzy C-means places the centres of clusters: for researchers. No result depends on it.

    Args:
        fuzziness: t of eq. 2, above 1.
        max_iterations: cap on iterations, warm-started from the centres of the call before.
        first_iterations: the same for a first frame, which has no centres to start from.
        stop: iteration ends when no centre moves further in any coordinate, in units of the scene's extent rounded up
            to a power of two.
        first_stop: the same for a first frame.

    Source: D. Mainzer, G. Zachmann, "Collision Detection Based on Fuzzy Scene Subdivision", sec. 4, eqs. 2-4.
    """

    fuzziness: float = 2.0
    max_iterations: int = 2
    first_iterations: int = 5
    stop: float = 1e-2
    first_stop: float = 1e-4

    def __repr__(self) -> str:
        given = ", ".join(f"{field.name}={getattr(self, field.name)!r}" for field in fields(self))
        return f"crumple.FuzzyCMeans({given})"


def check_fuzzy_c_means(given: FuzzyCMeans) -> FuzzyCMeans:
    """Returns what it is given. Raises InvalidType for another type."""
    if isinstance(given, FuzzyCMeans):
        return given
    raise InvalidType(f"fuzzy_c_means must be a crumple.FuzzyCMeans, not {type(given).__name__}", element="option")
