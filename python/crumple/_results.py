"""The base of all results, and the results that need little more: contacts, and distances of bodies."""

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
    """The request that a result is for.

    Attributes:
        scene: "mesh", "meshes", "world" or "part".
        of_bodies: whether rows have bodies.
        output: as the query has it.
        options: members of the query that are true, such as "index".
        kinds: of candidates.
        copy: arrays are writable copies.
        block: a block of a stream, which has rows and nothing else.
    """

    scene: str
    of_bodies: bool
    output: str
    options: frozenset[str]
    kinds: tuple[str, ...]
    copy: bool
    block: bool


class Array(cached_property[Any]):
    """An array of a result, which its pickles have, too.

    Attributes:
        dtype: of its elements.
        columns: of each row.
        found: the name that the extension module has for it: that of the attribute, without a leading underscore.
    """

    def __init__(self, dtype: str, about: str, columns: tuple[int, ...]) -> None:
        super().__init__(lambda result: result._array(self.found))
        self.dtype, self.columns, self.__doc__ = dtype, columns, about

    def __set_name__(self, owner: type, name: str) -> None:
        super().__set_name__(owner, name)
        self.found = name.removeprefix("_")


# Declare an array by the type of its elements; `about` is what help() shows of it.


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
    """Base of all results: NumPy views of what the library found.

    A result outlives its detector, and no later call changes it. Its arrays are read-only views of the library's memory
    that keep that memory alive; once the last of them is gone, the detector's next call uses the memory again. With
    `copy=True` they are writable arrays of their own. What was not requested is an InvalidInput that says how to ask.

    Results can be copied and pickled: copy.copy shares the arrays, copy.deepcopy does not; unpickling checks that all
    of it fits together, or raises InvalidInput. What was written into the arrays of `copy=True` is not carried.
    """

    _query: ClassVar[str]  # the name of the query

    def __init__(self, found: Any, request: Request, *scene: Any) -> None:
        self._found = found  # of the extension module, or _pickles.Stored
        self._request = request
        self._scene = scene  # what files and pictures need of it

    def _check(self, name: str) -> None:
        """Raises InvalidInput, which says how to ask, for an array that was not requested."""

    def _refuse(self, name: str, how: str) -> None:
        raise InvalidInput(f"{name} was not requested: {self._query}({how})")

    def _array(self, name: str) -> Any:
        self._check(name)
        array = getattr(self._found, name)
        return array.copy() if self._request.copy else array

    @property
    def any(self) -> bool:
        """True if there is anything at all."""
        return self._found.any

    @property
    def statistics(self) -> Statistics:
        """Counts and times of the stages."""
        return self._found.statistics

    def __bool__(self) -> bool:
        """True if there is anything at all."""
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
    """In lower case; .csv for pairs.csv.gz, whose contents are compressed."""
    path = Path(name)
    return (path.with_suffix("") if path.suffix.lower() == ".gz" else path).suffix.lower()


class ContactKind(IntEnum):
    """What two triangles have in common: 1, 2 or 3 to 6 extreme points."""

    POINT = 1
    SEGMENT = 2
    AREA = 3


class Contacts:
    """Where the pairs of a result meet: the whole intersection of each pair by its extreme points.

    Each coordinate is the exact one, rounded to the nearest float64. The lexicographically smallest exact point comes
    first; areas run counter-clockwise about the first triangle's normal.

    Attributes:
        kinds: (pairs,) uint8, a ContactKind each.
        offsets: (pairs + 1,) int64; the points of pair i are points[offsets[i]:offsets[i + 1]], or contacts[i].
        points: (k, 3) float64; 1, 2 or 3 to 6 a pair.
    """

    kinds: NDArray[np.uint8]
    offsets: NDArray[np.int64]
    points: NDArray[np.float64]

    def __init__(self, kinds: NDArray[np.uint8], offsets: NDArray[np.int64], points: NDArray[np.float64]) -> None:
        self.kinds = kinds
        self.offsets = offsets
        self.points = points

    def __len__(self) -> int:
        """How many pairs."""
        return len(self.kinds)

    def __getitem__(self, pair: int) -> NDArray[np.float64]:
        """(1 to 6, 3) float64: the points of a pair, a view. Raises IndexError."""
        if not -len(self) <= pair < len(self):
            raise IndexError(f"there are {len(self)} contacts, none of number {pair}")
        pair %= len(self)
        return self.points[self.offsets[pair] : self.offsets[pair + 1]]

    def __iter__(self) -> Iterator[NDArray[np.float64]]:
        """The points of one pair after the other, as contacts[i]."""
        return (self[pair] for pair in range(len(self)))

    def __repr__(self) -> str:
        return f"<crumple.Contacts: {len(self)} pairs, {len(self.points)} points>"


class Distances(Result):
    """How far apart bodies are: a row for each pair of them, the same bytes wherever it is computed.

    Rows are in the order of first body, second body, the first the lower one. So worlds follow each other, and pairs
    among bodies that are in all worlds, which come once, are last. `len(distances)` is the number of rows.
    """

    _query = "DistanceQuery"

    bodies = int32("(k, 2) int32: the two bodies, the lower one first.", (2,))
    squared_distance = float64(
        "(k,) float64: their exact squared distance, rounded to the nearest number; 0 where triangles intersect."
    )

    @cached_property
    def distance(self) -> NDArray[np.float64]:
        """(k,) float64: the square root of `squared_distance`."""
        import numpy as np

        distance = np.sqrt(self.squared_distance)
        distance.flags.writeable = self._request.copy
        return distance

    touching = bools("(k,) bool: whether the distance is 0 exactly. A squared distance may also be rounded to 0.")
    triangles = int32("(k, 2) int32: which triangle of each body, the first of those that are at that distance.", (2,))
    points = float64(
        "(k, 2, 3) float64: where these triangles are closest, a point of each body's, rounded; of such as intersect "
        "one point of both, twice.",
        (2, 3),
    )
    world_rows = int64(
        '(w,) int64: the row of each world, or -1 if no pair of its bodies is within the radius; for output="nearest".'
    )

    def _check(self, name: str) -> None:
        if name == "world_rows" and self._request.output != "nearest":
            self._refuse(name, 'output="nearest"')

    @property
    def any(self) -> bool:
        """True if there is any row."""
        return len(self) > 0

    @property
    def count(self) -> int:
        """How many pairs of bodies are listed."""
        return len(self)

    def __bool__(self) -> bool:
        """True if there is any row."""
        return len(self) > 0

    def __len__(self) -> int:
        """How many pairs of bodies are listed."""
        return len(self._found.bodies)

    def __repr__(self) -> str:
        pairs = "pair" if len(self) == 1 else "pairs"
        told = f"{len(self)} {pairs} of bodies, {int(self._found.touching.sum())} touching"
        return f"<crumple.Distances: {told}, {self.statistics.milliseconds:.3g} ms>"
