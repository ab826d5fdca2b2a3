"""Functions for a single search, each with a detector that lives for the call."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from ._detector import Detector

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from ._candidates import Candidates
    from ._impacts import FreeStep, Impacts
    from ._near import Nearby
    from ._nearest import NearestBodies
    from ._world import World


def find_self_intersections(vertices: Any, faces: Any = None, *, copy: bool = False, **query: Any) -> NDArray[np.int32]:
    """(k, 2) int32: all colliding pairs within one soup, sorted, from a detector that lives for this call.

    Arguments, errors and source as of Detector.find_self. For more than one call keep a Detector: it is faster when
    warm, and costs a millisecond to make.
    """
    return Detector().find_self(vertices, faces, copy=copy, **query).pairs


def find_intersections_between(a: Any, b: Any, *, copy: bool = False, **query: Any) -> NDArray[np.int32]:
    """(k, 2) int32: all colliding pairs of two meshes, (index in a, index in b), sorted.

    Arguments, errors, cost and source as of Detector.find_between, and what find_self_intersections says of warm calls.
    """
    return Detector().find_between(a, b, copy=copy, **query).pairs


def has_intersections(vertices: Any, faces: Any = None, **query: Any) -> bool:
    """Whether any two triangles of a soup collide. All else, cost and source included: Detector.has_intersections."""
    return Detector().has_intersections(vertices, faces, **query)


def has_intersections_between(a: Any, b: Any, **query: Any) -> bool:
    """Whether two meshes collide. All else, cost and source included: Detector.has_intersections_between."""
    return Detector().has_intersections_between(a, b, **query)


def find_impacts(*scene: Any, **question: Any) -> Impacts:
    """What touches what on the way of (vertices, end, faces) or of a world. All else: Detector.find_impacts."""
    return Detector().find_impacts(*scene, **question)


def time_of_first_impact(*scene: Any, **question: Any) -> float | None:
    """When anything first touches on that way; None: never. All else: Detector.time_of_first_impact."""
    return Detector().time_of_first_impact(*scene, **question)


def is_free(*scene: Any, **question: Any) -> bool:
    """Whether nothing touches on that way. All else: Detector.is_free."""
    return Detector().is_free(*scene, **question)


def find_free_step(*scene: Any, **question: Any) -> FreeStep:
    """A share of the step and positions there that are free as they are rounded. All else: Detector.find_free_step."""
    return Detector().find_free_step(*scene, **question)


def find_near(*scene: Any, **question: Any) -> Nearby:
    """What is near what in (vertices, faces) or in a world, and how near. All else: Detector.find_near."""
    return Detector().find_near(*scene, **question)


def find_candidates(*scene: Any, **question: Any) -> Candidates:
    """Which features of (vertices, faces) or of a world have boxes that overlap. All else: Detector.find_candidates."""
    return Detector().find_candidates(*scene, **question)


def find_nearest(world: World, **question: Any) -> NearestBodies:
    """How far apart the bodies of a world are, each pair of them. All else: Detector.find_nearest."""
    return Detector().find_nearest(world, **question)
