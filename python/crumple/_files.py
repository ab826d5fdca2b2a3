"""Files of meshes, worlds, poses and pairs; and scenes made by formula."""

from __future__ import annotations

import os
import warnings
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, Literal, NamedTuple

from . import _core
from ._errors import FileWarning, InvalidInput, InvalidType, suggesting
from ._mesh import FileMesh, Mesh, Polygons, as_mesh, constant_shape
from ._world import World

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray


@suggesting
def read_mesh(
    path: str | os.PathLike[str],
    *,
    precision: Literal["automatic", "float32", "float64"] = "automatic",
    weld: Literal["automatic", "yes", "no"] = "automatic",
    group_property: str = "",
    triangulation: Literal["ears", "fan"] = "ears",
    strict: bool = False,
    unit: Literal["um", "mm", "cm", "in", "ft", "m"] | None = None,
) -> FileMesh:
    """Reads PLY, OBJ, STL, OFF, glTF or 3MF, told apart by content first and extension second.

    Of glTF and 3MF all bodies, where they are, are one mesh; read_world keeps them apart.

    Args:
        path: the file.
        precision: of the coordinates; "automatic" loses no bit of the file.
        weld: whether to join vertices at equal positions; "automatic": STL only, which names no vertices.
        group_property: PLY: the integer face property that holds the groups.
        triangulation: how polygons become triangles. "ears": convex ones as a fan, concave ones without overlaps;
            "fan": all from their first corner.
        strict: raise InvalidInput for what would be a FileWarning.
        unit: of the coordinates: files that do not say theirs, all but .3mf and glTF, are taken for it, and those in
            another unit are converted, each coordinate rounded once. None: as the file has it.

    Returns a FileMesh of (n, 3) float32 or float64, (m, 3) int32 and, if asked for, (m,) int32; it is a Mesh that also
    names the polygon of each triangle and the unit. Issues a FileWarning for anything odd about the file. Raises
    FileError, and InvalidInput that names the file and the line or byte; never returns part of a mesh. Reads hundreds
    of MB a second; Ctrl-C waits until it is done. docs/input.md tells what the readers accept, warn of and refuse.
    """
    (vertices, faces, groups, polygons), odd, unit_of_file = _core.read_mesh(
        path, precision, weld, group_property, triangulation, strict, unit
    )
    for message in odd:
        warnings.warn(message, FileWarning, stacklevel=3)  # points at the caller, beyond `suggesting`
    mesh = FileMesh(vertices, faces, groups)
    if polygons is not None:
        mesh.polygons = Polygons(*polygons)
    mesh.unit = unit_of_file
    return mesh


def write_mesh(path: str | os.PathLike[str], mesh: Any) -> None:
    """Writes .ply, .obj, .stl, .off, .glb or .3mf by extension. `mesh` is what as_mesh takes, with arrays on the host.

    Coordinates keep every bit, except in .stl and .glb, which hold float32; .ply keeps groups, as the face property
    `group`. .3mf keeps the unit of a FileMesh, and .glb, which is in metres, its size; the others have no unit.
    Raises FileError, InvalidInput; the file then stays as it was. Ctrl-C waits until the file is written.
    """
    _core.write_mesh(path, as_mesh(mesh))


def read_pairs(path: str | os.PathLike[str]) -> NDArray[np.int32]:
    """(k, 2) int32: the pairs of a file, in its order.

    .csv, .json and .npz are read as Result.save writes them; any other file is text, the first two numbers of each
    line. Raises FileError, InvalidInput.
    """
    return _core.read_pairs(path)


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
    made = [constant_shape(Mesh(*shape[:3]), f"shape {i}: ") for i, shape in enumerate(shapes)]
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


class ProceduralScene(NamedTuple):
    """What a procedural scene is: its default number of triangles, and how many frames it has."""

    name: str
    summary: str
    triangles: int
    frames: int


def scenes() -> list[ProceduralScene]:
    """The scenes that make_scene knows."""
    return [ProceduralScene(*description) for description in _core.scenes()]


@suggesting
def make_scene(name: str, *, triangles: int = 0, frame: int | None = None, seed: int = 1) -> Mesh:
    """Makes a procedural scene, the same bits on every machine.

    Args:
        name: one of those that scenes() lists, for instance "cloth".
        triangles: about how many; 0: the scene's default.
        frame: of an animation, from 0; None: the last.
        seed: other numbers give other scenes of the same kind.

    Returns a Mesh with groups. Raises InvalidInput. Simulated scenes take seconds to minutes, the first time; Ctrl-C
    ends them between two frames.
    """
    return Mesh(*_core.make_scene(name, triangles, frame, seed)[:3])
