"""Scenes from the arguments of calls, checks of queries for a scene, and results for callers."""

from __future__ import annotations

import re
from dataclasses import replace
from typing import Any

from . import _core
from ._errors import InvalidInput, InvalidType, name_of_type
from ._feature_pairs import Candidates
from ._features import FirstImpact, FreeStep, Impacts, Proximities
from ._intersections import Intersections
from ._mesh import Mesh, as_mesh, is_mesh, mesh_of, name_of_number
from ._overlaps import Overlaps
from ._queries import (
    CandidateQuery,
    FirstImpactQuery,
    FreeStepQuery,
    IntersectionQuery,
    PairFilter,
    ProximityQuery,
    Query,
)
from ._results import Distances, Request, Result
from ._world import World

#: Scene in the form of the extension module (python/src/scene.h).
Scene = World | _core.Part | Mesh | tuple[Mesh, Mesh]
_WHOLE = (World, Mesh, _core.Part)


def scene_of(
    given: Any, second: Any = None, groups: Any = None, *, end: Any = None, edges: Any = None, points: Any = None
) -> Scene:
    """Returns the scene of one object, of two meshes, or of vertices and faces. Keywords are attributes of the mesh.

    `given` and `second` are an object and None, two meshes, or vertices and faces. The object is a World, a Part, a
    list or tuple of two meshes, or anything that as_mesh takes.
    """
    is_plain = second is None and end is None and groups is None and edges is None and points is None
    if is_plain and isinstance(given, _WHOLE):
        return given
    given_attributes = {"end": end, "groups": groups, "edges": edges, "points": points}
    attributes = {name: value for name, value in given_attributes.items() if value is not None}
    is_whole = isinstance(given, (World, _core.Part))
    if is_whole:
        for name in [*attributes, *([] if second is None else ["a second argument"])]:
            raise InvalidType(f"{name} is for meshes, but the scene is a crumple.{type(given).__name__}")
        return given
    if second is None and isinstance(given, (list, tuple)) and given and all(map(is_mesh, given)):
        if len(given) != 2:
            raise InvalidType(
                f"a scene of several meshes has two, not {len(given)}; pass one mesh alone, and more than two as a "
                "crumple.World"
            )
        given, second = given
    if second is not None and is_mesh(second):
        for name in attributes:
            raise InvalidType(f"{name} is for one mesh, but the scene is two meshes")
        return as_mesh(given), as_mesh(second)
    return mesh_of(given, second, **attributes) if attributes or second is None else Mesh(given, second)


def step_of(start: Any, end: Any, faces: Any, groups: Any = None, edges: Any = None, points: Any = None) -> Any:
    """Returns the scene of a step, given as (start, end, faces), as (mesh, end), or as a scene with end positions."""
    if end is not None and faces is None and is_mesh(end):
        return scene_of(start, end, groups=groups, edges=edges, points=points)
    return scene_of(start, faces, end=end, groups=groups, edges=edges, points=points)


def kind_of(scene: Scene) -> str:
    """Returns the kind of a scene: "mesh", "meshes", "world" or "part"."""
    if isinstance(scene, World):
        return "world"
    if isinstance(scene, _core.Part):
        return "part"
    return "mesh" if isinstance(scene, Mesh) else "meshes"


def excluded_in(scene: Scene, pairs: PairFilter) -> Any:
    """Returns the indices of excluded pairs of bodies: (k, 2) int32. Caches them in the filter, for calls in a loop."""
    if not isinstance(scene, World):
        raise InvalidInput("excluded_bodies are only for a crumple.World")
    kept = pairs._indices
    if kept is not None and kept[0] is scene._columns:
        return kept[1]
    from ._world_arrays import excluded_pairs

    made = excluded_pairs(pairs.excluded_bodies, scene.distinct, scene.index)
    if type(pairs.excluded_bodies) is tuple:
        pairs.__dict__["_indices"] = scene._columns, made
    return made


def with_names(scene: Scene, error: InvalidInput) -> InvalidInput:
    """Returns the error. If the scene is a world, adds the names of bodies and shapes to its message."""
    named = _named(scene, str(error)) if isinstance(scene, World) else str(error)
    if named == str(error):
        return error
    return type(error)(named, code=error.code, element=error.element, index=error.index)


def _of_shape(number: int) -> str:
    """Returns a description of a named shape, from the number of its name (Shape.name), for messages."""
    name = name_of_number(number)
    return "an earlier shape of a file " if name is None else f"an earlier shape with the name {name!r} "


def _named(world: World, message: str) -> str:
    """Returns the message with the name of the shape instead of its number, and with the body's name added."""
    message = re.sub(r"an earlier shape with the name (\d+) ", lambda found: _of_shape(int(found[1])), message)
    found = re.match(r"body (\d+): ", message)
    if not found or int(found[1]) >= len(world):
        return message
    body = int(found[1])
    name, moving = world.names[world.originals[body]], world._moving
    told = [repr(name)] if name else []
    if len(world) > world.distinct and body < moving * world._count:
        told.append(f"of configuration {body // moving}")
    return f"body {body} ({' '.join(told)}): {message[found.end() :]}" if told else message


