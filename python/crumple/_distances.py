"""The result of a DistanceQuery."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING

from ._result import Result

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray


class Distances(Result):
    """How far apart bodies are: a row for each pair of them, the same bytes wherever it is computed.

    Rows are in the order of first body, second body, the first the lower one. So worlds follow each other, and pairs
    among bodies that are in all worlds, which come once, are last. `len(distances)` is the number of rows.
    """

    _query = "DistanceQuery"

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
        distance.flags.writeable = self._request.copy
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
