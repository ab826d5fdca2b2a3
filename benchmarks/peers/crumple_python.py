"""Crumple's Python package: all intersecting pairs of triangles, sorted."""

import crumple
import numpy as np

from peers.worker import load


class CrumpleSelf:
    name, question, computes = "crumple", "self", "exact pairs, sorted"
    package, scalar, describes = "crumple", "float64", "whole result, exact"
    ways = [("", 1), ("", 0)]

    def __init__(self, folder, way):
        self.meshes = [crumple.Mesh(*map(np.ascontiguousarray, load(folder, which))) for which in self.inputs()]
        self.detector = crumple.Detector(backend="cpu")

    def inputs(self):
        return [""]

    def call(self):
        return self.detector.intersections(*self.meshes).pairs

    def count(self, found):
        return len(found)

    def pairs(self, found):
        return set(map(tuple, found.tolist()))


class CrumpleBetween(CrumpleSelf):
    question = "between"

    def inputs(self):
        return ["", "_b"]


class CrumpleSelfAny(CrumpleSelf):
    question, computes, pairs = "any", "exact yes or no", None

    def call(self):
        return self.detector.any(self.meshes if len(self.meshes) > 1 else self.meshes[0])

    def count(self, found):
        return int(found)


class CrumpleBetweenAny(CrumpleSelfAny):
    inputs = CrumpleBetween.inputs


WORKERS = [CrumpleSelf, CrumpleBetween, CrumpleSelfAny]
