"""Poses of the links of a robot for many configurations at once, and bounds on how far links move off straight lines.

A robot is a tree of links, connected by joints. A joint is fixed, turns about an axis (revolute), or slides along one
(prismatic). Arrays have one row per configuration. Nothing here depends on another package.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, Literal, NamedTuple

import numpy as np

from .._errors import InvalidInput
from ._batches import rigid_pose_of, slices

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["Joint", "Tree"]

_KINDS = ("fixed", "revolute", "prismatic")
_ROWS = 2048  # configurations whose frames are computed together, so that they stay in the cache


class Joint(NamedTuple):
    """Joint between two links. Its frame is that of the child at the value 0.

    Attributes
    ----------
    name, parent, child : str
        Names of the joint and of its links.
    kind : {"fixed", "revolute", "prismatic"}
        Revolute joints include continuous ones.
    origin : (4, 4) or (3, 4) array_like
        Pose of the joint's frame in the frame of the parent: a rotation and a translation.
    axis : (3,) array_like
        Axis in the joint's frame, of any length but 0.
    follows : str or None
        Name of the joint that this one mimics: its value is `multiplier` times the value of that joint plus `offset`.
    """

    name: str
    parent: str
    child: str
    kind: Literal["fixed", "revolute", "prismatic"]
    origin: Any
    axis: Any = (1.0, 0.0, 0.0)
    follows: str | None = None
    multiplier: float = 1.0
    offset: float = 0.0


class Tree:
    """Links and joints in an order in which parents come before children.

    Parameters
    ----------
    joints : sequence of Joint
        In any order. The values of a configuration are those of the joints that move and mimic no other, in this
        order.
    base : str or None
        Link from which all others descend; None: the only link that is no child.

    Attributes
    ----------
    variables : list of str
        Names of the joints whose values make a configuration.
    base : str
    joints : list of Joint
        In the given order; origins are (4, 4) arrays.
    parents : dict of str to Joint
        Joint above each link but the base, parents before children.

    Raises
    ------
    InvalidInput
        If the joints do not make a tree, a kind, an origin or an axis is invalid, two joints have the same name, or a
        joint mimics one that does not exist.
    """

    def __init__(self, joints: Sequence[Joint], base: str | None = None) -> None:
        self.joints = joints = [_checked(joint) for joint in joints]
        names = [joint.name for joint in joints]
        repeated = {name for name in names if names.count(name) > 1}
        if repeated:
            raise InvalidInput(f"several joints are called {min(repeated)!r}")
        children = [joint.child for joint in joints]
        twice = {child for child in children if children.count(child) > 1}
        if twice:
            raise InvalidInput(f"link {min(twice)!r} is the child of several joints; a robot must be a tree")
        if base is None:
            roots = {joint.parent for joint in joints} - set(children)
            if not joints:
                raise InvalidInput("there are no joints; pass base=")
            if not roots:
                raise InvalidInput("the joints form a cycle; a robot must be a tree")
            if len(roots) > 1:
                raise InvalidInput(f"links {', '.join(sorted(roots))} have no parent; connect them by joints")
            (base,) = roots
        if base in children:
            raise InvalidInput(f"link {base!r} cannot be the base, because it is the child of a joint")
        self.base = base
        self.parents: dict[str, Joint] = {}
        waiting = list(joints)
        while waiting:
            ready = [joint for joint in waiting if joint.parent == base or joint.parent in self.parents]
            if not ready:
                raise InvalidInput(f"joint {waiting[0].name!r} is not connected with the base {base!r}")
            self.parents.update((joint.child, joint) for joint in ready)
            waiting = [joint for joint in waiting if joint.child not in self.parents]
        moving = {joint.name: joint for joint in joints if joint.kind != "fixed"}
        self.variables = [name for name, joint in moving.items() if joint.follows is None]
        self._values = {name: _value(joint, moving, self.variables) for name, joint in moving.items()}
        self._aligned = {link: _alignment(joint) for link, joint in self.parents.items() if joint.kind != "fixed"}

    def value(self, joint: Joint, configurations: NDArray[np.float64]) -> NDArray[np.float64]:
        """Returns the values of a joint that moves, (n,), from configurations, (n, variables)."""
        column, multiplier, offset = self._values[joint.name]
        return multiplier * configurations[:, column] + offset

    def poses(self, configurations: NDArray[np.float64], links: Sequence[str]) -> NDArray[np.float64]:
        """Returns the poses of links in the frame of the base, (n, links, 3, 4), in float64 with rounding.

        Cost: some 0.1 microseconds for each link and configuration, on one thread.
        """
        made = np.empty((len(configurations), len(links), 3, 4))
        for rows in slices(len(configurations), _ROWS):
            for i, frame in enumerate(self._frames(configurations[rows], links)):
                made[rows, i] = np.moveaxis(frame, 2, 0)
        return made

    def _frames(self, configurations: NDArray[np.float64], links: Sequence[str]) -> list[NDArray[np.float64]]:
        """Returns the pose of each link as an array of shape (3, 4, n or 1)."""
        # The frame of a link whose joint moves has its z axis along that joint's axis, and has to be multiplied by
        # `rest`, (4, 4), to be the link's own.
        frames: dict[str, tuple[Any, Any]] = {self.base: (np.eye(3, 4)[:, :, None], np.eye(4))}
        for link, joint in self.parents.items():
            frame, rest = frames[joint.parent]
            if joint.kind == "fixed":
                frames[link] = frame, rest @ joint.origin
                continue
            align = self._aligned[link]
            frame = _times(frame, rest @ joint.origin @ align)
            values = self.value(joint, configurations)
            moved = np.empty((3, 4, len(values)))
            if joint.kind == "prismatic":
                moved[:, :3] = frame[:, :3]
                np.add(frame[:, 3], values * frame[:, 2], out=moved[:, 3])
            else:
                cosine, sine = np.cos(values), np.sin(values)
                np.add(cosine * frame[:, 0], sine * frame[:, 1], out=moved[:, 0])
                np.subtract(cosine * frame[:, 1], sine * frame[:, 0], out=moved[:, 1])
                moved[:, 2:] = frame[:, 2:]
            frames[link] = moved, align.T
        return [_times(*frames[link]) for link in links]

    def reach(self, links: Sequence[str], radii: Sequence[float]) -> float:
        """Returns a bound on the distance of any point of the links from the origin of the base, if no joint slides."""
        most = 0.0
        for link, reach in zip(links, radii):
            while link != self.base:
                joint = self.parents[link]
                reach += float(np.linalg.norm(joint.origin[:3, 3]))
                link = joint.parent
            most = max(most, reach)
        return most

    def bends(
        self, starts: NDArray[np.float64], ends: NDArray[np.float64], links: Sequence[str], radii: Sequence[float]
    ) -> NDArray[np.float64]:
        """Returns bounds on the second derivative by time of any point of each link, (n, links), rounded.

        Joint values move at constant rates from start to end in a unit of time. Within a piece of the length h, a point
        is at most h² / 8 times this bound away from the straight motion between its positions at the ends of the piece.
        The radius of a link is the largest distance of its points from the origin of its frame.

        Notes
        -----
        Let a_j be the axis of joint j, and |d_j| the rate of its value. The derivative of a point by two revolute
        joints i and j, of which i is closer to the base or i = j, is a_i x (a_j x (x - p_j)); its length is at most the
        distance r_j of the point from the axis j. If j is prismatic and i revolute, it is a_i x a_j, of length 1 at
        most; if i is prismatic, it is 0. So the second derivative is at most the sum over j of r_j |d_j| (2 S_j +
        |d_j|), where S_j is the sum of |d_i| of the revolute joints above j, r_j is 1 for prismatic joints, and the
        last |d_j| only counts for revolute ones. The distance of a point from an axis is at most its distance from the
        joint's origin, and that is at most the radius of the link plus the lengths of all offsets between the two, in
        any configuration.
        """
        made = np.zeros((len(starts), len(links)))
        for i, link in enumerate(links):
            chain = []  # joints from the base to the link, each with its r_j
            reach: Any = radii[i]
            while link != self.base:
                joint = self.parents[link]
                if joint.kind == "prismatic":
                    chain.append((joint, 1.0))
                    ends_of_slide = [np.abs(self.value(joint, q)) for q in (starts, ends)]
                    reach = reach + np.maximum(*ends_of_slide)
                elif joint.kind != "fixed":
                    chain.append((joint, reach))
                reach = reach + np.linalg.norm(joint.origin[:3, 3])
                link = joint.parent
            above: Any = 0.0
            for joint, distance in reversed(chain):
                rate = np.abs(self.value(joint, ends) - self.value(joint, starts))
                own = 0.0 if joint.kind == "prismatic" else rate
                made[:, i] += distance * rate * (2 * above + own)
                above = above + own
        return made


def _checked(joint: Joint) -> Joint:
    """Returns a joint with its origin as a (4, 4) array. Raises InvalidInput if its kind or its origin is invalid."""
    if joint.kind not in _KINDS:
        kinds = "fixed, revolute (also for continuous joints) or prismatic"
        raise InvalidInput(f"joint {joint.name!r}: kind must be {kinds}, not {joint.kind!r}")
    return joint._replace(origin=rigid_pose_of(joint.origin, f"joint {joint.name!r}", "origin"))


def _value(joint: Joint, moving: dict[str, Joint], variables: list[str]) -> tuple[int, float, float]:
    """Returns column, multiplier and offset of a joint's value, through joints that mimic others."""
    multiplier, offset, seen = 1.0, 0.0, {joint.name}
    while joint.follows is not None:
        multiplier, offset = multiplier * joint.multiplier, multiplier * joint.offset + offset
        if joint.follows not in moving or joint.follows in seen:
            raise InvalidInput(f"joint {joint.name!r} mimics {joint.follows!r}, which is fixed, missing or mimics it")
        joint = moving[joint.follows]
        seen.add(joint.name)
    return variables.index(joint.name), multiplier, offset


def _alignment(joint: Joint) -> NDArray[np.float64]:
    """Returns a rotation, (4, 4), that maps the z axis to the axis of a joint. It is exact for coordinate axes."""
    axis = np.asarray(joint.axis, np.float64)
    length = np.linalg.norm(axis)
    if axis.shape != (3,) or not np.isfinite(length) or length == 0:
        raise InvalidInput(f"joint {joint.name!r}: its axis must be finite and not 0, not {joint.axis}")
    z = axis / length
    x = np.eye(3)[np.argmin(np.abs(z))]
    x = x - (x @ z) * z
    x /= np.linalg.norm(x)
    made = np.eye(4)
    made[:3, :3] = np.eye(3) if z[2] == 1 else np.column_stack([x, np.cross(z, x), z])
    return made


def _times(frames: NDArray[np.float64], matrix: NDArray[np.float64]) -> NDArray[np.float64]:
    """Returns the products of frames, (3, 4, n), with a matrix, (4, 4)."""
    return frames if np.array_equal(matrix, np.eye(4)) else np.matmul(matrix.T, frames)
