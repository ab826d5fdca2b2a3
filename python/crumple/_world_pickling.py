"""Takes worlds and their shapes apart for pickle, and puts them together again, with all that is read checked."""

from __future__ import annotations

from typing import Any

import numpy as np

from . import _arrays
from ._errors import InvalidType
from ._mesh import Mesh
from ._shape import OwnName, Shape
from ._versions import refuse as restore_result  # noqa: F401
from ._world import World


def state_of_shape(shape: Shape, name: Any) -> tuple[Any, ...]:
    """Vertices, faces, groups, name, vertices at the end, edges, points, radii, vertices at rest; as NumPy has them."""
    vertices, faces, groups = shape.mesh
    faces = _arrays.faces(faces, "") if len(_arrays.host_array(faces, "faces")) else np.empty((0, 3), np.int32)
    groups = None if groups is None else _arrays.groups(groups, "")
    end = None if shape.end is None else _arrays.end_vertices(shape.end, "")
    edges = None if shape.edges is None else _arrays.edges(shape.edges, "")
    points = None if shape.points is None else _arrays.points(shape.points, "")
    radii = None if shape.radii is None else _arrays.radii(shape.radii, "")
    rest = None if shape.rest is None else _arrays.rest_vertices(shape.rest, "")
    return _arrays.vertices(vertices, ""), faces, groups, name, end, edges, points, radii, rest


def restore_shape(
    vertices: Any,
    faces: Any,
    groups: Any,
    name: Any,
    end: Any = None,
    edges: Any = None,
    points: Any = None,
    radii: Any = None,
    rest: Any = None,
) -> Shape:
    """A shape whose own name is nobody else's has another number here."""
    shape = Shape.__new__(Shape)
    name = OwnName() if isinstance(name, OwnName) else name
    shape._make(Mesh(vertices, faces, groups), name, "", end, (edges, points), radii, rest)
    return shape


def poses_of(poses: Any) -> Any:
    """As NumPy's."""
    return None if poses is None else _arrays.poses(poses, "")


def restore_world(
    shapes: Any,
    bodies: Any,
    groups: Any,
    worlds: Any,
    self_collisions: Any,
    names: Any,
    poses: Any,
    end_poses: Any = None,
) -> World:
    """The world of these columns."""
    columns = {"groups": groups, "worlds": worlds, "self_collisions": self_collisions, "names": names}
    return World(shapes, bodies, poses=poses, end_poses=end_poses, **columns)


def restore_configurations(base: Any, poses: Any, end_poses: Any = None) -> World:
    """The world of these configurations."""
    if not isinstance(base, World):
        raise InvalidType("the state of a world of configurations needs a World")
    return base.configurations(poses, end_poses)
