"""Detector.find_candidates, of one mesh and of worlds, and its answer."""

from __future__ import annotations

import os
from collections.abc import Iterable
from functools import cached_property
from typing import TYPE_CHECKING, Any, Literal, overload

from . import _core
from ._core import Statistics
from ._errors import InvalidInput, InvalidType
from ._feature_question import or_of_world
from ._mesh import listing_of
from ._pair_lists import PairLists
from ._result import extension_of, file_name
from ._world_search import excluded_in, with_names

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray
    from typing_extensions import Self

    from ._detector import Detector, GroupPairs, Wanted
    from ._world import World

CandidateKind = Literal["vertex_face", "edge_edge", "edge_face", "face_face", "vertex_edge", "vertex_vertex"]

# The list of each kind.
_LISTS = {
    "vertex_face": "vertex_faces",
    "edge_edge": "edge_edges",
    "edge_face": "edge_faces",
    "face_face": "face_faces",
    "vertex_edge": "vertex_edges",
    "vertex_vertex": "vertex_vertices",
}
_KIND_OF = {name: kind for kind, name in _LISTS.items()} | {f"{kind}_bodies": kind for kind in _LISTS}


class Candidates(PairLists):
    """Which features have boxes that overlap, of the kinds that were asked for: the same bytes wherever it is computed.

    A list for each kind, sorted and unique; of worlds by body before vertex, edge or face. IPC Toolkit's face-vertex,
    edge-face and edge-vertex candidates are `vertex_faces`, `edge_faces` and `vertex_edges` here.

    An answer is true if it lists anything; `len(candidates)` is the number of all. A kind that was not asked for is an
    InvalidInput that says how to ask. It outlives its detector, and no later call changes it. Its arrays are read-only
    views of the library's memory that keep that memory alive, or with `copy=True` writable arrays of their own. It can
    be copied and pickled: copy.copy shares the arrays, copy.deepcopy does not.
    """

    def _check_listed(self, name: str) -> None:
        answer, kind = self._answer, _KIND_OF.get(name)
        if name.endswith("_bodies") and not answer.of_world:
            raise InvalidInput(f"{name} are those of a world, but this was asked of one mesh")
        if kind is not None and kind not in answer.kinds:
            raise InvalidInput(f'{name} was not asked for: find_candidates(..., kinds=["{kind}"])')

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
        """What was asked for."""
        return self._answer.kinds

    @property
    def count(self) -> int:
        """How many candidates are listed, of all kinds."""
        return self._answer.count

    def __bool__(self) -> bool:
        """Whether anything is listed."""
        return self._answer.count > 0

    def save(self, path: str | os.PathLike[str]) -> None:
        """Writes the lists that were asked for as .txt, .csv, .json or .npz, by extension (docs/feature_lists.md).

        Edges are named by their vertices in .txt and .csv; of worlds ids are body:id there. A file appears when it is
        complete; the old one stays until then. Ctrl-C waits until the file is written. Raises InvalidInput for other
        extensions; FileError.
        """
        name = file_name(path)
        if extension_of(name) not in (".txt", ".csv", ".json", ".npz"):
            raise InvalidInput(f"{name}: candidates are saved as .txt, .csv, .json or .npz")
        _core.write_candidates(path, self._answer)

    def __repr__(self) -> str:
        of = ", ".join(f"{len(getattr(self._answer, _LISTS[kind]))} {kind}" for kind in self.kinds)
        found = "candidates" if self.count != 1 else "candidate"
        return f"<crumple.Candidates: {self.count} {found}, {of}, {self.statistics.milliseconds:.3g} ms>"

    def __reduce__(self) -> Any:
        return _restore, (_stored(self._answer),)

    def __deepcopy__(self, memo: dict[int, Any]) -> Self:
        return type(self)(_StoredAnswer(_stored(self._answer)))


class _StoredAnswer:
    """An answer in arrays of its own, where _core.CandidatesAnswer has the library's."""

    def __init__(self, state: dict[str, Any]) -> None:
        self.__dict__.update(state)


