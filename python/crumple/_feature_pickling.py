"""Takes Impacts and Nearby apart for pickle, and puts them together again, with all that is read checked."""

from __future__ import annotations

from typing import Any

import numpy as np

from ._core import Statistics
from ._errors import InvalidInput, InvalidType
from ._feature_result import FeatureResult
from ._impacts import FirstImpact, Impacts
from ._near import EdgeEdgeType, Nearby, VertexEdgeType, VertexFaceType, VertexVertexType

_TYPES = {"Impacts": Impacts, "Nearby": Nearby}
_VALUES = {"Impacts": ("toi", "start"), "Nearby": ("squared_distance", "touching")}

# The kinds of pairs, and the array of each.
_LISTS = {
    "vertex_face": "vertex_faces",
    "edge_edge": "edge_edges",
    "vertex_edge": "vertex_edges",
    "vertex_vertex": "vertex_vertices",
}

# Type and columns of each array that both have; what was not asked for is empty.
_ARRAYS = {
    "world_hit": (np.bool_, ()),
    "edges": (np.int32, (2,)),
    "first_edge": (np.int64, ()),
    "vertex_faces": (np.int32, (2,)),
    "vertex_face_bodies": (np.int32, (2,)),
    "edge_edges": (np.int32, (2,)),
    "edge_edge_bodies": (np.int32, (2,)),
    "points": (np.int32, ()),
    "first_point": (np.int64, ()),
    "vertex_edges": (np.int32, (2,)),
    "vertex_edge_bodies": (np.int32, (2,)),
    "vertex_vertices": (np.int32, (2,)),
    "vertex_vertex_bodies": (np.int32, (2,)),
    "vertex_offsets": (np.int64, ()),
    "face_offsets": (np.int64, ()),
    "by_face": (np.int64, ()),
    "edge_offsets": (np.int64, ()),
    "second_edge_offsets": (np.int64, ()),
    "by_second_edge": (np.int64, ()),
    "vertex_edge_offsets": (np.int64, ()),
    "edge_vertex_offsets": (np.int64, ()),
    "by_edge": (np.int64, ()),
    "vertex_vertex_offsets": (np.int64, ()),
    "second_vertex_offsets": (np.int64, ()),
    "by_second_vertex": (np.int64, ()),
}
_OF_MOTION = {
    "triangle_pairs": (np.int32, (2,)),
    "triangle_pair_bodies": (np.int32, (2,)),
    "triangle_pair_toi": (np.float64, ()),
    "triangle_pair_start": (np.bool_, ()),
    "triangle_offsets": (np.int64, ()),
    "second_triangle_offsets": (np.int64, ()),
    "by_second_triangle": (np.int64, ()),
}
_OF_NEARNESS = {
    "vertex_face_type": (np.uint8, ()),
    "vertex_face_at": (np.float64, (2,)),
    "edge_edge_type": (np.uint8, ()),
    "edge_edge_at": (np.float64, (2,)),
    "vertex_edge_type": (np.uint8, ()),
    "vertex_edge_at": (np.float64, (2,)),
    "vertex_vertex_type": (np.uint8, ()),
    "vertex_vertex_at": (np.float64, (2,)),
    "vertex_distance": (np.float64, ()),
    "face_distance": (np.float64, ()),
    "edge_distance": (np.float64, ()),
}
_FLAGS = ("any", "of_world", "has_index", "copy", "is_block", "of_part")


def _flags_of(kind: str) -> tuple[str, ...]:
    return (*_FLAGS, "has_closest", "has_least") if kind == "Nearby" else (*_FLAGS, "has_triangle_pairs")


def _arrays_of(kind: str) -> dict[str, tuple[Any, tuple[int, ...]]]:
    value, flag = _VALUES[kind]
    values = {f"{name}_{value}": (np.float64, ()) for name in _LISTS}
    more = _OF_NEARNESS if kind == "Nearby" else _OF_MOTION
    return {**_ARRAYS, **more, **values, **{f"{name}_{flag}": (np.bool_, ()) for name in _LISTS}}


class StoredAnswer:
    """An answer in arrays of its own, where _core.ImpactsAnswer and _core.NearbyAnswer have the library's."""

    def __init__(self, state: dict[str, Any]) -> None:
        self.__dict__.update(state)


def stored(answer: Any) -> dict[str, Any]:
    """A copy that shares nothing."""
    kind = "Impacts" if hasattr(answer, "world_first") else "Nearby"
    state = {name: getattr(answer, name) for name in (*_flags_of(kind), "count", "wants", "statistics")}
    if kind == "Impacts":
        state.update(first=answer.first, world_first=list(answer.world_first))
    for name in _arrays_of(kind):
        state[name] = getattr(answer, name).copy()
        state[name].flags.writeable = False
    return state


