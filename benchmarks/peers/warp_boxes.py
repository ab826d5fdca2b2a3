"""NVIDIA Warp (PyPI: warp-lang) on a CUDA device: a bounding volume hierarchy over boxes, and all pairs that overlap.

CRUMPLE_WARP_DEVICE=cpu checks the code without a GPU; its times mean nothing.
"""

import os

import numpy as np
import warp as wp

from peers.worker import load

wp.config.quiet = True
wp.init()
DEVICE = os.environ.get("CRUMPLE_WARP_DEVICE", "cuda:0")
if DEVICE.startswith("cuda") and wp.get_cuda_device_count() == 0:
    raise ImportError("Warp finds no CUDA device")


@wp.kernel
def find_bounds(points: wp.array(dtype=wp.vec3), triangles: wp.array(dtype=wp.vec3i), lower: wp.array(dtype=wp.vec3),
                upper: wp.array(dtype=wp.vec3)):
    t = wp.tid()
    k = triangles[t]
    lower[t] = wp.min(points[k[0]], wp.min(points[k[1]], points[k[2]]))
    upper[t] = wp.max(points[k[0]], wp.max(points[k[1]], points[k[2]]))


@wp.kernel
def find_pairs(tree: wp.uint64, lower: wp.array(dtype=wp.vec3), upper: wp.array(dtype=wp.vec3),
               count: wp.array(dtype=wp.int32), pairs: wp.array(dtype=wp.vec2i)):
    t = wp.tid()
    query = wp.bvh_query_aabb(tree, lower[t], upper[t])
    other = wp.int32(0)
    while wp.bvh_query_next(query, other):
        if other > t:
            i = wp.atomic_add(count, 0, 1)
            if i < pairs.shape[0]:
                pairs[i] = wp.vec2i(t, other)


class WarpBoxes:
    """The mesh is on the device before the clock starts, and the pairs stay on the device; the tree is built in each call. The
    array of pairs is large enough for all pairs, because a first call has counted them."""

    name, question, computes = "Warp LBVH, CUDA", "self", "overlapping boxes"
    package, scalar, describes = "warp-lang", "float32", "boxes only, on the GPU: pairs of overlapping boxes, neighbours included"
    ways = [("", 0)]

    def __init__(self, folder, way):
        vertices, triangles = load(folder)
        self.points = wp.array(np.ascontiguousarray(vertices, np.float32), dtype=wp.vec3, device=DEVICE)
        self.triangles = wp.array(np.ascontiguousarray(triangles), dtype=wp.vec3i, device=DEVICE)
        self.lower, self.upper = (wp.empty(len(triangles), dtype=wp.vec3, device=DEVICE) for _ in range(2))
        self.counter = wp.zeros(1, dtype=wp.int32, device=DEVICE)
        self.found = wp.empty(0, dtype=wp.vec2i, device=DEVICE)
        self.found = wp.empty(self.call(), dtype=wp.vec2i, device=DEVICE)

    def call(self):
        n = len(self.triangles)
        self.counter.zero_()
        wp.launch(find_bounds, n, [self.points, self.triangles, self.lower, self.upper], device=DEVICE)
        tree = wp.Bvh(self.lower, self.upper, constructor="lbvh" if DEVICE.startswith("cuda") else None)
        wp.launch(find_pairs, n, [tree.id, self.lower, self.upper, self.counter, self.found], device=DEVICE)
        return int(self.counter.numpy()[0])  # waits until the device is done

    def count(self, answer):
        return answer

    def pairs(self, answer):
        return set(map(tuple, self.found.numpy().tolist()))


WORKERS = [WarpBoxes]
