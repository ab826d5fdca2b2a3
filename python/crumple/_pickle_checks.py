"""Consistency checks of unpickled results, so that their attributes, pictures and files can rely on valid contents."""

from __future__ import annotations

from typing import Any

import numpy as np

from ._errors import InvalidInput
from ._features import (
    LISTS,
    EdgeEdgeType,
    FirstImpact,
    Impacts,
    Proximities,
    VertexEdgeType,
    VertexFaceType,
    VertexVertexType,
)
from ._intersections import OUTPUTS
from ._results import Result

_OUTPUTS = {"Impacts": Impacts._outputs, "Proximities": Proximities._outputs}
_VALUES = {"Impacts": ("toi", "start"), "Proximities": ("squared_distance", "touching")}
_LISTS = {kind: LISTS[kind] for kind in ("vertex_face", "edge_edge", "vertex_edge", "vertex_vertex")}


class _Check:
    """Base class of checks that the members of a result are consistent."""

    def __init__(self, result: Result) -> None:
        self._name, self._found, self._request = type(result).__name__, result._found, result._request
        self._scene = result._scene

    def _that(self, holds: Any, what: str) -> None:
        if not holds:
            raise InvalidInput(f"the state of {self._name} is inconsistent: {what}")

    def _offsets(self, offsets: np.ndarray, parts: int, most: int, what: str) -> None:
        self._that(len(offsets) == parts + 1 and offsets[0] == 0 and (np.diff(offsets) >= 0).all(), what)
        self._that(offsets[-1] <= most, what)

    def all(self) -> None:
        """Raises InvalidInput if anything is inconsistent."""
        raise NotImplementedError


def _are_two_ids(ids: tuple[Any, ...]) -> bool:
    return [*map(type, ids)] == [int, int] and all(0 <= number < 2**31 for number in ids)


