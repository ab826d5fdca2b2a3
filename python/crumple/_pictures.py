"""Pictures by PyVista, which is imported only here."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from ._drawing import CONTACT, drawing_of

if TYPE_CHECKING:
    from ._intersections import Painted


def _in_front(actor: Any) -> None:
    """Draws contacts a little nearer to the eye: the surfaces that they lie in would hide half of each line."""
    mapper = actor.mapper
    mapper.SetResolveCoincidentTopologyToPolygonOffset()
    mapper.SetRelativeCoincidentTopologyLineOffsetParameters(0.0, -300.0)
    mapper.SetRelativeCoincidentTopologyPointOffsetParameter(-300.0)


def plotter(result: Painted, off_screen: bool | None) -> Any:
    """A pyvista.Plotter that shows the result. Raises a ModuleNotFoundError that says what to install."""
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


def image(result: Painted, **options: Any) -> Any:
    """A PIL.Image, without opening a window."""
    scene = plotter(result, off_screen=True)
    try:
        pixels = scene.screenshot(**{**options, "filename": None, "return_img": True})
    finally:
        scene.close()
    from PIL import Image  # PyVista needs it, too

    return Image.fromarray(pixels)
