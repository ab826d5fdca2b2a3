"""Robots from URDF and SRDF files: exact collisions, clearances and motions for many configurations in one call.

Needs yourdfpy (`pip install yourdfpy`), which reads the URDF.

Examples
--------
    from crumple.adapters import urdf

    robot = urdf.load("panda.urdf", srdf="panda.srdf")
    obstacles = urdf.Obstacles({"table": (urdf.box([1, 1, 0.1]), pose)})
    free = ~robot.collides(configurations, obstacles)                      # (n,) bool from (n, joints) float
    free_motion = ~robot.collides_between(starts, ends, obstacles)
"""

from __future__ import annotations

import errno
import os
import pathlib
import xml.etree.ElementTree as ElementTree
from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from .._errors import Error, FileError, InvalidInput, MemoryLimit
from .._files import read_mesh
from .._mesh import Mesh
from ._kinematics import Joint
from ._obstacles import Obstacles
from ._primitives import PrimitiveMesh, box, capsule, cylinder, ellipsoid, sphere
from ._robot import LinkPairs, Robot

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = [
    "Joint",
    "LinkPairs",
    "Obstacles",
    "PrimitiveMesh",
    "Robot",
    "box",
    "capsule",
    "cylinder",
    "ellipsoid",
    "load",
    "read_srdf",
    "sphere",
]

_KINDS = {"fixed": "fixed", "revolute": "revolute", "continuous": "revolute", "prismatic": "prismatic"}


def load(
    path: str | os.PathLike[str],
    srdf: str | os.PathLike[str] | None = None,
    *,
    packages: Mapping[str, str | os.PathLike[str]] | None = None,
    max_tessellation_error: float = 1e-3,
    allowed: Iterable[tuple[str, str]] = (),
    solid: bool = True,
    **options: Any,
) -> Robot:
    """Reads a robot with its collision geometry: meshes, boxes, cylinders and spheres.

    Parameters
    ----------
    path : str or os.PathLike
        URDF file.
    srdf : str or os.PathLike, optional
        SRDF file. The pairs whose collisions it disables are not tested.
    packages : mapping of str to folder, optional
        Folders for package:// names. Others are looked for in the folder of the URDF and in those above it, with and
        without the name of the package.
    max_tessellation_error : float, default 0.001
        Upper bound on how far meshes that replace cylinders and spheres extend beyond them, in metres. These meshes
        contain what they replace, so that no collision is missed. The bound that was reached is
        Robot.tessellation_error.
    allowed : iterable of (str, str)
        Further pairs of links that are not tested. Adjacent links are never tested.
    solid : bool, default True
        True: a closed body inside another one collides with it; False: only surfaces collide.
    **options
        Options of crumple.Detector.

    Returns
    -------
    Robot
        All collision geometry of a link is one mesh, in float64. Seams of mesh files are welded.

    Raises
    ------
    ImportError
        If yourdfpy is not installed.
    FileError
        If the URDF or the SRDF cannot be read.
    InvalidInput
        If a file is invalid, a mesh is missing or cannot be read, or a joint is planar or floating. Names the link or
        joint.

    Notes
    -----
    Meshes are PLY, OBJ, STL, OFF, glTF or 3MF. Collada files (.dae) need trimesh and pycollada.
    """
    try:
        import yourdfpy
    except ImportError as error:
        raise ImportError(f"crumple.adapters.urdf.load needs yourdfpy ({error}): pip install yourdfpy") from None
    _check_file(path)
    try:
        model = yourdfpy.URDF.load(os.fspath(path), build_scene_graph=False, load_meshes=False).robot
    except Exception as error:  # yourdfpy raises errors of many types
        raise InvalidInput(f"{os.fspath(path)} is not a valid URDF file: {type(error).__name__}: {error}") from error
    joints = [_joint(joint) for joint in model.joints]
    limits = {
        joint.name: (joint.limit.lower or 0.0, joint.limit.upper or 0.0)  # both are optional, and 0 by default
        for joint in model.joints
        if joint.type in ("revolute", "prismatic") and joint.limit is not None
    }
    folder, meshes, worst = pathlib.Path(path).resolve().parent, {}, 0.0
    for link in model.links:
        parts = [_posed(c, folder, packages or {}, max_tessellation_error, link.name) for c in link.collisions]
        if parts:
            meshes[link.name] = _joined(parts)
            worst = max(worst, *(getattr(mesh, "tessellation_error", 0.0) for mesh, _ in parts))
    disabled = [] if srdf is None else [p for p in read_srdf(srdf) if p[0] in meshes and p[1] in meshes]
    if not joints and len(model.links) > 1:
        names = ", ".join(link.name for link in model.links)
        raise InvalidInput(f"{os.fspath(path)}: no joint connects the links {names}")
    base = model.links[0].name if not joints and model.links else None
    return Robot(
        joints,
        meshes,
        [*disabled, *allowed],
        limits=limits,
        solid=solid,
        tessellation_error=worst,
        base=base,
        **options,
    )


