"""Results about pairs of features: impacts and proximities, and what they share with candidates."""

from __future__ import annotations

import os
from collections.abc import Callable
from enum import IntEnum
from typing import TYPE_CHECKING, Any, ClassVar, Literal, NamedTuple

from . import _core
from ._errors import InvalidInput, InvalidType
from ._mesh import as_mesh
from ._results import Result, bools, extension_of, file_name, float64, int32, int64, uint8

if TYPE_CHECKING:
    from numpy.typing import NDArray

#: The list of each kind of pairs.
LISTS = {
    "vertex_face": "vertex_faces",
    "edge_edge": "edge_edges",
    "edge_face": "edge_faces",
    "face_face": "face_faces",
    "vertex_edge": "vertex_edges",
    "vertex_vertex": "vertex_vertices",
}
_OF_THE_WHOLE = ("edges", "first_edge", "points", "first_point")
_NOT_IN_BLOCKS = ("world_hit", "first", "world_first")
_KINDS = ("vertex_face", "edge_edge", "vertex_edge", "vertex_vertex")
_CLOSEST = tuple(f"{kind}_{what}" for kind in _KINDS for what in ("type", "at"))
_LEAST = ("vertex_distance", "face_distance", "edge_distance")


def _is_index(name: str) -> bool:
    return name.startswith("by_") or name.endswith("_offsets")


class PairLists(Result):
    """Base of results that list pairs of features, a list for each kind."""

    @property
    def count(self) -> int:
        """How many pairs of features are listed, of all kinds."""
        self._check("count")
        return self._found.count

    def __len__(self) -> int:
        """How many pairs of features are listed; 0 where they were not requested."""
        return self._found.count

    vertex_faces = int32(
        "(k, 2) int32: each a vertex and a face that does not name it, sorted; of worlds within their bodies.", (2,)
    )
    vertex_face_bodies = int32("(k, 2) int32, of a world: the vertex's body and the face's.", (2,))
    edge_edges = int32(
        "(k, 2) int32: each two of `edges` without a common vertex, sorted; of worlds within their bodies.", (2,)
    )
    edge_edge_bodies = int32("(k, 2) int32, of a world: the body of each of the two edges.", (2,))
    edges = int32(
        "(n, 2) int32: the vertices of each edge, the lower first; each edge once, in lexicographic order. Or as "
        "they were listed (`edges`). Of a world those of body b are edges[first_edge[b]:first_edge[b + 1]], and an "
        "edge counts within its body.",
        (2,),
    )
    first_edge = int64("(bodies + 1,) int64: where each body's edges begin in `edges`; one mesh is one body.")
    points = int32(
        "(n,) int32: the vertices that were listed as points, in their order; then rows name vertices by place here. "
        "Of a world those of body b are points[first_point[b]:first_point[b + 1]]; a body without any names its "
        "vertices."
    )
    first_point = int64("(bodies + 1,) int64: where each body's listed points begin in `points`.")
    vertex_edge_bodies = int32("(k, 2) int32, of a world: the vertex's body and the edge's.", (2,))
    vertex_vertex_bodies = int32("(k, 2) int32, of a world: the body of each of the two vertices.", (2,))


