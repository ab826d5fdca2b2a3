"""Clustering: the clusters and leaves into which a search divides a scene."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray


@dataclass(frozen=True, eq=False, kw_only=True)
class Clustering:
    """Clusters and leaves into which a search divides a scene (Detector.cluster), for researchers.

    The scene is divided into clusters, and large clusters into leaves; a cluster that is not divided is a leaf. Clusters
    and leaves overlap. There are k clusters, l leaves and m triangles; those of a second mesh follow those of the first.
    Positions are in the coordinates of the scene. A plain value, which can be pickled.

    Attributes
    ----------
    centres : (k, 3) ndarray of float64
        Centres of the clusters.
    offsets : (m + 1,) ndarray of int64
        Clusters of triangle t: clusters[offsets[t]:offsets[t + 1]], ascending. None for triangles that the search leaves
        out: those of two meshes that are far from the other mesh, and copies of degenerate triangles.
    clusters : (n,) ndarray of int32
        Clusters of all triangles.
    nearest_cluster : (m,) ndarray of int32
        That of a triangle's clusters whose centre is nearest to its centroid, or -1.
    leaf_cluster : (l,) ndarray of int32
        Cluster that the leaf is or lies in; ascending.
    leaf_centres : (l, 3) ndarray of float64
        Centres of the leaves.
    axes : (l, 3, 3) ndarray of float64
        Axes of each leaf's frame, in rows of length 1; the first is the sweep direction. All 0 for a leaf of fewer than
        two triangles, which is not swept.
    leaf_offsets : (l + 1,) ndarray of int64
        Triangles of a leaf: members[leaf_offsets[i]:leaf_offsets[i + 1]], ascending.
    members : (n,) ndarray of int32
        Triangles of all leaves.
    nearest_leaf : (m,) ndarray of int32
        That leaf of the triangle's nearest cluster whose centre is nearest to its centroid, or -1.
    complete : bool
        As `complete` of Statistics: False if pairs may be lost.
    """

    centres: NDArray[np.float64]
    offsets: NDArray[np.int64]
    clusters: NDArray[np.int32]
    nearest_cluster: NDArray[np.int32]
    leaf_cluster: NDArray[np.int32]
    leaf_centres: NDArray[np.float64]
    axes: NDArray[np.float64]
    leaf_offsets: NDArray[np.int64]
    members: NDArray[np.int32]
    nearest_leaf: NDArray[np.int32]
    complete: bool

    def __repr__(self) -> str:
        return (
            f"<crumple.Clustering: {len(self.centres)} clusters, {len(self.leaf_cluster)} leaves of "
            f"{len(self.nearest_cluster)} triangles>"
        )
