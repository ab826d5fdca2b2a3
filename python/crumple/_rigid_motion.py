"""Motions of rigid bodies in pieces, for queries about motion, which move vertices straight."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

from . import _core
from ._errors import InvalidInput, suggesting

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray


class RigidMotion(NamedTuple):
    """A motion of rigid bodies in pieces, in each of which vertices go straight.

    Attributes:
        poses: (pieces + 1, n, 3, 4) float64: piece k goes from poses[k] to poses[k + 1].
        min_distance: bound on how much nearer two bodies come in the motion than in its pieces: what to add to a
            minimum distance, so that no piece misses a contact of the motion.
    """

    poses: NDArray[np.float64]
    min_distance: float


def _poses(given: Any, name: str) -> NDArray[np.float64]:
    import numpy as np

    from ._arrays import host_array

    array = host_array(given, name)
    if array.ndim != 3 or array.shape[1:] not in ((3, 4), (4, 4)):
        raise InvalidInput(f"{name} must have shape (n, 3, 4) or (n, 4, 4), not {array.shape}")
    if array.dtype.kind not in "fiu" or array.dtype.itemsize > 8:
        raise InvalidInput(f"{name} must be float64 or float32, not {array.dtype}")
    return np.ascontiguousarray(array[:, :3], np.float64)


@suggesting
def cut_rigid_motion(start: Any, end: Any, radii: Any, tolerance: float) -> RigidMotion:
    """A rigid motion between two poses of each body, cut into pieces in which vertices go straight, so that searches of
    the pieces miss nothing of it.

    Each body turns about its origin by at most half a turn at a constant rate about a fixed axis, while the origin goes
    straight. Search piece k as world.at(poses[k], poses[k + 1]), with `min_distance` added to the requested one.

    Args:
        start, end: (n, 3, 4) or (n, 4, 4) float64 or float32: rotations and translations.
        radii: (n,) float64: of each body the largest distance of a vertex from the origin of its shape.
        tolerance: `min_distance` is at most this, and some units in the last place of the largest coordinate.

    Raises InvalidInput, which names the body. What is promised, and why: docs/motion.md. Cost: O(n) a piece.
    """
    import numpy as np

    from ._arrays import host_array

    radius = host_array(radii, "radii")
    if radius.ndim != 1 or radius.dtype.kind not in "fiu":
        raise InvalidInput(f"radii must be (n,) numbers, not {radius.shape} of {radius.dtype}")
    poses = _poses(start, "start"), _poses(end, "end")
    return RigidMotion(*_core.rigid_motion(*poses, np.ascontiguousarray(radius, np.float64), tolerance))