def restore(kind: Any, state: Any) -> FeatureResult:
    """Raises InvalidType and InvalidInput for what neither an Impacts nor a Nearby can have given."""
    if kind not in _TYPES or not isinstance(state, dict):
        raise InvalidType("the state of an answer about features must be its name and a dict")
    arrays = _arrays_of(kind)
    needed = {**dict.fromkeys(_flags_of(kind), bool), "count": int, "wants": str, "statistics": Statistics}
    if kind == "Impacts":
        needed["world_first"] = list
    expected = {*arrays, *needed, *(["first"] if kind == "Impacts" else [])}
    if state.keys() != expected:
        raise InvalidType(f"the state of {kind} must have {', '.join(sorted(expected))}")
    for name, wanted in needed.items():
        if not isinstance(state[name], wanted):
            raise InvalidType(f"the state of {kind} needs {name} as {wanted.__name__}")
    made = {name: _array(state[name], name, *arrays[name], kind) for name in arrays}
    answer = StoredAnswer({**state, **made})
    _Check(kind, answer).all()
    return _TYPES[kind](answer)


def _array(array: Any, name: str, dtype: Any, columns: tuple[int, ...], kind: str) -> np.ndarray:
    if not isinstance(array, np.ndarray) or array.dtype.newbyteorder("=") != dtype or array.shape[1:] != columns:
        shape = ", ".join(["n", *map(str, columns)])
        raise InvalidType(f"the state of {kind} needs {name} as an array ({shape}) of {np.dtype(dtype)}")
    array = np.array(array, dtype, order="C")
    array.flags.writeable = False
    return array


