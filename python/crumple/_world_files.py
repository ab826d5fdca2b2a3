"""Worlds of files and of trimesh, and files of poses."""

from __future__ import annotations

import os
import warnings
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, Literal

from . import _core
from ._errors import FileWarning, InvalidInput, InvalidType, suggesting
from ._mesh import Mesh
from ._shape import OwnName, Shape
from ._world import World

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray


def _constant_shape(mesh: Mesh, which: str) -> Shape:
    """A shape with a name of its own, whose arrays nobody can write to."""
    for array in mesh:
        if array is not None:
            array.flags.writeable = False
    shape = Shape.__new__(Shape)
    shape._make(mesh, OwnName(), which)
    return shape


@suggesting
def read_world(
    path: str | os.PathLike[str],
    *,
    precision: Literal["automatic", "float32", "float64"] = "automatic",
    weld: Literal["automatic", "yes", "no"] = "automatic",
    triangulation: Literal["ears", "fan"] = "ears",
    strict: bool = False,
    unit: Literal["um", "mm", "cm", "in", "ft", "m"] | None = None,
) -> World:
    """Reads glTF 2.0 (.glb, .gltf) as a World: each node of the default scene that has a mesh is a body.

    Bodies come in the order of the file's nodes, with their names and their transforms from the root. Names that are
    missing are those of the meshes, or node7; the second of a name becomes NAME_2. Meshes over the same data are one
    shape. Of 3MF each mesh that the build names, itself or by components, is a body, with the object's name, or that of
    an object around it, or `object 7`. Any other mesh file is a world of one body in place. Shapes are read-only arrays
    that detectors remember.

    World.unit is that of the file. Arguments, errors and warnings as of read_mesh; docs/input.md tells what is read,
    skipped and refused.
    """
    shapes, bodies, names, poses, odd, unit_of_file = _core.read_world(
        path, precision, weld, triangulation, strict, unit
    )
    for message in odd:
        warnings.warn(message, FileWarning, stacklevel=3)  # points at the caller, beyond `suggesting`
    made = [_constant_shape(Mesh(*shape[:3]), f"shape {i}: ") for i, shape in enumerate(shapes)]
    world = World(made, bodies, poses=poses, names=names)
    world.unit = unit_of_file
    return world


def read_poses(path: str | os.PathLike[str], bodies: World | int | Sequence[str] = 1) -> NDArray[np.float64]:
    """(k, n, 3, 4) float64: the poses of a file, n a configuration.

    Args:
        path: .npy of float32 or float64, of a shape that ends with 12 or 3, 4 (16 or 4, 4); any other file is text, a
            row of 12 (or 16) numbers a line, with commas or blanks between. Rows are those of each body in turn,
            configuration after configuration.
        bodies: how many one configuration has, or their names; of a World, those that are not at rest (-1).

    Raises FileError, and InvalidInput that names the row and its body.
    """
    if isinstance(bodies, World):
        names = [name or f"body {i}" for i, name in enumerate(bodies.names)]
        names = [name for name, world in zip(names, bodies.worlds.tolist()) if world != -1]
    elif isinstance(bodies, (str, bytes, bool)) or not hasattr(bodies, "__index__"):
        if isinstance(bodies, (str, bytes, bool)) or not all(isinstance(name, str) for name in bodies):
            raise InvalidType(f"bodies must be a World, a number or names, not {type(bodies).__name__}")
        names = list(bodies)
    else:
        names = [f"body {i}" for i in range(bodies.__index__())]
    if not names:
        raise InvalidInput("bodies must be at least one: nothing else can be posed")
    poses: Any = _core.read_poses(path, names)
    return poses.reshape(-1, len(names), 3, 4)


def from_trimesh(scene: Any) -> World:
    import numpy as np

    if not all(hasattr(scene, name) for name in ("graph", "geometry")):
        kind = type(scene)
        raise InvalidType(f"a scene of trimesh is wanted, not {kind.__module__}.{kind.__qualname__}")
    shapes: list[Shape] = []
    places: dict[str, int] = {}
    names, of, poses = [], [], []
    for node in scene.graph.nodes_geometry:
        transform, geometry = scene.graph[node]
        mesh = scene.geometry[geometry]
        if not hasattr(mesh, "faces"):  # paths and points, which bound nothing
            continue
        if geometry not in places:
            places[geometry] = len(shapes)
            copied = Mesh(np.array(mesh.vertices), np.array(mesh.faces))
            shapes.append(_constant_shape(copied, f"geometry {geometry!r}: "))
        names.append(str(node))
        of.append(places[geometry])
        poses.append(np.asarray(transform, np.float64))
    return World(shapes, of, poses=np.array(poses).reshape(-1, 4, 4), names=names)
