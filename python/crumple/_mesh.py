"""Meshes as input, crumple's own and those of trimesh, meshio, Open3D and PyVista, and shapes of bodies."""

from __future__ import annotations

import itertools
from typing import TYPE_CHECKING, Any, NamedTuple

from . import _core
from ._errors import Error, InvalidInput, InvalidType, name_of_type, suggesting

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray
    from typing_extensions import Self


class _Arrays(NamedTuple):
    vertices: Any
    faces: Any
    groups: Any = None


class Mesh(_Arrays):
    """A triangle soup: any will do, open, non-manifold, degenerate, several objects in one array. Nothing is copied.

    A tuple (vertices, faces, groups), with the attributes of a step and of features beside it.

    Attributes:
        vertices: (n, 3) float32 or float64: NumPy, or anything that speaks DLPack or the buffer protocol; any strides.
        faces: (m, 3) integers, indices into `vertices`; or flat, three a triangle.
        groups: (m,) integers that fit int32, one group a face, or None: all in group 0.
        end: (n, 3) float32 or float64: where the vertices are at the end of a step; None: they stay. If one of both is
            float64, all is computed in float64.
        edges: (k, 2) integers: what is meant by edges, instead of those of the faces. Rows name them by their place.
        points: (k,) indices of vertices: what is meant by vertices, instead of those that a face or an edge names. Rows
            name them by their place. With either, `faces` may be empty: rods, hair, particles.
    """

    end: Any = None
    edges: Any = None
    points: Any = None

    def __new__(
        cls, vertices: Any, faces: Any, groups: Any = None, *, end: Any = None, edges: Any = None, points: Any = None
    ) -> Self:
        mesh = super().__new__(cls, vertices, faces, groups)
        if end is not None:
            mesh.end = end
        if edges is not None:
            mesh.edges = edges
        if points is not None:
            mesh.points = points
        return mesh

    def moving_to(self, end: Any) -> Self:
        """The same mesh, whose vertices go straight to `end`: (n, 3) float32 or float64."""
        return self._with(end=end)

    def _with(self, **changes: Any) -> Self:
        """A copy with other arrays or attributes."""
        arrays = [changes.pop(name, value) for name, value in zip(self._fields, self)]
        mesh = type(self)(*arrays)
        mesh.__dict__.update(self.__dict__, **changes)
        return mesh


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
        f"Open3D or PyVista, not {f'a tuple of {len(mesh)}' if isinstance(mesh, tuple) else name_of_type(type(mesh))}"
    )


def is_mesh(thing: Any) -> bool:
    """True of what as_mesh takes, False of an array of vertices or faces."""
    if isinstance(thing, Mesh):
        return True
    if isinstance(thing, tuple):
        return len(thing) in (2, 3) and not _is_row(thing[0])
    if isinstance(thing, list) or hasattr(thing, "__dlpack__") or hasattr(thing, "__array_interface__"):
        return False
    return hasattr(thing, "vertices") or hasattr(thing, "points") or hasattr(thing, "vertex")


def _is_row(thing: Any) -> bool:
    """True of (0, 1, 2) and of 0, which a tuple of faces has where a mesh has its vertices."""
    if isinstance(thing, (list, tuple)):
        return len(thing) > 0 and not hasattr(thing[0], "__len__")
    return isinstance(thing, int)


def mesh_of(vertices: Any, faces: Any = None, **attributes: Any) -> Mesh:
    """A mesh that is given by its arrays, or as one object; attributes that are None are those of the object."""
    given = {name: value for name, value in attributes.items() if value is not None}
    if faces is None and ("edges" in given or "points" in given) and not is_mesh(vertices):
        faces = []  # a mesh without faces
    mesh = as_mesh(vertices) if faces is None else Mesh(vertices, faces)
    return mesh._with(**given) if given else mesh


def open_edges(vertices: Any, faces: Any = None, weld: bool = False) -> tuple[NDArray[np.int32], NDArray[np.int32]]:
    """The open edges of a surface: those that triangles name more often in one direction than in the other.

    A surface without any is closed, as an OverlapQuery needs it. An edge of one triangle is open, and so is one along
    which two triangles run in the same direction.

    Args:
        vertices, faces: (n, 3) and (m, 3), on the host; or one object that as_mesh takes.
        weld: vertices at equal positions are one, the lowest of them.

    Returns (k, 2) int32, the two vertices of each edge, the lower one first, in lexicographic order; and (k,) int32,
    the lowest triangle that names it. Raises InvalidInput, InvalidType.
    """
    return _core.open_edges(mesh_of(vertices, faces), weld)


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
            f"a mesh of PyVista must be PolyData, not {name_of_type(type(mesh))}: "
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


_FIRST_OWN = 2**63  # numbers of names; those below are for names that are numbers
_own_numbers = itertools.count(_FIRST_OWN)
_numbers: dict[str, int] = {}


class OwnName:
    """The name of a shape that nobody else names, and whose arrays nobody changes."""


def _number_of(name: Any) -> int:
    if name is None:
        return 0
    if isinstance(name, OwnName):
        return next(_own_numbers)
    if isinstance(name, str):
        if not name:
            raise InvalidInput("name must not be empty; None: the shape has no name")
        return _numbers.get(name) or _numbers.setdefault(name, next(_own_numbers))
    if isinstance(name, bool) or not hasattr(name, "__index__"):
        raise InvalidType(f"name must be a str, an int or None, not {type(name).__name__}")
    number = name.__index__()
    if not 0 < number < _FIRST_OWN:
        raise InvalidInput(f"name must be a str or from 1 to {_FIRST_OWN - 1}, not {number}")
    return number


