"""Conversion of the columns of a world: arrays with one entry per body.

A column is converted if no value changes; otherwise an error that names the column is raised.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from typing import Any

import numpy as np

from ._arrays import host_array
from ._errors import InvalidInput, InvalidType
from ._queries import is_array


def _column(array: Any, name: str, bodies: int | None) -> np.ndarray:
    result = host_array(array, name)
    if result.ndim == 0 and bodies is not None:  # one value for all bodies
        result = np.broadcast_to(result, bodies)
    if result.ndim != 1:
        raise InvalidInput(f"{name} must have shape (bodies,), not {result.shape}")
    if bodies is not None and len(result) != bodies:
        raise InvalidInput(f"{name} must be one for each of the {bodies} bodies, not {len(result)}")
    return result


def ids(array: Any, name: str, bodies: int | None = None) -> np.ndarray:
    """Returns integers as a read-only, contiguous (n,) int32 copy."""
    result = _column(array, name, bodies)
    if result.size == 0:
        result = result.astype(np.int32)
    if result.dtype.kind not in "iu":
        raise InvalidInput(f"{name} must be integers, not {result.dtype}")
    limits = np.iinfo(np.int32)
    outside = np.flatnonzero((result > limits.max) | (result < limits.min))
    if len(outside):
        body = int(outside[0])
        raise InvalidInput(
            f"{name}: {result[body]} of body {body} does not fit int32",
            code="index_out_of_range",
            element="body",
            index=body,
        )
    return _constant(result, np.int32)


def flags(array: Any, name: str, bodies: int) -> np.ndarray:
    """Returns truth values as a read-only, contiguous (n,) bool copy."""
    result = _column(array, name, bodies)
    if result.size and result.dtype != np.bool_:
        raise InvalidType(f"{name} must be True or False, or (bodies,) of bool, not {result.dtype}")
    return _constant(result, np.bool_)


def _constant(array: np.ndarray, dtype: Any) -> np.ndarray:
    result = np.array(array, dtype, order="C")
    result.flags.writeable = False
    return result


def names(given: Any, bodies: int) -> tuple[str, ...]:
    """Returns one name per body, "" for all if `given` is None. Refuses equal names that are not empty."""
    if given is None:
        return ("",) * bodies
    if isinstance(given, (str, bytes)) or not isinstance(given, Iterable):
        raise InvalidType(f"names must be a sequence of str, not {type(given).__name__}")
    result = tuple(str(name) if isinstance(name, str) else name for name in given)
    if len(result) != bodies:
        raise InvalidInput(f"names must be one for each of the {bodies} bodies, not {len(result)}")
    known: dict[str, int] = {}
    for body, name in enumerate(result):
        if not isinstance(name, str):
            kind = "None" if name is None else type(name).__name__
            raise InvalidType(f"names must be str, but that of body {body} is {kind}", element="body", index=body)
        if name and known.setdefault(name, body) != body:
            raise InvalidInput(
                f"names: bodies {known[name]} and {body} are both called {name!r}", element="body", index=body
            )
    return result


def _refuse(names: Sequence[str], body: int, what: str) -> None:
    told = f" ({names[body]!r})" if names[body] else ""
    raise InvalidInput(f"body {body}{told}: {what}", element="body", index=body)


def check_shapes(of: np.ndarray, shapes: int, names: Sequence[str]) -> None:
    """Raises InvalidInput if the shape index of a body is out of range. `names`: names of bodies, for the message."""
    for body in np.flatnonzero((of < 0) | (of >= shapes))[:1].tolist():
        _refuse(names, body, f"there is no shape {of[body]} (number of shapes: {shapes})")


def check_worlds(worlds: np.ndarray, names: Sequence[str]) -> None:
    """Raises InvalidInput unless world indices ascend over the bodies, and bodies in all worlds (-1) come last."""
    for body in np.flatnonzero(worlds < -1)[:1].tolist():
        _refuse(names, body, f"its world is {worlds[body]}; it must be 0 or more, or -1 for all worlds")
    order = np.where(worlds == -1, np.iinfo(np.int64).max, worlds.astype(np.int64))
    for before in np.flatnonzero(order[1:] < order[:-1])[:1].tolist():
        body, last = before + 1, worlds[before]
        what = f"its world {worlds[body]} comes after world {last}; world ids must ascend over the bodies"
        _refuse(names, body, "bodies that are in all worlds (-1) must come last" if last == -1 else what)


def pose_of(pose: Any, body: int, name: str = "pose") -> np.ndarray:
    """Returns the pose of one crumple.Body as (3, 4) float64; the identity for None."""
    if pose is None:
        return np.eye(3, 4)
    result = host_array(pose, f"body {body}: its {name}")
    sound = result.dtype.kind in "iu" or (result.dtype.kind, result.dtype.itemsize) in (("f", 4), ("f", 8))
    if result.shape not in ((3, 4), (4, 4)) or not sound:
        what = f"{result.shape}" if sound else f"{result.dtype}"
        raise InvalidInput(
            f"body {body}: its {name} must have shape (3, 4) or (4, 4), of float64, float32 or integers, not {what}",
            element="body",
            index=body,
        )
    if len(result) == 4 and result[3].tolist() != [0, 0, 0, 1]:
        last = " ".join(repr(float(value)) for value in result[3])
        raise InvalidInput(
            f"body {body}: the last row of its {name} must be 0 0 0 1, not {last}", element="body", index=body
        )
    return result[:3].astype(np.float64)


def stacked(poses: Sequence[Any], end_poses: Sequence[Any]) -> tuple[Any, Any]:
    """Returns an array of the poses, and one of the end poses, of all crumple.Body; None if no body has one.

    The end pose of a body without one is its pose.
    """
    started = ended = None
    if any(pose is not None for pose in poses):
        started = np.stack([pose_of(pose, i) for i, pose in enumerate(poses)])
    if any(pose is not None for pose in end_poses):
        pairs = enumerate(zip(poses, end_poses))
        ended = np.stack([pose_of(pose, i) if end is None else pose_of(end, i, "end pose") for i, (pose, end) in pairs])
    return started, ended


def shapes_of(shapes: Sequence[Any], given: Sequence[Any]) -> list[int]:
    """Returns the index of each body's shape. `given`: for each body, this index or one of the objects in `shapes`."""
    places = {id(shape): i for i, shape in enumerate(shapes)}
    result = []
    for i, shape in enumerate(given):
        place = places.get(id(shape), shape)
        if isinstance(place, (bool, np.bool_)) or not isinstance(place, (int, np.integer)):
            raise InvalidType(
                f"body {i}: its shape must be an index, or one of the world's crumple.Shape, not "
                f"{'another Shape' if hasattr(place, 'mesh') else type(place).__name__}",
                element="body",
                index=i,
            )
        result.append(int(place))
    return result