def checked_copy(copy: Any) -> bool:
    if isinstance(copy, bool) or type(copy).__name__ in ("bool_", "bool"):
        return bool(copy)
    raise InvalidType(f"copy must be True or False, not {type(copy).__name__}")


def checked_query(scene: Any, query: Any) -> Any:
    """Returns the query after checks of its type and for the scene. The kinds of a CandidateQuery become a tuple."""
    if type(query) is IntersectionQuery and type(query.filter) is PairFilter:
        return query
    if not isinstance(query, Query):
        raise InvalidType(f"query must be a query of crumple, such as crumple.ImpactQuery(), not {_name_of(query)}")
    if not isinstance(query.filter, PairFilter):
        raise InvalidType(f"filter must be a crumple.PairFilter, not {_name_of(query.filter)}")
    if isinstance(query, CandidateQuery):
        return query if type(query.kinds) is tuple else replace(query, kinds=_kinds(query.kinds))
    if isinstance(query, ProximityQuery):
        _check_radius(scene, query)
    return query


def _name_of(thing: Any) -> str:
    return f"the type {name_of_type(thing)} itself" if isinstance(thing, type) else name_of_type(type(thing))


def _kinds(kinds: Any) -> tuple[Any, ...]:
    if isinstance(kinds, str):
        return (kinds,)
    try:
        return tuple(kinds)
    except TypeError:
        raise InvalidType(f"kinds must be an iterable of str, not {type(kinds).__name__}") from None


def _check_radius(scene: Any, query: ProximityQuery) -> None:
    kind = kind_of(scene)
    radii = query.radii is not None
    if kind == "world":
        radii = radii or any(shape.radii is not None for shape in scene.shapes)
    elif kind == "part":
        radii = radii or scene.has_radii
    if query.radius is None and not radii:
        raise InvalidType("a ProximityQuery needs a radius, or radii of the vertices")
    if query.radius is not None and radii:
        raise InvalidInput("radius cannot be given together with radii")


#: Type of the result, by Query._call: the name of the query in names of methods (Detector.impacts, _find_impacts).
RESULTS: dict[str, type[Result]] = {
    "intersections": Intersections,
    "impacts": Impacts,
    "proximities": Proximities,
    "candidates": Candidates,
    "distances": Distances,
    "overlaps": Overlaps,
}
_OPTIONS = (
    *("index", "triangle_pairs", "closest", "least"),
    *("self_overlaps", "gradient", "curves", "windings", "depths", "depth_tolerance"),
    *("directions", "first_free", "translation", "extents", "unions", "regions"),
)


def show(found: Any, scene: Any, query: Any, copy: bool, block: bool = False) -> Any:
    """Makes the result of a query for the caller from the result of the extension module, `found`."""
    requests = query._requests  # cached, because callers use a query many times
    if requests is None:
        requests = query.__dict__["_requests"] = {}
    key = (type(scene), copy, block) if copy or block else type(scene)
    request = requests.get(key)
    if request is None:
        request = requests[key] = _request_of(query, kind_of(scene), copy, block)
    if type(query) is IntersectionQuery:
        if request.scene == "world":
            return Intersections(found, request, scene, scene.poses)
        return Intersections(found, request, *_kept(scene, request.scene))
    if isinstance(query, FirstImpactQuery):
        first = None if found is None else FirstImpact(*found)
        return first if first is None or request.of_bodies else first._replace(bodies=None)
    if not isinstance(query, FreeStepQuery):
        return RESULTS[query._call](found, request)
    step = FreeStep(*found)
    if step.first is None:
        return step
    first = FirstImpact(*step.first)
    return step._replace(first=first if request.of_bodies else first._replace(bodies=None))


def _request_of(query: Any, kind: str, copy: bool, block: bool) -> Request:
    of_bodies = kind == "world" or (kind == "meshes" and not isinstance(query, IntersectionQuery))
    output = getattr(query, "output", "pairs")
    listed = output in ("pairs", "contacts")
    options = options_in_result(query) if listed else frozenset()
    if getattr(query, "containment", False):
        options |= {"containment"}
    return Request(kind, of_bodies, output, options, getattr(query, "kinds", ()), copy, block)


def options_in_result(query: Any) -> frozenset[str]:
    """Returns the names of the options of a query that add attributes to its result."""
    return frozenset(name for name in _OPTIONS if getattr(query, name, False))


def _kept(scene: Any, kind: str) -> tuple[Any, ...]:
    """Returns what files and pictures need: the first and second mesh and, for a part, the ids of their triangles.

    Items that do not exist are None.
    """
    if kind == "part":
        second = None if scene.second is None else Mesh(*scene.second)
        return Mesh(*scene.mesh), second, scene.triangles, None if second is None else scene.triangles_second
    first, second = (scene, None) if kind == "mesh" else scene
    return first, second, None, None
