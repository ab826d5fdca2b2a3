"""Results about pairs of features: impacts and proximities, and the base class that they share with candidates."""

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

#: Name of the list of each kind of pairs.
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
    """Base class of results that list pairs of features, one list for each kind."""

    @property
    def count(self) -> int:
        """Number of pairs of features that are listed, of all kinds."""
        self._check("count")
        return self._found.count

    def __len__(self) -> int:
        """Number of pairs of features that are listed; 0 if they were not requested."""
        return self._found.count

    vertex_faces = int32(
        "(k, 2) int32: a vertex and a face that does not name it; for worlds, indices within their bodies.", (2,)
    )
    vertex_face_bodies = int32("(k, 2) int32, for worlds and two meshes: bodies of the vertex and the face.", (2,))
    edge_edges = int32(
        "(k, 2) int32: two of `edges` without a common vertex; for worlds, indices within their bodies.", (2,)
    )
    edge_edge_bodies = int32("(k, 2) int32, for worlds and two meshes: bodies of the two edges.", (2,))
    edges = int32(
        "(n, 2) int32: vertices of each edge: the edges of the mesh (Mesh.edges) in their order, or each edge of the "
        "faces once, the lower vertex first, in lexicographic order. For worlds, body b has "
        "edges[first_edge[b]:first_edge[b + 1]], and indices of edges count within the body.",
        (2,),
    )
    first_edge = int64("(bodies + 1,) int64: start of each body's edges in `edges`, and the end; one mesh is one body.")
    points = int32(
        "(n,) int32: the points of the mesh (Mesh.points) in their order; rows then name vertices by their position "
        "here. For worlds, body b has points[first_point[b]:first_point[b + 1]]; rows of a body without points have "
        "indices of its vertices."
    )
    first_point = int64("(bodies + 1,) int64: start of each body's points in `points`, and the end.")
    vertex_edge_bodies = int32("(k, 2) int32, for worlds and two meshes: bodies of the vertex and the edge.", (2,))
    vertex_vertex_bodies = int32("(k, 2) int32, for worlds and two meshes: bodies of the two vertices.", (2,))