class _CheckFeatures(_Check):
    def all(self) -> None:
        found, outputs = self._found, _OUTPUTS[self._name]
        self._has = self._request.options.__contains__
        self._that(self._request.output in outputs, "output")
        self._listed = self._request.output == outputs[-1]
        rows = sum(len(getattr(found, pairs)) for pairs in _LISTS.values())
        self._that(found.count == rows and (self._listed or not rows), "count")
        triangles = len(found.triangle_pairs) if self._name == "Impacts" else 0
        self._that(not self._listed or found.any == (rows + triangles > 0), "any")
        self._that(self._request.output != "any" or not len(found.world_hit), "world_hit")
        self._that(not self._has("index") or (self._listed and not self._request.of_bodies), "index")
        alone = rows and not (self._has("index") or len(found.world_hit) or self._request.scene == "part")
        self._that(not self._request.block or alone, "block")
        self._edges()
        for name, pairs in _LISTS.items():
            self._list(name, pairs)
        for offsets, second, by_second, pairs in (
            ("vertex_offsets", "face_offsets", "by_face", "vertex_faces"),
            ("edge_offsets", "second_edge_offsets", "by_second_edge", "edge_edges"),
            ("vertex_edge_offsets", "edge_vertex_offsets", "by_edge", "vertex_edges"),
            ("vertex_vertex_offsets", "second_vertex_offsets", "by_second_vertex", "vertex_vertices"),
        ):
            self._index(offsets, second, by_second, getattr(found, pairs))
        if self._name == "Impacts":
            self._triangles()
            self._first()
        else:
            self._closest_and_least()

    def _edges(self) -> None:
        first, edges = self._found.first_edge, self._found.edges
        if self._request.scene == "part":
            lists = (first, edges, self._found.first_point, self._found.points)
            return self._that(not any(map(len, lists)), "edges")
        self._that(len(first) or not (len(edges) or self._listed), "first_edge")
        if len(first):
            self._that(first[0] == 0 and first[-1] == len(edges) and (np.diff(first) >= 0).all(), "first_edge")
            self._that(self._request.of_bodies or len(first) == 2, "first_edge")
        self._that(((edges >= 0).all(axis=1) & (edges[:, 0] != edges[:, 1])).all(), "edges")
        first_point, points = self._found.first_point, self._found.points
        self._that(len(first_point) == len(first), "first_point")
        if len(first_point):
            self._that(first_point[0] == 0 and first_point[-1] == len(points), "first_point")
        self._that((np.diff(first_point) >= 0).all() and (len(first_point) or not len(points)), "first_point")
        self._that((points >= 0).all(), "points")

    def _list(self, name: str, array: str) -> None:
        found, pairs = self._found, getattr(self._found, array)
        rows = len(pairs)
        value, flag = (getattr(found, f"{name}_{word}") for word in _VALUES[self._name])
        bodies = getattr(found, f"{name}_bodies")
        self._that(len(value) == len(flag) == rows, f"the lengths of {array}")
        self._that((value >= 0).all() and (self._name == "Proximities" or (value <= 1).all()), f"the values of {array}")
        self._that((value[flag] == 0).all(), f"the flags of {array}")
        self._that((pairs >= 0).all(), array)
        self._that(len(bodies) == (rows if self._request.of_bodies else 0), f"{name}_bodies")
        if self._request.scene == "part":
            return
        if not self._request.of_bodies:
            bodies = np.zeros((rows, 2), np.int32)
        self._that(((bodies >= 0) & (bodies < max(len(found.first_edge) - 1, 0))).all(), f"{name}_bodies")
        if not rows:
            return
        edges, points = np.diff(found.first_edge), np.diff(found.first_point)
        for column, of in enumerate(name.split("_")):
            index, body = pairs[:, column], bodies[:, column]
            if of == "edge":
                self._that((index < edges[body]).all(), f"{array} and edges")
            if of == "vertex":
                self._that(((index < points[body]) | (points[body] == 0)).all(), f"{array} and points")

    def _triangles(self) -> None:
        found = self._found
        fits = self._listed if self._has("triangle_pairs") else not len(found.triangle_pairs)
        self._that(fits, "triangle_pairs")
        self._list("triangle_pair", "triangle_pairs")
        names = ("triangle_offsets", "second_triangle_offsets", "by_second_triangle")
        self._index(*names, found.triangle_pairs, self._has("triangle_pairs"))

    def _index(self, offsets: str, second: str, by_second: str, pairs: np.ndarray, listed: bool = True) -> None:
        first, last, order = (getattr(self._found, name) for name in (offsets, second, by_second))
        if not (self._has("index") and listed):
            return self._that(not (len(first) or len(last) or len(order)), offsets)
        for column, of, name in ((0, first, offsets), (1, last, second)):
            self._that(len(of) and of[0] == 0 and of[-1] == len(pairs) and (np.diff(of) >= 0).all(), name)
            if self._request.scene == "part":  # offsets are by position in the part, but `pairs` has ids
                continue
            self._that((pairs[:, column] < len(of) - 1).all(), name)
            counts = np.bincount(pairs[:, column], minlength=len(of) - 1)
            self._that(np.array_equal(np.diff(of), counts), name)
        self._that(np.array_equal(order, np.lexsort((pairs[:, 0], pairs[:, 1]))), by_second)

    def _first(self) -> None:
        found = self._found
        firsts = [first for first in (found.first, *found.world_first) if first is not None]
        told = self._request.output in ("first", "pairs")
        self._that(told or not (firsts or found.world_first), "first")
        for first in firsts:
            self._that(isinstance(first, tuple) and [*map(type, first)] == [str, tuple, tuple, float, bool], "first")
            impact = FirstImpact(*first)
            self._that(impact.kind in _LISTS, "the kind of the first impact")
            self._that(_are_two_ids(impact.pair), "the pair of the first impact")
            fits = _are_two_ids(impact.bodies) and (self._request.of_bodies or impact.bodies == (0, 0))
            self._that(fits, "the bodies of the first impact")
            self._that(0 <= impact.toi <= 1, "the time of the first impact")
        if self._request.block:
            self._that(not (firsts or found.world_first), "first")
        elif self._listed:
            self._that((found.first is not None) == (found.count > 0), "first")
        else:
            self._that(found.first is None or found.any, "first")

    def _closest_and_least(self) -> None:
        found = self._found
        self._that(self._listed or not (self._has("closest") or self._has("least")), "closest and least")
        for name, pairs, most in (
            ("vertex_face", found.vertex_faces, VertexFaceType.P_T),
            ("edge_edge", found.edge_edges, EdgeEdgeType.EA_EB),
            ("vertex_edge", found.vertex_edges, VertexEdgeType.P_E),
            ("vertex_vertex", found.vertex_vertices, VertexVertexType.P_P),
        ):
            types, at = getattr(found, f"{name}_type"), getattr(found, f"{name}_at")
            rows = len(pairs) if self._has("closest") else 0
            self._that(len(types) == len(at) == rows and (types <= most).all(), f"{name}_type")
            self._that(((at >= 0) & (at <= 1)).all(), f"{name}_at")
        self._that(not (self._has("least") and self._request.of_bodies), "least")
        for name in ("vertex_distance", "face_distance", "edge_distance"):
            least = getattr(found, name)
            self._that((least >= 0).all() and (self._has("least") or not len(least)), name)
        whole = self._has("least") and not self._request.scene == "part"
        self._that(not whole or len(found.edge_distance) == len(found.edges), "edge_distance")


