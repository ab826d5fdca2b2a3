"""FCL (PyPI: python-fcl), which trimesh calls: all intersecting pairs of triangles of two meshes."""

import fcl
import numpy as np

from peers.worker import load


class PythonFcl:
    """Builds trees in each call, as for meshes that deform. Its request is for pairs without contact points."""

    name, question, computes = "python-fcl", "between", "pairs, rounding errors"
    package, scalar, describes = "python-fcl", "float64", "pairs between two meshes, with rounding errors"
    ways = [("", 1)]

    def __init__(self, folder, way):
        self.arrays = [tuple(map(np.ascontiguousarray, load(folder, which))) for which in ("", "_b")]
        self.request = fcl.CollisionRequest(num_max_contacts=2**31 - 1)

    @staticmethod
    def body(vertices, triangles):
        model = fcl.BVHModel()
        model.beginModel(len(vertices), len(triangles))
        model.addSubModel(vertices, triangles)
        model.endModel()
        return fcl.CollisionObject(model)

    def call(self):
        result = fcl.CollisionResult()
        fcl.collide(*(self.body(*arrays) for arrays in self.arrays), self.request, result)
        return result

    def count(self, result):
        return len(result.contacts)

    def pairs(self, result):
        return {(contact.b1, contact.b2) for contact in result.contacts}


WORKERS = [PythonFcl]
