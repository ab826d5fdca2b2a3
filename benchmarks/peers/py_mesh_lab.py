"""PyMeshLab (PyPI: pymeshlab): triangles of one mesh that intersect another one, without their partners."""

import numpy as np
import pymeshlab

from peers.worker import load


class PyMeshLab:
    name, question, computes = "PyMeshLab", "self", "triangles, no pairs"
    package, scalar = "pymeshlab", "float64"
    describes = "triangles that intersect another one, with rounding errors, no pairs"
    ways, pairs = [("", 1)], None

    def __init__(self, folder, way):
        vertices, triangles = map(np.ascontiguousarray, load(folder))
        self.meshes = pymeshlab.MeshSet()
        self.meshes.add_mesh(pymeshlab.Mesh(vertices, triangles))

    def call(self):
        self.meshes.compute_selection_by_self_intersections_per_face()
        return self.meshes.current_mesh().face_selection_array()

    def count(self, found):
        return int(found.sum())


WORKERS = [PyMeshLab]