_PLAIN = {"kinds": tuple, "of_world": bool, "copy": bool, "count": int, "statistics": Statistics}
_ARRAYS = [*_KIND_OF, "edges", "first_edge", "points", "first_point"]


def _stored(answer: Any) -> dict[str, Any]:
    """A copy that shares nothing."""
    state = {name: getattr(answer, name) for name in _PLAIN}
    for name in _ARRAYS:
        state[name] = getattr(answer, name).copy()
        state[name].flags.writeable = False
    return state


def _restore(state: Any) -> Candidates:
    """Raises InvalidType and InvalidInput for what no Candidates can have given."""
    import numpy as np

    if not isinstance(state, dict) or state.keys() != {*_PLAIN, *_ARRAYS}:
        raise InvalidType(f"the state of Candidates must be a dict of {', '.join(sorted([*_PLAIN, *_ARRAYS]))}")
    for name, wanted in _PLAIN.items():
        if not isinstance(state[name], wanted):
            raise InvalidType(f"the state of Candidates needs {name} as {wanted.__name__}")
    made = {name: _restored(state[name], name) for name in _ARRAYS}
    answer = _StoredAnswer({**state, **made})
    first, edges, points = answer.first_edge, answer.edges, answer.points
    fits = len(first) == len(answer.first_point) and (len(first) == 2 or (answer.of_world and len(first) > 0))
    for offsets, listed in ((first, edges), (answer.first_point, points)):
        fits = fits and offsets[0] == 0 and offsets[-1] == len(listed) and bool((np.diff(offsets) >= 0).all())
    fits = fits and bool((edges >= 0).all() and (edges[:, 0] != edges[:, 1]).all() and (points >= 0).all())
    if not fits or not set(answer.kinds) <= set(_LISTS):
        raise InvalidInput("the state of Candidates does not fit together: edges, points or kinds")
    for kind, name in _LISTS.items():
        pairs, bodies = made[name], made[f"{kind}_bodies"]
        asked = kind in answer.kinds or not len(pairs)
        if not asked or (pairs < 0).any() or len(bodies) != (len(pairs) if answer.of_world else 0):
            raise InvalidInput(f"the state of Candidates does not fit together: {name}")
        if not ((bodies >= 0) & (bodies < len(first) - 1)).all():
            raise InvalidInput(f"the state of Candidates does not fit together: {kind}_bodies")
        of = bodies if answer.of_world else np.zeros_like(pairs)
        for column, feature in enumerate(kind.split("_")):
            if feature == "edge" and not (pairs[:, column] < np.diff(first)[of[:, column]]).all():
                raise InvalidInput(f"the state of Candidates does not fit together: {name} and edges")
    if answer.count != sum(len(made[name]) for name in _LISTS.values()):
        raise InvalidInput("the state of Candidates does not fit together: count")
    return Candidates(answer)


def _restored(array: Any, name: str) -> np.ndarray:
    import numpy as np

    dtype = np.int64 if name.startswith("first_") else np.int32
    columns = () if name in ("first_edge", "points", "first_point") else (2,)
    if not isinstance(array, np.ndarray) or array.dtype.newbyteorder("=") != dtype or array.shape[1:] != columns:
        shape = "n" if not columns else "n, 2"
        raise InvalidType(f"the state of Candidates needs {name} as an array ({shape}) of {np.dtype(dtype)}")
    array = np.array(array, dtype, order="C")
    array.flags.writeable = False
    return array


def candidate_question(kinds: Any, inflation: Any, weld: Any, rules: Any) -> Any:
    if isinstance(kinds, str):
        kinds = (kinds,)
    try:
        kinds = tuple(kinds)
    except TypeError:
        raise InvalidType(f"kinds must be an iterable of str, not {type(kinds).__name__}") from None
    return _core.CandidateQuestion(kinds, inflation, weld, rules)


