"""What results about pairs of features have in common: Impacts, Proximities and Candidates."""

from __future__ import annotations

import os
from collections.abc import Callable
from functools import cached_property
from typing import TYPE_CHECKING, Any, ClassVar

from ._errors import InvalidInput, InvalidType
from ._mesh import as_mesh
from ._result import Result, extension_of, file_name

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

_INDEX = (
    *("vertex_offsets", "face_offsets", "by_face"),
    *("edge_offsets", "second_edge_offsets", "by_second_edge"),
    *("vertex_edge_offsets", "edge_vertex_offsets", "by_edge"),
    *("vertex_vertex_offsets", "second_vertex_offsets", "by_second_vertex"),
    *("triangle_offsets", "second_triangle_offsets", "by_second_triangle"),
)
_OF_THE_WHOLE = ("edges", "first_edge", "points", "first_point")
_NOT_IN_BLOCKS = ("world_hit", "first", "world_first")
_BODIES = (
    *("vertex_face_bodies", "edge_edge_bodies", "vertex_edge_bodies", "vertex_vertex_bodies"),
    "triangle_pair_bodies",
)


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

    @cached_property
    def vertex_faces(self) -> NDArray[np.int32]:
        """(k, 2) int32: each a vertex and a face that does not name it, sorted; of worlds within their bodies."""
        return self._array("vertex_faces")

    @cached_property
    def vertex_face_bodies(self) -> NDArray[np.int32]:
        """(k, 2) int32, of a world: the vertex's body and the face's."""
        return self._array("vertex_face_bodies")

    @cached_property
    def edge_edges(self) -> NDArray[np.int32]:
        """(k, 2) int32: each two of `edges` without a common vertex, sorted; of worlds within their bodies."""
        return self._array("edge_edges")

    @cached_property
    def edge_edge_bodies(self) -> NDArray[np.int32]:
        """(k, 2) int32, of a world: the body of each of the two edges."""
        return self._array("edge_edge_bodies")

    @cached_property
    def edges(self) -> NDArray[np.int32]:
        """(n, 2) int32: the vertices of each edge, the lower first; each edge once, in lexicographic order.

        Or as they were listed (`edges`).
        Of a world those of body b are edges[first_edge[b]:first_edge[b + 1]], and an edge counts within its body.
        """
        return self._array("edges")

    @cached_property
    def first_edge(self) -> NDArray[np.int64]:
        """(bodies + 1,) int64: where each body's edges begin in `edges`; one mesh is one body."""
        return self._array("first_edge")

    @cached_property
    def points(self) -> NDArray[np.int32]:
        """(n,) int32: the vertices that were listed as points, in their order; then rows name vertices by place here.

        Of a world those of body b are points[first_point[b]:first_point[b + 1]]; a body without any names its vertices.
        """
        return self._array("points")

    @cached_property
    def first_point(self) -> NDArray[np.int64]:
        """(bodies + 1,) int64: where each body's listed points begin in `points`."""
        return self._array("first_point")

    @cached_property
    def vertex_edge_bodies(self) -> NDArray[np.int32]:
        """(k, 2) int32, of a world: the vertex's body and the edge's."""
        return self._array("vertex_edge_bodies")

    @cached_property
    def vertex_vertex_bodies(self) -> NDArray[np.int32]:
        """(k, 2) int32, of a world: the body of each of the two vertices."""
        return self._array("vertex_vertex_bodies")


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
        if name in _BODIES and not request.of_bodies:
            raise InvalidInput(f"{name} are for worlds, but the scene is one mesh")
        if name in _INDEX and request.of_bodies:
            raise InvalidInput(f"{name} is for one mesh, but the scene is a world")
        self._check_output(name)
        if name in _INDEX and "index" not in request.options:
            self._refuse(name, "index=True")

    @cached_property
    def vertex_edges(self) -> NDArray[np.int32]:
        """(k, 2) int32: each a vertex and one of `edges` that is of no face, sorted; see docs/motion.md."""
        return self._array("vertex_edges")

    @cached_property
    def vertex_vertices(self) -> NDArray[np.int32]:
        """(k, 2) int32: each two vertices of no face and no edge, sorted."""
        return self._array("vertex_vertices")

    @cached_property
    def vertex_offsets(self) -> NDArray[np.int64]:
        """(vertices + 1,), with `index`: rows of vertex v: vertex_faces[vertex_offsets[v]:vertex_offsets[v + 1]]."""
        return self._array("vertex_offsets")

    @cached_property
    def face_offsets(self) -> NDArray[np.int64]:
        """(faces + 1,), with `index`: rows of face f: vertex_faces[by_face[face_offsets[f]:face_offsets[f + 1]]]."""
        return self._array("face_offsets")

    @cached_property
    def by_face(self) -> NDArray[np.int64]:
        """(k,) int64, with `index`: positions in `vertex_faces`, sorted by face, then by vertex."""
        return self._array("by_face")

    @cached_property
    def edge_offsets(self) -> NDArray[np.int64]:
        """(n + 1,), with `index`: rows whose lower edge is e: edge_edges[edge_offsets[e]:edge_offsets[e + 1]]."""
        return self._array("edge_offsets")

    @cached_property
    def second_edge_offsets(self) -> NDArray[np.int64]:
        """(n + 1,), with `index`: the same for the higher edge, as ranges of `by_second_edge`."""
        return self._array("second_edge_offsets")

    @cached_property
    def by_second_edge(self) -> NDArray[np.int64]:
        """(k,) int64, with `index`: positions in `edge_edges`, sorted by the higher edge, then by the lower."""
        return self._array("by_second_edge")

    @cached_property
    def vertex_edge_offsets(self) -> NDArray[np.int64]:
        """(vertices + 1,), with `index`: as vertex_offsets, of `vertex_edges`."""
        return self._array("vertex_edge_offsets")

    @cached_property
    def edge_vertex_offsets(self) -> NDArray[np.int64]:
        """(n + 1,), with `index`: rows of edge e, as ranges of `by_edge`."""
        return self._array("edge_vertex_offsets")

    @cached_property
    def by_edge(self) -> NDArray[np.int64]:
        """(k,) int64, with `index`: positions in `vertex_edges`, sorted by edge, then by vertex."""
        return self._array("by_edge")

    @cached_property
    def vertex_vertex_offsets(self) -> NDArray[np.int64]:
        """(vertices + 1,), with `index`: rows whose first vertex is v, of `vertex_vertices`."""
        return self._array("vertex_vertex_offsets")

    @cached_property
    def second_vertex_offsets(self) -> NDArray[np.int64]:
        """(vertices + 1,), with `index`: the same for the second vertex, as ranges of `by_second_vertex`."""
        return self._array("second_vertex_offsets")

    @cached_property
    def by_second_vertex(self) -> NDArray[np.int64]:
        """(k,) int64, with `index`: positions in `vertex_vertices`, sorted by the second vertex, then by the first."""
        return self._array("by_second_vertex")

    @cached_property
    def world_hit(self) -> NDArray[np.bool_]:
        """(worlds,) bool: in which worlds there is anything. From output="any_by_world" on."""
        return self._array("world_hit")

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
