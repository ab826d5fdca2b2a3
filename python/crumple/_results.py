"""Results: each query's, made of what the extension module found."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from ._candidates import Candidates
from ._distances import Distances
from ._errors import InvalidInput, InvalidType
from ._impacts import FirstImpact, FreeStep, Impacts
from ._intersections import Intersections
from ._mesh import Mesh
from ._proximities import Proximities
from ._queries import (
    CandidateQuery,
    FirstImpactQuery,
    FreeStepQuery,
    IntersectionQuery,
    PairFilter,
    ProximityQuery,
    Query,
)
from ._result import Request, Result
from ._scene import kind_of

_RESULTS: dict[str, type[Result]] = {
    "intersections": Intersections,
    "impacts": Impacts,
    "proximities": Proximities,
    "candidates": Candidates,
    "distances": Distances,
}
_OPTIONS = ("index", "triangle_pairs", "closest", "least")


def show(found: Any, scene: Any, query: Any, copy: bool, block: bool = False) -> Any:
    """The result of a query, of the extension module's."""
    kind = kind_of(scene)
    of_bodies = kind == "world" or (kind == "meshes" and not isinstance(query, IntersectionQuery))
    if isinstance(query, FirstImpactQuery):
        first = None if found is None else FirstImpact(*found)
        return first if first is None or of_bodies else first._replace(bodies=None)
    if isinstance(query, FreeStepQuery):
        return FreeStep(*found)
    request = _request_of(query, kind, of_bodies, copy, block)
    return _RESULTS[query._call](found, request, *(_kept(scene, kind) if isinstance(query, IntersectionQuery) else ()))


def _request_of(query: Any, *how: Any) -> Request:
    """The request of this query; cached by the query, which callers use many times."""
    known = query.__dict__.setdefault("_request", {})
    request = known.get(how)
    if request is None:
        kind, of_bodies, copy, block = how
        output = getattr(query, "output", "pairs")
        listed = output in ("pairs", "contacts")
        options = frozenset(name for name in _OPTIONS if listed and getattr(query, name, False))
        request = known[how] = Request(kind, of_bodies, output, options, getattr(query, "kinds", ()), copy, block)
    return request


def _kept(scene: Any, kind: str) -> tuple[Any, ...]:
    """The parts of a scene that files and pictures need: (world, poses), or two meshes and ids of triangles."""
    if kind == "world":
        return scene, scene.poses
    if kind == "part":
        second = None if scene.second is None else Mesh(*scene.second)
        return Mesh(*scene.mesh), second, scene.triangles, None if second is None else scene.triangles_second
    first, second = (scene, None) if kind == "mesh" else scene
    return first, second, None, None


def checked_copy(copy: Any) -> bool:
    if isinstance(copy, bool) or type(copy).__name__ in ("bool_", "bool"):
        return bool(copy)
    raise InvalidType(f"copy must be True or False, not {type(copy).__name__}")


def checked_query(scene: Any, query: Any) -> Any:
    """The query, with its kinds as a tuple, and a radius that fits the scene."""
    if not isinstance(query, Query):
        raise InvalidType(f"query must be one of crumple's, such as crumple.ImpactQuery(), not {_name_of(query)}")
    filters = query.filter  # type: ignore[attr-defined]
    if not isinstance(filters, PairFilter):
        raise InvalidType(f"filter must be a crumple.PairFilter, not {_name_of(filters)}")
    if isinstance(query, CandidateQuery):
        return replace(query, kinds=_kinds(query.kinds))
    if isinstance(query, ProximityQuery):
        _check_radius(scene, query)
    return query


def _name_of(thing: Any) -> str:
    kind = thing if isinstance(thing, type) else type(thing)
    name = f"{kind.__module__}.{kind.__qualname__}".removeprefix("builtins.")
    return f"the type {name} itself" if isinstance(thing, type) else name


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