class FeatureResult(PairLists):
    """Base of Impacts and Proximities."""

    _write: ClassVar[Callable[..., None]]
    _outputs: ClassVar[tuple[str, ...]]
    _from: ClassVar[dict[str, int]]  # what is made from which of `_outputs` on; all else is made for the last

    def _check_output(self, name: str) -> None:
        if name in _NOT_IN_BLOCKS and self._request.block:
            raise InvalidInput(f"{name} is part of a whole result, but this is one of its blocks")
        least = self._from.get(name, len(self._outputs) - 1)
        if self._outputs.index(self._request.output) < least:
            self._refuse(name, f'output="{self._outputs[least]}"')

    def _check(self, name: str) -> None:
        request = self._request
        if name in _OF_THE_WHOLE and request.scene == "part":
            raise InvalidInput(
                f"{name} is part of the result of a whole mesh, but the scene is a part, which has edge_ids"
            )
        if name.endswith("_bodies") and not request.of_bodies:
            raise InvalidInput(f"{name} are for worlds, but the scene is one mesh")
        if _is_index(name) and request.of_bodies:
            raise InvalidInput(f"{name} is for one mesh, but the scene is a world")
        self._check_output(name)
        if _is_index(name) and "index" not in request.options:
            self._refuse(name, "index=True")

    vertex_edges = int32(
        "(k, 2) int32: each a vertex and one of `edges` that is of no face, sorted; see docs/motion.md.", (2,)
    )
    vertex_vertices = int32("(k, 2) int32: each two vertices of no face and no edge, sorted.", (2,))
    vertex_offsets = int64(
        "(vertices + 1,), with `index`: rows of vertex v: vertex_faces[vertex_offsets[v]:vertex_offsets[v + 1]]."
    )
    face_offsets = int64(
        "(faces + 1,), with `index`: rows of face f: vertex_faces[by_face[face_offsets[f]:face_offsets[f + 1]]]."
    )
    by_face = int64("(k,) int64, with `index`: positions in `vertex_faces`, sorted by face, then by vertex.")
    edge_offsets = int64(
        "(n + 1,), with `index`: rows whose lower edge is e: edge_edges[edge_offsets[e]:edge_offsets[e + 1]]."
    )
    second_edge_offsets = int64("(n + 1,), with `index`: the same for the higher edge, as ranges of `by_second_edge`.")
    by_second_edge = int64(
        "(k,) int64, with `index`: positions in `edge_edges`, sorted by the higher edge, then by the lower."
    )
    vertex_edge_offsets = int64("(vertices + 1,), with `index`: as vertex_offsets, of `vertex_edges`.")
    edge_vertex_offsets = int64("(n + 1,), with `index`: rows of edge e, as ranges of `by_edge`.")
    by_edge = int64("(k,) int64, with `index`: positions in `vertex_edges`, sorted by edge, then by vertex.")
    vertex_vertex_offsets = int64("(vertices + 1,), with `index`: rows whose first vertex is v, of `vertex_vertices`.")
    second_vertex_offsets = int64(
        "(vertices + 1,), with `index`: the same for the second vertex, as ranges of `by_second_vertex`."
    )
    by_second_vertex = int64(
        "(k,) int64, with `index`: positions in `vertex_vertices`, sorted by the second vertex, then by the first."
    )
    world_hit = bools('(worlds,) bool: in which worlds there is anything. From output="any_by_world" on.')

    def save(self, path: str | os.PathLike[str], mesh: Any = None) -> None:
        """Writes a file of the kind that its extension names.

        - .txt, .csv, .json, .npz: the lists; of worlds ids are body:id in .txt and .csv
        - .glb: the `mesh` of the scene, its triangles coloured by time or by distance, the darkest first

        A file appears when it is complete; the old one stays until then. Ctrl-C waits until the file is written. Raises
        InvalidInput for other extensions, for results that list no pairs, and for a mesh that does not fit; FileError.
        """
        self._check_output("what save writes")
        if self._request.scene == "part":
            raise InvalidInput("a result of a part is not saved: files name edges by their vertices, all of the mesh")
        name = file_name(path)
        extension = extension_of(name)
        if extension == ".glb" and mesh is None:
            raise InvalidType(f"{name}: a coloured mesh needs the mesh: save(path, mesh)")
        if extension != ".glb" and mesh is not None:
            raise InvalidType(f"mesh is no option of {extension} files")
        if extension == ".glb" and self._request.of_bodies:
            raise InvalidInput(f"{name}: a result about one mesh is saved as .glb, but the scene is a world")
        if extension not in (".txt", ".csv", ".json", ".npz", ".glb"):
            raise InvalidInput(f"{name}: a result is saved as .txt, .csv, .json, .npz (lists) or .glb (coloured mesh)")
        type(self)._write(path, self, None if mesh is None else as_mesh(mesh))

    def _description(self, found: str) -> str:
        """What __repr__ says."""
        listed = self._found
        if self._request.output == self._outputs[-1]:
            faces, edges = len(listed.vertex_faces), len(listed.edge_edges)
            found = f"{listed.count} {found}, {faces} of vertex and face, {edges} of edge and edge"
            for pairs, kind in ((listed.vertex_edges, "edge"), (listed.vertex_vertices, "vertex")):
                found += f", {len(pairs)} of vertex and {kind}" if len(pairs) else ""
        return f"<crumple.{type(self).__name__}: {found}, {self.statistics.milliseconds:.3g} ms>"


