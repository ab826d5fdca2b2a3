"""Stencils: near pairs and impacts in the form that solvers need."""

from __future__ import annotations

from dataclasses import dataclass, replace
from enum import IntEnum
from typing import TYPE_CHECKING, Any

from . import _core
from ._errors import InvalidInput, InvalidType, name_of_type, suggesting
from ._features import FeatureResult, Impacts
from ._scene import scene_of

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

_OF_ROWS = ("vertices", "weights", "normals", "distance", "normal_from", "type")
_KINDS = ("vertex_face", "edge_edge", "vertex_edge", "vertex_vertex")


class NormalFrom(IntEnum):
    """Origin of the normal of a stencil.

    NONE: there is no direction, the normal is 0. APART: the features are apart; from the nearest point of the second
    one to that of the first. BEFORE: they touch; perpendicular to both, on the side where the first one was before.
    REST: they touch; perpendicular to both, on the side where the first one is in the rest shape.
    """

    NONE = 0
    APART = 1
    BEFORE = 2
    REST = 3


@dataclass(frozen=True, eq=False, repr=False)
class Stencils:
    """Result of stencils: n rows, one for each pair of features or, with `reduced`, for several equal ones.

    `len(stencils)` is n.

    With x the positions of the vertices, (weights[i, :, None] * x[vertices[i]]).sum(axis=0) is the vector from the
    nearest point of the second feature to that of the first, up to rounding. Its length is the distance. The derivative
    of the distance by vertex k is weights[i, k] * normals[i].

    Attributes
    ----------
    vertices : (n, 4) ndarray of int32
        The vertices of the first feature, then those of the second: vertex and face, edge and edge, vertex and edge, or
        two vertices. The last vertex is repeated, with weight 0, if there are fewer than four. For worlds and two
        meshes, vertex v of body b is first_vertex[b] + v.
    weights : (n, 4) ndarray of float64
        Barycentric coordinates of the nearest points: sum 1 over the first feature, -1 over the second. Rounded;
        exactly 0 for vertices outside of the closest parts.
    normals : (n, 3) ndarray of float64
        Unit vectors from the second feature to the first; 0 if there is no direction.
    distance : (n,) ndarray of float64
        Distances, rounded.
    normal_from : (n,) ndarray of uint8
        NormalFrom of each row.
    type : (n,) ndarray of uint8
        Closest parts of the features of the row: a VertexFaceType, EdgeEdgeType, VertexEdgeType or VertexVertexType.
    first : (5,) ndarray of int64
        Rows of kind k are [first[k], first[k + 1]), in the order vertex_face, edge_edge, vertex_edge, vertex_vertex.
        They have the order of the lists, such as vertex_faces; with `reduced` they are sorted by their vertices.
    multiplicity : (n,) ndarray of int32
        With `reduced`: number of pairs that a row replaces. Otherwise empty.
    row_of_pair : (k,) ndarray of int64
        With `reduced`: row of each pair, for the pairs of all lists, one list after the other. Otherwise empty.
    first_vertex : (bodies + 1,) ndarray of int64
        For worlds and two meshes: body b has the vertices [first_vertex[b], first_vertex[b + 1]).
    """

    vertices: NDArray[np.int32]
    weights: NDArray[np.float64]
    normals: NDArray[np.float64]
    distance: NDArray[np.float64]
    normal_from: NDArray[np.uint8]
    type: NDArray[np.uint8]
    first: NDArray[np.int64]
    multiplicity: NDArray[np.int32]
    row_of_pair: NDArray[np.int64]
    first_vertex: NDArray[np.int64]

    def __len__(self) -> int:
        """Number of rows."""
        return len(self.distance)

    def __repr__(self) -> str:
        kinds = ", ".join(f"{self.first[k + 1] - self.first[k]} {kind}" for k, kind in enumerate(_KINDS))
        return f"<crumple.Stencils: {len(self)} rows ({kinds})>"

    def rows(self, kind: str) -> slice:
        """Returns the rows of a kind, such as "vertex_face".

        Raises
        ------
        InvalidInput
            If there is no such kind.
        """
        if kind not in _KINDS:
            raise InvalidInput(f"kind must be one of {', '.join(_KINDS)}, not {kind!r}")
        k = _KINDS.index(kind)
        return slice(int(self.first[k]), int(self.first[k + 1]))

    def select(self, mask: Any) -> Stencils:
        """Returns the rows for which `mask` is True, for example those that are active.

        Parameters
        ----------
        mask : (n,) array_like of bool

        Returns
        -------
        Stencils
            Without `row_of_pair`.
        """
        import numpy as np

        mask = np.asarray(mask, bool)
        rows = np.flatnonzero(mask)
        arrays = {name: getattr(self, name)[rows] for name in _OF_ROWS}
        if len(self.multiplicity):
            arrays["multiplicity"] = self.multiplicity[rows]
        first = np.searchsorted(rows, self.first)
        return replace(self, **arrays, first=first, row_of_pair=self.row_of_pair[:0])

    def vectors(self, x: Any) -> NDArray[np.float64]:
        """Returns the sum of weights times the rows of `x` that belong to the vertices.

        Parameters
        ----------
        x : (vertices, 3) array_like
            Positions, or velocities, of all vertices, for example at another time than that of the pairs.

        Returns
        -------
        (n, 3) ndarray of float64
            For positions, the vectors between the points of the features that were nearest.

        Raises
        ------
        InvalidInput
            If `x` does not have three columns, or lacks a row.
        """
        import numpy as np

        x = np.asarray(x)
        if x.ndim != 2 or x.shape[1] != 3:
            raise InvalidInput(f"x must have shape (vertices, 3), not {x.shape}")
        self._check_count(len(x), "the number of rows of x")
        return np.einsum("kc,kcx->kx", self.weights, x[self.vertices])

    def scatter(self, vectors: Any, vertices: int) -> NDArray[np.float64]:
        """Returns the sum of weights times `vectors` for each vertex: the transpose of `vectors`.

        Parameters
        ----------
        vectors : (n, 3) array_like
            One vector per row, such as the derivative of an energy by the distance, times the normal.
        vertices : int
            Number of all vertices.

        Returns
        -------
        (vertices, 3) ndarray of float64
            Summed in the order of the rows.

        Raises
        ------
        InvalidInput
            If `vectors` does not have shape (n, 3), or `vertices` is too small.
        """
        import numpy as np

        vectors = np.asarray(vectors)
        if vectors.shape != (len(self), 3):
            raise InvalidInput(f"vectors must have shape ({len(self)}, 3), not {vectors.shape}")
        self._check_count(vertices, "vertices")
        parts = self.weights[:, :, None] * vectors[:, None, :]
        names = self.vertices.ravel()
        return np.stack([np.bincount(names, parts[..., axis].ravel(), vertices) for axis in range(3)], axis=1)

    def _check_count(self, count: int, name: str) -> None:
        most = self.vertices.max(initial=-1)
        if count <= most:
            raise InvalidInput(f"{name} must be above the largest index, {most}, not {count}")


