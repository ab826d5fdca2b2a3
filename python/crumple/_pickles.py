"""Takes results apart for pickle, and puts them together again, with all that is read checked."""

from __future__ import annotations

from typing import Any

import numpy as np

from . import _arrays, _core
from ._candidates import LISTS, Candidates
from ._core import Statistics
from ._distances import Distances
from ._errors import InvalidInput, InvalidType
from ._impacts import Impacts
from ._intersections import Intersections
from ._mesh import Mesh
from ._pickle_checks import check_fit
from ._proximities import Proximities
from ._result import Request, Result
from ._world import World

_RESULTS: dict[str, type[Result]] = {
    "Intersections": Intersections,
    "Impacts": Impacts,
    "Proximities": Proximities,
    "Candidates": Candidates,
    "Distances": Distances,
}

Columns = dict[str, tuple[Any, tuple[int, ...]]]  # type and columns of each array; what was not requested is empty


def _all(dtype: Any, names: list[str], columns: tuple[int, ...] = ()) -> Columns:
    return {name: (dtype, columns) for name in names}


_KINDS = ("vertex_face", "edge_edge", "vertex_edge", "vertex_vertex")
_OF_FEATURES: Columns = {
    **_all(np.int32, ["edges"], (2,)),
    **_all(np.int32, ["points"]),
    **_all(np.int64, ["first_edge", "first_point"]),
}
_OF_LISTS: Columns = {
    **_OF_FEATURES,
    **_all(np.bool_, ["world_hit"]),
    **_all(np.int32, [name for kind in _KINDS for name in (LISTS[kind], f"{kind}_bodies")], (2,)),
    **_all(np.int64, ["vertex_offsets", "face_offsets", "by_face", "edge_offsets", "second_edge_offsets"]),
    **_all(np.int64, ["by_second_edge", "vertex_edge_offsets", "edge_vertex_offsets", "by_edge"]),
    **_all(np.int64, ["vertex_vertex_offsets", "second_vertex_offsets", "by_second_vertex"]),
}
_ARRAYS: dict[str, Columns] = {
    "Intersections": {
        **_all(np.int32, ["pairs", "bodies"], (2,)),
        **_all(np.int64, ["offsets", "world_counts", "world_offsets", "body_offsets", "first_triangle"]),
        **_all(np.bool_, ["hit", "hit_second", "world_hit"]),
        **_all(np.uint8, ["contact_kinds"]),
        **_all(np.int64, ["contact_offsets"]),
        **_all(np.float64, ["contact_points"], (3,)),
    },
    "Impacts": {
        **_OF_LISTS,
        **_all(np.int32, ["triangle_pairs", "triangle_pair_bodies"], (2,)),
        **_all(np.float64, [f"{kind}_toi" for kind in (*_KINDS, "triangle_pair")]),
        **_all(np.bool_, [f"{kind}_start" for kind in (*_KINDS, "triangle_pair")]),
        **_all(np.int64, ["triangle_offsets", "second_triangle_offsets", "by_second_triangle"]),
    },
    "Proximities": {
        **_OF_LISTS,
        **_all(np.float64, [f"{kind}_squared_distance" for kind in _KINDS]),
        **_all(np.bool_, [f"{kind}_touching" for kind in _KINDS]),
        **_all(np.uint8, [f"{kind}_type" for kind in _KINDS]),
        **_all(np.float64, [f"{kind}_at" for kind in _KINDS], (2,)),
        **_all(np.float64, ["vertex_distance", "face_distance", "edge_distance"]),
    },
    "Candidates": {
        **_OF_FEATURES,
        **_all(np.int32, [name for kind in LISTS for name in (LISTS[kind], f"{kind}_bodies")], (2,)),
    },
    "Distances": {
        **_all(np.int32, ["bodies", "triangles"], (2,)),
        **_all(np.float64, ["squared_distance"]),
        **_all(np.bool_, ["touching"]),
        **_all(np.float64, ["points"], (2, 3)),
    },
}
_VALUES: dict[str, dict[str, type]] = {
    "Intersections": {"any": bool, "count": int, "statistics": Statistics},
    "Impacts": {"any": bool, "count": int, "statistics": Statistics, "first": object, "world_first": list},
    "Proximities": {"any": bool, "count": int, "statistics": Statistics},
    "Candidates": {"any": bool, "count": int, "statistics": Statistics},
    "Distances": {"statistics": Statistics},
}


class Stored:
    """Arrays and values of a result, where the extension module has the library's."""

    def __init__(self, state: dict[str, Any]) -> None:
        self.__dict__.update(state)


def _values_of(kind: str, found: Any) -> dict[str, Any]:
    return {name: getattr(found, name) for name in (*_ARRAYS[kind], *_VALUES[kind])}


def stored(kind: str, found: Any) -> dict[str, Any]:
    """A copy that shares nothing."""
    state = _values_of(kind, found)
    for name in _ARRAYS[kind]:
        state[name] = state[name].copy()
        state[name].flags.writeable = False
    return state


def state_of(result: Result) -> tuple[Any, ...]:
    """Returns what restore needs to make an equal result. All arrays are NumPy's, those of meshes and poses too."""
    kind = type(result).__name__
    scene: tuple[Any, ...] = ()
    if isinstance(result, Intersections):
        scene = _state_of_scene(result)
    return kind, tuple(result._request), _values_of(kind, result._found), *scene