class FirstImpact(NamedTuple):
    """The first impact of a step: that of least time as rounded, then the first in the order of the result.

    Attributes:
        kind: "vertex_face", "edge_edge", "vertex_edge" or "vertex_vertex".
        pair: as a row of Impacts.vertex_faces, edge_edges, vertex_edges or vertex_vertices.
        bodies: of a world, the bodies of the pair; else None.
        toi: first time of contact in [0, 1], rounded down.
        start: whether they touch at the start.
    """

    kind: Literal["vertex_face", "edge_edge", "vertex_edge", "vertex_vertex"]
    pair: tuple[int, int]
    bodies: tuple[int, int] | None
    toi: float
    start: bool


class FreeStep(NamedTuple):
    """A share of a step that is free.

    Attributes:
        share: 0 to 1, the least of all; 1: the whole step is free; 0: contact is at the start, or too near.
        positions: (n, 3), of the precision of the mesh: start + s (end - start) with the share s of the vertex, body or
            world, rounded. Of a world body by body, as they are posed, in float64.
        first: the first impact of the uncut step; None: there is none.
        intersecting: with `triangle_pairs`, the first two triangles that intersect at the start; else None.
        intersecting_bodies: of a world or two meshes, their bodies; else None.
        vertex_shares: (n,) float64, with held="vertices": the share of each vertex; else None.
        body_shares: (bodies,) float64: of a world or two meshes the share of each body, unless vertices are held; else
            None.
        first_vertex: (bodies + 1,) int64: rows of body b in `positions` are first_vertex[b] to first_vertex[b + 1]; of
            a mesh None.
    """

    share: float
    positions: NDArray[Any]
    first: FirstImpact | None = None
    intersecting: tuple[int, int] | None = None
    intersecting_bodies: tuple[int, int] | None = None
    vertex_shares: NDArray[Any] | None = None
    body_shares: NDArray[Any] | None = None
    first_vertex: NDArray[Any] | None = None


