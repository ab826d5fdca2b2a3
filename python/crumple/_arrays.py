"""Conversion of arrays that the library cannot read in place.

The extension module reads arrays in place if it can (python/src/arrays.h). It calls these functions for all others:
Python lists, foreign byte orders, narrow and unsigned integers, and invalid input. The functions convert an array if no
value changes, and otherwise raise InvalidInput or InvalidType, which names the array. The parameter `which` is a prefix
of that name, such as "first mesh: ".
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Any

import numpy as np

from ._errors import InvalidInput, InvalidType

# DLPack's device types: types of memory that a CPU can read, types that the cuda backend reads in place, and names of
# some others for messages.
_HOST = {1, 3, 11}
_CUDA = {2, 13}
_DEVICES = {4: "OpenCL", 7: "Vulkan", 8: "Metal", 10: "ROCm", 14: "oneAPI"}
_TO_HOST = "copy them to the host (PyTorch: .cpu(), CuPy: .get(), JAX: jax.device_get, Warp: .numpy())"


def _kind_of_device(device: Any, name: str) -> int:
    try:
        kind = device()[0]
        return int(getattr(kind, "value", kind))  # Open3D returns an enumerator that is no integer
    except Exception as error:
        raise InvalidType(f"{name} cannot be read: __dlpack_device__ failed: {error}") from error


def _refuse_mask(array: Any, name: str, **place: Any) -> None:
    if isinstance(array, np.ma.MaskedArray) and np.ma.is_masked(array):
        first = np.argwhere(np.ma.getmaskarray(array))[0].tolist()
        if "element" in place:
            place["index"] = first[0]
        raise InvalidInput(
            f"{name} masked at {tuple(first)}: a masked array must have no masked value; leave out masked elements, "
            "fill them by numpy.ma.filled, or pass .data, which has no mask",
            **place,
        )


# For each kind of array: its name in messages, and the name of one of its elements.
_NAMES = {
    "vertices": ("vertices", "vertex"),
    "end_vertices": ("end vertices", "vertex"),
    "rest_vertices": ("rest vertices", "vertex"),
    "radii": ("radii", "vertex"),
    "faces": ("faces", "triangle"),
    "groups": ("groups", "group"),
    "group_pairs": ("excluded_groups", "group"),
    "poses": ("poses", "body"),
    "edges": ("edges", "edge"),
    "points": ("points", "point"),
    "triangle_ids": ("triangle_ids", "triangle"),
    "vertex_ids": ("vertex_ids", "vertex"),
    "body_ids": ("body_ids", "body"),
}


def refuse_masked(array: Any, kind: str, which: str) -> None:
    """Raises InvalidInput if a NumPy array, of a subclass of ndarray that is read in place, has masked values."""
    name, element = _NAMES[kind]
    _refuse_mask(array, f"{which}{name} are", element=element)


def lies_in_cuda_memory(array: Any) -> bool:
    """True if `__dlpack_device__` reports CUDA memory; False if the array has no such method."""
    try:
        return _kind_of_device(array.__dlpack_device__, "") in _CUDA
    except Exception:  # host_array raises an error later, unless the array can be read in another way
        return False


def refuse_failed_dlpack(error: BaseException, stream: int, kind: str, which: str) -> None:
    """Raises an error that names the array, with the exception that its `__dlpack__` has raised as the cause."""
    if not isinstance(error, Exception):
        raise error
    name = f"{which}{_NAMES[kind][0]}"
    message = (
        f"{name} in CUDA memory cannot be read: __dlpack__(stream={stream}), which makes them ready on the stream, "
        f"raised {type(error).__name__}: {error}"
    )
    raise (MemoryError if isinstance(error, MemoryError) else InvalidInput)(message) from error


def refuse_unannounced_cuda_memory(kind: str, which: str) -> None:
    """Raises InvalidInput for an array in CUDA memory whose `__dlpack_device__` did not report CUDA memory.

    Its `__dlpack__` was therefore called without a stream, so the array may not be ready.
    """
    name = f"{which}{_NAMES[kind][0]}"
    raise InvalidInput(
        f"{name} lie in CUDA memory, but have no __dlpack_device__ that says so, and cannot be made ready on a stream"
    )


def _name_of_type(thing: Any) -> str:
    return "None" if thing is None else type(thing).__name__


def _length(row: Any) -> int | None:
    try:
        return None if isinstance(row, (str, bytes)) else len(row)
    except TypeError:
        return None


def _ragged(rows: Any) -> str:
    """Returns a description of two rows of unequal length, or "" if all rows have the same length."""
    lengths = [_length(row) for row in rows]

    def told(i: int) -> str:
        return f"row {i} is {_name_of_type(rows[i])}" if lengths[i] is None else f"row {i} has {lengths[i]} elements"

    other = next((i for i, length in enumerate(lengths) if length != lengths[0]), 0)
    return f"{told(other)}, {told(0)}" if other else ""


def _what_objects(array: Any, objects: np.ndarray) -> str:
    """Returns the end of a message: what an array of Python objects contains instead of numbers."""
    if objects.ndim == 0:
        return f"not {_name_of_type(array)}"
    if objects.ndim == 1 and any(_length(row) is not None for row in objects):
        return f"not of rows: {_ragged(objects) or 'numpy.stack joins them'}"
    integers = True
    for place, element in np.ndenumerate(objects):
        if isinstance(element, bool) or not isinstance(element, (int, float, np.integer, np.floating)):
            return f"but element {place} is {_name_of_type(element)}"
        integers = integers and isinstance(element, (int, np.integer))
        if integers and not -(2**63) <= element < 2**64:
            return f"but element {place} is {element}, which does not fit in 64 bits"
    return f"not of objects; convert it, for instance by .astype({'int64' if integers else 'float64'!r})"


def host_array(array: Any, name: str, in_place: str = "") -> np.ndarray:
    """Returns an array in host memory as a NumPy array, without a copy if possible.

    Parameters
    ----------
    array : array_like
        NumPy array, sequence, or anything that supports DLPack.
    name : str
        Name of the array in messages.
    in_place : str, default ""
        Shape and type that the cuda backend reads in place, for messages about arrays in CUDA memory; "" if it reads
        none.

    Returns
    -------
    ndarray
        Array of any shape and of a numeric dtype.

    Raises
    ------
    InvalidInput
        If the array is in device memory, is ragged, has masked values, or cannot be read.
    InvalidType
        If its elements are Python objects that are not numbers.
    MemoryError
        If there is not enough memory for a copy.
    """
    device = getattr(array, "__dlpack_device__", None)
    if device is not None and not isinstance(array, np.ndarray):
        kind = _kind_of_device(device, name)
        if kind in _CUDA and in_place:
            raise InvalidInput(f"{name} in CUDA memory must be {in_place}; arrays there are not converted")
        if kind not in _HOST:
            memory = "CUDA" if kind in _CUDA else _DEVICES.get(kind, "device")
            raise InvalidInput(f"{name} lie in {memory} memory, but must be in host memory: {_TO_HOST}")
    try:
        has_dlpack_only = device is not None and not hasattr(array, "__array__")
        result = np.from_dlpack(array) if has_dlpack_only else np.asanyarray(array)
    except MemoryError as error:
        why = str(error) or "the machine has no memory left"
        raise MemoryError(f"{name} cannot be read as an array: {why}") from error
    except Exception as error:
        why = _ragged(array) if isinstance(error, ValueError) and _is_sequence(array) else ""
        raise InvalidInput(f"{name} cannot be read as an array: {why or error}") from error
    _refuse_mask(result, f"{name} are")
    for row in array if _is_sequence(array) else ():
        _refuse_mask(row, f"{name}: a row is")
    result = np.asarray(result)
    if result.dtype == object:
        raise InvalidType(f"{name} must be an array of numbers, {_what_objects(array, result)}")
    return result


def _triangles(array: np.ndarray, name: str) -> np.ndarray:
    """Returns faces as (m, 3), from (m, 3) or flat indices. Refuses flat cells that are preceded by their size, 3."""
    if array.ndim != 1:
        return _rows(array, 3, name)
    if len(array) and len(array) % 4 == 0 and (array[::4] == 3).all():
        raise InvalidInput(
            f"{name} look like cells with their sizes, (3, a, b, c, 3, d, e, f, ...): "
            "pass .reshape(-1, 4)[:, 1:] of them"
            + (", or .reshape(-1, 3) if they are triangles nevertheless" if len(array) % 3 == 0 else "")
        )
    if len(array) % 3:
        raise InvalidInput(
            f"{name} must have shape (n, 3), or be flat with three indices a triangle, not {array.shape}"
        )
    return array.reshape(-1, 3)


def _rows(array: np.ndarray, columns: int, name: str) -> np.ndarray:
    if array.shape == (0,):  # an empty list
        array = array.reshape(0, columns)
    if array.ndim != 2 or array.shape[1] != columns:
        raise InvalidInput(f"{name} must have shape (n, {columns}), not {array.shape}")
    return array


def _native(array: np.ndarray, dtype: Any) -> np.ndarray:
    return np.require(array, np.dtype(dtype).newbyteorder("="), ["C", "A"])


def _is_sequence(array: Any) -> bool:
    return isinstance(array, (list, tuple))


def _integers(array: Any, name: str, in_place: str = "") -> np.ndarray:
    result = host_array(array, name, in_place)
    if result.size == 0 and _is_sequence(array):
        result = result.astype(np.int64)
    if result.dtype.kind not in "iu":
        raise InvalidType(f"{name} must be integers, not {result.dtype}")
    return result


def _positions(array: Any, name: str, in_place: str = "") -> np.ndarray:
    """Returns positions as (n, 3) float32 or float64 in native byte order, contiguous and aligned."""
    result = _rows(host_array(array, name, in_place), 3, name)
    if _is_sequence(array) and result.dtype.kind in "iu":
        result = result.astype(np.float64)
    if result.dtype.kind != "f" or result.dtype.itemsize not in (4, 8):
        raise InvalidType(
            f"{name} must be float32 or float64, not {result.dtype}; convert them, for instance by .astype('float64')"
        )
    return _native(result, result.dtype)


def vertices(array: Any, which: str) -> np.ndarray:
    """Converts vertices to (n, 3) float32 or float64."""
    return _positions(array, which + "vertices", "(n, 3) of float32 or float64")


def end_vertices(array: Any, which: str) -> np.ndarray:
    """Converts positions at the end of a step to (n, 3) float32 or float64."""
    return _positions(array, which + "end vertices", "(n, 3) of float32 or float64")


def rest_vertices(array: Any, which: str) -> np.ndarray:
    """Converts positions of a rest shape to (n, 3) float32 or float64."""
    return _positions(array, which + "rest vertices", "(n, 3) of float32 or float64")


def radii(array: Any, which: str) -> np.ndarray:
    """Converts radii to (n,) float64, contiguous."""
    name = which + "radii"
    result = host_array(array, name, "(n) of float64 without gaps")
    if result.ndim != 1:
        raise InvalidInput(f"{name} must have shape (vertices,), not {result.shape}")
    if _is_sequence(array) and result.dtype.kind in "iu":
        result = result.astype(np.float64)
    if result.dtype.kind != "f" or result.dtype.itemsize not in (4, 8):
        raise InvalidType(f"{name} must be float64 or float32, not {result.dtype}")
    return _native(result, np.float64)


def faces(array: Any, which: str) -> np.ndarray:
    """Converts faces, (m, 3) or flat, to (m, 3) int64. Refuses indices that do not fit in int64."""
    name = which + "faces"
    result = _triangles(_integers(array, name, "(m, 3) or (3m) of int32, uint32 or int64"), name)
    if result.dtype.kind == "u" and result.dtype.itemsize == 8 and result.size:
        too_large = np.argwhere(result > np.iinfo(np.int64).max)
        if len(too_large):
            face, corner = too_large[0]
            raise InvalidInput(
                f"{which}triangle {face} names vertex {result[face, corner]}; this is outside the range of int64",
                code="index_out_of_range",
                element="triangle",
                index=int(face),
            )
    return _native(result, np.int64)


def _int32(array: np.ndarray, name: str, what: str = "group id", element: str = "group") -> np.ndarray:
    limits = np.iinfo(np.int32)
    outside = np.argwhere((array > limits.max) | (array < limits.min))
    if len(outside):
        index = int(outside[0][0])
        raise InvalidInput(
            f"{name}: {what} {array[tuple(outside[0])]} at {index} does not fit int32", element=element, index=index
        )
    return _native(array, np.int32)


def groups(array: Any, which: str) -> np.ndarray:
    """Converts groups to (m,) int32, contiguous."""
    name = which + "groups"
    result = _integers(array, name, "(m) of int32 without gaps")
    if result.ndim != 1:
        raise InvalidInput(f"{name} must have shape (faces,), not {result.shape}")
    return _int32(result, name)


def edges(array: Any, which: str) -> np.ndarray:
    """Converts codimensional edges to (k, 2) int32, contiguous."""
    name = which + "edges"
    return _int32(_rows(_integers(array, name, "(k, 2) of int32 without gaps"), 2, name), name, "vertex", "edge")


def points(array: Any, which: str) -> np.ndarray:
    """Converts codimensional points, which are indices of vertices, to (k,) int32, contiguous."""
    name = which + "points"
    result = _integers(array, name, "(k) of int32 without gaps")
    if result.ndim != 1:
        raise InvalidInput(f"{name} must have shape (n,), indices of vertices, not {result.shape}")
    return _int32(result, name, "vertex", "point")


def _ids(array: Any, name: str) -> np.ndarray:
    """Converts ids to (n,) int64, contiguous. Does not check the values: the library does."""
    result = _integers(array, name)
    if result.ndim != 1:
        raise InvalidInput(f"{name} must have shape (n,), not {result.shape}")
    if result.dtype == np.uint64 and result.size and result.max() > np.iinfo(np.int64).max:
        raise InvalidInput(f"{name}: {result.max()} does not fit int64")
    return _native(result, np.int64)


def triangle_ids(array: Any, which: str) -> np.ndarray:
    """Converts ids of local triangles, which count over all ranks, to (m,) int64."""
    return _ids(array, which + "triangle_ids")


def vertex_ids(array: Any, which: str) -> np.ndarray:
    """Converts ids of local vertices, which count over all ranks, to (n,) int64."""
    return _ids(array, which + "vertex_ids")


def body_ids(array: Any, which: str) -> np.ndarray:
    """Converts ids of local bodies, which count over all ranks, to (n,) int64."""
    return _ids(array, which + "body_ids")


def poses(array: Any, which: str) -> np.ndarray:
    """Converts poses to float64: (n, 3, 4) or (n, 4, 4), or with a leading axis of configurations."""
    name = which + "poses"
    result = host_array(array, name, "(n, 3, 4) of float64 or float32 without gaps")
    if result.shape == (0,):  # an empty list
        result = result.reshape(0, 3, 4)
    if result.ndim not in (3, 4) or result.shape[-1] != 4 or result.shape[-2] not in (3, 4):
        raise InvalidInput(f"{name} must have shape (bodies, 3, 4) or (bodies, 4, 4), not {result.shape}")
    if result.dtype.kind not in "iu" and (result.dtype.kind, result.dtype.itemsize) not in (("f", 4), ("f", 8)):
        raise InvalidType(f"{name} must be float64 or float32, not {result.dtype}")
    return _native(result, np.float64)


def group_pairs(pairs: Any, which: str) -> np.ndarray:
    """Converts an array or an iterable of pairs of groups to (n, 2) int32."""
    name = which + "excluded_groups"
    if isinstance(pairs, Iterable) and (isinstance(pairs, dict) or not hasattr(pairs, "__getitem__")):
        pairs = list(pairs)  # NumPy does not read sets and generators
    return _int32(_rows(_integers(pairs, name), 2, name), name)


def if_given(convert: Callable[[Any, str], np.ndarray], array: Any) -> np.ndarray | None:
    """Returns convert(array, ""), where `convert` is a function of this module, or None if `array` is None."""
    return None if array is None else convert(array, "")
