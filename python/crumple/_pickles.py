"""States of results for pickle, and restoring of results from states, which are validated completely."""

from __future__ import annotations

from typing import Any

import numpy as np

from . import _arrays, _core
from ._core import Statistics
from ._errors import InvalidInput, InvalidType
from ._intersections import Intersections
from ._mesh import Mesh
from ._pickle_checks import check_fit
from ._results import Array, Request, Result
from ._scene import RESULTS
from ._world import World

_RESULTS = {kind.__name__: kind for kind in RESULTS.values()}
# For each class of results, the arrays that it declares. In a state, arrays that were not requested are empty.
_ARRAYS = {
    name: {array.found: array for base in kind.__mro__ for array in vars(base).values() if isinstance(array, Array)}
    for name, kind in _RESULTS.items()
}
_VALUES: dict[str, dict[str, type]] = {
    "Intersections": {"any": bool, "count": int, "statistics": Statistics},
    "Impacts": {"any": bool, "count": int, "statistics": Statistics, "first": object, "world_first": list},
    "Proximities": {"any": bool, "count": int, "statistics": Statistics},
    "Candidates": {"any": bool, "count": int, "statistics": Statistics},
    "Distances": {"statistics": Statistics},
    "Overlaps": {"any": bool, "count": int, "statistics": Statistics, "part": tuple},
}


class Stored:
    """Replacement for the extension module's result in a restored result: arrays and values as attributes."""

    def __init__(self, state: dict[str, Any]) -> None:
        self.__dict__.update(state)


def _values_of(kind: str, found: Any) -> dict[str, Any]:
    return {name: getattr(found, name) for name in (*_ARRAYS[kind], *_VALUES[kind])}


def stored(kind: str, found: Any) -> dict[str, Any]:
    """Returns deep, read-only copies of the arrays, and the values, of the result `found` of class `kind`, by name."""
    state = _values_of(kind, found)
    for name in _ARRAYS[kind]:
        state[name] = state[name].copy()
        state[name].flags.writeable = False
    return state


def state_of(result: Result) -> tuple[Any, ...]:
    """Returns the arguments with which `restore` makes an equal result. All arrays are NumPy arrays."""
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
        raise InvalidInput("the mesh was changed after the search, so the result no longer fits it")
    if not faces.size:
        faces = np.empty((0, 3), np.int32)
    return vertices, faces, None if mesh.groups is None else _arrays.groups(mesh.groups, which)


def restore(kind: Any, request: Any, state: Any, *scene: Any) -> Result:
    """Makes a result from a state. Raises InvalidType or InvalidInput for an invalid state."""
    if not isinstance(kind, str) or kind not in _RESULTS:
        raise InvalidType(f"a result must be one of {', '.join(_RESULTS)}, not {kind!r}")
    arrays, values = _ARRAYS[kind], _VALUES[kind]
    if not isinstance(state, dict) or state.keys() != {*arrays, *values}:
        raise InvalidType(f"the state of {kind} must be a dict of {', '.join(sorted([*arrays, *values]))}")
    for name, wanted in values.items():
        if not isinstance(state[name], wanted) or (wanted is Statistics and not _core.is_filled(state[name])):
            raise InvalidType(f"the state of {kind} needs {name} as {wanted.__name__}")
    made = {name: _array(state[name], f"the state of {kind} needs {name}", arrays[name]) for name in arrays}
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


def _array(array: Any, needs: str, wanted: Array) -> np.ndarray:
    dtype, columns = wanted.dtype, wanted.columns
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
        raise InvalidInput(f"the state of {kind} is inconsistent: scene")
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
