"""Takes a Result apart for pickle, and puts it together again, with all that is read checked."""

from __future__ import annotations

from typing import Any

import numpy as np

from . import _arrays, _core
from ._errors import InvalidInput, InvalidType
from ._mesh import Mesh
from ._result import Result

# Type and shape of each array; without contacts, theirs are empty.
_ARRAYS = {
    "pairs": (np.int32, (-1, 2)),
    "offsets": (np.int64, (-1,)),
    "hit": (np.bool_, (-1,)),
    "hit_second": (np.bool_, (-1,)),
    "contact_kinds": (np.uint8, (-1,)),
    "contact_offsets": (np.int64, (-1,)),
    "contact_points": (np.float64, (-1, 3)),
}
_OTHERS = {"statistics", "first", "second", "has_contacts", "copy", "ids", "ids_second"}


def _mesh_as_arrays(mesh: Mesh, which: str, triangles: int) -> tuple[Any, Any, Any]:
    vertices = _arrays.vertices(mesh.vertices, which)
    faces = _arrays.host_array(mesh.faces, which + "faces")
    if faces.size != 3 * triangles:
        raise InvalidInput("the mesh was changed after the search: the result does not fit it any more")
    if not faces.size:
        faces = np.empty((0, 3), np.int32)
    return vertices, faces, None if mesh.groups is None else _arrays.groups(mesh.groups, which)


def state_of(result: Result) -> dict[str, Any]:
    """What restore needs to make an equal result. All arrays are NumPy's, those of the meshes too."""
    answer, first, second = result._answer, result._first, result._second
    state: dict[str, Any] = {name: getattr(answer, name) for name in _ARRAYS}
    one_soup = second is None
    return {
        **state,
        "statistics": result.statistics,
        "first": _mesh_as_arrays(first, "" if one_soup else "first mesh: ", len(state["hit"])),
        "second": None if second is None else _mesh_as_arrays(second, "second mesh: ", len(state["hit_second"])),
        "has_contacts": answer.has_contacts,
        "copy": answer.copy,
        "ids": result._ids[0],
        "ids_second": result._ids[1],
    }


def _array(array: Any, name: str) -> np.ndarray:
    dtype, shape = _ARRAYS[name]
    if not isinstance(array, np.ndarray) or array.dtype.newbyteorder("=") != dtype:
        raise InvalidType(f"the state of a Result needs {name} as an array of {np.dtype(dtype)}")
    if array.ndim != len(shape) or array.shape[1:] != shape[1:]:
        raise InvalidInput(f"the state of a Result needs {name} of shape {shape}, not {array.shape}")
    array = np.require(array, dtype, ["C", "A"])
    return array.view(np.uint8) if dtype is np.bool_ else array


def restore(state: Any) -> Result:
    """A result with memory of its own. Raises InvalidType and InvalidInput for what state_of cannot have given."""
    if not isinstance(state, dict) or set(state) != _ARRAYS.keys() | _OTHERS:
        raise InvalidType(f"the state of a Result must be a dict of {', '.join([*_ARRAYS, *sorted(_OTHERS)])}")
    arrays = [_array(state[name], name) for name in _ARRAYS]
    for name in ("has_contacts", "copy"):
        if not isinstance(state[name], bool):
            raise InvalidType(f"the state of a Result needs {name} as bool")
    for name in ("first", "second"):
        if not isinstance(state[name], tuple) or len(state[name]) != 3:
            if name == "first" or state[name] is not None:
                raise InvalidType(f"the state of a Result needs {name} as a tuple (vertices, faces, groups)")
    ids = []
    for name in ("ids", "ids_second"):
        if state[name] is not None and (not isinstance(state[name], np.ndarray) or state[name].dtype != np.int32):
            raise InvalidType(f"the state of a Result needs {name} as an array of int32 or None")
        ids.append(None if state[name] is None else np.require(state[name].ravel(), np.int32, ["C", "A"]))
    first = Mesh(*state["first"])
    second = None if state["second"] is None else Mesh(*state["second"])
    answer = _core.restore(*arrays, state["statistics"], first, second, state["has_contacts"], state["copy"], *ids)
    return Result(answer, first, second, (ids[0], ids[1]))