class _CheckCandidates(_Check):
    def all(self) -> None:
        found, of_bodies = self._found, self._request.of_bodies
        first, edges, points = found.first_edge, found.edges, found.points
        fits = len(first) == len(found.first_point) and (len(first) == 2 or (of_bodies and len(first) > 0))
        for offsets, listed in ((first, edges), (found.first_point, points)):
            fits = fits and offsets[0] == 0 and offsets[-1] == len(listed) and bool((np.diff(offsets) >= 0).all())
        self._that(fits and (edges >= 0).all() and (edges[:, 0] != edges[:, 1]).all() and (points >= 0).all(), "edges")
        self._that(all(kind in [*LISTS] for kind in self._request.kinds), "kinds")
        for kind, name in LISTS.items():
            pairs, bodies = getattr(found, name), getattr(found, f"{kind}_bodies")
            self._that((kind in self._request.kinds or not len(pairs)) and (pairs >= 0).all(), name)
            self._that(len(bodies) == (len(pairs) if of_bodies else 0), name)
            self._that(((bodies >= 0) & (bodies < len(first) - 1)).all(), f"{kind}_bodies")
            of = bodies if of_bodies else np.zeros_like(pairs)
            for column, feature in enumerate(kind.split("_")):
                if feature == "edge":
                    self._that((pairs[:, column] < np.diff(first)[of[:, column]]).all(), f"{name} and edges")
        count = sum(len(getattr(found, name)) for name in LISTS.values())
        self._that(found.count == count and found.any == (count > 0), "count")


class _CheckDistances(_Check):
    def all(self) -> None:
        found = self._found
        bodies, squared = found.bodies, found.squared_distance
        rows = (squared, found.touching, found.triangles, found.points)
        self._that(all(len(array) == len(bodies) for array in rows), "lengths")
        first, second = bodies[:, 0].astype(np.int64), bodies[:, 1].astype(np.int64)
        self._that((0 <= first).all() and (first < second).all(), "bodies")
        self._that((np.diff(first << 32 | second) > 0).all(), "bodies")
        self._that((squared >= 0).all() and not squared[found.touching].any(), "squared_distance")
        self._that((found.triangles >= 0).all(), "triangles")
        self._that(np.isfinite(found.points).all(), "points")
        rows = found.world_rows[found.world_rows != -1]
        self._that(self._request.output in ("nearest", "pairs"), "output")
        self._that(self._request.output == "nearest" or not len(found.world_rows), "world_rows")
        self._that(self._request.output == "pairs" or np.array_equal(rows, np.arange(len(bodies))), "world_rows")


