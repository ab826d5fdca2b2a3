"""IPC Toolkit (PyPI: ipctk): boxes by its LBVH, and has_intersections."""

import ctypes

import ipctk
import numpy as np

from peers.worker import load


class IpcBoxes:
    """LBVH build and face-face candidates: neighbours left out. No edges are given, so none are put into a tree."""

    name, question, computes = "IPC Toolkit LBVH, from Python", "self", "overlapping boxes"
    ways = [("", 1), ("", 0)]

    def __init__(self, folder, way):
        self.vertices, self.triangles = load(folder)
        self.edges = np.asfortranarray(np.empty((0, 2), np.int32))
        self.tree = ipctk.LBVH()

    def call(self):
        self.tree.build(self.vertices, self.edges, self.triangles)
        return self.tree.detect_face_face_candidates()

    def count(self, answer):
        return len(answer)


class IpcBoxesNative(IpcBoxes):
    """The same without the list of Python objects, which takes longer than the search: the C++ member function, which the
    module exports, is called with a std::vector of three pointers."""

    name = "IPC Toolkit LBVH, C++ only"

    class Vector(ctypes.Structure):
        _fields_ = [("begin", ctypes.c_void_p), ("end", ctypes.c_void_p), ("capacity", ctypes.c_void_p)]

    def __init__(self, folder, way):
        super().__init__(folder, way)
        symbol = "_ZNK3ipc4LBVH27detect_face_face_candidatesERSt6vectorINS_17FaceFaceCandidateESaIS2_EE"
        self.detect = ctypes.CDLL(ipctk.__file__)[symbol]
        self.detect.argtypes, self.detect.restype = [ctypes.c_void_p, ctypes.c_void_p], None
        self.free = ctypes.CDLL(None).free
        self.free.argtypes = [ctypes.c_void_p]
        # pybind11 keeps the address of the C++ object behind the header of the Python object.
        self.address = ctypes.c_void_p.from_address(id(self.tree) + object.__basicsize__).value

    def call(self):
        self.tree.build(self.vertices, self.edges, self.triangles)
        candidates = self.Vector()
        self.detect(self.address, ctypes.byref(candidates))
        return candidates

    def count(self, answer):
        pairs = (answer.end - answer.begin) // 8  # two int32
        self.free(answer.begin)
        return pairs


class IpcIntersections:
    """has_intersections: edges against faces, on float64."""

    name, question, computes = "IPC Toolkit has_intersections", "any", "yes or no"
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


WORKERS = [IpcBoxes, IpcBoxesNative, IpcIntersections]