def name_of_number(number: int) -> str | int | None:
    """The name that a number stands for; None: a shape's own, which has no other."""
    if number < _FIRST_OWN:
        return number
    return next((name for name, known in _numbers.items() if known == number), None)


class Shape(_core.Shape):
    """Triangles, and edges and points, that bodies are made of. Nothing is copied.

    Args:
        vertices: (n, 3) float32 or float64; or a mesh that as_mesh knows, and then no `faces`. On the host.
        faces: (m, 3) integers, or flat: three a triangle.
        groups: (m,) integers that fit int32, one a triangle; None: the mesh's, or each body's own.
        name: a str, or an int from 1 to 2**63 - 1. What it names has the same contents now and in later calls. A
            detector checks it in the first call only and keeps what it has computed, for all bodies of that shape: one
            that is clear of all others costs less than a microsecond. Pairs within a body are searched anew. Names
            count for a whole process; another size or precision under a known name is an InvalidInput. A shape whose
            vertices move gets no name, or a new one with each change.
        end: (n, 3) float32 or float64: where they are at the end of a step, for queries about a step; None: they stay.
            What a name promises says nothing of it, nor of what follows.
        edges, points: as crumple.Mesh has them, for queries about features. What no face names is of
            the body's group where the shape has no groups, else of none.
        radii: (n,) float64 or float32, one a vertex, for a ProximityQuery, which tells what they are; None: 0, where
            another shape has some. In the units of the world, whatever the pose.
        rest: (n, 3) float32 or float64: where the vertices are at rest, before poses, for `rest_radius` of
            a ProximityQuery; None: there is no such shape.

    Raises InvalidInput, which names the argument. Whether coordinates are finite and indices in range is looked at when
    a search first reads the shape.
    """

    __slots__ = ("__weakref__", "_end", "_lists", "_mesh", "_name", "_radii", "_rest")

    @suggesting
    def __init__(
        self,
        vertices: Any,
        faces: Any = None,
        groups: Any = None,
        name: int | str | None = None,
        end: Any = None,
        edges: Any = None,
        points: Any = None,
        radii: Any = None,
        rest: Any = None,
    ) -> None:
        mesh = mesh_of(vertices, faces, groups=groups, end=end, edges=edges, points=points)
        self._make(mesh, name, "", mesh.end, (mesh.edges, mesh.points), radii, rest)

    def _make(
        self,
        mesh: Mesh,
        name: Any,
        which: str,
        end: Any = None,
        lists: tuple[Any, Any] = (None, None),
        radii: Any = None,
        rest: Any = None,
    ) -> None:
        super().__init__(mesh, which, _number_of(name), end, lists, radii, rest)
        self._lists = lists
        self._mesh = mesh
        self._name = name
        self._end = end
        self._radii = radii
        self._rest = rest

    @property
    def mesh(self) -> Mesh:
        """What the shape was made of."""
        return self._mesh

    @property
    def name(self) -> int | str | None:
        """What the shape is remembered by, if anything; None also for one that a file gave, whose name is its own."""
        return None if isinstance(self._name, OwnName) else self._name

    @property
    def end(self) -> Any:
        """Where the vertices are at the end of a step, as given; None: they stay."""
        return self._end

    @property
    def edges(self) -> Any:
        """The edges that are meant, as given; None: those of the faces."""
        return self._lists[0]

    @property
    def points(self) -> Any:
        """The vertices that are meant as points, as given; None: those that a face or an edge names."""
        return self._lists[1]

    @property
    def radii(self) -> Any:
        """The radii of the vertices, as given, or None."""
        return self._radii

    @property
    def rest(self) -> Any:
        """Where the vertices are at rest, as given, or None."""
        return self._rest

    def __reduce__(self) -> Any:
        import numpy as np

        from . import _arrays
        from ._arrays import if_given

        vertices, faces, groups = self.mesh
        faces = _arrays.faces(faces, "") if len(_arrays.host_array(faces, "faces")) else np.empty((0, 3), np.int32)
        return restore_shape, (
            _arrays.vertices(vertices, ""),
            faces,
            if_given(_arrays.groups, groups),
            self._name,
            if_given(_arrays.end_vertices, self.end),
            if_given(_arrays.edges, self.edges),
            if_given(_arrays.points, self.points),
            if_given(_arrays.radii, self.radii),
            if_given(_arrays.rest_vertices, self.rest),
        )

    def __repr__(self) -> str:
        named = f" {self.name!r}" if self.name else ""
        return f"<crumple.Shape{named}: {self.triangles} triangles>"


def shape_of(given: Any, which: str, name: Any = None) -> Shape:
    """A Shape as it is, or one of a mesh. `which` leads every message."""
    if isinstance(given, Shape):
        return given
    try:
        mesh = as_mesh(given)
    except Error as error:
        raise type(error)(f"{which}{error}", code=error.code) from None
    shape = Shape.__new__(Shape)
    shape._make(mesh, name, which, mesh.end, (mesh.edges, mesh.points))
    return shape


def constant_shape(mesh: Mesh, which: str) -> Shape:
    """A shape with a name of its own, whose arrays nobody can write to."""
    for array in mesh:
        if array is not None:
            array.flags.writeable = False
    shape = Shape.__new__(Shape)
    shape._make(mesh, OwnName(), which)
    return shape


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
    """The shape of a pickle. One whose own name is nobody else's has another number here."""
    shape = Shape.__new__(Shape)
    name = OwnName() if isinstance(name, OwnName) else name
    shape._make(Mesh(vertices, faces, groups), name, "", end, (edges, points), radii, rest)
    return shape