def excluded_pairs(excluded: Any, bodies: int, index: Callable[[str], int]) -> np.ndarray:
    """Returns excluded pairs of bodies as (k, 2) int32. They are given as indices below `bodies`, or as names.

    `index` is a function that returns the index of a name.
    """
    # Fast path: the array needs no conversion, and the extension module checks the range of its indices.
    if type(excluded) is np.ndarray and excluded.dtype == np.int32 and excluded.shape[1:] == (2,):
        return excluded
    if isinstance(excluded, (str, bytes)) or not isinstance(excluded, Iterable):
        kind = "None" if excluded is None else type(excluded).__name__
        raise InvalidType(f"excluded must be pairs of bodies, not {kind}")
    if is_array(excluded):
        pairs = host_array(excluded, "excluded")
        if pairs.size == 0:
            return np.empty((0, 2), np.int32)
        if pairs.ndim != 2 or pairs.shape[1] != 2:
            raise InvalidInput(f"excluded must have shape (k, 2), not {pairs.shape}")
        if pairs.dtype.kind not in "iu":
            raise InvalidInput(f"excluded must be integers, not {pairs.dtype}")
        outside = np.argwhere((pairs < 0) | (pairs >= bodies))
        if len(outside):
            _refuse_index(int(pairs[tuple(outside[0])]), bodies)
        return np.ascontiguousarray(pairs, np.int32)
    rows = [[_body(one, bodies, index) for one in _pair(pair)] for pair in excluded]
    return np.array(rows, np.int32).reshape(-1, 2)


def _pair(pair: Any) -> Any:
    # A set of one element stands for the pair of a body with itself.
    given = sorted(pair, key=str) if isinstance(pair, (set, frozenset)) else pair
    if isinstance(given, (str, bytes)) or not isinstance(given, Sequence | np.ndarray):
        raise InvalidType(f"excluded must be pairs of bodies, such as {{'arm', 'hand'}}, but {pair!r} is not a pair")
    if len(given) == 1 and isinstance(pair, (set, frozenset)):
        given = [given[0], given[0]]
    if len(given) != 2:
        raise InvalidInput(f"excluded must be pairs of bodies, such as {{'arm', 'hand'}}, but {pair!r} is not a pair")
    return given


def _body(given: Any, bodies: int, index: Callable[[str], int]) -> int:
    if isinstance(given, str):
        try:
            return index(given)
        except InvalidInput as error:
            raise InvalidInput(f"excluded: {error}", element="body") from None
    if isinstance(given, (bool, np.bool_)) or not isinstance(given, (int, np.integer)):
        raise InvalidType(f"excluded must name bodies by str or int, not {type(given).__name__}")
    if not 0 <= given < bodies:
        _refuse_index(int(given), bodies)
    return int(given)


def _refuse_index(body: int, bodies: int) -> None:
    raise InvalidInput(f"excluded names body {body} of {bodies}", code="index_out_of_range", element="body", index=body)