class FeatureResult(PairLists):
    """Base class of Impacts and Proximities."""

    _write: ClassVar[Callable[..., None]]
    _outputs: ClassVar[tuple[str, ...]]
    _from: ClassVar[dict[str, int]]  # by attribute: index in `_outputs` from which on it exists; default: the last one

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
        "(k, 2) int32: a vertex and one of `edges` without a face; docs/motion.md lists the exceptions.", (2,)
    )
    vertex_vertices = int32("(k, 2) int32: two vertices that no face and no edge names.", (2,))
    vertex_offsets = int64(
        "(vertices + 1,) int64, with `index`: vertex v has the rows vertex_faces[vertex_offsets[v]:vertex_offsets[v + "
        "1]]."
    )
    face_offsets = int64(
        "(faces + 1,) int64, with `index`: face f has the rows vertex_faces[by_face[face_offsets[f]:face_offsets[f + "
        "1]]]."
    )
    by_face = int64("(k,) int64, with `index`: positions in `vertex_faces`, sorted by face, then vertex.")
    edge_offsets = int64(
        "(n + 1,) int64, with `index`: rows with lower edge e: edge_edges[edge_offsets[e]:edge_offsets[e + 1]]."
    )
    second_edge_offsets = int64("(n + 1,) int64, with `index`: offsets into `by_second_edge`, by higher edge.")
    by_second_edge = int64("(k,) int64, with `index`: positions in `edge_edges`, sorted by higher edge, then lower.")
    vertex_edge_offsets = int64("(vertices + 1,) int64, with `index`: offsets into `vertex_edges`, by vertex.")
    edge_vertex_offsets = int64("(n + 1,) int64, with `index`: offsets into `by_edge`, by edge.")
    by_edge = int64("(k,) int64, with `index`: positions in `vertex_edges`, sorted by edge, then vertex.")
    vertex_vertex_offsets = int64(
        "(vertices + 1,) int64, with `index`: offsets into `vertex_vertices`, by first vertex."
    )
    second_vertex_offsets = int64(
        "(vertices + 1,) int64, with `index`: offsets into `by_second_vertex`, by second vertex."
    )
    by_second_vertex = int64(
        "(k,) int64, with `index`: positions in `vertex_vertices`, sorted by second vertex, then first."
    )
    world_hit = bools(
        '(worlds,) bool: True for worlds in which anything was found. Requires output="any_by_world" or more.'
    )

    def save(self, path: str | os.PathLike[str], mesh: Any = None) -> None:
        """Writes a file of the kind that its extension selects.

        Parameters
        ----------
        path : str or os.PathLike
            File. By extension:

            - .txt, .csv, .json, .npz: the lists; in .txt and .csv, ids of worlds have the form body:id;
            - .glb: the mesh, with triangles coloured by time or by distance: the darkest are the earliest or nearest.
        mesh : mesh, optional
            For .glb, the mesh of the scene.

        Raises
        ------
        InvalidInput
            If the extension is another one, the result lists no pairs, the scene is a part, or the mesh does not fit.
        FileError
            If the file cannot be written.

        Notes
        -----
        The file appears when it is complete; an existing file stays until then. Ctrl-C waits until the file is written.
        """
        self._check_output("the list that save writes")
        if self._request.scene == "part":
            raise InvalidInput(
                "a result of a part cannot be saved: files name edges by their vertices, which it does not have"
            )
        name = file_name(path)
        extension = extension_of(name)
        if extension == ".glb" and mesh is None:
            raise InvalidType(f"{name}: a coloured mesh needs the mesh: save(path, mesh)")
        if extension != ".glb" and mesh is not None:
            raise InvalidType(f"mesh is not an option of {extension} files")
        if extension == ".glb" and self._request.of_bodies:
            raise InvalidInput(f"{name}: only a result about one mesh can be saved as .glb, but the scene is a world")
        if extension not in (".txt", ".csv", ".json", ".npz", ".glb"):
            raise InvalidInput(f"{name}: a result is saved as .txt, .csv, .json, .npz (lists) or .glb (coloured mesh)")
        type(self)._write(path, self, None if mesh is None else as_mesh(mesh))

    def _description(self, found: str) -> str:
        """Returns the text of __repr__. `found` names what was found: "impacts"."""
        listed = self._found
        if self._request.output == self._outputs[-1]:
            faces, edges = len(listed.vertex_faces), len(listed.edge_edges)
            found = f"{listed.count} {found}, {faces} of vertex and face, {edges} of edge and edge"
            for pairs, kind in ((listed.vertex_edges, "edge"), (listed.vertex_vertices, "vertex")):
                found += f", {len(pairs)} of vertex and {kind}" if len(pairs) else ""
        return f"<crumple.{type(self).__name__}: {found}, {self.statistics.milliseconds:.3g} ms>"


class FirstImpact(NamedTuple):
    """First impact of a step: the one with the least rounded time; of several, the first in the order of Impacts.

    Attributes
    ----------
    kind : {"vertex_face", "edge_edge", "vertex_edge", "vertex_vertex"}
        Kind of the two features.
    pair : tuple of int
        The two features, as in a row of Impacts.vertex_faces, edge_edges, vertex_edges or vertex_vertices.
    bodies : tuple of int or None
        For worlds and two meshes, the bodies of the pair.
    toi : float
        First time of contact in [0, 1], rounded down.
    start : bool
        True if the two features touch at the start.
    """

    kind: Literal["vertex_face", "edge_edge", "vertex_edge", "vertex_vertex"]
    pair: tuple[int, int]
    bodies: tuple[int, int] | None
    toi: float
    start: bool