def _state_of_scene(result: Intersections) -> tuple[Any, ...]:
    if result._request.scene == "world":
        world, poses = result._scene
        return world, _arrays.if_given(_arrays.poses, poses)
    first, second, ids, ids_second = result._scene
    found, whole = result._found, result._listed and not result._request.block
    one = "" if second is None else "first mesh: "
    return (
        _mesh_as_arrays(first, one, len(found.hit) if whole else None),
        None if second is None else _mesh_as_arrays(second, "second mesh: ", len(found.hit_second) if whole else None),
        ids,
        ids_second,
    )


def _mesh_as_arrays(mesh: Mesh, which: str, triangles: int | None) -> tuple[Any, Any, Any]:
    vertices = _arrays.vertices(mesh.vertices, which)
    faces = _arrays.host_array(mesh.faces, which + "faces")
    if triangles is not None and faces.size != 3 * triangles:
        raise InvalidInput("the mesh was changed after the search: the result does not fit it any more")
    if not faces.size:
        faces = np.empty((0, 3), np.int32)
    return vertices, faces, None if mesh.groups is None else _arrays.groups(mesh.groups, which)


def restore(kind: Any, request: Any, state: Any, *scene: Any) -> Result:
    """A result with memory of its own. Raises InvalidType and InvalidInput for what state_of cannot have given."""
    if not isinstance(kind, str) or kind not in _RESULTS:
        raise InvalidType(f"a result must be one of {', '.join(_RESULTS)}, not {kind!r}")
    arrays, values = _ARRAYS[kind], _VALUES[kind]
    if not isinstance(state, dict) or state.keys() != {*arrays, *values}:
        raise InvalidType(f"the state of {kind} must be a dict of {', '.join(sorted([*arrays, *values]))}")
    for name, wanted in values.items():
        if not isinstance(state[name], wanted) or (wanted is Statistics and not _core.is_filled(state[name])):
            raise InvalidType(f"the state of {kind} needs {name} as {wanted.__name__}")
    made = {name: _array(state[name], f"the state of {kind} needs {name}", *arrays[name]) for name in arrays}
    request = _request(request, kind)
    if kind == "Intersections":
        scene = _scene(request, scene)
    elif scene:
        raise InvalidType(f"the state of {kind} has no scene")
    result = _RESULTS[kind](Stored({**state, **made}), request, *scene)
    check_fit(result)
    if isinstance(result, Intersections) and result._listed and not result._of_world:
        first, second, *ids = scene
        names = ("pairs", "offsets", "hit", "hit_second", "contact_kinds", "contact_offsets", "contact_points")
        arrays_of = [made[name].view(np.uint8) if made[name].dtype == np.bool_ else made[name] for name in names]
        has_contacts = request.output == "contacts"
        result._found = _core.restore(*arrays_of, state["statistics"], first, second, has_contacts, request.block, *ids)
    return result


def _array(array: Any, needs: str, dtype: Any, columns: tuple[int, ...]) -> np.ndarray:
    fits = isinstance(array, np.ndarray) and array.dtype.newbyteorder("=") == dtype
    if not fits or array.ndim != 1 + len(columns) or array.shape[1:] != columns:
        shape = ", ".join(["n", *map(str, columns)])
        raise InvalidType(f"{needs} as an array ({shape}) of {np.dtype(dtype)}")
    array = np.array(array, dtype, order="C")
    array.flags.writeable = False
    return array


def _request(given: Any, kind: str) -> Request:
    types = {"scene": str, "of_bodies": bool, "output": str, "options": frozenset, "kinds": tuple}
    if not isinstance(given, tuple) or len(given) != len(Request._fields):
        raise InvalidType(f"the state of {kind} needs the request as a tuple of {', '.join(Request._fields)}")
    request = Request(*given)
    for name, value in request._asdict().items():
        if not isinstance(value, types.get(name, bool)):
            raise InvalidType(f"the state of {kind} needs {name} as {types.get(name, bool).__name__}")
    of_bodies = request.scene == "world" or (request.scene == "meshes" and kind != "Intersections")
    if request.scene not in ("mesh", "meshes", "world", "part") or request.of_bodies != of_bodies:
        raise InvalidInput(f"the state of {kind} does not fit together: scene")
    return request


def _scene(request: Request, given: tuple[Any, ...]) -> tuple[Any, ...]:
    if request.scene == "world":
        if len(given) != 2 or not isinstance(given[0], World):
            raise InvalidType("the state of Intersections of a world needs the world and its poses")
        return given
    if len(given) != 4:
        raise InvalidType("the state of Intersections of meshes needs two meshes, and ids of their triangles")
    for name, mesh in (("first", given[0]), ("second", given[1])):
        if (not isinstance(mesh, tuple) or len(mesh) != 3) and (name == "first" or mesh is not None):
            raise InvalidType(f"the state of Intersections needs {name} as a tuple (vertices, faces, groups)")
    for ids in given[2:]:
        if ids is not None and (not isinstance(ids, np.ndarray) or ids.dtype != np.int32 or ids.ndim != 1):
            raise InvalidType("the state of Intersections needs ids as an array (n) of int32 or None")
    first, second, *numbers = given
    ids = [None if array is None else np.require(array, np.int32, ["C", "A"]) for array in numbers]
    return Mesh(*first), None if second is None else Mesh(*second), *ids