class _CheckOverlaps(_Check):
    def all(self) -> None:
        found, output = self._found, self._request.output
        self._that(output in ("any", "any_by_world", "body_pairs", "pairs"), "output")
        if self._part():
            return
        rows = len(found.bodies) if output in ("body_pairs", "pairs") else 0
        self._that(len(found.bodies) == len(found.relation) == found.count == rows, "count")
        numbers = (found.volume, found.centroid, found.area_vector, found.normal, found.mean_depth)
        lengths = {len(array) for array in (*numbers, found.torque, found.torque_point, found.contact_area)}
        self._that(lengths == {rows if output == "pairs" else 0}, "lengths")
        first, second = found.bodies[:, 0].astype(np.int64), found.bodies[:, 1].astype(np.int64)
        has, of_mesh = self._request.options.__contains__, self._request.scene == "mesh"
        itself = has("self_overlaps") or of_mesh
        self._that((0 <= first).all() and (first <= second if itself else first < second).all(), "bodies")
        self._that((np.diff(first << 32 | second) > 0).all(), "bodies")
        self._that((found.skipped >= 0).all() and (np.diff(found.skipped) > 0).all(), "skipped")
        self._that((found.relation < 6).all(), "relation")
        self._curves(rows)
        self._regions(rows)
        self._per_row(rows, {"extents": ("box", "thickness"), "depth_tolerance": ("depth_reached", "depth_bound")})
        self._per_row(rows, {"unions": ("union_volume", "intersection_over_union", "difference_volume")})
        self._per_row(rows, {"translation": ("translation_low", "translation_high", "translation")})
        self._that(rows == 0 or len(found.withdrawals) % rows == 0, "withdrawals")
        self._that(has("directions") == bool(len(found.withdrawals)) or rows == 0, "withdrawals")
        self._that(len(found.first_free) == (len(found.withdrawals) if has("first_free") else 0), "first_free")
        depths = len(found.depths)
        self._that(len(found.depth_points) == len(found.depth_triangles) == depths, "depths")
        self._that(len(found.deepest) == (rows if has("depths") else 0), "deepest")
        self._that(((-1 <= found.deepest) & (found.deepest < depths)).all(), "deepest")
        for option, offsets, vertices, values in (
            ("gradient", found.gradient_offsets, found.gradient_vertices, found.gradient),
            ("windings", found.winding_offsets, found.winding_vertices, found.windings),
            ("depths", found.depth_offsets, found.depth_vertices, found.depths),
        ):
            if has(option):
                self._offsets(offsets, rows, len(values), option)
            self._that(len(values) == len(vertices) and (has(option) or not len(values)), option)
            self._that((vertices >= 0).all(), option)
        self._that(len(found.body_volume) == len(found.is_solid) and (itself or not len(found.is_solid)), "is_solid")

    def _part(self) -> bool:
        """Checks the lists of a part. Returns True if the result is about a part."""
        found, of_part = self._found, self._request.scene == "part"
        types = [type(value) for value in found.part]
        self._that(types == [int, int, bool], "part")
        index, count, _ = found.part
        self._that(0 <= index < count if of_part else index == count == 0, "part")
        pairs, bodies = found.part_pairs, found.part_bodies
        self._that(len(pairs) == len(bodies) and (of_part or not len(pairs)), "part_pairs")
        self._that((pairs >= 0).all() and (bodies >= 0).all() and (bodies <= 1).all(), "part_pairs")
        if of_part:
            self._that(not found.any and found.count == len(found.bodies) == len(found.volume) == 0, "part")
        return of_part

    def _per_row(self, rows: int, arrays: dict[str, tuple[str, ...]]) -> None:
        given = self._request.options
        for option, names in arrays.items():
            made = option in given or (option == "extents" and "regions" in given)
            for name in names:
                self._that(len(getattr(self._found, name)) == (rows if made else 0), name)

    def _regions(self, rows: int) -> None:
        found, has = self._found, self._request.options.__contains__
        regions = len(found.region_volume)
        if has("regions"):
            self._offsets(found.region_offsets, rows, regions, "region_offsets")
        self._that(has("regions") or not regions, "regions")
        names = "centroid", "area_vector", "normal", "mean_depth", "thickness", "box", "is_contact", "is_merged", "pieces"
        for name in names:
            self._that(len(getattr(found, f"region_{name}")) == regions, f"region_{name}")
        both = has("regions") and has("curves")
        self._that(len(found.curve_regions) == (len(found.curve_closed) if both else 0), "curve_regions")
        self._that(((-1 <= found.curve_regions) & (found.curve_regions < regions)).all(), "curve_regions")

    def _curves(self, rows: int) -> None:
        found, has = self._found, "curves" in self._request.options
        curves, points = len(found.curve_closed), len(found.curve_points)
        if has:
            self._offsets(found.curve_offsets, rows, curves, "curve_offsets")
            self._offsets(found.curve_point_offsets, curves, points, "curve_point_offsets")
        self._that(has or not curves + points, "curves")
        self._that(len(found.curve_area_vector) == len(found.curve_torque) == curves, "curves")
        self._that(len(found.curve_triangles) == points, "curve_triangles")
        self._that((found.curve_triangles >= -1).all(), "curve_triangles")


