"""Queries: the type of a query selects what is searched for, and the type of the result.

The members of a query are also the keyword arguments of the corresponding method of Detector. The extension module
reads them by name (python/src/queries.cpp). FuzzyCMeans and Method, options of detectors, are declared here, too.
"""

from __future__ import annotations

import inspect
import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, fields
from difflib import get_close_matches
from typing import Any, ClassVar, Literal

from ._errors import Function, InvalidInput, InvalidType

Scope = Literal["both", "between", "within"]
CandidateKind = Literal["vertex_face", "edge_edge", "edge_face", "face_face", "vertex_edge", "vertex_vertex"]


@dataclass(frozen=True, kw_only=True)
class PairFilter:
    """Selection of the pairs that a query tests.

    Parameters
    ----------
    bodies : {"both", "between", "within"}, default "both"
        Pairs between different bodies, within one body, or both. Must be "both" for scenes other than worlds.
    groups : {"both", "between", "within"}, default "both"
        Pairs between different groups, within one group, or both. Equal groups of different bodies or meshes are one
        group.
    excluded_bodies : iterable of pairs, or (k, 2) array_like of int, optional
        Pairs of bodies of a world that are not tested, by name or index: sets such as {"arm", "hand"} ({"arm"} is the
        arm with itself), or sequences of two. In robotics, this is the allowed collision matrix.
    excluded_groups : iterable of pairs, or (k, 2) array_like of int, optional
        Pairs of groups that are not tested.
    """

    bodies: Scope = "both"
    groups: Scope = "both"
    excluded_bodies: Any = None
    excluded_groups: Any = None

    _indices: ClassVar[Any] = None  # cache of each object: (columns of a world, excluded_bodies as its body indices)

    def __post_init__(self) -> None:
        """Replaces excluded pairs that are not an array by immutable copies, so that their indices can be cached."""
        pairs = self.excluded_bodies
        if isinstance(pairs, Iterable) and not isinstance(pairs, (str, bytes)) and not is_array(pairs):
            object.__setattr__(self, "excluded_bodies", tuple(map(_constant, pairs)))

    def __getstate__(self) -> dict[str, Any]:
        """Returns the members only, so pickles and copies have no cached data."""
        return members_of(self)


def is_array(value: Any) -> bool:
    """True for arrays of NumPy and of other packages."""
    return hasattr(value, "dtype") or hasattr(value, "__dlpack__")


def _constant(pair: Any) -> Any:
    """Returns an immutable copy of a pair, unless its type is unexpected."""
    if isinstance(pair, set):
        return frozenset(pair)
    if hasattr(pair, "tolist"):
        pair = pair.tolist()  # a row of a NumPy array
    return tuple(pair) if isinstance(pair, list) else pair


def members_of(value: Any) -> dict[str, Any]:
    """Returns the fields of a dataclass."""
    return {field.name: getattr(value, field.name) for field in fields(value)}


class Query:
    """Base class of all queries."""

    filter: PairFilter
    _call: ClassVar[str]  # name of the query in methods: Detector.impacts, and _find_impacts of the extension module
    _deliveries: ClassVar[frozenset[str]] = frozenset({"find", "supports"})
    _methods: ClassVar[dict[str, str]]  # names of methods of the extension module's detector, by delivery
    _read: ClassVar[Any] = None  # cache of each object: the extension module's query
    _requests: ClassVar[Any] = None  # cache of each object: the Requests of its results

    def __init_subclass__(cls) -> None:
        cls._methods = {delivery: f"_{delivery}_{cls._call}" for delivery in cls._deliveries}

    def __getstate__(self) -> dict[str, Any]:
        """Returns the members only, so pickles and copies have no cached data."""
        return members_of(self)


_OF_PAIRS = frozenset({"find", "supports", "any", "stream", "partition", "launch"})


