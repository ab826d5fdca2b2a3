"""Meshes as input: crumple's own, and those of trimesh, meshio, Open3D and PyVista."""

from __future__ import annotations

from typing import Any, NamedTuple

from . import _core
from ._errors import InvalidInput, InvalidType


class Mesh(NamedTuple):
    """A triangle soup: any will do, open, non-manifold, degenerate, several objects in one array. Nothing is copied.

    Attributes:
        vertices: (n, 3) float32 or float64: NumPy, or anything that speaks DLPack or the buffer protocol; any strides.
        faces: (m, 3) integers, indices into `vertices`; or flat, three a triangle.
        groups: (m,) integers that fit int32, one group a face, or None: all in group 0.
    """

    vertices: Any
    faces: Any
    groups: Any = None


class Polygons(NamedTuple):
    """The polygons that a file's triangles were cut from.

    `numpy.unique(numpy.sort(polygons.of_triangle[result.pairs]), axis=0)` are the pairs of polygons of one mesh that
    collide; (p, p) is a polygon that collides with itself.

    Attributes:
        of_triangle: (m,) int32, the polygon of each triangle, ascending.
        offsets: (p + 1,) int64; the corners of polygon i are corners[offsets[i]:offsets[i + 1]].
        corners: (k,) int32, indices into the vertices, in the order of the file.
    """

    of_triangle: Any
    offsets: Any
    corners: Any


class FileMesh(Mesh):
    """A Mesh read from a file.

    Attributes:
        polygons: the file's Polygons, or None where each of its faces is a triangle.
        unit: of the coordinates, "um", "mm", "cm", "in", "ft" or "m"; None if the file does not say.
    """

    polygons: Polygons | None = None
    unit: str | None = None


def as_mesh(mesh: Any) -> Mesh:
    """Views another package's mesh as a Mesh, without a copy where that package's arrays allow it.

    Takes a Mesh, a tuple (vertices, faces) or (vertices, faces, groups), and meshes of

    - trimesh: Trimesh
    - meshio: Mesh; triangles, and quadrilaterals cut in two as read_mesh cuts them (concave ones without overlap), in
      the order of its cells; vertices and lines, higher-order ones too, bound nothing and are left out
    - Open3D: geometry.TriangleMesh and t.geometry.TriangleMesh
    - PyVista: PolyData of triangles

    Raises InvalidType for anything else, InvalidInput for cells that are neither triangles nor quadrilaterals.
    """
    if isinstance(mesh, Mesh):
        return mesh
    if isinstance(mesh, tuple) and len(mesh) in (2, 3):
        return Mesh(*mesh)
    if any(base.__module__.partition(".")[0] in ("pyvista", "pyvista_wasm") for base in type(mesh).__mro__):
        return _from_pyvista(mesh)
    if hasattr(mesh, "vertices") and hasattr(mesh, "faces"):  # trimesh, and packages that use its names
        return Mesh(mesh.vertices, mesh.faces)
    if hasattr(mesh, "points") and hasattr(mesh, "cells_dict"):
        return _from_meshio(mesh)
    if hasattr(mesh, "vertices") and hasattr(mesh, "triangles"):
        return _from_open3d(mesh)
    if hasattr(mesh, "vertex") and hasattr(mesh, "triangle"):
        return _from_open3d_tensors(mesh)
    if hasattr(mesh, "graph") and hasattr(mesh, "geometry"):
        raise InvalidType(
            "a scene of trimesh is a world of bodies: crumple.World.from_trimesh, or as one mesh .to_mesh() of it"
        )
    raise InvalidType(
        "a mesh must be crumple.Mesh, a tuple (vertices, faces) or (vertices, faces, groups), or of trimesh, meshio, "
        f"Open3D or PyVista, not {f'a tuple of {len(mesh)}' if isinstance(mesh, tuple) else _name_of_type(mesh)}"
    )


def soup_of(vertices: Any, faces: Any = None, groups: Any = None) -> Mesh:
    """A mesh that is given by its arrays, or as one object."""
    if faces is not None:
        return Mesh(vertices, faces, groups)
    mesh = as_mesh(vertices)
    if groups is None:
        return mesh
    grouped = mesh._replace(groups=groups)
    if isinstance(mesh, FileMesh) and isinstance(grouped, FileMesh):
        grouped.polygons, grouped.unit = mesh.polygons, mesh.unit
    return grouped


def listing_of(vertices: Any, faces: Any, groups: Any, edges: Any, points: Any) -> Mesh:
    """The same, or an array of vertices alone where edges or points are listed: a mesh without faces."""
    alone = isinstance(vertices, list) or hasattr(vertices, "__array_interface__") or hasattr(vertices, "__dlpack__")
    if faces is None and alone and not (edges is None and points is None):
        return Mesh(vertices, [], groups)
    return soup_of(vertices, faces, groups)


def _name_of_type(thing: Any) -> str:
    return f"{type(thing).__module__}.{type(thing).__qualname__}".removeprefix("builtins.")


def _from_open3d(mesh: Any) -> Mesh:
    import numpy as np

    return Mesh(np.asarray(mesh.vertices), np.asarray(mesh.triangles))


def _from_open3d_tensors(mesh: Any) -> Mesh:
    # Empty meshes lack these attributes.
    return Mesh(
        mesh.vertex.positions if "positions" in mesh.vertex else [],
        mesh.triangle.indices if "indices" in mesh.triangle else [],
    )


def _from_pyvista(mesh: Any) -> Mesh:
    if not hasattr(type(mesh), "is_all_triangles"):
        raise InvalidType(
            f"a mesh of PyVista must be PolyData, not {_name_of_type(mesh)}: "
            "call .extract_surface().triangulate() first"
        )
    if not len(mesh.faces) and not mesh.n_strips:  # empty, or vertices and lines, which bound nothing
        return Mesh(mesh.points, [])
    if mesh.n_strips or not mesh.is_all_triangles:
        raise InvalidInput("the PyVista mesh has faces that are no triangles: call .triangulate() first")
    return Mesh(mesh.points, mesh.regular_faces)


def _from_meshio(mesh: Any) -> Mesh:
    import numpy as np

    points = np.asarray(mesh.points)
    if points.dtype.kind in "iu":
        points = points.astype(np.float64)
    blocks = []
    for block in mesh.cells:  # in their order; cells_dict gathers cells by type
        kind, cells = block.type, block.data
        if kind == "triangle":
            blocks.append(cells)
        elif kind == "quad":
            if points.shape[1:] != (3,):
                raise InvalidInput(f"the meshio mesh has points of shape {points.shape}, not (n, 3)")
            places = np.ascontiguousarray(points, np.float64)
            blocks.append(_core.cut_quadrilaterals(places, np.ascontiguousarray(cells, np.int64)))
        elif kind != "vertex" and not kind.startswith("line"):
            raise InvalidInput(
                f"the meshio mesh has cells of type {kind}: extract its surface, or pass "
                "(mesh.points, mesh.cells_dict['triangle'])"
            )
    faces = blocks[0] if len(blocks) == 1 else np.concatenate([np.empty((0, 3), np.int64), *blocks])
    return Mesh(points, faces)
