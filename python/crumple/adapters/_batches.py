"""Helpers of adapters that search many configurations at once: rows of joint values, poses, and pairs of groups."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from difflib import get_close_matches
from typing import TYPE_CHECKING, Any

import numpy as np

from .._arrays import host_array
from .._errors import InvalidInput

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["excluded_groups", "finite_rows", "pose_of", "rigid_pose_of", "slices", "suggestion"]


def finite_rows(given: Any, name: str, columns: int, shape: str) -> tuple[NDArray[np.float64], tuple[int, ...]]:
    """Returns an array of shape (..., columns) as (n, columns), and the leading part of its shape.

    Raises InvalidInput if the shape is wrong or a value is not finite. `shape` is the part of the message that states
    the right shape, and `name` is what a message calls the array.
    """
    array = host_array(given, name)
    if array.ndim < 1 or array.shape[-1] != columns:
        raise InvalidInput(f"{name} must {shape}, not {array.shape}")
    rows = np.ascontiguousarray(array, np.float64).reshape(math.prod(array.shape[:-1]), columns)
    odd = np.flatnonzero(~np.isfinite(rows).all(axis=1))
    if len(odd):
        raise InvalidInput(f"{name}: configuration {odd[0]} has a value that is not finite")
    return rows, array.shape[:-1]


def slices(count: int, size: int) -> Iterator[slice]:
    """Yields slices of at most `size` rows that cover `count` rows."""
    return (slice(begin, begin + size) for begin in range(0, count, size))


def pose_of(pose: Any, which: str, noun: str = "pose") -> NDArray[np.float64]:
    """Returns a copy of a pose as (3, 4). Raises InvalidInput, beginning with `which`, if it is invalid."""
    array = np.array(pose, np.float64)
    if array.shape not in ((3, 4), (4, 4)):
        raise InvalidInput(f"{which}: its {noun} must have shape (3, 4) or (4, 4), not {array.shape}")
    if not np.isfinite(array).all():
        raise InvalidInput(f"{which}: its {noun} must be finite")
    return array[:3]


def rigid_pose_of(pose: Any, which: str, noun: str = "pose") -> NDArray[np.float64]:
    """Returns a rigid pose as (4, 4). Raises InvalidInput if it is no rotation with a translation, up to 1e-9."""
    made = np.eye(4)
    made[:3] = pose_of(pose, which, noun)
    turn = made[:3, :3]
    if np.abs(turn @ turn.T - np.eye(3)).max() > 1e-9 or np.linalg.det(turn) < 0:
        raise InvalidInput(f"{which}: its {noun} is not a rotation with a translation")
    return made


def excluded_groups(tested: NDArray[np.bool_]) -> NDArray[np.int32]:
    """Returns the pairs of groups, (k, 2), that are not tested, for PairFilter(excluded_groups=).

    `tested` is a symmetric (groups, groups) matrix. Groups of a filter are not repeated for each configuration, as
    excluded bodies are.
    """
    first, second = np.triu_indices(len(tested))
    left_out = ~tested[first, second]
    return np.column_stack([first, second])[left_out].astype(np.int32)


def suggestion(name: str, names: Iterable[str]) -> str:
    """Returns the end of a message about an unknown name: a similar name, if there is one."""
    close = get_close_matches(name, list(names), n=1)
    return f". Did you mean {close[0]!r}?" if close else ""
