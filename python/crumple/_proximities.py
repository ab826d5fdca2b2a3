"""The result of a ProximityQuery."""

from __future__ import annotations

from enum import IntEnum
from functools import cached_property
from typing import TYPE_CHECKING, ClassVar

from . import _core
from ._errors import InvalidInput
from ._features import FeatureResult

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray


class VertexFaceType(IntEnum):
    """Which part of a face is closest to a vertex: of lowest dimension, then first in this order.

    E0 is the side from the face's first corner to the second, E1 from there to the third, E2 back: IPC Toolkit's names.
    """

    P_T0 = 0
    P_T1 = 1
    P_T2 = 2
    P_E0 = 3
    P_E1 = 4
    P_E2 = 5
    P_T = 6


class EdgeEdgeType(IntEnum):
    """Which parts of two edges are closest: of lowest dimension, then first in this order.

    EA and EB are the edges, EA0 is the first vertex of EA in `edges`: IPC Toolkit's names.
    """

    EA0_EB0 = 0
    EA0_EB1 = 1
    EA1_EB0 = 2
    EA1_EB1 = 3
    EA_EB0 = 4
    EA_EB1 = 5
    EA0_EB = 6
    EA1_EB = 7
    EA_EB = 8


class VertexEdgeType(IntEnum):
    """Which part of an edge is closest to a vertex: its first vertex in `edges`, its second one, or the edge."""

    P_E0 = 0
    P_E1 = 1
    P_E = 2


class VertexVertexType(IntEnum):
    """Which parts of two vertices are closest: there is only one."""

    P_P = 0


_KINDS = ("vertex_face", "edge_edge", "vertex_edge", "vertex_vertex")
_CLOSEST = tuple(f"{kind}_{what}" for kind in _KINDS for what in ("type", "at"))
_LEAST = ("vertex_distance", "face_distance", "edge_distance")


class Proximities(FeatureResult):
    """What is near what, and how near, as much as `output` requested: the same bytes wherever it is computed.

    Two lists, of vertices with faces and of edges with edges, sorted and unique; of worlds by body before vertex, face
    or edge. A squared distance is the exact one, rounded to the nearest float64: infinite beyond the largest.

    It is true if anything is near; `len(proximities)` is the number of pairs.
    """

    _query = "ProximityQuery"
    _write = staticmethod(_core.write_proximities)
    _outputs = ("any", "any_by_world", "pairs")
    _from: ClassVar = {"world_hit": 1}

    @cached_property
    def vertex_face_squared_distance(self) -> NDArray[np.float64]:
        """(k,) float64: the squared distance of vertex and face."""
        return self._array("vertex_face_squared_distance")

    @cached_property
    def vertex_face_touching(self) -> NDArray[np.bool_]:
        """(k,) bool: whether their distance is 0 exactly. A squared distance may also be rounded to 0."""
        return self._array("vertex_face_touching")

    @cached_property
    def edge_edge_squared_distance(self) -> NDArray[np.float64]:
        """(k,) float64: the squared distance of the two edges."""
        return self._array("edge_edge_squared_distance")

    @cached_property
    def edge_edge_touching(self) -> NDArray[np.bool_]:
        """(k,) bool: whether their distance is 0 exactly."""
        return self._array("edge_edge_touching")

    def _check(self, name: str) -> None:
        if name in _LEAST and self._request.of_bodies:
            raise InvalidInput(f"{name} is for one mesh, but the scene is a world")
        super()._check(name)
        for option, names in (("closest", _CLOSEST), ("least", _LEAST)):
            if name in names and option not in self._request.options:
                self._refuse(name, f"{option}=True")

    @cached_property
    def vertex_face_type(self) -> NDArray[np.uint8]:
        """(k,) uint8, with `closest`: a VertexFaceType each."""
        return self._array("vertex_face_type")

    @cached_property
    def vertex_face_at(self) -> NDArray[np.float64]:
        """(k, 2), with `closest`: (u, v) of the face's point a + u (b - a) + v (c - a) that is closest, rounded."""
        return self._array("vertex_face_at")

    @cached_property
    def edge_edge_type(self) -> NDArray[np.uint8]:
        """(k,) uint8, with `closest`: an EdgeEdgeType each."""
        return self._array("edge_edge_type")

    @cached_property
    def edge_edge_at(self) -> NDArray[np.float64]:
        """(k, 2), with `closest`: (s, t) of the edges' points a + s (b - a) and c + t (d - c), rounded."""
        return self._array("edge_edge_at")

    @cached_property
    def vertex_edge_squared_distance(self) -> NDArray[np.float64]:
        """(k,) float64: the squared distance of vertex and edge."""
        return self._array("vertex_edge_squared_distance")

    @cached_property
    def vertex_edge_touching(self) -> NDArray[np.bool_]:
        """(k,) bool: whether their distance is 0 exactly."""
        return self._array("vertex_edge_touching")

    @cached_property
    def vertex_vertex_squared_distance(self) -> NDArray[np.float64]:
        """(k,) float64: the squared distance of the two vertices."""
        return self._array("vertex_vertex_squared_distance")

    @cached_property
    def vertex_vertex_touching(self) -> NDArray[np.bool_]:
        """(k,) bool: whether their distance is 0 exactly."""
        return self._array("vertex_vertex_touching")

    @cached_property
    def vertex_edge_type(self) -> NDArray[np.uint8]:
        """(k,) uint8, with `closest`: a VertexEdgeType each."""
        return self._array("vertex_edge_type")

    @cached_property
    def vertex_edge_at(self) -> NDArray[np.float64]:
        """(k, 2), with `closest`: (s, 0) of the edge's point a + s (b - a), rounded."""
        return self._array("vertex_edge_at")

    @cached_property
    def vertex_vertex_type(self) -> NDArray[np.uint8]:
        """(k,) uint8, with `closest`: a VertexVertexType each, 0."""
        return self._array("vertex_vertex_type")

    @cached_property
    def vertex_vertex_at(self) -> NDArray[np.float64]:
        """(k, 2), with `closest`: zeros."""
        return self._array("vertex_vertex_at")

    @cached_property
    def vertex_distance(self) -> NDArray[np.float64]:
        """(vertices,), with `least`: each one's least distance, over the pairs listed; rounded down; or infinite.

        Of listed points in their order.
        """
        return self._array("vertex_distance")

    @cached_property
    def face_distance(self) -> NDArray[np.float64]:
        """(faces,), with `least`: the same of each face."""
        return self._array("face_distance")

    @cached_property
    def edge_distance(self) -> NDArray[np.float64]:
        """(n,), with `least`: the same of each of `edges`."""
        return self._array("edge_distance")

    def __repr__(self) -> str:
        found = "pairs" if self._found.count != 1 else "pair"
        if self._request.output != "pairs":
            found = "something is near" if self._found.any else "nothing is near"
        return self._description(found)
