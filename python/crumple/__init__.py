"""Crumple finds all pairs of triangles that intersect, in one mesh or between two, exactly and fast.

    import crumple

    pairs = crumple.find_self_intersections(vertices, faces)          # (k, 2) int32, sorted

    detector = crumple.Detector(threads=2)                            # keep it: the next call is faster
    result = detector.find_self(vertices, faces, contacts=True)       # result.pairs, .offsets, .hit, .contacts
    result.save("collisions.png")

    world = crumple.World([arm, table], worlds=[0, -1])               # bodies, poses, many configurations at once
    detector.find(world, wants="any").any

    crumple.time_of_first_impact(vertices, next_vertices, faces)      # on the straight way there: in [0, 1], or None
    detector.find_near(vertices, faces, radius=0.01)                  # features within a distance, and how near
    detector.find_nearest(world).squared_distance                     # of each pair of bodies, and where

Vertices are (n, 3) float32 or float64, faces (m, 3) integers or flat: NumPy arrays, or anything that speaks DLPack.
Any triangle soup will do. What counts as a collision: docs/contract.md.
"""

from . import _distribution  # noqa: F401, refuses two that overwrite each other
from ._candidates import Candidates
from ._core import Part, Statistics, __version__
from ._detector import Detector
from ._devices import DeviceInfo, DeviceList, list_devices
from ._errors import BackendUnavailable, Error, FileError, FileWarning, InvalidInput, InvalidType, MemoryLimit
from ._feature_pairs import PairDistances, PairImpacts, pair_distances, pair_impacts
from ._files import Scene, make_scene, read_mesh, read_pairs, scenes, write_mesh
from ._fuzzy_c_means import FuzzyCMeans
from ._impacts import FirstImpact, FreeStep, Impacts
from ._launches import DeviceArray, DeviceCandidates, DeviceImpacts, DeviceNearby, DeviceResult, DeviceWorldResult
from ._mesh import FileMesh, Mesh, Polygons, as_mesh
from ._near import EdgeEdgeType, Nearby, VertexEdgeType, VertexFaceType, VertexVertexType
from ._nearest import NearestBodies
from ._result import Block, ContactKind, Contacts, Result
from ._short_forms import (
    find_candidates,
    find_free_step,
    find_impacts,
    find_intersections_between,
    find_near,
    find_nearest,
    find_self_intersections,
    has_intersections,
    has_intersections_between,
    is_free,
    time_of_first_impact,
)
from ._world import Body, Shape, World
from ._world_files import read_poses, read_world
from ._world_result import WorldResult

__all__ = [
    "BackendUnavailable",
    "Block",
    "Body",
    "Candidates",
    "ContactKind",
    "Contacts",
    "Detector",
    "DeviceArray",
    "DeviceCandidates",
    "DeviceImpacts",
    "DeviceInfo",
    "DeviceList",
    "DeviceNearby",
    "DeviceResult",
    "DeviceWorldResult",
    "EdgeEdgeType",
    "Error",
    "FileError",
    "FileMesh",
    "FileWarning",
    "FirstImpact",
    "FreeStep",
    "FuzzyCMeans",
    "Impacts",
    "InvalidInput",
    "InvalidType",
    "MemoryLimit",
    "Mesh",
    "Nearby",
    "NearestBodies",
    "PairDistances",
    "PairImpacts",
    "Part",
    "Polygons",
    "Result",
    "Scene",
    "Shape",
    "Statistics",
    "VertexEdgeType",
    "VertexFaceType",
    "VertexVertexType",
    "World",
    "WorldResult",
    "__version__",
    "as_mesh",
    "find_candidates",
    "find_free_step",
    "find_impacts",
    "find_intersections_between",
    "find_near",
    "find_nearest",
    "find_self_intersections",
    "has_intersections",
    "has_intersections_between",
    "is_free",
    "list_devices",
    "make_scene",
    "pair_distances",
    "pair_impacts",
    "read_mesh",
    "read_pairs",
    "read_poses",
    "read_world",
    "scenes",
    "time_of_first_impact",
    "write_mesh",
]
