"""trueform (PyPI: trueform): all intersecting pairs of triangles of two meshes, or yes or no for one mesh, by trees."""

import numpy as np
import trueform

from peers.worker import load


class TrueformBetween:
    """Makes new meshes in each call, because a mesh caches its tree."""

    name, question, computes = "trueform", "between", "exact pairs"
    package, scalar = "trueform", "float64"
    describes = "pairs between two meshes; of one mesh, yes or no"
    ways = [("", 1), ("", 0)]

    def __init__(self, folder, way):
        self.arrays = [self.arrays_of(*load(folder)), self.arrays_of(*load(folder, "_b"))]
        self.build()

    @staticmethod
    def arrays_of(vertices, triangles):
        return np.ascontiguousarray(triangles), np.ascontiguousarray(vertices)

    def build(self):
        self.meshes = [trueform.Mesh(*arrays) for arrays in self.arrays]

    def call(self):
        self.build()
        return trueform.gather_intersecting_ids(*self.meshes)

    def count(self, answer):
        return len(answer)

    def pairs(self, answer):
        return set(map(tuple, answer.tolist()))


class TrueformTreesBuilt(TrueformBetween):
    name = "trueform, trees built"

    def call(self):
        return trueform.gather_intersecting_ids(*self.meshes)


class TrueformAny:
    name, question, computes = "trueform", "any", "yes or no"
    package, scalar, describes = "trueform", "float64", TrueformBetween.describes
    ways = [("", 1), ("", 0)]

    def __init__(self, folder, way):
        self.arrays = TrueformBetween.arrays_of(*load(folder))

    def call(self):
        return trueform.has_self_intersections(trueform.Mesh(*self.arrays))

    def count(self, answer):
        return int(answer)


WORKERS = [TrueformBetween, TrueformTreesBuilt, TrueformAny]