class FreeStep(NamedTuple):
    """Result of a FreeStepQuery.

    Attributes
    ----------
    share : float
        Share of the step that is free, 0 to 1: the smallest of all shares below. 1: the whole step is free. 0:
        something touches at the start, or so early that no free share was found (FreeStepQuery).
    positions : (n, 3) ndarray
        start + s (end - start), rounded to the precision of the mesh, where s is the share of the vertex, of its body
        or of its world (FreeStepQuery.held). For worlds and two meshes: the posed vertices, body after body, in
        float64.
    first : FirstImpact or None
        First impact of the whole step; None if there is none.
    intersecting : tuple of int or None
        With `triangle_pairs`, the first pair of triangles that intersect at the start, if any.
    intersecting_bodies : tuple of int or None
        For worlds and two meshes, the bodies of these triangles.
    vertex_shares : (n,) ndarray of float64 or None
        Share of each vertex, for held="vertices".
    body_shares : (bodies,) ndarray of float64 or None
        Share of each body, for worlds and two meshes, unless held="vertices".
    first_vertex : (bodies + 1,) ndarray of int64 or None
        For worlds and two meshes: body b has the rows first_vertex[b] to first_vertex[b + 1] of `positions`.
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
    """Result of an ImpactQuery: features that touch during a step, and when, as much as `output` requests.

    `bool(impacts)` is True if anything touches, and `len(impacts)` is the number of impacts.

    Notes
    -----
    There are two lists: vertices with faces, and edges with edges. Each pair occurs once. Lists are sorted by first
    feature, then second; for worlds by body before each feature. Meshes with `edges` or `points` have two more lists,
    for features without a face: vertices with edges, and vertices with vertices. Times are in [0, 1], and rounded down:
    toi <= exact time < next float64. Every backend, instruction set and thread count gives the same bytes.
    """

    _query = "ImpactQuery"
    _write = staticmethod(_core.write_impacts)
    _outputs = ("any", "any_by_world", "first", "pairs")
    _from: ClassVar = {"world_hit": 1, **dict.fromkeys(("first", "world_first", *_OF_THE_WHOLE), 2)}

    vertex_face_toi = float64("(k,) float64: first time of contact of vertex and face.")
    vertex_face_start = bools(
        "(k,) bool: True if they touch at the start; then toi is 0. It may also be 0 for a later contact."
    )
    edge_edge_toi = float64("(k,) float64: first time of contact of the two edges.")
    edge_edge_start = bools("(k,) bool: True if they touch at the start.")
    vertex_edge_toi = float64("(k,) float64: first time of contact of vertex and edge.")
    vertex_edge_start = bools("(k,) bool: True if they touch at the start.")
    vertex_vertex_toi = float64("(k,) float64: first time of contact of the two vertices.")
    vertex_vertex_start = bools("(k,) bool: True if they touch at the start.")
    triangle_pairs = int32(
        "(k, 2) int32, with `triangle_pairs`: triangles a < b, sorted; for worlds, indices within their bodies.", (2,)
    )
    triangle_pair_bodies = int32("(k, 2) int32, for worlds and two meshes: bodies of the two triangles.", (2,))
    triangle_pair_toi = float64(
        "(k,) float64: first time of contact of their features; 0 if they intersect at the start."
    )
    triangle_pair_start = bools("(k,) bool: True if they intersect, or features of theirs touch, at the start.")
    triangle_offsets = int64("(faces + 1,) int64, with `index`: offsets into `triangle_pairs`, by first triangle.")
    second_triangle_offsets = int64(
        "(faces + 1,) int64, with `index`: offsets into `by_second_triangle`, by second triangle."
    )
    by_second_triangle = int64(
        "(k,) int64, with `index`: positions in `triangle_pairs`, sorted by second triangle, then first."
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
        """First impact of all worlds; None if there is none. Requires output "first" or "pairs"."""
        self._check_output("first")
        return self._first(self._found.first)

    @property
    def world_first(self) -> list[FirstImpact | None]:
        """First impact of each world, or None if it has none. Requires output "first" or "pairs"."""
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
    """Part of a face that is closest to a vertex. Of several, one of lowest dimension, then the first in this order.

    The names are those of IPC Toolkit. E0 is the side from the face's first corner to the second, E1 from the second to
    the third, E2 from the third to the first.
    """

    P_T0 = 0
    P_T1 = 1
    P_T2 = 2
    P_E0 = 3
    P_E1 = 4
    P_E2 = 5
    P_T = 6


class EdgeEdgeType(IntEnum):
    """Parts of two edges that are closest. Of several, the parts of lowest dimension, then the first in this order.

    The names are those of IPC Toolkit. EA and EB are the two edges; EA0 is the first vertex of EA in `edges`.
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
    """Part of an edge that is closest to a vertex: its first or second vertex in `edges`, or the inside of the edge."""

    P_E0 = 0
    P_E1 = 1
    P_E = 2


