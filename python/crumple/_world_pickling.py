"""Takes worlds and their results apart for pickle, and puts them together again, with all that is read checked."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from . import _arrays
from ._core import Statistics
from ._errors import InvalidInput, InvalidType
from ._mesh import Mesh
from ._world import OwnName, Shape, World
from ._world_result import WANTS, WorldResult

# Type and shape of each array; what was not asked for is empty.
_ARRAYS = {
    "world_hit": (np.bool_, (-1,)),
    "world_counts": (np.int64, (-1,)),
    "bodies": (np.int32, (-1, 2)),
    "pairs": (np.int32, (-1, 2)),
    "contact_kinds": (np.uint8, (-1,)),
    "contact_offsets": (np.int64, (-1,)),
    "contact_points": (np.float64, (-1, 3)),
    "world_offsets": (np.int64, (-1,)),
    "body_offsets": (np.int64, (-1,)),
    "first_triangle": (np.int64, (-1,)),
    "hit": (np.bool_, (-1,)),
}


class StoredAnswer(NamedTuple):
    """An answer in arrays of its own, where _core.WorldAnswer has the library's."""

    any: bool
    count: int
    wants: str
    has_index: bool
    copy: bool
    statistics: Statistics
    world_hit: np.ndarray
    world_counts: np.ndarray
    bodies: np.ndarray
    pairs: np.ndarray
    contact_kinds: np.ndarray
    contact_offsets: np.ndarray
    contact_points: np.ndarray
    world_offsets: np.ndarray
    body_offsets: np.ndarray
    first_triangle: np.ndarray
    hit: np.ndarray


def stored(answer: Any) -> StoredAnswer:
    """A copy that shares nothing."""
    values = {name: getattr(answer, name) for name in StoredAnswer._fields}
    for name in _ARRAYS:
        values[name] = values[name].copy()
        values[name].flags.writeable = False
    return StoredAnswer(**values)


def restore_result(answer: Any, world: Any, poses: Any) -> WorldResult:
    """Raises InvalidType and InvalidInput for what a WorldResult cannot have given."""
    if not isinstance(answer, tuple) or len(answer) != len(StoredAnswer._fields) or not isinstance(world, World):
        raise InvalidType("the state of a WorldResult must be (answer, world, poses)")
    given = StoredAnswer(*answer)
    for name, kind in {"any": bool, "count": int, "has_index": bool, "copy": bool, "statistics": Statistics}.items():
        if not isinstance(getattr(given, name), kind):
            raise InvalidType(f"the state of a WorldResult needs {name} as {kind.__name__}")
    _check(given.wants in WANTS, "wants")
    arrays = {name: _array(getattr(given, name), name) for name in _ARRAYS}
    restored = given._replace(**arrays)
    _check_fit(restored, world)
    return WorldResult(restored, world, poses)


def _array(array: Any, name: str) -> np.ndarray:
    dtype, shape = _ARRAYS[name]
    if not isinstance(array, np.ndarray) or array.dtype.newbyteorder("=") != dtype:
        raise InvalidType(f"the state of a WorldResult needs {name} as an array of {np.dtype(dtype)}")
    _check(array.ndim == len(shape) and array.shape[1:] == shape[1:], f"the shape of {name}")
    array = np.array(array, dtype, order="C")
    array.flags.writeable = False
    return array


def _check(holds: Any, what: str) -> None:
    if not holds:
        raise InvalidInput(f"the state of the WorldResult does not fit together: {what}")


def _check_offsets(offsets: np.ndarray, parts: int, most: int, name: str) -> None:
    _check(len(offsets) == parts + 1 and offsets[0] == 0 and (np.diff(offsets) >= 0).all(), name)
    _check(offsets[-1] <= most, name)


def _check_fit(answer: StoredAnswer, world: World) -> None:
    wants, rows = WANTS.index(answer.wants), len(answer.bodies)
    worlds = int(max(world.worlds.max(initial=-1), -1)) + 1
    _check(len(answer.world_hit) == (worlds if wants >= 1 else 0), "world_hit")
    _check(len(answer.world_counts) == (worlds if wants >= 3 else 0), "world_counts")
    _check(len(answer.pairs) == (rows if wants >= 4 else 0) and (rows == 0 or wants in (2, 4, 5)), "pairs")
    _check(wants < 4 or answer.count == rows, "count")
    _check(((answer.bodies >= 0) & (answer.bodies < len(world))).all(), "bodies")
    sizes = np.array([shape.triangles for shape in world.shapes], np.int64)[world.bodies]
    if wants >= 4:
        _check(((answer.pairs >= 0) & (answer.pairs < sizes[answer.bodies])).all(), "pairs")
    if wants == 5:
        _check(len(answer.contact_kinds) == rows, "contacts")
        _check_offsets(answer.contact_offsets, rows, len(answer.contact_points), "offsets of contacts")
        _check(np.isfinite(answer.contact_points).all(), "points of contacts")
    if answer.has_index:
        _check_offsets(answer.world_offsets, worlds, rows, "world_offsets")
        _check_offsets(answer.body_offsets, len(world), rows, "body_offsets")
        _check(np.array_equal(answer.first_triangle, np.concatenate([[0], np.cumsum(sizes)])), "first_triangle")
        _check(len(answer.hit) == sizes.sum(), "hit")


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