def _positions(given: Any, name: str) -> NDArray[np.float64] | None:
    import numpy as np

    from ._arrays import host_array

    if given is None:
        return None
    array = host_array(given, name)
    if array.ndim != 2 or array.shape[1] != 3 or array.dtype.kind not in "fiu":
        raise InvalidInput(f"{name} must be (vertices, 3) float64 or float32, not {array.shape} {array.dtype}")
    return np.ascontiguousarray(array, np.float64)


@suggesting
def stencils(
    scene: Any,
    found: FeatureResult,
    *,
    before: Any = None,
    rest: Any = None,
    reduced: bool = False,
    parallel: float = 0.0,
    threads: int = 0,
) -> Stencils:
    """Returns the stencils of near pairs or impacts: for each pair its vertices, weights, normal and distance.

    Near pairs are taken at the positions at which they were found, and impacts at their times.

    Parameters
    ----------
    scene : scene
        Scene of the query, in host memory: a mesh or (vertices, faces), a list of two meshes, or a World. For Impacts
        it moves: Mesh(start, faces).moving_to(end).
    found : Proximities or Impacts
        Result that lists pairs. Proximities with closest=True save half of the work here.
    before : (vertices, 3) array_like of float64 or float32, optional
        Earlier positions of all vertices, for the normals of pairs that touch. For worlds and two meshes: posed, body
        after body.
    rest : (vertices, 3) array_like of float64 or float32, optional
        Rest shape, in the form of `before`. Its orientation decides where `before` does not. Also the lengths of edges
        for `parallel`; None: those of the scene.
    reduced : bool, default False
        If True, replaces each pair by its closest parts, and merges equal rows, as IPC (Li et al. 2020) does.
    parallel : float, default 0
        With `reduced`: two edges e and f stay a pair of edges if |e x f|**2 < parallel * |e'|**2 * |f'|**2, where e'
        and f' are the edges in the rest shape. The mollifier of IPC needs 1e-3.
    threads : int, default 0
        Number of threads; 0: as many as the machine has.

    Returns
    -------
    Stencils

    Raises
    ------
    InvalidInput
        If the result lists no pairs or does not fit the scene, the scene is a part or in device memory, or an argument
        is invalid.

    Notes
    -----
    The bytes are the same for every backend and number of threads. Ctrl-C waits for the result. Cost per pair: about
    0.2 us, without `closest` 0.4 us; `reduced`, which sorts the pairs, adds 0.2 us. docs/nearness.md describes signs,
    and normals of pairs that touch.
    """
    if not isinstance(found, FeatureResult):
        raise InvalidType(f"found must be crumple.Proximities or crumple.Impacts, not {name_of_type(type(found))}")
    found._check_output("the list that stencils read")
    if found._request.scene == "part":
        raise InvalidInput("stencils are for results of whole scenes, but the scene of this result is a part")
    call = _core.stencils_of_impacts if isinstance(found, Impacts) else _core.stencils_of_proximities
    options = (_positions(before, "before"), _positions(rest, "rest"), reduced, parallel, threads)
    return Stencils(*call(scene_of(scene), found, *options))
