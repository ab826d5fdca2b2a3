"""libigl (PyPI: libigl): remesh_self_intersections and intersect_other, detection only. Both use CGAL's exact kernel."""

import igl.copyleft.cgal as cgal
import numpy as np

from peers.worker import load


def arrays(folder, which=""):
    vertices, triangles = load(folder, which)
    return np.ascontiguousarray(vertices), np.ascontiguousarray(triangles, np.int64)


class LibiglSelf:
    name, question, computes = "libigl", "self", "exact pairs"
    package, scalar = "libigl", "float64, exact"
    describes = "whole result, exact, by CGAL's kernel"
    ways = [("", 1), ("", 0)]

    def __init__(self, folder, way):
        self.arrays, self.find = arrays(folder), cgal.remesh_self_intersections

    def call(self):
        return self.find(*self.arrays, detect_only=True)[2]

    def count(self, answer):
        return len(answer)

    def pairs(self, answer):
        return {tuple(sorted(pair)) for pair in answer.tolist()}


class LibiglBetween(LibiglSelf):
    question = "between"

    def __init__(self, folder, way):
        self.arrays, self.find = arrays(folder) + arrays(folder, "_b"), cgal.intersect_other

    def call(self):
        return self.find(*self.arrays, detect_only=True)[0]

    def pairs(self, answer):
        return set(map(tuple, answer.tolist()))


WORKERS = [LibiglSelf, LibiglBetween]
