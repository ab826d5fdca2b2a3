"""The result of a CandidateQuery."""

from __future__ import annotations

import os
from functools import cached_property
from typing import TYPE_CHECKING

from . import _core
from ._errors import InvalidInput
from ._features import PairLists
from ._result import extension_of, file_name
from ._versions import refuse as _restore  # noqa: F401

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

#: The list of each kind.
LISTS = {
    "vertex_face": "vertex_faces",
    "edge_edge": "edge_edges",
    "edge_face": "edge_faces",
    "face_face": "face_faces",
    "vertex_edge": "vertex_edges",
    "vertex_vertex": "vertex_vertices",
}
_KIND_OF = {name: kind for kind, name in LISTS.items()} | {f"{kind}_bodies": kind for kind in LISTS}


class Candidates(PairLists):
    """Which features have boxes that overlap, of the requested kinds: the same bytes wherever it is computed.

    A list for each kind, sorted and unique; of worlds by body before vertex, edge or face. IPC Toolkit's face-vertex,
    edge-face and edge-vertex candidates are `vertex_faces`, `edge_faces` and `vertex_edges` here.

    It is true if it lists anything; `len(candidates)` is the number of all.
    """

    _query = "CandidateQuery"

    def _check(self, name: str) -> None:
        kind = _KIND_OF.get(name)
        if name.endswith("_bodies") and not self._request.of_bodies:
            raise InvalidInput(f"{name} are for worlds, but the scene is one mesh")
        if kind is not None and kind not in self._request.kinds:
            self._refuse(name, f'kinds=["{kind}"]')

    @cached_property
    def edge_faces(self) -> NDArray[np.int32]:
        """(k, 2) int32: each one of `edges` and a face without a common vertex."""
        return self._array("edge_faces")

    @cached_property
    def face_faces(self) -> NDArray[np.int32]:
        """(k, 2) int32: each two faces without a common vertex, the lower first."""
        return self._array("face_faces")

    @cached_property
    def vertex_edges(self) -> NDArray[np.int32]:
        """(k, 2) int32: each a vertex and one of `edges` that does not name it."""
        return self._array("vertex_edges")

    @cached_property
    def vertex_vertices(self) -> NDArray[np.int32]:
        """(k, 2) int32: each two vertices, the lower first."""
        return self._array("vertex_vertices")

    @cached_property
    def edge_face_bodies(self) -> NDArray[np.int32]:
        """(k, 2) int32, of a world: the edge's body and the face's."""
        return self._array("edge_face_bodies")

    @cached_property
    def face_face_bodies(self) -> NDArray[np.int32]:
        """(k, 2) int32, of a world: the body of each of the two faces."""
        return self._array("face_face_bodies")

    @property
    def kinds(self) -> tuple[str, ...]:
        """The requested kinds."""
        return self._request.kinds

    def __bool__(self) -> bool:
        """True if anything is listed."""
        return self._found.count > 0

    def save(self, path: str | os.PathLike[str]) -> None:
        """Writes the lists that were requested as .txt, .csv, .json or .npz, by extension (docs/feature_lists.md).

        Edges are named by their vertices in .txt and .csv; of worlds ids are body:id there. A file appears when it is
        complete; the old one stays until then. Ctrl-C waits until the file is written. Raises InvalidInput for other
        extensions; FileError.
        """
        name = file_name(path)
        if extension_of(name) not in (".txt", ".csv", ".json", ".npz"):
            raise InvalidInput(f"{name}: candidates are saved as .txt, .csv, .json or .npz")
        _core.write_candidates(path, self)

    def __repr__(self) -> str:
        of = ", ".join(f"{len(getattr(self._found, LISTS[kind]))} {kind}" for kind in self.kinds)
        found = "candidates" if self.count != 1 else "candidate"
        return f"<crumple.Candidates: {self.count} {found}, {of}, {self.statistics.milliseconds:.3g} ms>"