@dataclass(frozen=True, kw_only=True)
class IntersectionQuery(Query):
    """Query for all pairs of triangles that intersect; the result is Intersections.

    Parameters
    ----------
    output : {"any", "any_by_world", "body_pairs", "count", "pairs", "contacts"}, default "pairs"
        How much of the result is made: whether anything intersects, in which worlds, which bodies, the number of pairs,
        all pairs, or all pairs with the points of each intersection. The search ends as soon as the output is decided.
    neighbours : {"geometric", "skip"}, default "geometric"
        Treatment of adjacent triangles, which share a vertex. "geometric": they intersect only if they have a common
        point outside the convex hull of their shared vertices, as two triangles folded onto each other do, and the two
        triangles of a hinge do not. "skip": they are never reported.
    kind : {"all", "proper"}, default "all"
        "all": touching counts; "proper": only if an edge strictly crosses the interior of the other triangle.
    weld : bool, default False
        True: vertices at equal positions count as one, also if they belong to different meshes or bodies.
    containment : bool, default False
        True: a body inside another one counts in the outputs "any", "any_by_world" and "body_pairs", but never as pairs
        of triangles. Intersections.inside marks such pairs of bodies. Two bodies count if their surfaces meet, or
        otherwise if a component of one has a vertex at which the winding number of the other's surface is not 0. For
        worlds and two meshes, with `kind` "all". Meshes must be in host memory.
    open : {"error", "skip"}, default "error"
        With `containment`, treatment of bodies whose surface is not closed, if they are in a pair whose boxes overlap
        and whose surfaces do not meet. "error": raises InvalidInput; "skip": nothing counts as inside such a body, and
        Intersections.skipped lists it.
    filter : PairFilter, optional
        Pairs to test.
    index : bool, default False
        True: results about worlds also have offsets by world and by body, and hit flags. Results about meshes always
        have offsets and hit flags.

    Notes
    -----
    docs/contract.md defines an intersection.

    References
    ----------
    .. [1] D. Mainzer and G. Zachmann, "Collision Detection Based on Fuzzy Scene Subdivision", Algorithm 1.
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
    _deliveries: ClassVar[frozenset[str]] = _OF_PAIRS | {"cluster"}


@dataclass(frozen=True, kw_only=True)
class ImpactQuery(Query):
    """Query for features that touch during a step, and when; the result is Impacts.

    In a step, every vertex moves straight from its start to its end.

    An impact is a vertex and a face without that vertex, or two edges without a common vertex, that have a common point
    at some time in [0, 1]. Features are closed and may be degenerate. If the inside of an edge meets the inside of a
    face, and nothing else touches, the triangles intersect, but there is no impact.

    Parameters
    ----------
    output : {"any", "any_by_world", "first", "pairs"}, default "pairs"
        How much of the result is made: whether anything touches, in which worlds, the first impact, or all impacts. The
        search ends as soon as the output is decided.
    min_distance : float, default 0
        Features touch if their distance is at most this, in the units of the coordinates.
    min_distance_share : float, default 0
        Minimum distance as a share, in [0, 1), of the pair's distance at the start. If `min_distance` is given, too,
        the larger of both distances applies.
    approaching_only : bool, default False
        True: drops pairs of features that touch at the start (whose distance is at most the minimum distance, if there
        is one) and never come nearer than they are at the start. If they do come nearer, `toi` is the last time before
        that. Features at distance 0 cannot come nearer, so they are always dropped.
    weld : bool, default False
        True: vertices with equal positions at the start and at the end count as one. Features that share such a vertex
        are adjacent, and are not tested.
    filter : PairFilter, optional
        Pairs to test. A vertex or edge is in the group of its lowest triangle.
    index : bool, default False
        True: results about one mesh also have offsets by vertex, face and edge.
    triangle_pairs : bool, default False
        True: also finds pairs of triangles that intersect at the start, and pairs of triangles between whose features
        there is an impact. These pairs count for `any` and `world_hit`; `first` remains an impact of features.

    Notes
    -----
    docs/motion.md defines an impact.
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
    """Query for the first impact of a step, in all worlds together; the result is a FirstImpact, or None.

    Parameters
    ----------
    min_distance, min_distance_share, approaching_only, weld, filter
        As for ImpactQuery.
    """

    min_distance: float = 0.0
    min_distance_share: float = 0.0
    approaching_only: bool = False
    weld: bool = False
    filter: PairFilter = PairFilter()

    _call: ClassVar[str] = "first_impact"


