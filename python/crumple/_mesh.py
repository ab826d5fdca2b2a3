"""Input meshes, of crumple and of trimesh, meshio, Open3D and PyVista; and shapes of bodies."""

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
    """Triangle soup, with optional positions at the end of a step, edges and points. Nothing is copied.

    Works on any triangle soup: open, non-manifold, degenerate, several objects in one array. A Mesh is a tuple
    (vertices, faces, groups) with further attributes.

    Attributes
    ----------
    vertices : (n, 3) array_like of float32 or float64
        Positions: a NumPy array, or anything that supports DLPack or the buffer protocol, with any strides.
    faces : (m, 3) or (3 m,) array_like of int
        Indices of vertices.
    groups : (m,) array_like of int or None
        Group of each triangle, within the range of int32; None: all in group 0.
    end : (n, 3) array_like of float32 or float64, or None
        Positions at the end of a step; None: the mesh does not move. If `vertices` or `end` is float64, the computation
        is in float64.
    edges : (k, 2) array_like of int or None
        Edges that queries about features test, instead of the edges of the faces. Rows of results contain their
        positions in this array.
    points : (k,) array_like of int or None
        Vertices that queries about features test, instead of all vertices of faces and edges. Rows of results contain
        their positions in this array. With `edges` or `points`, `faces` may be empty: for rods, hair, particles.
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
        """Returns this mesh with positions at the end of a step, to which vertices move straight.

        Parameters
        ----------
        end : (n, 3) array_like of float32 or float64
            Positions at the end.

        Returns
        -------
        Mesh
        """
        return self._with(end=end)

    def _with(self, **changes: Any) -> Self:
        """Returns a copy in which the given arrays and attributes are replaced."""
        arrays = [changes.pop(name, value) for name, value in zip(self._fields, self)]
        mesh = type(self)(*arrays)
        mesh.__dict__.update(self.__dict__, **changes)
        return mesh


class Polygons(NamedTuple):
    """Polygons of a file, from which the triangles were made.

    Attributes
    ----------
    of_triangle : (m,) ndarray of int32
        Polygon of each triangle, ascending.
    offsets : (p + 1,) ndarray of int64
        Polygon i has the corners corners[offsets[i]:offsets[i + 1]].
    corners : (k,) ndarray of int32
        Indices of vertices, in the order of the file.

    Examples
    --------
    Pairs of polygons of one mesh that collide; (p, p) is a polygon that collides with itself:

        numpy.unique(numpy.sort(polygons.of_triangle[result.pairs]), axis=0)
    """

    of_triangle: Any
    offsets: Any
    corners: Any


class FileMesh(Mesh):
    """Mesh that was read from a file.

    Attributes
    ----------
    polygons : Polygons or None
        Polygons of the file; None if all of its faces are triangles.
    unit : {"um", "mm", "cm", "in", "ft", "m"} or None
        Unit of the coordinates; None if the file does not state one.
    """

    polygons: Polygons | None = None
    unit: str | None = None


def as_mesh(mesh: Any) -> Mesh:
    """Returns a mesh of another package as a Mesh, without a copy if that package's arrays allow it.

    Parameters
    ----------
    mesh : Mesh, tuple, or mesh of another package
        A tuple is (vertices, faces) or (vertices, faces, groups). Other packages:

        - trimesh: Trimesh;
        - meshio: Mesh. Its triangles and quadrilaterals, in the order of its cells; each quadrilateral is cut into two
          triangles as in read_mesh (a concave one without overlap). Cells that are vertices or lines are left out;
        - Open3D: geometry.TriangleMesh and t.geometry.TriangleMesh;
        - PyVista: PolyData of triangles.

    Returns
    -------
    Mesh

    Raises
    ------
    InvalidType
        If the object is anything else.
    InvalidInput
        If it has cells that are neither triangles nor quadrilaterals.
    """
    if isinstance(mesh, Mesh):
        return mesh
    if isinstance(mesh, tuple) and len(mesh) in (2, 3):
        return Mesh(*mesh)
    if any(base.__module__.partition(".")[0] in ("pyvista", "pyvista_wasm") for base in type(mesh).__mro__):
        return _from_pyvista(mesh)
    if hasattr(mesh, "vertices") and hasattr(mesh, "faces"):  # trimesh, and packages with the same names
        return Mesh(mesh.vertices, mesh.faces)
    if hasattr(mesh, "points") and hasattr(mesh, "cells_dict"):
        return _from_meshio(mesh)
    if hasattr(mesh, "vertices") and hasattr(mesh, "triangles"):
        return _from_open3d(mesh)
    if hasattr(mesh, "vertex") and hasattr(mesh, "triangle"):
        return _from_open3d_tensors(mesh)
    if hasattr(mesh, "graph") and hasattr(mesh, "geometry"):
        raise InvalidType(
            "a trimesh scene is a world of bodies: use crumple.World.from_trimesh(scene), or scene.to_mesh()"
        )
    raise InvalidType(
        "a mesh must be crumple.Mesh, a tuple (vertices, faces) or (vertices, faces, groups), or of trimesh, meshio, "
        f"Open3D or PyVista, not {f'a tuple of {len(mesh)}' if isinstance(mesh, tuple) else name_of_type(type(mesh))}"
    )


def is_mesh(thing: Any) -> bool:
    """True for anything that as_mesh takes, False for an array of vertices or faces."""
    if isinstance(thing, Mesh):
        return True
    if isinstance(thing, tuple):
        return len(thing) in (2, 3) and not _is_row(thing[0])
    if isinstance(thing, list) or hasattr(thing, "__dlpack__") or hasattr(thing, "__array_interface__"):
        return False
    return hasattr(thing, "vertices") or hasattr(thing, "points") or hasattr(thing, "vertex")


def _is_row(thing: Any) -> bool:
    """True for an index or a row of indices: `thing` is then the first element of faces, not the vertices of a mesh."""
    if isinstance(thing, (list, tuple)):
        return len(thing) > 0 and not hasattr(thing[0], "__len__")
    return isinstance(thing, int)


def mesh_of(vertices: Any, faces: Any = None, **attributes: Any) -> Mesh:
    """Returns a Mesh, made from arrays or from one object. Attributes that are not None replace those of the object."""
    given = {name: value for name, value in attributes.items() if value is not None}
    if faces is None and ("edges" in given or "points" in given) and not is_mesh(vertices):
        faces = []  # a mesh without faces
    mesh = as_mesh(vertices) if faces is None else Mesh(vertices, faces)
    return mesh._with(**given) if given else mesh


def open_edges(vertices: Any, faces: Any = None, weld: bool = False) -> tuple[NDArray[np.int32], NDArray[np.int32]]:
    """Finds the open edges of a surface: edges that its triangles name more often in one direction than in the other.

    A surface without open edges is closed, as an OverlapQuery needs it. An edge of only one triangle is open, and so is
    an edge that two triangles traverse in the same direction.

    Parameters
    ----------
    vertices : (n, 3) array_like, or mesh
        Vertices in host memory; or one object that as_mesh takes.
    faces : (m, 3) or (3 m,) array_like of int, optional
        Indices of vertices.
    weld : bool, default False
        True: vertices at equal positions count as one, the one with the lowest index.

    Returns
    -------
    edges : (k, 2) ndarray of int32
        Vertices of each edge, the lower one first, in lexicographic order.
    triangles : (k,) ndarray of int32
        Lowest triangle of each edge.

    Raises
    ------
    InvalidInput, InvalidType
        If the mesh is invalid.

    Notes
    -----
    Cost: O(m log m), on one thread.
    """
    return _core.open_edges(mesh_of(vertices, faces), weld)


def _from_open3d(mesh: Any) -> Mesh:
    import numpy as np

    return Mesh(np.asarray(mesh.vertices), np.asarray(mesh.triangles))


def _from_open3d_tensors(mesh: Any) -> Mesh:
    # An empty mesh has no positions and no indices.
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
    if not len(mesh.faces) and not mesh.n_strips:  # the mesh is empty, or has only vertices and lines
        return Mesh(mesh.points, [])
    if mesh.n_strips or not mesh.is_all_triangles:
        raise InvalidInput("the PyVista mesh has faces that are not triangles: call .triangulate() first")
    return Mesh(mesh.points, mesh.regular_faces)


def _from_meshio(mesh: Any) -> Mesh:
    import numpy as np

    points = np.asarray(mesh.points)
    if points.dtype.kind in "iu":
        points = points.astype(np.float64)
    blocks = []
    for block in mesh.cells:  # in the order of cells; cells_dict collects them by type
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


_FIRST_OWN = 2**63  # smallest number that is assigned to a str or an OwnName; an int name is its own number and smaller
_own_numbers = itertools.count(_FIRST_OWN)
_numbers: dict[str, int] = {}


class OwnName:
    """Private name of one shape, whose arrays never change."""


def _number_of(name: Any) -> int:
    if name is None:
        return 0
    if isinstance(name, OwnName):
        return next(_own_numbers)
    if isinstance(name, str):
        if not name:
            raise InvalidInput("name must not be empty; use None for a shape without a name")
        return _numbers.get(name) or _numbers.setdefault(name, next(_own_numbers))
    if isinstance(name, bool) or not hasattr(name, "__index__"):
        raise InvalidType(f"name must be a str, an int or None, not {type(name).__name__}")
    number = name.__index__()
    if not 0 < number < _FIRST_OWN:
        raise InvalidInput(f"name must be a str or from 1 to {_FIRST_OWN - 1}, not {number}")
    return number


def name_of_number(number: int) -> str | int | None:
    """Returns the name to which a number was assigned; None if it was assigned to an OwnName."""
    if number < _FIRST_OWN:
        return number
    return next((name for name, known in _numbers.items() if known == number), None)


class Shape(_core.Shape):
    """Triangles, edges and points that bodies are made of. Nothing is copied.

    Parameters
    ----------
    vertices : (n, 3) array_like of float32 or float64, or mesh
        Positions in host memory; or, without `faces`, a mesh that as_mesh takes.
    faces : (m, 3) or (3 m,) array_like of int, optional
        Indices of vertices.
    groups : (m,) array_like of int, optional
        Group of each triangle, within the range of int32. None: the groups of the mesh; if it has none, each body's
        group.
    name : str or int, optional
        A str, or an int from 1 to 2**63 - 1. With a name, the caller promises that every shape with this name has the
        same contents in all calls. A detector then validates the shape in the first call only, and caches derived data
        for all bodies with this shape. Names are valid for the whole process. If vertices change, use no name or a new
        one.
    end : (n, 3) array_like of float32 or float64, optional
        Positions at the end of a step, for queries about motion; None: the shape does not move. This array and the
        following ones may differ between shapes of one `name`.
    edges, points : array_like of int, optional
        As in Mesh, for queries about features. A feature without a face is in the body's group if the shape has no
        groups, and in no group otherwise.
    radii : (n,) array_like of float64 or float32, optional
        Radius of each vertex, for a ProximityQuery, in the units of the world: poses do not scale it. None: all radii
        are 0 if another shape has radii.
    rest : (n, 3) array_like of float32 or float64, optional
        Rest shape, unposed, for `rest_radius` of a ProximityQuery; None: no rest shape.

    Raises
    ------
    InvalidInput
        If an argument is invalid. Names the argument. Coordinates and indices are validated by the first search that
        reads the shape. That search also refuses a shape whose size or precision differs from another shape of this
        name.

    Notes
    -----
    Cost: a body whose shape has a name costs less than a microsecond per call while it is clear of all other bodies.
    Pairs within a body are searched anew in each call.
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
        """Mesh that the shape was made from."""
        return self._mesh

    @property
    def name(self) -> int | str | None:
        """Name of the shape; None if it has no name, or only a private one, as shapes from files have."""
        return None if isinstance(self._name, OwnName) else self._name

    @property
    def end(self) -> Any:
        """Positions of the vertices at the end of a step, as given; None: the shape does not move."""
        return self._end

    @property
    def edges(self) -> Any:
        """Edges that queries about features test, as given; None: the edges of the faces."""
        return self._lists[0]

    @property
    def points(self) -> Any:
        """Vertices that queries about features test, as given; None: the vertices of faces and edges."""
        return self._lists[1]

    @property
    def radii(self) -> Any:
        """Radii of the vertices, as given, or None."""
        return self._radii

    @property
    def rest(self) -> Any:
        """Rest shape, as given, or None."""
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
    """Returns a Shape unchanged, or makes one from a mesh. `which` is the prefix of all messages."""
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
    """Makes a shape with a private name. Makes the arrays of the mesh read-only."""
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
    """Makes a shape from the contents of a pickle. A private name gets a new number."""
    shape = Shape.__new__(Shape)
    name = OwnName() if isinstance(name, OwnName) else name
    shape._make(Mesh(vertices, faces, groups), name, "", end, (edges, points), radii, rest)
    return shape
