"""Overlaps of bodies: how much, where, and which way out."""

from __future__ import annotations

from enum import IntEnum
from typing import ClassVar

from ._results import Result, bools, float64, int32, int64, uint8

_FROM = {"skipped": "any", "world_hit": "any_by_world", "bodies": "body_pairs", "relation": "body_pairs"}
_ORDER = ("any", "any_by_world", "body_pairs", "pairs")
_OPTION = {
    **dict.fromkeys(("gradient", "gradient_vertices", "gradient_offsets"), "gradient"),
    **dict.fromkeys(("windings", "winding_vertices", "winding_offsets"), "windings"),
    **dict.fromkeys(("body_volume", "is_solid"), "self_overlaps"),
}


class OverlapRelation(IntEnum):
    """Relation of two bodies, decided exactly; volumes are integrals of winding numbers, in magnitude.

    TOUCHING: their surfaces meet, and the overlap has no volume. FIRST_INSIDE, SECOND_INSIDE, EQUAL: the overlap has
    the volume of the first body, of the second, of both. OVERLAPPING: none of these.
    """

    TOUCHING = 0
    OVERLAPPING = 1
    FIRST_INSIDE = 2
    SECOND_INSIDE = 3
    EQUAL = 4


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
        "(k,) float64: the area in which the surfaces coincide: what pairs of faces in one plane have in common, summed."
    )

    gradient = float64(
        "(m, 3) float64: derivatives of volumes by vertices, those that are not 0, for OverlapQuery(gradient=True).",
        (3,),
    )
    gradient_vertices = int32("(m, 2) int32: of each of `gradient` the body, and the vertex of its shape.", (2,))
    gradient_offsets = int64("(k + 1,) int64: row i has gradient[gradient_offsets[i] : gradient_offsets[i + 1]].")
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
