"""Meshes of primitives: boxes, cylinders, spheres, capsules and ellipsoids, each with a bound on its error.

A round primitive becomes a convex polyhedron that contains it, so that no collision of the primitive is missed. Each
point of the polyhedron is at most `tessellation_error` away from the primitive. The polyhedron is inscribed first, with
its vertices on the primitive, and then scaled about the centre until its faces are outside.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from .._errors import InvalidInput
from .._mesh import Mesh

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["PrimitiveMesh", "box", "capsule", "cylinder", "ellipsoid", "sphere"]

_MOST_SIDES = 2048  # a sphere of so many sides has four million triangles
_ROUNDING = 1 + 2.0**-40  # factor that outweighs the rounding of vertices


class PrimitiveMesh(Mesh):
    """Closed convex mesh that contains a primitive.

    Attributes
    ----------
    tessellation_error : float
        Upper bound on the distance of any point of the mesh from the primitive, in the units of the coordinates; 0 for
        boxes.
    """

    tessellation_error: float = 0.0


def box(size: Any) -> PrimitiveMesh:
    """Returns a box about the origin.

    Parameters
    ----------
    size : (3,) array_like of float
        Lengths of the edges.
    """
    corners = (np.indices((2, 2, 2)).reshape(3, 8).T - 0.5) * _positive("size", size, 3)
    sides = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
    return PrimitiveMesh(corners, np.array([f for a, b, c, d in sides for f in ((a, b, c), (a, c, d))], np.int32))


def cylinder(radius: float, length: float, *, max_error: float) -> PrimitiveMesh:
    """Returns a prism that contains the cylinder of this radius and length along z, about the origin.

    Parameters
    ----------
    radius, length : float
        Size of the cylinder.
    max_error : float
        Upper bound on `tessellation_error`.
    """
    radius, length = _positive("radius and length", [radius, length], 2)
    sides, factor = _sides(radius, max_error, lambda n: 1 / math.cos(math.pi / n))
    around = _circle(sides) * radius * factor
    ring = np.column_stack([around, np.full(sides, length / 2)])
    rings = np.concatenate([ring * [1, 1, -1], ring])
    return _made(_revolved(rings, sides, [0, 0, -length / 2], [0, 0, length / 2]), radius * (factor - 1))


def capsule(radius: float, length: float, *, max_error: float) -> PrimitiveMesh:
    """Returns a polyhedron that contains the points within `radius` of a segment along z, about the origin.

    Parameters
    ----------
    radius, length : float
        Radius, and length of the segment, which may be 0.
    max_error : float
        Upper bound on `tessellation_error`.
    """
    (radius,) = _positive("radius", [radius], 1)
    # A face is closest to the centre in its middle, half a side away from vertices in longitude and in latitude.
    sides, factor = _sides(radius, max_error, lambda n: 1 / math.cos(math.pi / n) ** 2)
    quarter = sides // 4
    latitudes = np.arange(1 - quarter, quarter) * (2 * math.pi / sides)
    heights = np.zeros(len(latitudes)) if length == 0 else np.sign(latitudes) * length / 2
    if length > 0:  # the equator twice, once for each half
        middle = len(latitudes) // 2
        latitudes = np.insert(latitudes, middle, 0.0)
        heights = np.insert(heights, middle, -length / 2)
        heights[middle + 1] = length / 2
    outer = radius * factor
    rings = np.concatenate(
        [
            np.column_stack([_circle(sides) * outer * math.cos(a), np.full(sides, outer * math.sin(a) + z)])
            for a, z in zip(latitudes, heights)
        ]
    )
    pole = outer + length / 2
    return _made(_revolved(rings, sides, [0, 0, -pole], [0, 0, pole]), outer - radius)


def sphere(radius: float, *, max_error: float) -> PrimitiveMesh:
    """Returns a polyhedron that contains the sphere of this radius about the origin.

    Parameters
    ----------
    radius : float
        Radius.
    max_error : float
        Upper bound on `tessellation_error`.
    """
    return capsule(radius, 0.0, max_error=max_error)


def ellipsoid(radii: Any, *, max_error: float) -> PrimitiveMesh:
    """Returns a polyhedron that contains the ellipsoid with these semi-axes along x, y and z, about the origin.

    Parameters
    ----------
    radii : (3,) array_like of float
        Semi-axes.
    max_error : float
        Upper bound on `tessellation_error`.
    """
    radii = _positive("radii", radii, 3)
    largest = float(radii.max())
    ball = sphere(1.0, max_error=max_error / largest)
    return _made((ball.vertices * radii, ball.faces), ball.tessellation_error * largest)


def _positive(name: str, values: Any, count: int) -> NDArray[np.float64]:
    array = np.asarray(values, np.float64)
    if array.shape != (count,) or not (np.isfinite(array) & (array > 0)).all():
        raise InvalidInput(f"{name} must be finite and above 0, not {values}")
    return array


def _made(arrays: tuple[Any, Any], error: float) -> PrimitiveMesh:
    mesh = PrimitiveMesh(*arrays)
    mesh.tessellation_error = float(error)
    return mesh


def _sides(radius: float, max_error: float, factor: Any) -> tuple[int, float]:
    """Returns the number of sides, a multiple of 4, and the factor between inscribed and circumscribed polyhedra."""
    if not max_error > 0:
        raise InvalidInput(f"the largest tessellation error must be above 0, not {max_error}")
    sides = 8
    while radius * (factor(sides) * _ROUNDING - 1) > max_error:
        sides += 4
        if sides > _MOST_SIDES:
            raise InvalidInput(
                f"a round primitive of radius {radius:g} needs more than {_MOST_SIDES} sides for a tessellation error "
                f"of {max_error:g}; permit a larger one"
            )
    return sides, factor(sides) * _ROUNDING


def _circle(sides: int) -> NDArray[np.float64]:
    turn = np.arange(sides) * (2 * math.pi / sides)
    return np.column_stack([np.cos(turn), np.sin(turn)])


def _revolved(rings: Any, sides: int, low: Any, high: Any) -> tuple[NDArray[np.float64], NDArray[np.int32]]:
    """Joins rings of vertices, from the lowest to the highest, and both poles to a closed surface."""
    count = len(rings) // sides
    i = np.arange(sides)
    j = (i + 1) % sides
    bottom, top, last = len(rings), len(rings) + 1, (count - 1) * sides
    faces = [
        np.column_stack([np.full(sides, bottom), j, i]),
        np.column_stack([last + i, last + j, np.full(sides, top)]),
    ]
    for start in range(0, last, sides):
        a, b = start + i, start + j
        faces += [np.column_stack([a, b, b + sides]), np.column_stack([a, b + sides, a + sides])]
    return np.concatenate([rings, [low, high]]), np.concatenate(faces).astype(np.int32)
