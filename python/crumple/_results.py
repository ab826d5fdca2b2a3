"""Base class of all results, and the results that need little more: contacts, and distances of bodies."""

from __future__ import annotations

import os
from collections.abc import Iterator
from copy import deepcopy
from enum import IntEnum
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar, NamedTuple

from ._errors import InvalidInput, InvalidType

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray
    from typing_extensions import Self

    from ._core import Statistics


class Request(NamedTuple):
    """Description of the request that a result is for: the scene, and what was searched for.

    Attributes
    ----------
    scene : {"mesh", "meshes", "world", "part"}
        Kind of the scene.
    of_bodies : bool
        True if rows name bodies.
    output : str
        Member `output` of the query.
    options : frozenset of str
        Names of the members of the query that are true, such as "index".
    kinds : tuple of str
        Requested kinds of candidates; empty for other queries.
    copy : bool
        True if arrays are writable copies.
    block : bool
        True for a block of a stream, which has rows only.
    """

    scene: str
    of_bodies: bool
    output: str
    options: frozenset[str]
    kinds: tuple[str, ...]
    copy: bool
    block: bool


class Array(cached_property[Any]):
    """Descriptor of an array of a result. Pickles of the result contain this array.

    Attributes
    ----------
    dtype : str
        Type of the elements.
    columns : tuple of int
        Shape of each row.
    found : str
        Name of the array in the extension module: the name of the attribute, without a leading underscore.
    """

    def __init__(self, dtype: str, about: str, columns: tuple[int, ...]) -> None:
        super().__init__(lambda result: result._array(self.found))
        self.dtype, self.columns, self.__doc__ = dtype, columns, about

    def __set_name__(self, owner: type, name: str) -> None:
        super().__set_name__(owner, name)
        self.found = name.removeprefix("_")


# Functions that declare an array of a result, one for each type of elements. `about` is the docstring of the array.


def uint8(about: str, columns: tuple[int, ...] = ()) -> cached_property[NDArray[np.uint8]]:
    return Array("uint8", about, columns)


def int32(about: str, columns: tuple[int, ...] = ()) -> cached_property[NDArray[np.int32]]:
    return Array("int32", about, columns)


def int64(about: str, columns: tuple[int, ...] = ()) -> cached_property[NDArray[np.int64]]:
    return Array("int64", about, columns)


def float64(about: str, columns: tuple[int, ...] = ()) -> cached_property[NDArray[np.float64]]:
    return Array("float64", about, columns)


def bools(about: str, columns: tuple[int, ...] = ()) -> cached_property[NDArray[np.bool_]]:
    return Array("bool", about, columns)


class Result:
    """Base class of all results: NumPy views of the library's result.

    Notes
    -----
    A result outlives its detector, and no later call changes it. Its arrays are read-only views that keep the library's
    memory alive. When the result and all of these views are gone, the detector's next call reuses the memory. With
    `copy=True`, arrays are writable copies. Access to an attribute that was not requested raises InvalidInput, which
    names the option that requests it.

    Results can be copied and pickled: copy.copy shares the arrays, copy.deepcopy does not. Unpickling raises
    InvalidInput if the members are inconsistent. Copies and pickles do not contain changes to the arrays of
    `copy=True`.
    """

    _query: ClassVar[str]  # name of the query's class

    def __init__(self, found: Any, request: Request, *scene: Any) -> None:
        self._found = found  # the extension module's result, or _pickles.Stored
        self._request = request
        self._scene = scene  # what files and pictures need of the scene: meshes, or a world and its poses

    def _check(self, name: str) -> None:
        """Raises InvalidInput if the attribute `name` was not requested. Subclasses override this."""

    def _refuse(self, name: str, how: str) -> None:
        raise InvalidInput(f"{name} was not requested: {self._query}({how})")

    def _array(self, name: str) -> Any:
        self._check(name)
        array = getattr(self._found, name)
        return array.copy() if self._request.copy else array

    @property
    def any(self) -> bool:
        """True if anything was found."""
        return self._found.any

    @property
    def statistics(self) -> Statistics:
        """Counts and times of the call."""
        return self._found.statistics

    def __bool__(self) -> bool:
        """True if anything was found."""
        return self._found.any

    def __reduce__(self) -> Any:
        from ._pickles import restore, state_of

        return restore, state_of(self)

    def __copy__(self) -> Self:
        return type(self)(self._found, self._request, *self._scene)

    def __deepcopy__(self, memo: dict[int, Any]) -> Self:
        from ._pickles import Stored, stored

        deep_copy = getattr(self._found, "deep_copy", None)
        found = deep_copy() if deep_copy else Stored(stored(type(self).__name__, self._found))
        return type(self)(found, self._request, *(deepcopy(thing, memo) for thing in self._scene))


