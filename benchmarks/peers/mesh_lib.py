"""MeshLib (PyPI: meshlib): findSelfCollidingTriangles of one mesh, and findCollidingTriangles of two meshes."""

import meshlib.mrmeshnumpy as mrmeshnumpy
import meshlib.mrmeshpy as mrmeshpy
import numpy as np

from peers.worker import load


class MeshLib:
    """findSelfCollidingTriangles, including triangles that only touch. MeshLib stores float32. Builds the tree of boxes
    in each call, as for a mesh that deforms."""

    name, question, computes = "MeshLib", "self", "pairs, float32"
    package, scalar = "meshlib", "float32"
    describes = "whole result for the mesh rounded to float32; touching is included in one mesh, left out between two"
    ways = [("", 1), ("", 0)]

    def __init__(self, folder, way):
        self.meshes = [self.mesh(*load(folder, which)) for which in self.inputs()]
        self.parts = [mrmeshpy.MeshPart(mesh) for mesh in self.meshes]

    def inputs(self):
        return [""]

    @staticmethod
    def mesh(vertices, triangles):
        vertices = np.ascontiguousarray(vertices, np.float32)
        return mrmeshnumpy.meshFromFacesVerts(np.ascontiguousarray(triangles), vertices)

    def find(self):
        return mrmeshpy.findSelfCollidingTriangles(*self.parts, touchIsIntersection=True)

    def call(self):
        for mesh in self.meshes:
            mesh.invalidateCaches()
        return self.find()

    def count(self, answer):
        return answer.size()

    def pairs(self, answer):
        return {tuple(sorted(pair)) for pair in self.numbers(answer)}

    def numbers(self, answer):
        return ((int(pair.aFace.get()), int(pair.bFace.get())) for pair in answer)


class MeshLibTreeBuilt(MeshLib):
    name = "MeshLib, tree built"

    def call(self):
        return self.find()


class MeshLibBetween(MeshLib):
    """findCollidingTriangles. It always leaves out triangles that only touch."""

    question = "between"

    def inputs(self):
        return ["", "_b"]

    def find(self):
        return mrmeshpy.findCollidingTriangles(*self.parts)

    def pairs(self, answer):
        return set(self.numbers(answer))


class MeshLibTreesBuilt(MeshLibBetween):
    """Builds trees before the timed calls, as for rigid bodies."""

    name = "MeshLib, trees built"

    def call(self):
        return self.find()


WORKERS = [MeshLib, MeshLibTreeBuilt, MeshLibBetween, MeshLibTreesBuilt]