@dataclass(frozen=True, kw_only=True)
class FreeStepQuery(Query):
    """Query for a share of a step that is free of impacts, and for the positions there; the result is a FreeStep.

    The motion to these positions is free although they are rounded. The positions vertices + toi * (end - vertices)
    need not be: computed in floating point, they belong to a slightly different motion from that of `toi`.

    Parameters
    ----------
    held : {"worlds", "bodies", "vertices"}, default "worlds"
        Objects that are held back if two features touch: their whole world (a mesh is one world), the two bodies, or
        the vertices of the two features. Everything else moves on.
    min_distance, min_distance_share, approaching_only, weld, filter
        As for ImpactQuery.
    triangle_pairs : bool, default False
        The share is 0 if triangles intersect at the start.

    Notes
    -----
    If two features touch, the objects that `held` selects stop before the time of contact: by 2**-16 of that time if
    this suffices, otherwise by more. Their share is 0 if the features touch at the start, if only a share below 2**-40
    would be free, or after 40 attempts. Features that touch at the start hold their whole world at the start. With
    `approaching_only` they do not; if they would come nearer, only the objects that `held` selects stay at the start.

    Cost: one to three times that of a FirstImpactQuery; with held="bodies" and "vertices" that of an ImpactQuery for
    each of a few iterations.
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
    """Query for features whose distance is at most a radius, and for their distances; the result is Proximities.

    A pair of features is a vertex and a face without that vertex, or two edges without a common vertex. Two triangles
    that intersect need not have features that are near each other.

    Parameters
    ----------
    output : {"any", "any_by_world", "pairs"}, default "pairs"
        How much of the result is made: whether anything is near, in which worlds, or all pairs. The search ends as soon
        as the output is decided.
    radius : float
        Largest Euclidean distance, 0 or more, in the units of the coordinates. Required unless there are radii.
    radii : (n,) array_like of float64 or float32, optional
        Radius of each vertex, instead of `radius`: for instance half the thickness of a cloth. The radius of an edge or
        a face is the largest of the radii of its vertices. Features are near if their distance is at most the sum of
        their radii, computed exactly. For one mesh; shapes of a world have radii of their own (Shape).
    strict : bool, default False
        True: features are near only if their distance is less than the radius, or than the sum of their radii.
    closest : bool, default False
        True: also finds where the features of each pair are closest.
    least : bool, default False
        True: also finds the least distance of each vertex, face and edge, for one mesh. It includes pairs that `rings`
        or `rest` drop from the lists, so that it can bound a step. If `rings` or `rest` is given, this takes a second
        search.
    weld : bool, default False
        True: vertices at equal positions count as one. Features that share such a vertex are adjacent, and are never
        near.
    rings : int, default 0
        Features are adjacent, and never near, if a path of at most this many edges connects a vertex of one with a
        vertex of the other. 0: only if they have a common vertex. This is the topological contact filter of Newton, the
        simulator. Paths are cached while the edges stay the same.
    rest : (n, 3) array_like of float32 or float64, optional
        Rest shape: positions of the vertices. For one mesh; shapes of a world have rest shapes of their own (Shape).
    rest_radius : float, default 0
        Features whose distance in the rest shape is at most this are never near.
    filter : PairFilter, optional
        Pairs to test. A vertex or edge is in the group of its lowest triangle.
    index : bool, default False
        True: results about one mesh also have offsets by vertex, face and edge.

    Notes
    -----
    A moving scene is searched at the start of the step. docs/nearness.md defines nearness.
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
    """Query for features whose inflated boxes overlap: the broad phase for a narrow phase of the caller.

    The result is Candidates.

    Parameters
    ----------
    kinds : str or iterable of str, default ("vertex_face", "edge_edge")
        Lists to make, of "vertex_face", "edge_edge", "edge_face", "face_face", "vertex_edge" and "vertex_vertex".
    inflation : float, default 0
        Inflation of each box on all sides, 0 or more, in the units of the coordinates.
    weld : bool, default False
        True: vertices with equal positions at the start and at the end count as one common vertex.
    neighbours : bool, default False
        True: pairs with a common vertex are listed, too, such as an edge and a face that contains it, but no feature
        with itself. Not supported by the cuda backend.
    filter : PairFilter, optional
        Pairs to test.

    Notes
    -----
    The box of a feature is axis-aligned and contains its vertices at the start and, if the scene moves, at the end. Two
    features are a candidate if they have no common vertex (unless `neighbours` is True) and the gap between their original boxes, computed without
    rounding, is at most twice `inflation` on every axis. So the lists are well-defined and complete
    (docs/candidates.md).
    """

    kinds: CandidateKind | Iterable[CandidateKind] = ("vertex_face", "edge_edge")
    inflation: float = 0.0
    weld: bool = False
    neighbours: bool = False
    filter: PairFilter = PairFilter()

    _call: ClassVar[str] = "candidates"
    _deliveries: ClassVar[frozenset[str]] = frozenset({"find", "supports", "stream", "launch"})


