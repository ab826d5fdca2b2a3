"""How clusters are placed."""

from __future__ import annotations

import dataclasses

from ._errors import InvalidType


@dataclasses.dataclass(frozen=True)
class FuzzyCMeans:
    """How fuzzy C-means places the centres of clusters: for researchers. No result depends on it.

    Args:
        fuzziness: t of eq. 2, above 1.
        max_iterations: cap on iterations, warm-started from the centres of the call before.
        first_iterations: the same for a first frame, which has no centres to start from.
        stop: iteration ends when no centre moves further in any coordinate, in units of the scene's extent rounded up
            to a power of two.
        first_stop: the same for a first frame.

    Source: D. Mainzer, G. Zachmann, "Collision Detection Based on Fuzzy Scene Subdivision", sec. 4, eqs. 2-4.
    """

    fuzziness: float = 2.0
    max_iterations: int = 2
    first_iterations: int = 5
    stop: float = 1e-2
    first_stop: float = 1e-4

    def __repr__(self) -> str:
        given = ", ".join(f"{field.name}={getattr(self, field.name)!r}" for field in dataclasses.fields(self))
        return f"crumple.FuzzyCMeans({given})"


def check_fuzzy_c_means(given: FuzzyCMeans) -> FuzzyCMeans:
    """Returns what it is given. Raises InvalidType for another type."""
    if isinstance(given, FuzzyCMeans):
        return given
    raise InvalidType(f"fuzzy_c_means must be a crumple.FuzzyCMeans, not {type(given).__name__}", element="option")
