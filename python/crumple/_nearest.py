"""Detector.find_nearest and its answer."""

from __future__ import annotations

import math
from functools import cached_property
from typing import TYPE_CHECKING, Any

from . import _core
from ._core import Statistics
from ._errors import InvalidInput, InvalidType
from ._names import suggesting
from ._world import World
from ._world_search import excluded_in, with_names

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray
    from typing_extensions import Self

    from ._detector import Detector, GroupPairs, Wanted


class NearestBodies:
    """How far apart bodies are: a row for each pair of them, the same bytes wherever it is computed.

    Rows are in the order of first body, second body, the first the lower one. So worlds follow each other, and pairs
    among bodies that are in all worlds, which come once, are last.

    `len(nearest)` is the number of rows. It outlives its detector, and no later call changes it. Its arrays are
    read-only views of the library's memory that keep that memory alive, or with `copy=True` writable arrays of their
    own. It can be copied and pickled: copy.copy shares the arrays, copy.deepcopy does not.
    """

    def __init__(self, answer: Any) -> None:
        self._answer = answer

    def _array(self, name: str) -> Any:
        array = getattr(self._answer, name)
        return array.copy() if self._answer.copy else array

    @cached_property
    def bodies(self) -> NDArray[np.int32]:
        """(k, 2) int32: the two bodies, the lower one first."""
        return self._array("bodies")

    @cached_property
    def squared_distance(self) -> NDArray[np.float64]:
        """(k,) float64: their exact squared distance, rounded to the nearest number; 0 where triangles intersect."""
        return self._array("squared_distance")

    @cached_property
    def distance(self) -> NDArray[np.float64]:
        """(k,) float64: the square root of `squared_distance`."""
        import numpy as np

        distance = np.sqrt(self.squared_distance)
        distance.flags.writeable = self._answer.copy
        return distance

    @cached_property
    def touching(self) -> NDArray[np.bool_]:
        """(k,) bool: whether the distance is 0 exactly. A squared distance may also be rounded to 0."""
        return self._array("touching")

    @cached_property
    def triangles(self) -> NDArray[np.int32]:
        """(k, 2) int32: which triangle of each body, the first of those that are at that distance."""
        return self._array("triangles")

    @cached_property
    def points(self) -> NDArray[np.float64]:
        """(k, 2, 3) float64: where these triangles are closest, a point of each body's, rounded; of such as intersect
        one point of both, twice.
        """
        return self._array("points")

    @property
    def statistics(self) -> Statistics:
        """Counts and times."""
        return self._answer.statistics

    def __len__(self) -> int:
        """How many pairs of bodies are listed."""
        return len(self._answer.bodies)

    def __repr__(self) -> str:
        pairs = "pair" if len(self) == 1 else "pairs"
        told = f"{len(self)} {pairs} of bodies, {int(self._answer.touching.sum())} touching"
        return f"<crumple.NearestBodies: {told}, {self.statistics.milliseconds:.3g} ms>"

    def __reduce__(self) -> Any:
        return _restore, (_stored(self._answer),)

    def __copy__(self) -> Self:
        return type(self)(self._answer)

    def __deepcopy__(self, memo: dict[int, Any]) -> Self:
        return type(self)(_StoredAnswer(_stored(self._answer)))


class _StoredAnswer:
    """An answer in arrays of its own, where _core.NearestAnswer has the library's."""

    def __init__(self, state: dict[str, Any]) -> None:
        self.__dict__.update(state)


_PLAIN = {"copy": bool, "statistics": Statistics}
_ARRAYS = {
    "bodies": ("int32", (2,)),
    "squared_distance": ("float64", ()),
    "touching": ("bool", ()),
    "triangles": ("int32", (2,)),
    "points": ("float64", (2, 3)),
}


def _stored(answer: Any) -> dict[str, Any]:
    """A copy that shares nothing."""
    state = {name: getattr(answer, name) for name in _PLAIN}
    for name in _ARRAYS:
        state[name] = getattr(answer, name).copy()
        state[name].flags.writeable = False
    return state


def _restore(state: Any) -> NearestBodies:
    """Raises InvalidType and InvalidInput for what no NearestBodies can have given."""
    import numpy as np

    if not isinstance(state, dict) or state.keys() != {*_PLAIN, *_ARRAYS}:
        raise InvalidType(f"the state of NearestBodies must be a dict of {', '.join(sorted([*_PLAIN, *_ARRAYS]))}")
    for name, wanted in _PLAIN.items():
        if not isinstance(state[name], wanted):
            raise InvalidType(f"the state of NearestBodies needs {name} as {wanted.__name__}")
    made = {name: _restored(state[name], name) for name in _ARRAYS}
    bodies, squared = made["bodies"], made["squared_distance"]
    _check(all(len(array) == len(bodies) for array in made.values()), "lengths")
    first, second = bodies[:, 0].astype(np.int64), bodies[:, 1].astype(np.int64)
    _check((0 <= first).all() and (first < second).all() and (np.diff(first << 32 | second) > 0).all(), "bodies")
    _check((squared >= 0).all() and not squared[made["touching"]].any(), "squared_distance")
    _check((made["triangles"] >= 0).all(), "triangles")
    _check(np.isfinite(made["points"]).all(), "points")
    return NearestBodies(_StoredAnswer({**state, **made}))


def _check(holds: Any, what: str) -> None:
    if not holds:
        raise InvalidInput(f"the state of NearestBodies does not fit together: {what}")


def _restored(array: Any, name: str) -> np.ndarray:
    import numpy as np

    dtype, columns = _ARRAYS[name]
    if not isinstance(array, np.ndarray) or array.dtype.newbyteorder("=") != dtype or array.shape[1:] != columns:
        shape = ", ".join(map(str, ("n", *columns)))
        raise InvalidType(f"the state of NearestBodies needs {name} as an array ({shape}) of {dtype}")
    array = np.array(array, dtype, order="C")
    array.flags.writeable = False
    return array


@suggesting
def find_nearest(
    self: Detector,
    world: World,
    *,
    radius: float = math.inf,
    groups: Wanted = "both",
    excluded: Any = None,
    excluded_groups: GroupPairs | None = None,
    poses: Any = None,
    copy: bool = False,
) -> NearestBodies:
    """How far apart the bodies of a world are: of each pair the distance, exactly, and where they are closest.

    Bodies are sets of triangles, not volumes: a body inside another one is as far from it as their surfaces. Shapes
    that are named are remembered; then a pair takes some microseconds to some ten.

    Args:
        world: crumple.World.
        radius: only pairs of bodies at most so far apart are listed, exactly: 0 or more, or infinite.
        groups, excluded, excluded_groups, poses: as Detector.find has them for worlds.
        copy: the answer gets writable arrays of its own instead of read-only views.

    Raises InvalidInput, which names body, shape or argument, also on a detector of the cuda backend; MemoryLimit. More:
    docs/nearest.md.
    """
    if not isinstance(world, World):
        raise InvalidType(f"find_nearest takes a crumple.World, not {type(world).__name__}")
    question = _core.Nearest(radius, _core.rules_of_world("between", groups, excluded_groups))
    poses = world.poses if poses is None else poses
    excluded = excluded_in(world, excluded)
    return NearestBodies(with_names(world, self._find_nearest, world, poses, question, excluded, copy))
