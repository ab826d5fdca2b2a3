"""libigl (PyPI: libigl) without CGAL: yes or no for two triangles."""

import igl
import numpy as np

from peers.worker import load


class LibiglTriangles:
    """tri_tri_intersection_test_3d, the method of Guigue and Devillers in float64."""

    name, question, computes = "libigl, no CGAL", "between", "yes or no for two triangles"
    package, scalar = "libigl", "float64"
    describes = "yes or no for two triangles, with rounding errors"
    ways, pairs, most_triangles = [("", 1)], None, 1

    def __init__(self, folder, way):
        corners = (vertices[triangles[0]] for vertices, triangles in (load(folder), load(folder, "_b")))
        self.points = [np.ascontiguousarray(p.reshape(1, 3)) for triangle in corners for p in triangle]

    def call(self):
        return igl.tri_tri_intersection_test_3d(*self.points)[0]

    def count(self, found):
        return int(found)


WORKERS = [LibiglTriangles]
