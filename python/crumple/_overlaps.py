"""Overlaps of bodies: how much, where, and which way out."""

from __future__ import annotations

import os
from enum import IntEnum
from itertools import pairwise
from typing import TYPE_CHECKING, Any, ClassVar

from . import _core
from ._errors import InvalidInput
from ._mesh import as_mesh
from ._results import Result, bools, extension_of, file_name, float64, int32, int64, uint8
from ._world import World

if TYPE_CHECKING:
    import numpy as np

_FROM = {"skipped": "any", "world_hit": "any_by_world", "bodies": "body_pairs", "relation": "body_pairs"}
_ORDER = ("any", "any_by_world", "body_pairs", "pairs")
_OF_CURVES = (
    "curve_offsets",
    "curve_closed",
    "curve_area_vector",
    "curve_torque",
    "curve_point_offsets",
    "curve_points",
    "curve_triangles",
)
_OPTION = {
    **dict.fromkeys(_OF_CURVES, "curves"),
    **dict.fromkeys(("gradient", "gradient_vertices", "gradient_offsets"), "gradient"),
    **dict.fromkeys(("windings", "winding_vertices", "winding_offsets"), "windings"),
    **dict.fromkeys(("body_volume", "is_solid"), "self_overlaps"),
}


class OverlapRelation(IntEnum):
    """Relation of two bodies, decided exactly; volumes are integrals of winding numbers, in magnitude.

    TOUCHING: their surfaces meet, and the overlap has no volume. FIRST_INSIDE, SECOND_INSIDE, EQUAL: the overlap has
    the volume of the first body, of the second, of each of them, which is not 0. OVERLAPPING: none of these.
    UNDEFINED: a surface is not closed (open="curves").
    """

    TOUCHING = 0
    OVERLAPPING = 1
    FIRST_INSIDE = 2
    SECOND_INSIDE = 3
    EQUAL = 4
    UNDEFINED = 5