class _CheckIntersections(_Check):
    """Checks of Intersections. For meshes, pairs are not checked here: the extension module checks them afterwards."""

    def all(self) -> None:
        found, request = self._found, self._request
        self._that(request.output in OUTPUTS, "output")
        least, contacts = OUTPUTS.index(request.output), len(found.contact_kinds)
        listed = least >= OUTPUTS.index("pairs")
        self._that(listed or not request.block, "block")
        self._that(listed or not len(found.pairs), "pairs")
        self._that(not listed or (found.count == len(found.pairs) and found.any == (found.count > 0)), "count")
        counted = least >= OUTPUTS.index("count") and not request.block
        self._that(not counted or found.count == found.statistics.pairs, "statistics")
        self._that(contacts == (len(found.pairs) if request.output == "contacts" else 0), "contacts")
        self._containment()
        if request.scene == "world":
            self._world(least)

    def _containment(self) -> None:
        found, request = self._found, self._request
        requested = "containment" in request.options
        rows = len(found.bodies) if requested and request.output == "body_pairs" else 0
        self._that(len(found.inside) == rows, "inside")
        self._that(requested or not len(found.skipped), "skipped")
        self._that((found.skipped >= 0).all() and (np.diff(found.skipped) > 0).all(), "skipped")

    def _world(self, least: int) -> None:
        found, request, world, rows = self._found, self._request, self._scene[0], len(self._found.bodies)
        worlds = int(max(world.worlds.max(initial=-1), -1)) + 1
        if not request.block:
            self._that(len(found.world_hit) == (worlds if least >= 1 else 0), "world_hit")
            self._that(len(found.world_counts) == (worlds if least >= 3 else 0), "world_counts")
        self._that(len(found.pairs) == (rows if least >= 4 else 0) and (rows == 0 or least in (2, 4, 5)), "pairs")
        self._that(((found.bodies >= 0) & (found.bodies < len(world))).all(), "bodies")
        sizes = np.array([shape.triangles for shape in world.shapes], np.int64)[world.bodies]
        if least >= 4:
            self._that(((found.pairs >= 0) & (found.pairs < sizes[found.bodies])).all(), "pairs")
        if least == 5:
            self._offsets(found.contact_offsets, rows, len(found.contact_points), "offsets of contacts")
            self._that(np.isfinite(found.contact_points).all(), "points of contacts")
        if "index" in request.options and not request.block:
            self._offsets(found.world_offsets, worlds, rows, "world_offsets")
            self._offsets(found.body_offsets, len(world), rows, "body_offsets")
            starts = np.concatenate([[0], np.cumsum(sizes)])
            self._that(np.array_equal(found.first_triangle, starts), "first_triangle")
            self._that(len(found.hit) == sizes.sum(), "hit")


_CHECKS: dict[str, type[_Check]] = {
    "Intersections": _CheckIntersections,
    "Impacts": _CheckFeatures,
    "Proximities": _CheckFeatures,
    "Candidates": _CheckCandidates,
    "Distances": _CheckDistances,
    "Overlaps": _CheckOverlaps,
}


def check_fit(result: Result) -> None:
    """Raises InvalidInput if the members of a result are inconsistent."""
    _CHECKS[type(result).__name__](result).all()
