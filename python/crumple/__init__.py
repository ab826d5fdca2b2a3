"""Exact collision detection between triangles.

Crumple finds all pairs of triangles that intersect in one mesh, between two meshes, or in a world of bodies. It also
finds the features (vertices, edges, faces) that touch during a time step, features within a distance, and the distances
and overlaps of bodies.

Notes
-----
Vertices are (n, 3) float32 or float64. Faces are (m, 3) integers, or flat. Both may be NumPy arrays or anything that
supports DLPack. Works on any triangle soup. docs/contract.md defines what counts as a collision.

Examples
--------
    import crumple

    pairs = crumple.intersections(vertices, faces).pairs              # (k, 2) int32, sorted

    detector = crumple.Detector(threads=2)                            # keep it: the next call is faster
    result = detector.intersections(vertices, faces, output="contacts")
    result.save("collisions.png")                                     # result.pairs, .offsets, .hit, .contacts

    world = crumple.World([arm, table], worlds=[0, -1])               # bodies, poses, many configurations at once
    detector.any(world)                                               # any(scene, query), find(scene, query)

    crumple.first_impact(vertices, next_vertices, faces)              # of a step: its time is .toi; None if it is free
    detector.proximities(vertices, faces, radius=0.01)                # features within a distance
    detector.distances(world).squared_distance                        # of each pair of bodies

    print(crumple.check("plate.stl", "pin.stl", clearance="0.1mm"))   # a verdict on parts and assemblies
"""

from __future__ import annotations

import functools as _functools
from typing import Any as _Any

from . import _versions  # noqa: F401, imported first: raises ImportError if two distributions are installed
from ._checks import CheckItem as CheckItem
from ._checks import CheckReport, check
from ._clustering import Clustering
from ._core import Part, Statistics, __version__
from ._detector import Detector
from ._device import DeviceArray as DeviceArray
from ._device import DeviceInfo as DeviceInfo
from ._device import DeviceList as DeviceList
from ._device import DeviceResult, list_devices
from ._device import Launch as Launch
from ._errors import BackendUnavailable, Error, FileError, FileWarning, InvalidInput, InvalidType, MemoryLimit
from ._feature_pairs import Candidates, pair_distances, pair_impacts
from ._feature_pairs import PairDistances as PairDistances
from ._feature_pairs import PairImpacts as PairImpacts
from ._features import EdgeEdgeType as EdgeEdgeType
from ._features import FirstImpact, FreeStep, Impacts, Proximities
from ._features import VertexEdgeType as VertexEdgeType
from ._features import VertexFaceType as VertexFaceType
from ._features import VertexVertexType as VertexVertexType
from ._files import ProceduralScene as ProceduralScene
from ._files import make_scene, read_mesh, read_pairs, read_poses, read_world, scenes, write_mesh
from ._intersections import Intersections
from ._mesh import FileMesh as FileMesh
from ._mesh import Mesh, Shape, as_mesh, open_edges
from ._mesh import Polygons as Polygons
from ._overlaps import OverlapRelation as OverlapRelation
from ._overlaps import Overlaps
from ._queries import (
    CandidateQuery,
    DistanceQuery,
    FirstImpactQuery,
    FreeStepQuery,
    FuzzyCMeans,
    ImpactQuery,
    IntersectionQuery,
    Method,
    OverlapQuery,
    PairFilter,
    ProximityQuery,
)
from ._results import ContactKind as ContactKind
from ._results import Contacts as Contacts
from ._results import Distances
from ._rigid_motion import RigidMotion as RigidMotion
from ._rigid_motion import cut_rigid_motion
from ._stencils import NormalFrom as NormalFrom
from ._stencils import Stencils as Stencils
from ._stencils import stencils
from ._world import Body, World


def _of_one_call(method: _Any) -> _Any:
    """Returns a function with the name and arguments of a method of Detector. Each call makes a detector of its own."""

    @_functools.wraps(method)
    def call(*scene: _Any, **options: _Any) -> _Any:
        return method(Detector(), *scene, **options)

    call.__qualname__, call.__module__ = method.__name__, __name__
    call.__doc__ = (
        f"{method.__doc__.splitlines()[0]}\n\nCalls Detector.{method.__name__} of a new detector. "
        "For more than one call, keep a Detector: it is faster\nwhen warm, and costs a millisecond to make."
    )
    return call


intersections = _of_one_call(Detector.intersections)
impacts = _of_one_call(Detector.impacts)
first_impact = _of_one_call(Detector.first_impact)
free_step = _of_one_call(Detector.free_step)
proximities = _of_one_call(Detector.proximities)
candidates = _of_one_call(Detector.candidates)
distances = _of_one_call(Detector.distances)
overlaps = _of_one_call(Detector.overlaps)

#: Functions, and classes that callers construct. Other classes, such as Contacts, are attributes of the module, too.
__all__ = [
    "BackendUnavailable",
    "Body",
    "CandidateQuery",
    "Candidates",
    "CheckReport",
    "Clustering",
    "Detector",
    "DeviceResult",
    "DistanceQuery",
    "Distances",
    "Error",
    "FileError",
    "FileWarning",
    "FirstImpact",
    "FirstImpactQuery",
    "FreeStep",
    "FreeStepQuery",
    "FuzzyCMeans",
    "ImpactQuery",
    "Impacts",
    "IntersectionQuery",
    "Intersections",
    "InvalidInput",
    "InvalidType",
    "MemoryLimit",
    "Mesh",
    "Method",
    "OverlapQuery",
    "Overlaps",
    "PairFilter",
    "Part",
    "Proximities",
    "ProximityQuery",
    "Shape",
    "Statistics",
    "World",
    "__version__",
    "as_mesh",
    "candidates",
    "check",
    "cut_rigid_motion",
    "distances",
    "first_impact",
    "free_step",
    "impacts",
    "intersections",
    "list_devices",
    "make_scene",
    "open_edges",
    "overlaps",
    "pair_distances",
    "pair_impacts",
    "proximities",
    "read_mesh",
    "read_pairs",
    "read_poses",
    "read_world",
    "scenes",
    "stencils",
    "write_mesh",
]
