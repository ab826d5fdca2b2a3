"""Result of an OverlapQuery: relation, volume, normal, depth, curves, regions and derivatives."""

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
_OF_REGIONS = (
    "region_offsets",
    "region_volume",
    "region_centroid",
    "region_area_vector",
    "region_normal",
    "region_mean_depth",
    "region_thickness",
    "region_box",
    "region_is_contact",
    "region_is_merged",
    "region_pieces",
    "curve_regions",
)
_OF_DEPTHS = ("depth_offsets", "depth_vertices", "depths", "depth_points", "depth_triangles", "deepest")
_OPTION = {
    **dict.fromkeys(_OF_REGIONS, "regions"),
    **dict.fromkeys(_OF_DEPTHS, "depths"),
    **dict.fromkeys(("depth_reached", "depth_bound"), "depth_tolerance"),
    **dict.fromkeys(("translation", "translation_low", "translation_high"), "translation"),
    **dict.fromkeys(("box", "thickness"), "extents"),
    **dict.fromkeys(("union_volume", "intersection_over_union", "difference_volume"), "unions"),
    "withdrawals": "directions",
    "first_free": "first_free",
    **dict.fromkeys(_OF_CURVES, "curves"),
    **dict.fromkeys(("gradient", "gradient_vertices", "gradient_offsets"), "gradient"),
    **dict.fromkeys(("windings", "winding_vertices", "winding_offsets"), "windings"),
    **dict.fromkeys(("body_volume", "is_solid"), "self_overlaps"),
}


class OverlapRelation(IntEnum):
    """Relation of two bodies, decided exactly.

    Volumes are integrals of winding numbers, in magnitude; the volume of an overlap is the integral of the product of
    the winding numbers of both bodies.

    Attributes
    ----------
    TOUCHING
        The surfaces meet, and the overlap has no volume.
    OVERLAPPING
        None of the other relations holds.
    FIRST_INSIDE
        The overlap has the volume of the first body, which is not 0.
    SECOND_INSIDE
        The overlap has the volume of the second body, which is not 0.
    EQUAL
        The overlap has the volume of each body.
    UNDEFINED
        A surface is not closed (open="curves").
    """

    TOUCHING = 0
    OVERLAPPING = 1
    FIRST_INSIDE = 2
    SECOND_INSIDE = 3
    EQUAL = 4
    UNDEFINED = 5


