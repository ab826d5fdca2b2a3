"""Files of meshes, worlds, poses and pairs; and procedural scenes."""

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
    """Reads a mesh from PLY, OBJ, STL, OFF, glTF or 3MF.

    Detects the format by content first, then by extension. All bodies of glTF and 3MF, posed, are joined into one mesh;
    read_world keeps them apart.

    Parameters
    ----------
    path : str or os.PathLike
        File.
    precision : {"automatic", "float32", "float64"}, default "automatic"
        Precision of the coordinates; "automatic" loses no bit of the file.
    weld : {"automatic", "yes", "no"}, default "automatic"
        Whether to merge vertices at equal positions. "automatic": only for STL, which has no indices, and for glTF,
        which repeats vertices.
    group_property : str, optional
        For PLY, the integer face property that contains the groups.
    triangulation : {"ears", "fan"}, default "ears"
        Triangulation of polygons. "fan": all polygons as a fan of triangles around their first corner. "ears": convex
        polygons as a fan, concave ones into triangles that do not overlap.
    strict : bool, default False
        If True, raises InvalidInput instead of issuing a FileWarning.
    unit : {"um", "mm", "cm", "in", "ft", "m"}, optional
        Unit of the result. Files that do not state a unit (all but 3MF and glTF) are assumed to use it; those in
        another unit are converted, each coordinate rounded once. None: the unit of the file.

    Returns
    -------
    FileMesh
        (n, 3) float32 or float64 vertices, (m, 3) int32 faces and, if requested, (m,) int32 groups; the polygons of the
        file, and the unit.

    Raises
    ------
    FileError
        If the file cannot be read.
    InvalidInput
        If its contents are invalid. Names the file and the line or byte.

    Warns
    -----
    FileWarning
        If something in the file is odd.

    Notes
    -----
    Never returns a part of a mesh. Reads hundreds of MB per second. Ctrl-C waits until the file is read. docs/input.md
    lists what the readers accept, warn about and refuse.
    """
    (vertices, faces, groups, polygons), odd, unit_of_file = _core.read_mesh(
        path, precision, weld, group_property, triangulation, strict, unit
    )
    for message in odd:
        warnings.warn(message, FileWarning, stacklevel=3)  # names the line of the caller; level 2 is in `suggesting`
    mesh = FileMesh(vertices, faces, groups)
    if polygons is not None:
        mesh.polygons = Polygons(*polygons)
    mesh.unit = unit_of_file
    return mesh


def write_mesh(path: str | os.PathLike[str], mesh: Any) -> None:
    """Writes a mesh to .ply, .obj, .stl, .off, .glb or .3mf, by extension.

    Coordinates keep every bit, except in .stl and .glb, which store float32. Groups are written to .ply only, as the
    face property `group`. The unit of a FileMesh is written to .3mf. Files of type .glb are in metres: coordinates with
    a unit are converted. Other formats have no unit.

    Parameters
    ----------
    path : str or os.PathLike
        File.
    mesh : mesh
        Anything that as_mesh takes, with arrays in host memory.

    Raises
    ------
    FileError
        If the file cannot be written; an existing file is unchanged then.
    InvalidInput
        If the mesh is invalid, or the extension is another one.

    Notes
    -----
    Ctrl-C waits until the file is written.
    """
    _core.write_mesh(path, as_mesh(mesh))