class VertexVertexType(IntEnum):
    """Parts of two vertices that are closest: always the vertices."""

    P_P = 0


class Proximities(FeatureResult):
    """Result of a ProximityQuery: features that are near each other, and how near, as much as `output` requests.

    `bool(proximities)` is True if anything is near, and `len(proximities)` is the number of pairs.

    Notes
    -----
    There are two lists: vertices with faces, and edges with edges. Each pair occurs once. Lists are sorted by first
    feature, then second; for worlds by body before each feature. Meshes with `edges` or `points` have two more lists,
    for features without a face: vertices with edges, and vertices with vertices. Squared distances are computed
    exactly, then rounded to the nearest float64; infinite if they overflow. Every backend, instruction set and thread
    count gives the same bytes.
    """

    _query = "ProximityQuery"
    _write = staticmethod(_core.write_proximities)
    _outputs = ("any", "any_by_world", "pairs")
    _from: ClassVar = {"world_hit": 1}

    vertex_face_squared_distance = float64("(k,) float64: squared distance of vertex and face.")
    vertex_face_touching = bools(
        "(k,) bool: True if their distance is 0 exactly. A squared distance may also be rounded to 0."
    )
    edge_edge_squared_distance = float64("(k,) float64: squared distance of the two edges.")
    edge_edge_touching = bools("(k,) bool: True if their distance is 0 exactly.")

    def _check(self, name: str) -> None:
        if name in _LEAST and self._request.of_bodies:
            raise InvalidInput(f"{name} is for one mesh, but the scene is a world")
        super()._check(name)
        for option, names in (("closest", _CLOSEST), ("least", _LEAST)):
            if name in names and option not in self._request.options:
                self._refuse(name, f"{option}=True")

    vertex_face_type = uint8("(k,) uint8, with `closest`: VertexFaceType of each pair.")
    vertex_face_at = float64(
        "(k, 2) float64, with `closest`: (u, v) of the face's closest point a + u (b - a) + v (c - a), rounded.", (2,)
    )
    edge_edge_type = uint8("(k,) uint8, with `closest`: EdgeEdgeType of each pair.")
    edge_edge_at = float64(
        "(k, 2) float64, with `closest`: (s, t) of the edges' closest points a + s (b - a) and c + t (d - c), rounded.",
        (2,),
    )
    vertex_edge_squared_distance = float64("(k,) float64: squared distance of vertex and edge.")
    vertex_edge_touching = bools("(k,) bool: True if their distance is 0 exactly.")
    vertex_vertex_squared_distance = float64("(k,) float64: squared distance of the two vertices.")
    vertex_vertex_touching = bools("(k,) bool: True if their distance is 0 exactly.")
    vertex_edge_type = uint8("(k,) uint8, with `closest`: VertexEdgeType of each pair.")
    vertex_edge_at = float64(
        "(k, 2) float64, with `closest`: (s, 0) of the edge's closest point a + s (b - a), rounded.", (2,)
    )
    vertex_vertex_type = uint8("(k,) uint8, with `closest`: VertexVertexType of each pair, 0.")
    vertex_vertex_at = float64("(k, 2) float64, with `closest`: zeros.", (2,))
    vertex_distance = float64(
        "(vertices,) float64, with `least`: least distance of each vertex in near pairs, including those that `rings` "
        "and `rest` drop, rounded down; infinite if there is none. If the mesh has points, one entry per point."
    )
    face_distance = float64("(faces,) float64, with `least`: least distance of each face, as `vertex_distance`.")
    edge_distance = float64("(n,) float64, with `least`: least distance of each of `edges`, as `vertex_distance`.")

    def __repr__(self) -> str:
        found = "pairs" if self._found.count != 1 else "pair"
        if self._request.output != "pairs":
            found = "something is near" if self._found.any else "nothing is near"
        return self._description(found)
