"""Obstacles of a robot, and checks of meshes and allowed pairs that robots share with them."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np

from .._arrays import host_array
from .._errors import InvalidInput
from .._mesh import Mesh, Shape, as_mesh, constant_shape, is_mesh
from ._batches import pose_of

__all__ = ["Obstacles", "allowed_pairs", "copied_shape"]


class Obstacles:
    """Bodies that do not move. Made once for many calls, because detectors cache data about them.

    Parameters
    ----------
    bodies : mapping of str to mesh, or to (mesh, pose)
        Bodies by name. A mesh is anything that as_mesh takes; a pose, (3, 4) or (4, 4), maps it to the frame of the
        robot's base. Meshes are copied.
    allowed : iterable of (str, str)
        Pairs of a link and an obstacle that are not tested.

    Attributes
    ----------
    names : tuple of str
    shapes : tuple of Shape
    poses : (n, 3, 4) ndarray of float64
        Read-only.

    Raises
    ------
    InvalidInput, InvalidType
        If a mesh or a pose is invalid. Names the obstacle.

    Notes
    -----
    A detector keeps cached data of obstacles as long as it exists, some 150 bytes per triangle.
    """

    def __init__(self, bodies: Mapping[str, Any], allowed: Iterable[tuple[str, str]] = ()) -> None:
        self.names = tuple(bodies)
        self.allowed = allowed_pairs(allowed)
        shapes = []
        poses = [np.eye(3, 4)]
        for name, body in bodies.items():
            posed = isinstance(body, (tuple, list)) and len(body) == 2 and is_mesh(body[0])
            mesh, pose = body if posed else (body, np.eye(3, 4))
            shapes.append(copied_shape(as_mesh(mesh), f"obstacle {name!r}: "))
            poses.append(pose_of(pose, f"obstacle {name!r}"))
        self.shapes, self.poses = tuple(shapes), np.array(poses[1:]).reshape(-1, 3, 4)
        self.poses.flags.writeable = False

    def __len__(self) -> int:
        """Number of obstacles."""
        return len(self.names)


def allowed_pairs(pairs: Iterable[Any]) -> frozenset[frozenset[str]]:
    """Returns pairs of names as sets. Raises InvalidInput if a pair does not have two different names."""
    made = frozenset(map(frozenset, pairs))
    for pair in made:
        if len(pair) != 2:
            raise InvalidInput(f"an allowed pair must have two different names, not {sorted(pair)}")
    return made


def copied_shape(mesh: Mesh, which: str) -> Shape:
    """Returns a shape with a private name and a copy of the mesh in float64. `which` is the prefix of messages."""
    vertices = np.array(host_array(mesh.vertices, which + "vertices"), np.float64)
    return constant_shape(Mesh(vertices, np.array(host_array(mesh.faces, which + "faces")).reshape(-1, 3)), which)