def read_pairs(path: str | os.PathLike[str]) -> NDArray[np.int32]:
    """Reads pairs of triangles from a file.

    Parameters
    ----------
    path : str or os.PathLike
        .csv, .json or .npz in the form in which Intersections.save writes them. Any other file is text, and the first
        two numbers of each line are read.

    Returns
    -------
    (k, 2) ndarray of int32
        Pairs in the order of the file.

    Raises
    ------
    FileError
        If the file cannot be read.
    InvalidInput
        If its contents are invalid.
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
    """Reads a world of bodies from glTF 2.0 (.glb, .gltf), 3MF, or any other mesh file.

    Parameters
    ----------
    path : str or os.PathLike
        File.
    precision, weld, triangulation, strict, unit
        As for read_mesh.

    Returns
    -------
    World
        Bodies with names and poses, and the unit of the file. Arrays of shapes are read-only, so that detectors can
        cache data about them.

    Raises
    ------
    FileError, InvalidInput
        As read_mesh.

    Warns
    -----
    FileWarning
        If something in the file is odd.

    Notes
    -----
    - glTF: each node of the default scene that has a mesh is a body, in the order of the file's nodes, with its name
      and the product of the transforms from the root. A node without a name gets the name of its mesh, or a name like
      node7. The second body with a name becomes NAME_2. Meshes that use the same data are one shape.
    - 3MF: each mesh that the build references, directly or through components, is a body, with the name of its object,
      or of an object that contains it, or a name like `object 7`.
    - Other files: one body, with the identity as its pose.

    docs/input.md lists what is read, skipped and refused.
    """
    shapes, bodies, names, poses, odd, unit_of_file = _core.read_world(
        path, precision, weld, triangulation, strict, unit
    )
    for message in odd:
        warnings.warn(message, FileWarning, stacklevel=3)  # names the line of the caller; level 2 is in `suggesting`
    made = [constant_shape(Mesh(*shape[:3]), f"shape {i}: ") for i, shape in enumerate(shapes)]
    world = World(made, bodies, poses=poses, names=names)
    world.unit = unit_of_file
    return world


def read_poses(path: str | os.PathLike[str], bodies: World | int | Sequence[str] = 1) -> NDArray[np.float64]:
    """Reads poses from a file.

    Parameters
    ----------
    path : str or os.PathLike
        .npy of float32 or float64, with a shape (..., 12), (..., 3, 4), (..., 16) or (..., 4, 4). Any other file is
        text: 12 or 16 numbers per line, separated by commas or blanks. Each row of numbers is a pose: first of all
        bodies in order in the first configuration, then in the second, and so on.
    bodies : World, int, or sequence of str, default 1
        Number of bodies in a configuration, or their names. A World stands for its bodies that are not in all worlds
        (-1).

    Returns
    -------
    (k, n, 3, 4) ndarray of float64
        Poses of k configurations of n bodies.

    Raises
    ------
    FileError
        If the file cannot be read.
    InvalidInput
        If its contents are invalid. Names the row and its body.
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
        raise InvalidInput("bodies must be at least one; bodies in all worlds (-1) do not count")
    poses: Any = _core.read_poses(path, names)
    return poses.reshape(-1, len(names), 3, 4)


class ProceduralScene(NamedTuple):
    """Description of a procedural scene.

    Attributes
    ----------
    name : str
        Name for make_scene.
    summary : str
        Description in one line.
    triangles : int
        Default number of triangles.
    frames : int
        Number of frames.
    """

    name: str
    summary: str
    triangles: int
    frames: int


def scenes() -> list[ProceduralScene]:
    """Returns the descriptions of all procedural scenes of make_scene, a list of ProceduralScene."""
    return [ProceduralScene(*description) for description in _core.scenes()]


@suggesting
def make_scene(name: str, *, triangles: int = 0, frame: int | None = None, seed: int = 1) -> Mesh:
    """Makes a procedural scene, with the same bits on every machine.

    Parameters
    ----------
    name : str
        Name of the scene, for instance "cloth"; scenes() lists them.
    triangles : int, default 0
        Approximate number of triangles; 0: the default of the scene.
    frame : int, optional
        Frame of an animation, from 0; None: the last one.
    seed : int, default 1
        Seed of the random numbers; other seeds give other scenes of the same kind.

    Returns
    -------
    Mesh
        Mesh with groups.

    Raises
    ------
    InvalidInput
        If an argument is invalid.

    Notes
    -----
    Simulated scenes take seconds to minutes the first time; Ctrl-C ends them between two frames.
    """
    return Mesh(*_core.make_scene(name, triangles, frame, seed)[:3])