def _candidates_in_world(
    self: Detector,
    world: World,
    *,
    kinds: CandidateKind | Iterable[CandidateKind] = ("vertex_face", "edge_edge"),
    inflation: float = 0.0,
    weld: bool = False,
    bodies: Wanted = "both",
    groups: Wanted = "both",
    excluded: Any = None,
    excluded_groups: GroupPairs | None = None,
    poses: Any = None,
    end_poses: Any = None,
    copy: bool = False,
) -> Candidates:
    question = candidate_question(kinds, inflation, weld, _core.rules_of_world(bodies, groups, excluded_groups))
    poses = world.poses if poses is None else poses
    end_poses = world.end_poses if end_poses is None else end_poses
    excluded = excluded_in(world, excluded)
    find = self._find_candidates_in_world
    return Candidates(with_names(world, find, world, poses, end_poses, question, excluded, copy))


@overload
def find_candidates(
    self: Detector,
    vertices: Any,
    faces: Any = None,
    *,
    end: Any = None,
    kinds: CandidateKind | Iterable[CandidateKind] = ("vertex_face", "edge_edge"),
    inflation: float = 0.0,
    weld: bool = False,
    groups: Any = None,
    edges: Any = None,
    points: Any = None,
    wanted: Wanted = "both",
    excluded_groups: GroupPairs | None = None,
    copy: bool = False,
) -> Candidates: ...


@overload
def find_candidates(
    self: Detector,
    world: World,
    /,
    *,
    kinds: CandidateKind | Iterable[CandidateKind] = ("vertex_face", "edge_edge"),
    inflation: float = 0.0,
    weld: bool = False,
    bodies: Wanted = "both",
    groups: Wanted = "both",
    excluded: Any = None,
    excluded_groups: GroupPairs | None = None,
    poses: Any = None,
    end_poses: Any = None,
    copy: bool = False,
) -> Candidates: ...


@or_of_world(_candidates_in_world)
def find_candidates(
    self: Detector,
    vertices: Any,
    faces: Any = None,
    *,
    end: Any = None,
    kinds: CandidateKind | Iterable[CandidateKind] = ("vertex_face", "edge_edge"),
    inflation: float = 0.0,
    weld: bool = False,
    groups: Any = None,
    edges: Any = None,
    points: Any = None,
    wanted: Wanted = "both",
    excluded_groups: GroupPairs | None = None,
    copy: bool = False,
) -> Candidates:
    """Which features have boxes that overlap: the lists that a narrow phase of one's own goes through.

    Of one mesh: find_candidates(vertices, faces), or find_candidates(mesh); with `end` of the way there. A box has the
    axes of the coordinates and holds where the feature's vertices are at the start and at the end. Two features are a
    candidate if they have no vertex in common and on every axis the gap between their boxes is at most twice
    `inflation`, in real numbers: it is a definition, so nothing is missed and nothing is more than that.

    Args:
        vertices: (n, 3) float32 or float64, at the start; or a mesh, and then no `faces`. All arrays on the host, or
            all in CUDA memory, where the cuda backend reads them.
        faces: (m, 3) integers, or flat: three a triangle.
        end: (n, 3): where they are at the end; None: they stay.
        kinds: which lists are made, one name or several: "vertex_face", "edge_edge", "edge_face", "face_face",
            "vertex_edge", "vertex_vertex".
        inflation: by how much each box is grown on all sides, 0 or more, in the units of the coordinates.
        weld: vertices at equal positions at the start and at the end count as one, for "in common".
        groups, edges, points, wanted, excluded_groups, copy: as find_impacts has them; all that is listed takes part.

    Of a world (crumple.World): find_candidates(world), on the way to `end_poses` and to the shapes' `end`.
        bodies, groups, excluded, excluded_groups, poses, end_poses: as find_impacts has them.

    Raises InvalidInput, which names the argument and the place; MemoryLimit.
    More: docs/candidates.md.
    """
    question = candidate_question(kinds, inflation, weld, _core.rules_of_mesh(wanted, excluded_groups))
    mesh = listing_of(vertices, faces, groups, edges, points)
    return Candidates(self._find_candidates(mesh, end, question, copy, (edges, points)))
