"""Arrays that the library cannot read in place: converted where nothing is lost, refused by name where it would be.

The extension module takes arrays in place where it can (python/src/arrays.h) and calls these functions for the
others: Python lists, byte orders of other machines, narrow and unsigned integers, and whatever is wrong.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np

from ._errors import InvalidInput, InvalidType

# DLPack's device types that a CPU can read, those that the cuda backend reads in place, and the names of the others.
_HOST = {1, 3, 11}
_CUDA = {2, 13}
_DEVICES = {4: "OpenCL", 7: "Vulkan", 8: "Metal", 10: "ROCm", 14: "oneAPI"}
_TO_HOST = "copy them to the host (PyTorch: .cpu(), CuPy: .get(), JAX: jax.device_get, Warp: .numpy())"


def _kind_of_device(device: Any, name: str) -> int:
    try:
        kind = device()[0]
        return int(getattr(kind, "value", kind))  # Open3D's enumerators are no integers
    except Exception as error:
        raise InvalidType(f"{name} do not tell where they lie, by __dlpack_device__: {error}") from error


def host_array(array: Any, name: str, in_place: str = "") -> np.ndarray:
    """The array, which must lie in host memory. `in_place`: what the cuda backend reads where it lies."""
    device = getattr(array, "__dlpack_device__", None)
    if device is not None and not isinstance(array, np.ndarray):
        kind = _kind_of_device(device, name)
        if kind in _CUDA and in_place:
            raise InvalidInput(f"{name} in CUDA memory must be {in_place}, for nothing is converted there")
        if kind not in _HOST:
            memory = "CUDA" if kind in _CUDA else _DEVICES.get(kind, "device")
            raise InvalidInput(f"{name} lie in {memory} memory, but are wanted in the host's: {_TO_HOST}")
    try:
        speaks_dlpack_only = device is not None and not hasattr(array, "__array__")
        result = np.from_dlpack(array) if speaks_dlpack_only else np.asarray(array)
    except Exception as error:
        raise InvalidInput(f"{name} cannot be read as an array: {error}") from error
    if result.dtype == object:
        raise InvalidInput(f"{name} must be an array of numbers, not {type(array).__name__}")
    return result


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
        raise InvalidInput(f"{name} must be integers, not {result.dtype}")
    return result


def vertices(array: Any, which: str) -> np.ndarray:
    """(n, 3) of float32 or float64, in native byte order and without odd strides."""
    name = which + "vertices"
    result = _rows(host_array(array, name, "(n, 3) of float32 or float64"), 3, name)
    if _is_sequence(array) and result.dtype.kind in "iu":
        result = result.astype(np.float64)
    if result.dtype.kind != "f" or result.dtype.itemsize not in (4, 8):
        raise InvalidInput(
            f"{name} must be float32 or float64, not {result.dtype}; convert them, for instance by .astype('float64')"
        )
    return _native(result, result.dtype)


def faces(array: Any, which: str) -> np.ndarray:
    """(m, 3) of int64. Nothing is truncated: what int64 cannot hold names no vertex."""
    name = which + "faces"
    result = _rows(_integers(array, name, "(m, 3) of int32, uint32 or int64"), 3, name)
    if result.dtype.kind == "u" and result.dtype.itemsize == 8 and result.size:
        too_large = np.argwhere(result > np.iinfo(np.int64).max)
        if len(too_large):
            face, corner = too_large[0]
            raise InvalidInput(
                f"{which}triangle {face} names vertex {result[face, corner]}, which no array has",
                code="index_out_of_range",
                element="triangle",
                index=int(face),
            )
    return _native(result, np.int64)


def _int32(array: np.ndarray, name: str) -> np.ndarray:
    limits = np.iinfo(np.int32)
    outside = np.argwhere((array > limits.max) | (array < limits.min))
    if len(outside):
        index = int(outside[0][0])
        raise InvalidInput(
            f"{name}: group id {array[tuple(outside[0])]} at {index} does not fit int32", element="group", index=index
        )
    return _native(array, np.int32)


def groups(array: Any, which: str) -> np.ndarray:
    """(m) of int32 without gaps."""
    name = which + "groups"
    result = _integers(array, name, "(m) of int32 without gaps")
    if result.ndim != 1:
        raise InvalidInput(f"{name} must have shape (faces,), not {result.shape}")
    return _int32(result, name)


def group_pairs(pairs: Any, which: str) -> np.ndarray:
    """(n, 2) of int32, from an array or any iterable of pairs."""
    name = which + "excluded_groups"
    if isinstance(pairs, Iterable) and (isinstance(pairs, dict) or not hasattr(pairs, "__getitem__")):
        pairs = list(pairs)  # a set, a generator: nothing that NumPy reads
    return _int32(_rows(_integers(pairs, name), 2, name), name)
