"""Coal (PyPI: coal), FCL's successor: all intersecting pairs of triangles of two meshes."""

import coal
import numpy as np

from peers.worker import load


class Coal:
    """Builds trees in each call, as for meshes that deform. Coal always computes a contact point and a normal of each
    pair, too, and uses one thread only."""

    name, question, computes = "Coal", "between", "pairs, rounding errors, contacts"
    package, scalar = "coal", "float64"
    describes = "pairs between two meshes, with rounding errors, and a contact for each"
    ways = [("OBBRSS", 1), ("OBB", 1)]

    def __init__(self, folder, way):
        self.kind = {"OBBRSS": coal.BVHModelOBBRSS, "OBB": coal.BVHModelOBB}[way]
        self.arrays = [self.arrays_of(*load(folder)), self.arrays_of(*load(folder, "_b"))]
        self.identity = coal.Transform3s.Identity()
        self.request = coal.CollisionRequest()
        self.request.num_max_contacts = 2**62
        self.build()

    @staticmethod
    def arrays_of(vertices, triangles):
        return vertices, np.asfortranarray(triangles, np.int64)

    def build(self):
        self.trees = []
        for vertices, triangles in self.arrays:
            tree = self.kind()
            tree.beginModel(len(triangles), len(vertices))
            tree.addVertices(vertices)
            tree.addTriangles(triangles)
            tree.endModel()
            self.trees.append(tree)

    def collide(self):
        result = coal.CollisionResult()
        coal.collide(self.trees[0], self.identity, self.trees[1], self.identity, self.request, result)
        return result

    def call(self):
        self.build()
        return self.collide()

    def count(self, answer):
        return answer.numContacts()

    def pairs(self, answer):
        contacts = (answer.getContact(i) for i in range(answer.numContacts()))
        return {(contact.b1, contact.b2) for contact in contacts}


class CoalTreesBuilt(Coal):
    """Builds trees before the timed calls, as for rigid bodies."""

    name = "Coal, trees built"

    def call(self):
        return self.collide()


WORKERS = [Coal, CoalTreesBuilt]