class Overlaps(Result):
    """How much bodies overlap: a row for each pair whose surfaces meet, or of which one has a component in the other.

    Rows are in the order of first body, second body, the first the lower one. So worlds follow each other, and pairs
    among bodies that are in all worlds, which come once, are last. `len(overlaps)` is the number of rows. Volumes, area
    vectors and torques are exact sums, rounded once; the same bytes wherever they are computed.
    """

    _query: ClassVar[str] = "OverlapQuery"

    world_hit = bools('(worlds,) bool: in which worlds there is a row. From output="any_by_world" on.')
    skipped = int32(
        '(s,) int32: with open="skip" the bodies that are not closed, of those that are wanted with a body whose box '
        "overlaps theirs."
    )
    bodies = int32("(k, 2) int32: the two bodies, the lower one first.", (2,))
    relation = uint8("(k,) uint8: an OverlapRelation each.")
    volume = float64("(k,) float64: the volume of the overlap, in the units of the world, cubed.")
    centroid = float64("(k, 3) float64: the centroid of the overlap; NaN where the volume is 0.", (3,))
    area_vector = float64(
        "(k, 3) float64: the derivative of the volume where the first body moves: the integral of the outward normal "
        "over what of its surface lies inside the second body.",
        (3,),
    )
    normal = float64("(k, 3) float64: the direction of the area vector, the contact normal; NaN where that is 0.", (3,))
    mean_depth = float64("(k,) float64: the volume over the length of the area vector; NaN where that is 0.")
    torque = float64(
        "(k, 3) float64: the derivative of the volume where the first body turns about `torque_point`.", (3,)
    )
    torque_point = float64("(k, 3) float64: the centroid; where there is none, a point between the bodies.", (3,))
    contact_area = float64(
        "(k,) float64: the total common area of coplanar triangles of both bodies, whichever way they face."
    )

    gradient = float64(
        "(m, 3) float64: derivatives of volumes by vertices, those that are not 0, for OverlapQuery(gradient=True).",
        (3,),
    )
    gradient_vertices = int32("(m, 2) int32: of each of `gradient` the body, and the vertex of its shape.", (2,))
    gradient_offsets = int64("(k + 1,) int64: row i has gradient[gradient_offsets[i] : gradient_offsets[i + 1]].")
    curve_offsets = int64(
        "(k + 1,) int64: for OverlapQuery(curves=True), row i has the curves from curve_offsets[i] to "
        "curve_offsets[i + 1]. If you follow one on the first body, seen from outside it, the inside of the second is "
        "on the left."
    )
    curve_closed = bools("(c,) bool: of each curve, whether it is closed. Curves end at boundaries of open surfaces.")
    curve_area_vector = float64(
        "(c, 3) float64: the contribution of each curve to the area vector, one-sided; NaN if it is open.",
        (3,),
    )
    curve_torque = float64("(c, 3) float64: the same of the torque.", (3,))
    curve_point_offsets = int64(
        "(c + 1,) int64: curve j has curve_points[curve_point_offsets[j] : curve_point_offsets[j + 1]]."
    )
    curve_points = float64(
        "(n, 3) float64: points of the curves, one after the other; of a closed one the last is the first.", (3,)
    )
    curve_triangles = int32(
        "(n, 2) int32: the triangles of the two bodies that cross between a point and the next; -1 at the last point "
        "of a curve.",
        (2,),
    )
    windings = int32(
        "(m,) int32: winding numbers of the other body at vertices, those that are not 0, for "
        "OverlapQuery(windings=True)."
    )
    winding_vertices = int32("(m, 2) int32: of each of `windings` the body, and the vertex of its shape.", (2,))
    winding_offsets = int64("(k + 1,) int64: row i has windings[winding_offsets[i] : winding_offsets[i + 1]].")
    body_volume = float64(
        "(bodies,) float64: the volume of each body, NaN of one that is not closed; of a mesh, or for "
        "OverlapQuery(self_overlaps=True)."
    )
    is_solid = bools("(bodies,) bool: whether all winding numbers of a body are 0 or 1; with `body_volume`.")

    def _check(self, name: str) -> None:
        option = _OPTION.get(name)
        of_mesh = option == "self_overlaps" and self._request.scene == "mesh"
        if option is not None and option not in self._request.options and not of_mesh:
            self._refuse(name, f"{option}=True")
        least = _FROM.get(name, "pairs")
        if _ORDER.index(self._request.output) < _ORDER.index(least):
            self._refuse(name, f'output="{least}"')

    def save(self, path: str | os.PathLike[str], *scene: Any) -> None:
        """Writes a picture in which overlaps are seen from outside: save("overlap.html", world), or (path, mesh, mesh).

        What lies inside another body of a row, or a second time inside its own, is opaque and in a strong colour, all
        else is translucent. Bodies of rows are cut for that along the curves in which they cross, which are searched
        anew, so that the file has other triangles than the scene.

        - .html: a page to turn and zoom, which also shows the curves
        - .glb, .3mf: bodies with names; .obj: one mesh, with its materials in a .mtl beside it
        - .ply, which knows nothing translucent: the surface of the overlaps alone

        `scene` is what was searched: a World of one configuration, or one or two meshes as as_mesh takes them. A file
        appears when it is complete; Ctrl-C waits until then. Raises InvalidInput for other extensions, for results that
        do not list bodies, and for a scene that does not fit; FileError.
        """
        name = file_name(path)
        if extension_of(name) not in (".html", ".glb", ".3mf", ".obj", ".ply"):
            raise InvalidInput(f"{name}: a picture of overlaps is saved as .html, .glb, .3mf, .obj or .ply")
        bodies, relations = self.bodies, self.relation
        is_world = len(scene) == 1 and isinstance(scene[0], World)
        world = scene[0] if is_world else World([as_mesh(mesh) for mesh in scene])
        if (world.worlds > 0).any():
            raise InvalidInput("a picture of overlaps shows one configuration, but the world has several")
        _core.write_coloured_overlaps(path, world, world.poses, world._all_names(), bodies, relations)

    @property
    def curves(self) -> list[list[np.ndarray]]:
        """The curves of each row: a list of arrays (m, 3) of points, which are parts of `curve_points`."""
        points = self.curve_points
        curves = [points[begin:end] for begin, end in pairwise(self.curve_point_offsets.tolist())]
        return [curves[begin:end] for begin, end in pairwise(self.curve_offsets.tolist())]

    @property
    def count(self) -> int:
        """How many pairs of bodies are listed."""
        return self._found.count

    def __len__(self) -> int:
        """How many pairs of bodies are listed."""
        return self._found.count

    def __repr__(self) -> str:
        pairs = "pair" if len(self) == 1 else "pairs"
        rows = (
            f"{len(self)} {pairs} of bodies" if self._request.output in ("body_pairs", "pairs") else f"any: {self.any}"
        )
        return f"<crumple.Overlaps: {rows}, {self.statistics.milliseconds:.3g} ms>"
