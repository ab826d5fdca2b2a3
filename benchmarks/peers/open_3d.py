"""Open3D (PyPI: open3d): intersecting pairs of triangles of one mesh; of two meshes, yes or no.

The wheel needs the system's libusb-1.0 (apt: libusb-1.0-0).
"""

import numpy as np
import open3d

from peers.worker import load


class Open3DSelf:
    """get_self_intersecting_triangles, which tests all pairs of boxes. So large scenes are left out."""

    name, question, computes = "Open3D", "self", "pairs, rounding errors"
    package, scalar = "open3d", "float64"
    describes = "pairs of triangles without a common vertex, with rounding errors"
    ways, most_triangles = [("", 1), ("", 0)], 20_000

    def __init__(self, folder, way):
        self.meshes = [self.mesh(*load(folder, which)) for which in self.inputs()]

    def inputs(self):
        return [""]

    @staticmethod
    def mesh(vertices, triangles):
        arrays = np.ascontiguousarray(vertices), np.ascontiguousarray(triangles)
        utility = open3d.utility
        return open3d.geometry.TriangleMesh(utility.Vector3dVector(arrays[0]), utility.Vector3iVector(arrays[1]))

    def call(self):
        return self.meshes[0].get_self_intersecting_triangles()

    def count(self, found):
        return len(found)

    def pairs(self, found):
        return set(map(tuple, np.sort(np.asarray(found).reshape(-1, 2), axis=1).tolist()))


class Open3DBetween(Open3DSelf):
    """is_intersecting: yes or no."""

    question, computes, describes, pairs = "between", "yes or no", "yes or no, with rounding errors", None

    def inputs(self):
        return ["", "_b"]

    def call(self):
        return self.meshes[0].is_intersecting(self.meshes[1])

    def count(self, found):
        return int(found)


WORKERS = [Open3DSelf, Open3DBetween]
