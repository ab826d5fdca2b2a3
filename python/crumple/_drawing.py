"""Pictures of results: plain arrays of all that a picture shows, and PyVista, which only this module imports."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ._arrays import host_array
from ._errors import InvalidInput
from ._mesh import Mesh
from ._results import Contacts

#: Red, green, blue of calm (free) and colliding triangles of the first and second mesh, and of contacts. The same
#: colours as in files that the library writes.
CALM = ((178, 178, 178), (150, 168, 188))
COLLIDING = ((213, 94, 0), (213, 94, 0))
CONTACT = (20, 20, 20)


class PictureContents(NamedTuple):
    """Contents of a picture.

    Attributes
    ----------
    first : Mesh
        First mesh.
    hit : (m,) ndarray of bool
        True for triangles of the first mesh that collide.
    contacts : Contacts or None
        Contacts to draw.
    second : Mesh or None
        Second mesh.
    hit_second : (m,) ndarray of bool or None
        True for triangles of the second mesh that collide.
    """

    first: Mesh
    hit: NDArray[np.bool_]
    contacts: Contacts | None
    second: Mesh | None = None
    hit_second: NDArray[np.bool_] | None = None


class Drawing(NamedTuple):
    """One or two meshes of a picture, joined into one, with the contacts.

    Attributes
    ----------
    vertices : (n, 3) ndarray of float64
        Vertices of both meshes.
    faces : (m, 3) ndarray of int64
        Indices of vertices.
    colours : (m, 3) ndarray of uint8
        Red, green, blue of each face.
    lines : (s, 2, 3) ndarray of float64
        Contact segments, and the edges of contact areas.
    points : (p, 3) ndarray of float64
        Contacts at a single point.
    """

    vertices: NDArray[np.float64]
    faces: NDArray[np.int64]
    colours: NDArray[np.uint8]
    lines: NDArray[np.float64]
    points: NDArray[np.float64]


def _arrays_of(mesh: Mesh, triangles: int):
    """Returns copies of vertices and faces as they are now. Raises InvalidInput if they no longer fit the result."""
    vertices, faces = host_array(mesh.vertices, "vertices"), host_array(mesh.faces, "faces")
    if vertices.size % 3 == 0 and faces.size == 3 * triangles:
        vertices, faces = vertices.astype(np.float64).reshape(-1, 3), faces.astype(np.int64).reshape(-1, 3)
        if not triangles or 0 <= faces.min() <= faces.max() < len(vertices):
            return vertices, faces
    raise InvalidInput("the mesh was changed after the search, so the result no longer fits it")


def _coloured(mesh: Mesh, hit: NDArray[np.bool_], side: int):
    vertices, faces = _arrays_of(mesh, len(hit))
    palette = np.array([CALM[side], COLLIDING[side]], np.uint8)
    return vertices, faces, palette[hit.astype(np.intp)]


def _contact_lines(result: PictureContents):
    contacts = result.contacts
    if contacts is None or not len(contacts):
        return np.empty((0, 2, 3)), np.empty((0, 3))
    # Lines join the points of a contact: each point to the next one, and the last point of an area to its first.
    starts, ends = contacts.offsets[:-1], contacts.offsets[1:]
    counts = ends - starts
    following = np.arange(len(contacts.points)) + 1
    following[ends - 1] = starts
    owner = np.repeat(np.arange(len(counts)), counts)
    drawn = counts[owner] > 1
    drawn[ends[counts == 2] - 1] = False  # draws a segment only once
    return np.stack([contacts.points[drawn], contacts.points[following[drawn]]], axis=1), contacts.points[
        starts[counts == 1]
    ]


def drawing_of(result: PictureContents) -> Drawing:
    """Returns the meshes of a result, with colliding triangles coloured, and its contacts. Copies all arrays."""
    vertices, faces, colours = _coloured(result.first, result.hit, 0)
    if result.second is not None:
        more_vertices, more_faces, more_colours = _coloured(result.second, result.hit_second, 1)
        faces = np.concatenate([faces, more_faces + len(vertices)])
        vertices = np.concatenate([vertices, more_vertices])
        colours = np.concatenate([colours, more_colours])
    return Drawing(vertices, faces, colours, *_contact_lines(result))


def _in_front(actor: Any) -> None:
    """Draws contacts a little nearer to the camera: otherwise the surfaces around them would hide parts of them."""
    mapper = actor.mapper
    mapper.SetResolveCoincidentTopologyToPolygonOffset()
    mapper.SetRelativeCoincidentTopologyLineOffsetParameters(0.0, -300.0)
    mapper.SetRelativeCoincidentTopologyPointOffsetParameter(-300.0)


def plotter(result: PictureContents, off_screen: bool | None) -> Any:
    """Returns a pyvista.Plotter of the result. Raises ModuleNotFoundError that names the package to install."""
    try:
        import pyvista
    except ModuleNotFoundError as error:
        raise ModuleNotFoundError("pictures need PyVista: pip install pyvista", name="pyvista") from error
    drawing = drawing_of(result)
    scene = pyvista.Plotter(off_screen=off_screen)
    scene.set_background("white")
    if len(drawing.faces):
        mesh = pyvista.PolyData.from_regular_faces(drawing.vertices, drawing.faces)
        mesh.cell_data["colour"] = drawing.colours
        scene.add_mesh(mesh, scalars="colour", rgb=True, show_edges=len(drawing.faces) <= 5_000, edge_color="#8a9199")
    if len(drawing.lines):
        lines = pyvista.line_segments_from_points(drawing.lines.reshape(-1, 3))
        _in_front(scene.add_mesh(lines, color=CONTACT, line_width=4))
    if len(drawing.points):
        points = pyvista.PolyData(np.ascontiguousarray(drawing.points))
        _in_front(scene.add_mesh(points, color=CONTACT, point_size=10, render_points_as_spheres=True))
    scene.camera_position = "iso"
    return scene


def image(result: PictureContents, **options: Any) -> Any:
    """Returns a PIL.Image of the result, without opening a window."""
    scene = plotter(result, off_screen=True)
    try:
        pixels = scene.screenshot(**{**options, "filename": None, "return_img": True})
    finally:
        scene.close()
    from PIL import Image  # a dependency of PyVista, too

    return Image.fromarray(pixels)
