"""MeshLib (PyPI: meshlib): findSelfCollidingTriangles."""

import meshlib.mrmeshnumpy as mrmeshnumpy
import meshlib.mrmeshpy as mrmeshpy
import numpy as np

from peers.worker import load


class MeshLib:
    """findSelfCollidingTriangles, touching included; MeshLib holds float32. The tree of boxes is built in each call, as for
    a mesh that deforms."""

    name, question, computes = "MeshLib", "self", "pairs, float32"
    package, scalar, describes = "meshlib", "float32", "whole answer for the mesh rounded to float32, touching included"
    ways = [("", 1), ("", 0)]

    def __init__(self, folder, way):
        vertices, triangles = load(folder)
        self.mesh = mrmeshnumpy.meshFromFacesVerts(np.ascontiguousarray(triangles), np.ascontiguousarray(vertices, np.float32))
        self.part = mrmeshpy.MeshPart(self.mesh)
        self.find = mrmeshpy.findSelfCollidingTriangles

    def call(self):
        self.mesh.invalidateCaches()
        return self.find(self.part, touchIsIntersection=True)

    def count(self, answer):
        return answer.size()

    def pairs(self, answer):
        return {tuple(sorted((int(p.aFace.get()), int(p.bFace.get())))) for p in answer}


class MeshLibTreeBuilt(MeshLib):
    name = "MeshLib, tree built"

    def call(self):
        return self.find(self.part, touchIsIntersection=True)


WORKERS = [MeshLib, MeshLibTreeBuilt]