class _Check:
    """Whether all of an answer fits together."""

    def __init__(self, kind: str, answer: Any) -> None:
        self._kind, self._answer = kind, answer

    def _that(self, holds: Any, what: str) -> None:
        if not holds:
            raise InvalidInput(f"the state of {self._kind} does not fit together: {what}")

    def all(self) -> None:
        answer, wants = self._answer, _TYPES[self._kind]._wants
        self._that(answer.wants in wants, "wants")
        self._listed = answer.wants == wants[-1]
        rows = sum(len(getattr(answer, pairs)) for pairs in _LISTS.values())
        self._that(answer.count == rows and (self._listed or not rows), "count")
        triangles = len(answer.triangle_pairs) if self._kind == "Impacts" else 0
        self._that(not self._listed or answer.any == (rows + triangles > 0), "any")
        self._that(answer.wants != "any" or not len(answer.world_hit), "world_hit")
        self._that(not answer.has_index or (self._listed and not answer.of_world), "has_index")
        self._that(not answer.is_block or (rows and not (answer.has_index or len(answer.world_hit))), "is_block")
        self._that(not (answer.of_part and (answer.of_world or answer.is_block)), "of_part")
        self._edges()
        for name, pairs in _LISTS.items():
            self._list(name, pairs)
        for offsets, second, by_second, pairs in (
            ("vertex_offsets", "face_offsets", "by_face", "vertex_faces"),
            ("edge_offsets", "second_edge_offsets", "by_second_edge", "edge_edges"),
            ("vertex_edge_offsets", "edge_vertex_offsets", "by_edge", "vertex_edges"),
            ("vertex_vertex_offsets", "second_vertex_offsets", "by_second_vertex", "vertex_vertices"),
        ):
            self._index(offsets, second, by_second, getattr(answer, pairs))
        if self._kind == "Impacts":
            self._triangles()
            self._first()
        else:
            self._closest_and_least()

    def _edges(self) -> None:
        first, edges = self._answer.first_edge, self._answer.edges
        if self._answer.of_part:
            lists = (first, edges, self._answer.first_point, self._answer.points)
            return self._that(not any(map(len, lists)), "edges")
        self._that(len(first) or not (len(edges) or self._listed), "first_edge")
        if len(first):
            self._that(first[0] == 0 and first[-1] == len(edges) and (np.diff(first) >= 0).all(), "first_edge")
            self._that(self._answer.of_world or len(first) == 2, "first_edge")
        self._that(((edges >= 0).all(axis=1) & (edges[:, 0] != edges[:, 1])).all(), "edges")
        first_point, points = self._answer.first_point, self._answer.points
        self._that(len(first_point) == len(first), "first_point")
        if len(first_point):
            self._that(first_point[0] == 0 and first_point[-1] == len(points), "first_point")
        self._that((np.diff(first_point) >= 0).all() and (len(first_point) or not len(points)), "first_point")
        self._that((points >= 0).all(), "points")

    def _list(self, name: str, array: str) -> None:
        answer, pairs = self._answer, getattr(self._answer, array)
        rows = len(pairs)
        value, flag = (getattr(answer, f"{name}_{word}") for word in _VALUES[self._kind])
        bodies = getattr(answer, f"{name}_bodies")
        self._that(len(value) == len(flag) == rows, f"the lengths of {array}")
        self._that((value >= 0).all() and (self._kind == "Nearby" or (value <= 1).all()), f"the values of {array}")
        self._that((value[flag] == 0).all(), f"the flags of {array}")
        self._that((pairs >= 0).all(), array)
        self._that(len(bodies) == (rows if answer.of_world else 0), f"{name}_bodies")
        if answer.of_part:
            return
        if not answer.of_world:
            bodies = np.zeros((rows, 2), np.int32)
        self._that(((bodies >= 0) & (bodies < max(len(answer.first_edge) - 1, 0))).all(), f"{name}_bodies")
        if not rows:
            return
        edges, points = np.diff(answer.first_edge), np.diff(answer.first_point)
        for column, of in enumerate(name.split("_")):
            index, body = pairs[:, column], bodies[:, column]
            if of == "edge":
                self._that((index < edges[body]).all(), f"{array} and edges")
            if of == "vertex":
                self._that(((index < points[body]) | (points[body] == 0)).all(), f"{array} and points")

    def _triangles(self) -> None:
        answer = self._answer
        self._that(self._listed or not answer.has_triangle_pairs, "has_triangle_pairs")
        self._that(answer.has_triangle_pairs or not len(answer.triangle_pairs), "triangle_pairs")
        self._list("triangle_pair", "triangle_pairs")
        names = ("triangle_offsets", "second_triangle_offsets", "by_second_triangle")
        self._index(*names, answer.triangle_pairs, answer.has_triangle_pairs)

    def _index(self, offsets: str, second: str, by_second: str, pairs: np.ndarray, listed: bool = True) -> None:
        first, last, order = (getattr(self._answer, name) for name in (offsets, second, by_second))
        if not (self._answer.has_index and listed):
            return self._that(not (len(first) or len(last) or len(order)), offsets)
        for column, of, name in ((0, first, offsets), (1, last, second)):
            self._that(len(of) and of[0] == 0 and of[-1] == len(pairs) and (np.diff(of) >= 0).all(), name)
            if self._answer.of_part:  # by position in the part
                continue
            self._that((pairs[:, column] < len(of) - 1).all(), name)
            counts = np.bincount(pairs[:, column], minlength=len(of) - 1)
            self._that(np.array_equal(np.diff(of), counts), name)
        self._that(np.array_equal(order, np.lexsort((pairs[:, 0], pairs[:, 1]))), by_second)

    def _first(self) -> None:
        answer = self._answer
        firsts = [first for first in (answer.first, *answer.world_first) if first is not None]
        told = answer.wants in ("earliest", "impacts")
        self._that(told or not (firsts or answer.world_first), "first")
        for first in firsts:
            self._that(isinstance(first, tuple) and len(first) == len(FirstImpact._fields), "first")
            impact = FirstImpact(*first)
            self._that(impact.kind in _LISTS, "the kind of the first impact")
            self._that((impact.bodies is not None) == answer.of_world, "the bodies of the first impact")
            self._that(0 <= impact.toi <= 1 and isinstance(impact.start, bool), "the time of the first impact")
        if answer.is_block:
            self._that(not (firsts or answer.world_first), "first")
        elif self._listed:
            self._that((answer.first is not None) == (answer.count > 0), "first")
        else:
            self._that(answer.first is None or answer.any, "first")

    def _closest_and_least(self) -> None:
        answer = self._answer
        self._that(self._listed or not (answer.has_closest or answer.has_least), "has_closest and has_least")
        for name, pairs, most in (
            ("vertex_face", answer.vertex_faces, VertexFaceType.P_T),
            ("edge_edge", answer.edge_edges, EdgeEdgeType.EA_EB),
            ("vertex_edge", answer.vertex_edges, VertexEdgeType.P_E),
            ("vertex_vertex", answer.vertex_vertices, VertexVertexType.P_P),
        ):
            types, at = getattr(answer, f"{name}_type"), getattr(answer, f"{name}_at")
            rows = len(pairs) if answer.has_closest else 0
            self._that(len(types) == len(at) == rows and (types <= most).all(), f"{name}_type")
            self._that(((at >= 0) & (at <= 1)).all(), f"{name}_at")
        self._that(not (answer.has_least and answer.of_world), "has_least")
        for name in ("vertex_distance", "face_distance", "edge_distance"):
            least = getattr(answer, name)
            self._that((least >= 0).all() and (answer.has_least or not len(least)), name)
        whole = answer.has_least and not answer.of_part
        self._that(not whole or len(answer.edge_distance) == len(answer.edges), "edge_distance")