@dataclass(frozen=True, kw_only=True)
class DistanceQuery(Query):
    """Query for the distance of each pair of bodies, and for where they are closest; the result is Distances.

    For a world, or two meshes. Bodies are sets of triangles, not volumes: the distance of a body inside another one is
    that of their surfaces.

    Parameters
    ----------
    output : {"pairs", "nearest"}, default "pairs"
        "pairs": a row for each pair of bodies. "nearest", which costs less: a row for each world, with its nearest pair
        of bodies. With "nearest", pairs of bodies that are both in all worlds belong to no world, and have no row.
    radius : float, default inf
        Lists only pairs of bodies whose exact distance is at most this: 0 or more, or infinite.
    filter : PairFilter, optional
        Pairs of triangles that count. Pairs within a body never count.

    Notes
    -----
    With the cuda backend, the host computes distances. Cost: with named shapes, which are cached, a few to some ten
    microseconds per pair of bodies. More in docs/nearest.md.
    """

    output: Literal["nearest", "pairs"] = "pairs"
    radius: float = math.inf
    filter: PairFilter = PairFilter()

    _call: ClassVar[str] = "distances"


@dataclass(frozen=True, kw_only=True)
class OverlapQuery(Query):
    """Query for the overlap of closed bodies: volume, normal, and derivatives; the result is Overlaps.

    For a world, two meshes, or one mesh with itself. Surfaces must be closed: their triangles name each edge equally
    often in both directions. Triangles are counter-clockwise seen from outside.

    Parameters
    ----------
    output : {"any", "any_by_world", "body_pairs", "pairs"}, default "pairs"
        How much of the result is made: whether any two bodies overlap, in which worlds, which bodies and their
        relation, or all numbers.
    min_volume : float, default 0
        Lists only overlaps with at least this volume, in magnitude and as rounded, in cubed units of the world.
    open : {"error", "skip", "curves"}, default "error"
        Treatment of bodies whose surface is not closed. "error": raises InvalidInput that names an edge; "skip": their
        pairs have no rows, and Overlaps.skipped lists them; "curves": their pairs have a row if the surfaces meet, with
        the relation UNDEFINED, the contact area and curves, but no other numbers.
    weld : bool, default False
        True: merges vertices of a shape at equal positions, which closes seams, as in STL files.
    self_overlaps : bool, default False
        True: also finds the overlap of each body with itself, regardless of its self_collisions: rows (i, i), volumes
        of bodies, and whether they are solids. Always on for a scene of one mesh.
    gradient : bool, default False
        True: also computes the derivatives of the volumes with respect to the vertices.
    curves : bool, default False
        True: also computes the curves in which surfaces of different bodies cross.
    windings : bool, default False
        True: also computes winding numbers at the vertices.
    depths : bool, default False
        True: also computes the depths of vertices of each body inside the other one.
    depth_tolerance : float, default 0
        Above 0: also computes bounds on the greatest depth of any point, which differ by at most this.
    directions : sequence of (x, y, z), default ()
        Directions along which the second body of each pair is moved away from the first one, for
        Overlaps.withdrawals; finite, not 0, of any length.
    first_free : bool, default False
        True: also computes the first motion along each direction at which the insides of two bodies do not overlap.
        Needs directions.
    translation : bool, default False
        True: also computes bounds on the length of the least translation that separates two bodies.
    solids : bool, default False
        True states that all bodies are solids: no surface passes through itself or is inside out. The lower bound on
        translations relies on it, and may be too large if it is wrong. With self_overlaps it is computed instead.
    extents : bool, default False
        True: also computes boxes and thicknesses of overlaps.
    unions : bool, default False
        True: also computes volumes of unions and differences.
    regions : bool, default False
        True: also computes the connected regions of each overlap, and boxes and thicknesses.
    filter : PairFilter, optional
        Pairs of bodies to test.

    Notes
    -----
    With the cuda backend, the device finds the triangles that intersect, decides how they cross, and sums; the host
    computes the rest. More in docs/overlap.md.
    """

    output: Literal["any", "any_by_world", "body_pairs", "pairs"] = "pairs"
    min_volume: float = 0.0
    open: Literal["error", "skip", "curves"] = "error"
    weld: bool = False
    self_overlaps: bool = False
    gradient: bool = False
    curves: bool = False
    windings: bool = False
    depths: bool = False
    depth_tolerance: float = 0.0
    directions: Sequence[Sequence[float]] = ()
    first_free: bool = False
    translation: bool = False
    solids: bool = False
    extents: bool = False
    unions: bool = False
    regions: bool = False
    filter: PairFilter = PairFilter()

    _call: ClassVar[str] = "overlaps"
    _deliveries: ClassVar[frozenset[str]] = frozenset(
        {"find", "supports", "any", "stream", "partition", "combine"}
    )

    def __post_init__(self) -> None:
        """Replaces the directions by an immutable copy."""
        try:
            directions = tuple(tuple(map(float, direction)) for direction in self.directions)
        except (TypeError, ValueError):
            raise InvalidInput("directions must be a sequence of directions (x, y, z)") from None
        if any(len(direction) != 3 for direction in directions):
            raise InvalidInput("directions must have three coordinates each")
        object.__setattr__(self, "directions", directions)


