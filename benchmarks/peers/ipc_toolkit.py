"""IPC Toolkit (PyPI: ipctk): overlapping boxes by all of its broad phases except BruteForce, and has_intersections."""

import ctypes

import ipctk
import numpy as np

from peers.worker import load


class IpcBoxes:
    """LBVH: builds the tree and finds face-face candidates, without adjacent faces. No edges are passed, so it builds
    no tree of edges."""

    name, question, computes = "IPC Toolkit LBVH, from Python", "self", "overlapping boxes"
    package, scalar, describes = "ipctk", "float64", "boxes only: pairs of overlapping boxes, neighbours left out"
    ways = [("", 1), ("", 0)]
    too_much = {"Generic_Twin_right": "millions of overlapping boxes, each a Python object"}
    phase = "LBVH"

    def __init__(self, folder, way):
        self.vertices, self.triangles = load(folder)
        self.edges = np.asfortranarray(np.empty((0, 2), np.int32))
        self.tree = getattr(ipctk, self.phase)()

    def call(self):
        self.tree.build(self.vertices, self.edges, self.triangles)
        return self.tree.detect_face_face_candidates()

    def count(self, answer):
        return len(answer)

    def pairs(self, answer):
        return {tuple(sorted((c.face0_id, c.face1_id))) for c in answer}


class IpcHashGrid(IpcBoxes):
    """HashGrid. Like SpatialHash, it takes seconds for ten thousand triangles. Larger scenes are left out, because each
    call would take minutes."""

    name, phase, most_triangles = "IPC Toolkit HashGrid, from Python", "HashGrid", 20_000


class IpcSpatialHash(IpcHashGrid):
    name, phase = "IPC Toolkit SpatialHash, from Python", "SpatialHash"


class IpcSweepAndPrune(IpcBoxes):
    name, phase = "IPC Toolkit SweepAndPrune, from Python", "SweepAndPrune"


class IpcBoxesNative(IpcBoxes):
    """LBVH without making a list of Python objects, which takes longer than the search. Calls the C++ member function,
    whose symbol the module exports, and passes it a std::vector: in memory, three pointers."""

    name, pairs, too_much = "IPC Toolkit LBVH, C++ only", None, {}

    class Vector(ctypes.Structure):
        _fields_ = [("begin", ctypes.c_void_p), ("end", ctypes.c_void_p), ("capacity", ctypes.c_void_p)]

    def __init__(self, folder, way):
        super().__init__(folder, way)
        symbol = "_ZNK3ipc4LBVH27detect_face_face_candidatesERSt6vectorINS_17FaceFaceCandidateESaIS2_EE"
        self.detect = ctypes.CDLL(ipctk.__file__)[symbol]
        self.detect.argtypes, self.detect.restype = [ctypes.c_void_p, ctypes.c_void_p], None
        self.free = ctypes.CDLL(None).free
        self.free.argtypes = [ctypes.c_void_p]
        # pybind11 stores the address of the C++ object after the header of the Python object.
        self.address = ctypes.c_void_p.from_address(id(self.tree) + object.__basicsize__).value

    def call(self):
        self.tree.build(self.vertices, self.edges, self.triangles)
        candidates = self.Vector()
        self.detect(self.address, ctypes.byref(candidates))
        return candidates

    def count(self, answer):
        pairs = (answer.end - answer.begin) // 8  # a pair is two int32
        self.free(answer.begin)
        return pairs


class IpcIntersections:
    """has_intersections: True if an edge intersects a face. It computes in float64."""

    name, question, computes = "IPC Toolkit has_intersections", "any", "yes or no"
    package, scalar, describes = "ipctk", "float64", "yes or no, edges against faces, with rounding errors"
    ways = [(phase, threads) for phase in ("LBVH", "HashGrid", "SpatialHash", "SweepAndPrune") for threads in (1, 0)]

    def __init__(self, folder, way):
        vertices, triangles = load(folder)
        self.vertices = vertices
        self.mesh = ipctk.CollisionMesh(vertices, np.asfortranarray(ipctk.edges(triangles)), triangles)
        self.has_intersections, self.broad_phase = ipctk.has_intersections, getattr(ipctk, way)()

    def call(self):
        return self.has_intersections(self.mesh, self.vertices, self.broad_phase)

    def count(self, answer):
        return int(answer)


WORKERS = [IpcBoxes, IpcBoxesNative, IpcHashGrid, IpcSpatialHash, IpcSweepAndPrune, IpcIntersections]
