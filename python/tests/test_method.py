"""Tests of variants of the method: sweep directions, membership rules, and the clusters of a search."""

import pickle

import numpy as np
import pytest

import crumple
from crumple import FuzzyCMeans, Method

# Two triangles whose tips cross, far from both of their centroids, which are the centres of the two clusters.
CROSS = (
    np.array([[-2, -0.1, 0], [-2, 0.1, 0], [0.25, 0, 0], [2, 0, -0.1], [2, 0, 0.1], [-0.25, 0, 0]]),
    np.array([[0, 1, 2], [3, 4, 5]]),
)


def detector(method=Method(), **options):
    means = FuzzyCMeans(max_iterations=0, first_iterations=0)
    return crumple.Detector(backend="cpu", clusters=2, fuzzy_c_means=means, method=method, **options)


def sheet(n=40):
    """A sheet of 2 n^2 triangles that folds through itself."""
    u, v = np.meshgrid(np.linspace(0, 1, n + 1), np.linspace(0, 1, n + 1), indexing="ij")
    vertices = np.stack([u + 0.3 * np.sin(17 * v), v, 0.2 * np.sin(11 * u) * np.cos(5 * v)], -1).reshape(-1, 3)
    a = (np.arange(n)[:, None] * (n + 1) + np.arange(n)).ravel()
    faces = np.concatenate([np.stack([a, a + 1, a + n + 2], -1), np.stack([a, a + n + 2, a + n + 1], -1)])
    return vertices, faces


def test_membership_that_loses_a_pair_says_so():
    whole = detector().intersections(CROSS)
    assert whole.pairs.tolist() == [[0, 1]] and whole.statistics.complete is True
    for method in (Method(membership="equation_5"), Method(membership="threshold", threshold=1)):
        found = detector(method).intersections(CROSS)
        assert len(found.pairs) == 0 and found.statistics.complete is False
        assert not detector(method).proximities(CROSS, radius=0.01).statistics.complete
        copy = pickle.loads(pickle.dumps(found.statistics))
        assert copy == found.statistics and copy.complete is False
    low = detector(Method(membership="threshold", threshold=0)).intersections(CROSS)
    assert low.pairs.tolist() == [[0, 1]] and low.statistics.complete


def test_queries_that_cannot_say_that_pairs_may_be_missing_are_refused():
    by = detector(Method(membership="equation_5"))
    with pytest.raises(crumple.InvalidInput, match="membership rule ball"):
        by.any(CROSS)
    with pytest.raises(crumple.InvalidInput, match="membership rule ball"):
        by.find(CROSS, crumple.OverlapQuery())
    assert not by.supports(CROSS, crumple.OverlapQuery()) and by.supports(CROSS)


def test_methods_are_values():
    method = Method(sweep=[1, 2, 3], membership="threshold", threshold=0.25)
    assert method.sweep == (1, 2, 3) and pickle.loads(pickle.dumps(method)) == method
    assert repr(method) == "crumple.Method(sweep=(1, 2, 3), membership='threshold', threshold=0.25)"
    assert method != Method() and detector(method).options["method"] == method


def test_clusters_are_those_of_the_next_search():
    mesh = sheet()
    by = crumple.Detector(backend="cpu", clusters=4, leaf_size=200)
    for _ in range(2):
        found = by.cluster(mesh)
        statistics = by.intersections(mesh).statistics
        assert len(found.centres) == statistics.clusters == 4
        assert len(found.leaf_cluster) == statistics.leaves
        assert len(found.members) == statistics.members
    assert repr(found) == f"<crumple.Clustering: 4 clusters, {len(found.axes)} leaves of {len(mesh[1])} triangles>"


def test_arrays_of_a_clustering_fit_together():
    vertices, faces = sheet()
    found = crumple.Detector(backend="cpu", clusters=4, leaf_size=200).cluster([(vertices, faces), (vertices, faces)])
    triangles, leaves = 2 * len(faces), len(found.leaf_cluster)
    assert found.offsets.shape == (triangles + 1,) and found.offsets[-1] == len(found.clusters)
    assert found.leaf_offsets.shape == (leaves + 1,) and found.leaf_offsets[-1] == len(found.members)
    assert found.axes.shape == (leaves, 3, 3) and found.leaf_centres.shape == (leaves, 3)
    np.testing.assert_allclose(found.axes @ found.axes.transpose(0, 2, 1), np.tile(np.eye(3), (leaves, 1, 1)), atol=1e-6)
    centroids = np.tile(vertices[faces].mean(1), (2, 1))
    distances = np.linalg.norm(centroids[:, None] - found.centres, axis=-1)
    np.testing.assert_array_equal(found.nearest_cluster, distances.argmin(1))
    np.testing.assert_array_equal(found.leaf_cluster[found.nearest_leaf], found.nearest_cluster)
    copy = pickle.loads(pickle.dumps(found))
    np.testing.assert_array_equal(copy.members, found.members)
    assert copy.complete is True


def test_clusters_of_other_scenes_and_backends_are_refused():
    mesh = sheet(3)
    with pytest.raises(crumple.InvalidInput, match="^clusters need the cpu backend"):
        crumple.Detector(backend="reference").cluster(mesh)
    with pytest.raises(crumple.InvalidInput, match="^only the clusters of one mesh or two meshes"):
        crumple.Detector(backend="cpu").cluster(crumple.World([crumple.Shape(*mesh)]))