class Overlaps(Result):
    """Result of an OverlapQuery: one row for each pair of bodies that overlap.

    Two bodies overlap if their surfaces meet, or if a component of one is inside the other. `len(overlaps)` is the
    number of rows.

    Notes
    -----
    Rows are sorted by first body, then second; the first is the lower one. So the rows of each world follow those of
    the world before. Pairs of bodies that are both in all worlds occur once, and come last. Volumes, area vectors and
    torques are exact sums, rounded once. Every backend, instruction set and thread count gives the same bytes.
    """

    _query: ClassVar[str] = "OverlapQuery"

    world_hit = bools('(worlds,) bool: True for worlds with a row. Requires output="any_by_world" or more.')
    skipped = int32(
        '(s,) int32, with open="skip": bodies that are not closed, ascending, among selected pairs whose boxes '
        "overlap; with self_overlaps, among all bodies."
    )
    bodies = int32("(k, 2) int32: the two bodies, the lower one first.", (2,))
    relation = uint8("(k,) uint8: OverlapRelation of each pair.")
    volume = float64("(k,) float64: volume of the overlap, in the units of the world, cubed.")
    centroid = float64("(k, 3) float64: centroid of the overlap; NaN if the volume is 0.", (3,))
    area_vector = float64(
        "(k, 3) float64: derivative of the volume by a translation of the first body: the integral of the outward "
        "normal over the part of its surface inside the second body.",
        (3,),
    )
    normal = float64("(k, 3) float64: direction of the area vector, the contact normal; NaN if that is 0.", (3,))
    mean_depth = float64("(k,) float64: volume over the length of the area vector; NaN if that is 0.")
    torque = float64(
        "(k, 3) float64: derivative of the volume by a rotation of the first body about `torque_point`.", (3,)
    )
    torque_point = float64("(k, 3) float64: the centroid, or a point between the bodies if there is none.", (3,))
    contact_area = float64(
        "(k,) float64: total common area of coplanar triangles of both bodies, regardless of their orientation."
    )

    gradient = float64(
        "(m, 3) float64: nonzero derivatives of the volumes by vertices, for OverlapQuery(gradient=True).", (3,)
    )
    gradient_vertices = int32("(m, 2) int32: for each of `gradient` the body, and the vertex of its shape.", (2,))
    gradient_offsets = int64("(k + 1,) int64: row i has gradient[gradient_offsets[i] : gradient_offsets[i + 1]].")
    curve_offsets = int64(
        "(k + 1,) int64, for OverlapQuery(curves=True): row i has the curves from curve_offsets[i] to curve_offsets[i "
        "+ 1]. If you follow one on the first body, seen from outside it, the inside of the second body is on the "
        "left."
    )
    curve_closed = bools("(c,) bool: True for closed curves. Others end at boundaries of open surfaces.")
    curve_area_vector = float64(
        "(c, 3) float64: contribution of each curve to the area vector, one-sided; NaN if it is open.", (3,)
    )
    curve_torque = float64(
        "(c, 3) float64: contribution of each curve to the torque, one-sided; NaN if it is open.", (3,)
    )
    curve_point_offsets = int64(
        "(c + 1,) int64: curve j has curve_points[curve_point_offsets[j] : curve_point_offsets[j + 1]]."
    )
    curve_points = float64(
        "(n, 3) float64: points of the curves, curve after curve; the last point of a closed curve is its first.", (3,)
    )
    curve_triangles = int32(
        "(n, 2) int32: triangles of the two bodies that cross between a point and the next; -1 at the last point of a "
        "curve.",
        (2,),
    )
    curve_regions = int64(
        "(c,) int64, for OverlapQuery(curves=True, regions=True): region of each curve, an index into the regions of "
        "all rows; -1 if a surface is not closed."
    )
    region_offsets = int64(
        "(k + 1,) int64, for OverlapQuery(regions=True): row i has the regions from region_offsets[i] to "
        "region_offsets[i + 1]. A region is a connected piece of the boundary of the overlap; cavities have negative "
        "volumes."
    )
    region_volume = float64("(r,) float64: volume of each region, correctly rounded.")
    region_centroid = float64("(r, 3) float64: centroid; NaN if the volume is 0.", (3,))
    region_area_vector = float64("(r, 3) float64: area vector, one-sided where surfaces coincide.", (3,))
    region_normal = float64("(r, 3) float64: direction of the area vector; NaN if that is 0.", (3,))
    region_mean_depth = float64("(r,) float64: volume over the length of the area vector; NaN if that is 0.")
    region_thickness = float64("(r,) float64: extent along the region's normal; NaN without a normal.")
    region_box = float64("(r, 6) float64: low and high corner of the region's box, rounded outwards.", (6,))
    region_is_contact = bools("(r,) bool: True if the volume is exactly 0.")
    region_is_merged = bools(
        "(r,) bool: True if the region may consist of several ones, because a surface passes through itself within it."
    )
    region_pieces = int32(
        "(r, 2) int32: numbers of connected pieces of the first and of the second body's surface that form the region. "
        "If one of them is 2 or more, the other body passes through that surface, as a rod through a plate.",
        (2,),
    )
    box = float64(
        "(k, 6) float64, for OverlapQuery(extents=True) or regions=True: low and high corner of the box of each "
        "overlap, rounded outwards.",
        (6,),
    )
    thickness = float64("(k,) float64: extent of each overlap along its normal, correctly rounded; made with `box`.")
    depth_offsets = int64("(k + 1,) int64: row i has depths[depth_offsets[i] : depth_offsets[i + 1]].")
    depth_vertices = int32("(m, 2) int32: for each of `depths` the body, and the vertex of its shape.", (2,))
    depths = float64(
        "(m,) float64, for OverlapQuery(depths=True): distances of vertices inside the other body to its surface, in "
        "units of length, correctly rounded."
    )
    depth_points = float64("(m, 3) float64: for each of `depths` the closest point of the other surface.", (3,))
    depth_triangles = int32("(m,) int32: for each of `depths` the triangle of the other body with that point.")
    deepest = int64("(k,) int64: index into `depths` of each row's deepest vertex; -1 if no vertex is inside.")
    depth_reached = float64(
        "(k,) float64, for OverlapQuery(depth_tolerance=...): depth that some point of each row has, rounded down."
    )
    depth_bound = float64("(k,) float64: depth that no point of the row exceeds; made with `depth_reached`.")
    union_volume = float64(
        "(k,) float64, for OverlapQuery(unions=True): volume of the union of both bodies: the sum of their volumes minus "
        "that of the overlap."
    )
    intersection_over_union = float64("(k,) float64: volume of the overlap over that of the union.")
    difference_volume = float64("(k, 2) float64: volume of each body without the other one.", (2,))
    withdrawals = float64(
        "(k * d,) float64, for d OverlapQuery(directions=...): withdrawals[d * i + j] is the greatest t >= 0 at which "
        "the first body of row i and the second one, moved by t times direction j, have a common point; 0 if there is "
        "none. NaN for a body with itself."
    )
    first_free = float64(
        "(k * d,) float64, for OverlapQuery(first_free=True, directions=...): first_free[d * i + j] is the least t >= 0 "
        "at which the insides of the first body of row i and the second one, moved by t times direction j, do not "
        "overlap, rounded up. Inside means that the winding number is not 0. At most the withdrawal; 0 if the bodies "
        "only touch. NaN for a body with itself, and if a surface is not closed."
    )
    translation_low = float64(
        "(k,) float64, for OverlapQuery(translation=True): lower bound on the length of every path of translations "
        "that separates the bodies; NaN unless both are known to be solids."
    )
    translation_high = float64("(k,) float64: length of a translation that separates the bodies, rounded up.")
    translation = float64("(k, 3) float64: this translation, of the second body.", (3,))
    windings = int32(
        "(m,) int32: nonzero winding numbers of the other body at vertices, for OverlapQuery(windings=True)."
    )
    winding_vertices = int32("(m, 2) int32: for each of `windings` the body, and the vertex of its shape.", (2,))
    winding_offsets = int64("(k + 1,) int64: row i has windings[winding_offsets[i] : winding_offsets[i + 1]].")
    body_volume = float64(
        "(bodies,) float64: volume of each body, NaN if it is not closed; for a mesh, or "
        "OverlapQuery(self_overlaps=True)."
    )
    is_solid = bools("(bodies,) bool: True if all winding numbers of a body are 0 or 1; made with `body_volume`.")

    part_pairs = int32(
        "(p, 2) int32, for a part of a scene: the pairs of triangles that intersect and that the part owns, as triangles "
        "of the meshes. Detector.combine makes rows from the results of all parts.",
        (2,),
    )
    part_bodies = int32("(p, 2) int32: for each of `part_pairs` the two meshes, 0 or 1; equal within one mesh.", (2,))

    def _check(self, name: str) -> None:
        of_part = self._request.scene == "part"
        if of_part != name.startswith("part_"):
            known = "has pairs of triangles only: Detector.combine makes rows from the results of all parts"
            whole = "is about a part of a scene, but this result is about a whole scene"
            raise InvalidInput(f"the result about a part {known}, not {name}" if of_part else f"{name} {whole}")
        if of_part:
            return
        if name == "world_hit" and self._request.block:
            raise InvalidInput(f"{name} is part of a whole result, but this is one of its blocks")
        option = _OPTION.get(name)
        given = self._request.options
        of_mesh = option == "self_overlaps" and self._request.scene == "mesh"
        of_regions = option == "extents" and "regions" in given
        least = _FROM.get(name, "pairs")
        if _ORDER.index(self._request.output) < _ORDER.index(least):
            self._refuse(name, f'output="{least}"')
        if option is not None and option not in given and not of_mesh and not of_regions:
            directions = "[(0, 0, 1)]"
            values = {"depth_tolerance": "0.01", "directions": directions, "first_free": f"True, directions={directions}"}
            self._refuse(name, f"{option}={values.get(option, 'True')}")

    def save(self, path: str | os.PathLike[str], *scene: Any) -> None:
        """Writes a picture in which overlaps are visible from outside.

        `overlaps.save("overlap.html", world)`, or with one or two meshes instead of the world.

        Parameters
        ----------
        path : str or os.PathLike
            File. By extension:

            - .html: an interactive page, which also shows the curves;
            - .glb, .3mf: bodies with names;
            - .obj: one mesh, with its materials in a .mtl file;
            - .ply, which has no translucent colours: only the surface of the overlaps.
        *scene : World, or one or two meshes
            Scene that was searched: a World of one configuration, or meshes that as_mesh takes.

        Raises
        ------
        InvalidInput
            If the extension is another one, the result does not list bodies, or the scene does not fit the result.
        FileError
            If the file cannot be written.

        Notes
        -----
        The parts of a body's surface that are inside a body with which it overlaps are opaque and in a strong colour,
        and so are those inside the body itself, for a body that overlaps itself. All other parts are translucent. To
        separate them, bodies are cut along the curves in which they cross, which takes another search. So the file has
        other triangles than the scene. The file appears when it is complete; Ctrl-C waits until then.
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
        """Curves of each row: a list of (m, 3) float64 views of `curve_points`."""
        points = self.curve_points
        curves = [points[begin:end] for begin, end in pairwise(self.curve_point_offsets.tolist())]
        return [curves[begin:end] for begin, end in pairwise(self.curve_offsets.tolist())]

    @property
    def regions(self) -> list[slice]:
        """Regions of each row: slices of `region_volume` and the other arrays of regions."""
        return [slice(begin, end) for begin, end in pairwise(self.region_offsets.tolist())]

    @property
    def part(self) -> tuple[int, int] | None:
        """Index of the part of a scene that the result is about, and the number of parts. None for a whole scene."""
        index, count, _ = self._found.part
        return (index, count) if count else None

    @property
    def count(self) -> int:
        """Number of pairs of bodies that are listed."""
        return self._found.count

    def __len__(self) -> int:
        """Number of pairs of bodies that are listed."""
        return self._found.count

    def __repr__(self) -> str:
        if self._request.scene == "part":
            index, count, _ = self._found.part
            return f"<crumple.Overlaps: part {index} of {count}, {len(self.part_pairs)} pairs of triangles>"
        pairs = "pair" if len(self) == 1 else "pairs"
        rows = (
            f"{len(self)} {pairs} of bodies" if self._request.output in ("body_pairs", "pairs") else f"any: {self.any}"
        )
        if self._request.block:
            return f"<crumple.Overlaps: a block of {rows}>"
        return f"<crumple.Overlaps: {rows}, {self.statistics.milliseconds:.3g} ms>"
