"""Motions of rigid bodies, cut into pieces for queries about motion, which move vertices along straight lines."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

from . import _core
from ._errors import InvalidInput, suggesting

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray


class RigidMotion(NamedTuple):
    """Motion of rigid bodies, cut into pieces in which vertices move along straight lines.

    Attributes
    ----------
    poses : (pieces + 1, n, 3, 4) ndarray of float64
        Piece k moves from poses[k] to poses[k + 1].
    min_distance : float
        Upper bound on how much nearer two bodies can come in the motion than in the pieces. Add it to the minimum
        distance of a query, so that the pieces miss no contact of the motion.
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
    """Cuts a rigid motion between two poses of each body into pieces in which vertices move along straight lines.

    Each body turns about its origin by at most half a turn, at a constant rate about a fixed axis, while the origin
    moves straight. Search piece k as `world.at(poses[k], poses[k + 1])`, with `min_distance` of the result added to the
    requested one; then the pieces miss no contact of the motion.

    Parameters
    ----------
    start, end : (n, 3, 4) or (n, 4, 4) array_like of float64 or float32
        Poses: rotations and translations.
    radii : (n,) array_like of float
        Largest distance of a vertex from the origin of its shape, for each body.
    tolerance : float
        Upper bound on `min_distance` of the result, up to some units in the last place of the largest coordinate.

    Returns
    -------
    RigidMotion

    Raises
    ------
    InvalidInput
        If an argument is invalid. Names the body.

    Notes
    -----
    Cost: O(n) per piece. docs/motion.md has the definition and the proof.
    """
    import numpy as np

    from ._arrays import host_array

    radius = host_array(radii, "radii")
    if radius.ndim != 1 or radius.dtype.kind not in "fiu":
        raise InvalidInput(f"radii must be (n,) numbers, not {radius.shape} of {radius.dtype}")
    poses = _poses(start, "start"), _poses(end, "end")
    return RigidMotion(*_core.rigid_motion(*poses, np.ascontiguousarray(radius, np.float64), tolerance))