def read_srdf(path: str | os.PathLike[str]) -> list[tuple[str, str]]:
    """Returns the pairs of links between which an SRDF file disables collisions, in the order of the file.

    Parameters
    ----------
    path : str or os.PathLike
        SRDF file.

    Returns
    -------
    list of (str, str)

    Raises
    ------
    FileError
        If the file cannot be read.
    InvalidInput
        If the file is not valid XML, or an entry lacks a link.
    """
    _check_file(path)
    try:
        root = ElementTree.parse(path).getroot()
        return [(pair.attrib["link1"], pair.attrib["link2"]) for pair in root.iter("disable_collisions")]
    except ElementTree.ParseError as error:
        raise InvalidInput(f"{os.fspath(path)} is not valid XML: {error}") from None
    except OSError as error:
        raise FileError(f"{os.fspath(path)}: {error.strerror}", code="file", errno=error.errno) from None
    except KeyError as error:
        raise InvalidInput(f"{os.fspath(path)}: an entry disable_collisions lacks {error}") from None


def _check_file(path: str | os.PathLike[str]) -> None:
    if not os.path.isfile(path):
        raise FileError(f"{os.fspath(path)}: there is no such file", code="file", errno=errno.ENOENT)


def _joint(joint: Any) -> Joint:
    if joint.type not in _KINDS:
        raise InvalidInput(f"joint {joint.name!r}: joints of the type {joint.type!r} are not supported")
    mimic = joint.mimic
    follows = {} if mimic is None else {"follows": mimic.joint, "multiplier": mimic.multiplier, "offset": mimic.offset}
    origin = np.eye(4) if joint.origin is None else np.asarray(joint.origin, np.float64)
    axis = (1.0, 0.0, 0.0) if joint.axis is None else tuple(joint.axis)
    return Joint(joint.name, joint.parent, joint.child, _KINDS[joint.type], origin, axis, **follows)  # type: ignore[arg-type]


def _posed(
    collision: Any, folder: pathlib.Path, packages: Mapping[str, Any], max_error: float, link: str
) -> tuple[Mesh, NDArray[np.float64]]:
    """Returns the mesh of a collision element, and its pose in the frame of the link."""
    geometry, pose = collision.geometry, collision.origin
    pose = np.eye(4) if pose is None else np.asarray(pose, np.float64)
    if geometry.box is not None:
        return box(geometry.box.size), pose
    if geometry.cylinder is not None:
        return cylinder(geometry.cylinder.radius, geometry.cylinder.length, max_error=max_error), pose
    if geometry.sphere is not None:
        return sphere(geometry.sphere.radius, max_error=max_error), pose
    if geometry.mesh is None:
        raise InvalidInput(f"link {link!r} has collision geometry that is no mesh, box, cylinder or sphere")
    mesh = _read(_resolved(geometry.mesh.filename, folder, packages, link), link)
    scale = np.ones(3) * (1.0 if geometry.mesh.scale is None else geometry.mesh.scale)
    faces = np.asarray(mesh.faces)
    return Mesh(np.asarray(mesh.vertices, np.float64) * scale, faces[:, ::-1] if scale.prod() < 0 else faces), pose


def _read(path: pathlib.Path, link: str) -> Mesh:
    """Reads a mesh, by trimesh if crumple has no reader for the format, as for .dae."""
    try:
        if path.suffix.lower() != ".dae":
            return read_mesh(path, weld="yes")
    except MemoryLimit:
        raise
    except Error as error:
        raise InvalidInput(f"link {link!r}: its mesh cannot be read: {error}") from error
    try:
        import trimesh

        mesh: Any = trimesh.load(path, force="mesh")  # with merged vertices
    except Exception as error:  # of many types, some for packages that are missing
        packages = "Collada files need trimesh and pycollada (pip install trimesh pycollada)"
        raise InvalidInput(f"link {link!r}: its mesh {path} cannot be read: {error}; {packages}") from error
    return Mesh(np.asarray(mesh.vertices), np.asarray(mesh.faces))


def _resolved(name: str, folder: pathlib.Path, packages: Mapping[str, Any], link: str) -> pathlib.Path:
    """Returns the file with a name, which may begin with package:// or file://."""
    scheme, mark, rest = name.partition("://")
    inside = rest if mark else scheme
    package, _, below = inside.partition("/")
    if scheme == "package" and mark and package in packages:
        places = [pathlib.Path(packages[package]) / below]
    else:
        above = [folder, *folder.parents]
        places = [pathlib.Path(inside)] if pathlib.Path(inside).is_absolute() else [f / inside for f in above]
        if scheme == "package" and mark:
            places += [f / below for f in above]
    for place in places:
        if place.is_file():
            return place
    if scheme == "package" and mark:
        known = f"{places[0]} is no file" if package in packages else f"it is neither in {folder} nor in a folder above"
        hint = f"{known}; pass packages={{{package!r}: FOLDER}}"
    else:
        hint = f"it is neither in {folder} nor in a folder above"
    raise InvalidInput(f"link {link!r}: there is no mesh {name}: {hint}")


def _joined(parts: list[tuple[Mesh, NDArray[np.float64]]]) -> Mesh:
    vertices, faces, count = [], [], 0
    for mesh, pose in parts:
        moved = np.asarray(mesh.vertices) @ pose[:3, :3].T + pose[:3, 3]
        vertices.append(moved)
        faces.append(np.asarray(mesh.faces, np.int32).reshape(-1, 3) + np.int32(count))
        count += len(moved)
    return Mesh(np.concatenate(vertices), np.concatenate(faces))