_PLAIN = {query: query() for query in Query.__subclasses__()}
_SIMPLE = frozenset({str, bool, int, float, type(None)})
_made: dict[Any, Query] = {}
_keywords = {query: {f.name for f in fields(query)} for query in _PLAIN}  # keywords of each method, for suggestions


def query_of(query: type[Query], options: dict[str, Any]) -> Query:
    """Returns a query with these members. Caches queries whose options are only strings and numbers, to save time."""
    if not options:
        return _PLAIN[query]
    types = tuple(map(type, options.values()))
    key = (query, types, tuple(options.items())) if _SIMPLE.issuperset(types) else None  # with types: True == 1
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
    """Decorates a method so that its signature lists the members of a query after its own parameters.

    The method receives these members as **options, and passes them to query_of.
    """

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
    """Parameters of fuzzy C-means, which places the centres of clusters, for researchers. No result depends on them.

    Parameters
    ----------
    fuzziness : float, default 2
        The exponent t of [1]_, eq. 2; above 1.
    max_iterations : int, default 2
        Largest number of iterations in a call that is warm-started from the centres of the previous call.
    first_iterations : int, default 5
        Largest number of iterations in a first call, which has no centres to start from.
    stop : float, default 1e-2
        Iteration stops when no centre moves further than this in any coordinate. Unit: the extent of the scene, rounded
        up to a power of two.
    first_stop : float, default 1e-4
        The same as `stop`, for a first call.

    References
    ----------
    .. [1] D. Mainzer and G. Zachmann, "Collision Detection Based on Fuzzy Scene Subdivision", sec. 4, eqs. 2-4.
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
    """Returns `given` unchanged. Raises InvalidType if it is not a FuzzyCMeans."""
    if isinstance(given, FuzzyCMeans):
        return given
    raise InvalidType(f"fuzzy_c_means must be a crumple.FuzzyCMeans, not {type(given).__name__}", element="option")


@dataclass(frozen=True)
class Method:
    """Steps of the method that researchers may vary. Only the cpu backend has variants.

    Parameters
    ----------
    sweep : {"pca", "x", "y", "z"} or sequence of three float, default "pca"
        Direction along which leaves are swept: the first principal component of each leaf ([1]_, sec. 3), a coordinate
        axis, or a vector of any length but 0. Changes no result.
    membership : {"ball", "equation_5", "threshold"}, default "ball"
        Rule by which triangles join clusters and leaves. Each triangle joins the cluster whose centre is nearest to its
        centroid. It joins another cluster if the ball around its centroid that contains it reaches the plane that
        bisects the two centres ("ball"), if its centroid is at most half of the largest radius of all balls from that
        plane ("equation_5": the overlap of two clusters is as wide as [1]_, eq. 5 demands), or if its membership in the
        cluster ([1]_, eq. 3) is at least `threshold` ("threshold"). Only "ball" never loses a pair. With the others,
        Detector compares each triangle's clusters with those of "ball", and `complete` of the result's Statistics is
        False if one is missing. They are supported for intersections (without containment), impacts, proximities and
        candidates; Detector raises InvalidInput for other queries that need clusters, and for `any`.
    threshold : float, default 0
        Membership from 0 (all clusters) to 1 (only the nearest), for "threshold".

    References
    ----------
    .. [1] D. Mainzer and G. Zachmann, "Collision Detection Based on Fuzzy Scene Subdivision".
    """

    sweep: Literal["pca", "x", "y", "z"] | Sequence[float] = "pca"
    membership: Literal["ball", "equation_5", "threshold"] = "ball"
    threshold: float = 0.0

    def __post_init__(self) -> None:
        if not isinstance(self.sweep, str) and isinstance(self.sweep, Iterable):
            object.__setattr__(self, "sweep", tuple(self.sweep))

    def __repr__(self) -> str:
        given = ", ".join(f"{field.name}={getattr(self, field.name)!r}" for field in fields(self))
        return f"crumple.Method({given})"


def check_method(given: Method) -> Method:
    """Returns `given` unchanged. Raises InvalidType if it is not a Method."""
    if isinstance(given, Method):
        return given
    raise InvalidType(f"method must be a crumple.Method, not {type(given).__name__}", element="option")