def file_name(path: Any) -> str:
    try:
        name = os.fsdecode(path)
        if b"\0" not in os.fsencode(name):
            return name
    except TypeError:
        kind = "None" if path is None else type(path).__name__
        raise InvalidType(f"path must be a str, bytes or os.PathLike, not {kind}") from None
    except UnicodeError:
        pass
    raise InvalidInput("path cannot be the name of a file")


def extension_of(name: str) -> str:
    """Returns the extension in lower case. For a compressed file such as pairs.csv.gz, returns ".csv"."""
    path = Path(name)
    return (path.with_suffix("") if path.suffix.lower() == ".gz" else path).suffix.lower()


class ContactKind(IntEnum):
    """Dimension of the intersection of two triangles: a point, a segment, or an area with 3 to 6 corners."""

    POINT = 1
    SEGMENT = 2
    AREA = 3


class Contacts:
    """Contacts of the pairs of a result: the whole intersection of each pair, given by its extreme points.

    `contacts[i]` has the points of pair i, and `len(contacts)` is the number of pairs.

    Attributes
    ----------
    kinds : (pairs,) ndarray of uint8
        ContactKind of each pair.
    offsets : (pairs + 1,) ndarray of int64
        Pair i has the points points[offsets[i]:offsets[i + 1]].
    points : (k, 3) ndarray of float64
        Extreme points: 1 of a point, 2 of a segment, 3 to 6 of an area.

    Notes
    -----
    Each coordinate is computed exactly, then rounded to the nearest float64. The lexicographically smallest exact point
    comes first. The points of an area run counter-clockwise about the first triangle's normal.
    """

    kinds: NDArray[np.uint8]
    offsets: NDArray[np.int64]
    points: NDArray[np.float64]

    def __init__(self, kinds: NDArray[np.uint8], offsets: NDArray[np.int64], points: NDArray[np.float64]) -> None:
        self.kinds = kinds
        self.offsets = offsets
        self.points = points

    def __len__(self) -> int:
        """Number of pairs."""
        return len(self.kinds)

    def __getitem__(self, pair: int) -> NDArray[np.float64]:
        """Returns the points of a pair, a (1 to 6, 3) float64 view. Raises IndexError."""
        if not -len(self) <= pair < len(self):
            raise IndexError(f"contact {pair} does not exist (number of contacts: {len(self)})")
        pair %= len(self)
        return self.points[self.offsets[pair] : self.offsets[pair + 1]]

    def __iter__(self) -> Iterator[NDArray[np.float64]]:
        """Yields the points of each pair, as `contacts[i]`."""
        return (self[pair] for pair in range(len(self)))

    def __repr__(self) -> str:
        return f"<crumple.Contacts: {len(self)} pairs, {len(self.points)} points>"


class Distances(Result):
    """Result of a DistanceQuery: one row for each pair of bodies.

    `len(distances)` is the number of rows.

    Notes
    -----
    Rows are sorted by first body, then second; the first is the lower one. So the rows of each world follow those of
    the world before. Pairs of bodies that are both in all worlds occur once, and come last. Every backend, instruction
    set and thread count gives the same bytes.
    """

    _query = "DistanceQuery"

    bodies = int32("(k, 2) int32: the two bodies, the lower one first.", (2,))
    squared_distance = float64(
        "(k,) float64: exact squared distance, rounded to the nearest number; 0 if triangles intersect."
    )

    @cached_property
    def distance(self) -> NDArray[np.float64]:
        """Square root of `squared_distance`: (k,) float64."""
        import numpy as np

        distance = np.sqrt(self.squared_distance)
        distance.flags.writeable = self._request.copy
        return distance

    touching = bools("(k,) bool: True if the distance is 0 exactly. A squared distance may also be rounded to 0.")
    triangles = int32("(k, 2) int32: a triangle of each body, the first pair at that distance.", (2,))
    points = float64(
        "(k, 2, 3) float64: closest points of these triangles, one of each body, rounded; if they intersect, a common "
        "point, twice.",
        (2, 3),
    )
    world_rows = int64(
        '(w,) int64: row of each world, or -1 if no pair of its bodies is within the radius; for output="nearest".'
    )

    def _check(self, name: str) -> None:
        if name == "world_rows" and self._request.output != "nearest":
            self._refuse(name, 'output="nearest"')

    @property
    def any(self) -> bool:
        """True if there is a row."""
        return len(self) > 0

    @property
    def count(self) -> int:
        """Number of pairs of bodies that are listed."""
        return len(self)

    def __bool__(self) -> bool:
        """True if there is a row."""
        return len(self) > 0

    def __len__(self) -> int:
        """Number of pairs of bodies that are listed."""
        return len(self._found.bodies)

    def __repr__(self) -> str:
        pairs = "pair" if len(self) == 1 else "pairs"
        told = f"{len(self)} {pairs} of bodies, {int(self._found.touching.sum())} touching"
        return f"<crumple.Distances: {told}, {self.statistics.milliseconds:.3g} ms>"