class Impacts(FeatureResult):
    """What touches what on its way, and when, as much as `output` requested: the same bytes wherever it is computed.

    Two lists, of vertices with faces and of edges with edges, sorted and unique; of worlds by body before vertex, face
    or edge. Where edges or points are listed two more, of what no face and no edge covers: vertices with edges of no
    face, and vertices with vertices of neither. A time is in [0, 1], the exact one rounded down: toi <= exact < next
    number.

    It is true if anything touches; `len(impacts)` is the number of impacts.
    """

    _query = "ImpactQuery"
    _write = staticmethod(_core.write_impacts)
    _outputs = ("any", "any_by_world", "first", "pairs")
    _from: ClassVar = {"world_hit": 1, **dict.fromkeys(("first", "world_first", *_OF_THE_WHOLE), 2)}

    vertex_face_toi = float64("(k,) float64: when vertex and face first touch.")
    vertex_face_start = bools(
        "(k,) bool: whether they touch at the start; then toi is 0. It may be 0 for a later contact as well."
    )
    edge_edge_toi = float64("(k,) float64: when the two edges first touch.")
    edge_edge_start = bools("(k,) bool: whether they touch at the start.")
    vertex_edge_toi = float64("(k,) float64: when vertex and edge first touch.")
    vertex_edge_start = bools("(k,) bool: whether they touch at the start.")
    vertex_vertex_toi = float64("(k,) float64: when the two vertices first touch.")
    vertex_vertex_start = bools("(k,) bool: whether they touch at the start.")
    triangle_pairs = int32(
        "(k, 2) int32, with `triangle_pairs`: triangles, a < b, sorted; of worlds within their bodies.", (2,)
    )
    triangle_pair_bodies = int32("(k, 2) int32: of a world, the bodies of the two triangles.", (2,))
    triangle_pair_toi = float64(
        "(k,) float64: when any of their features first touch; 0 where they intersect at the start."
    )
    triangle_pair_start = bools("(k,) bool: whether they intersect, or some features touch, at the start.")
    triangle_offsets = int64("(faces + 1,), with `index`: rows whose first triangle is t, of `triangle_pairs`.")
    second_triangle_offsets = int64(
        "(faces + 1,), with `index`: the same for the second triangle, as ranges of `by_second_triangle`."
    )
    by_second_triangle = int64(
        "(k,) int64, with `index`: positions in `triangle_pairs`, sorted by the second triangle, then by the first."
    )

    def _check(self, name: str) -> None:
        if "triangle" in name:
            self._check_output(name)
            if "triangle_pairs" not in self._request.options:
                self._refuse(name, "triangle_pairs=True")
        super()._check(name)

    def _first(self, given: Any) -> FirstImpact | None:
        if given is None:
            return None
        first = FirstImpact(*given)
        return first if self._request.of_bodies else first._replace(bodies=None)

    @property
    def first(self) -> FirstImpact | None:
        """The first impact, of all worlds; None: the step is free. From output="first" on."""
        self._check_output("first")
        return self._first(self._found.first)

    @property
    def world_first(self) -> list[FirstImpact | None]:
        """The first impact of each world. From output="first" on."""
        self._check_output("world_first")
        return [self._first(first) for first in self._found.world_first]

    def __repr__(self) -> str:
        output, found = self._request.output, self._found
        if output in ("any", "any_by_world"):
            return self._description("something touches" if found.any else "nothing touches")
        if output == "first":
            return self._description(f"first at {found.first[3]:.6g}" if found.first else "nothing touches")
        return self._description("impacts" if found.count != 1 else "impact")


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

    vertex_face_squared_distance = float64("(k,) float64: the squared distance of vertex and face.")
    vertex_face_touching = bools(
        "(k,) bool: whether their distance is 0 exactly. A squared distance may also be rounded to 0."
    )
    edge_edge_squared_distance = float64("(k,) float64: the squared distance of the two edges.")
    edge_edge_touching = bools("(k,) bool: whether their distance is 0 exactly.")

    def _check(self, name: str) -> None:
        if name in _LEAST and self._request.of_bodies:
            raise InvalidInput(f"{name} is for one mesh, but the scene is a world")
        super()._check(name)
        for option, names in (("closest", _CLOSEST), ("least", _LEAST)):
            if name in names and option not in self._request.options:
                self._refuse(name, f"{option}=True")

    vertex_face_type = uint8("(k,) uint8, with `closest`: a VertexFaceType each.")
    vertex_face_at = float64(
        "(k, 2), with `closest`: (u, v) of the face's point a + u (b - a) + v (c - a) that is closest, rounded.", (2,)
    )
    edge_edge_type = uint8("(k,) uint8, with `closest`: an EdgeEdgeType each.")
    edge_edge_at = float64(
        "(k, 2), with `closest`: (s, t) of the edges' points a + s (b - a) and c + t (d - c), rounded.", (2,)
    )
    vertex_edge_squared_distance = float64("(k,) float64: the squared distance of vertex and edge.")
    vertex_edge_touching = bools("(k,) bool: whether their distance is 0 exactly.")
    vertex_vertex_squared_distance = float64("(k,) float64: the squared distance of the two vertices.")
    vertex_vertex_touching = bools("(k,) bool: whether their distance is 0 exactly.")
    vertex_edge_type = uint8("(k,) uint8, with `closest`: a VertexEdgeType each.")
    vertex_edge_at = float64("(k, 2), with `closest`: (s, 0) of the edge's point a + s (b - a), rounded.", (2,))
    vertex_vertex_type = uint8("(k,) uint8, with `closest`: a VertexVertexType each, 0.")
    vertex_vertex_at = float64("(k, 2), with `closest`: zeros.", (2,))
    vertex_distance = float64(
        "(vertices,), with `least`: each one's least distance, over the pairs listed; rounded down; or infinite. Of "
        "listed points in their order."
    )
    face_distance = float64("(faces,), with `least`: the same of each face.")
    edge_distance = float64("(n,), with `least`: the same of each of `edges`.")

    def __repr__(self) -> str:
        found = "pairs" if self._found.count != 1 else "pair"
        if self._request.output != "pairs":
            found = "something is near" if self._found.any else "nothing is near"
        return self._description(found)
