"""Tests of decisions about given pairs of features: they must equal those of a search of the whole mesh."""

import functools

import numpy as np
import pytest

import crumple
from conftest import soup

KINDS = {"vertex_face": 4, "edge_edge": 4, "vertex_edge": 3, "vertex_vertex": 2}


def all_pairs(mesh, edges):
    """Returns, for vertex-face and for edge-edge pairs without a common vertex, all pairs and their vertices."""
    vertex, face = np.indices((len(mesh.vertices), len(mesh.faces))).reshape(2, -1)
    apart = (mesh.faces[face] != vertex[:, None]).all(axis=1)
    vertex, face = vertex[apart], face[apart]
    a, b = np.triu_indices(len(edges), 1)
    apart = (edges[a][:, :, None] != edges[b][:, None, :]).all(axis=(1, 2))
    a, b = a[apart], b[apart]
    faces = np.stack([vertex, face], 1), np.column_stack([vertex, mesh.faces[face]])
    return faces, (np.stack([a, b], 1), np.column_stack([edges[a], edges[b]]))


def moved(mesh, dtype=np.float64):
    random = np.random.default_rng(3)
    return (mesh.vertices + 0.3 * (random.random(mesh.vertices.shape) - 0.5)).astype(dtype)


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@pytest.mark.parametrize("question", [{}, {"min_distance": 0.02}, {"min_distance_share": 0.3}])
def test_impacts_of_pairs_match_a_search_of_the_mesh(dtype, question, detector):
    mesh = soup(25, size=0.4, dtype=dtype)
    start, end = mesh.vertices, moved(mesh, dtype)
    expected = detector.impacts(start, end, mesh.faces, **question)
    for kind, (pairs, points) in zip(("vertex_face", "edge_edge"), all_pairs(mesh, expected.edges)):
        find = functools.partial(crumple.pair_impacts, kind)
        found = find(start[points], end[points], **question)
        assert found.hit.any() and not found.hit.all()
        np.testing.assert_array_equal(pairs[found.hit], getattr(expected, f"{kind}s"))
        np.testing.assert_array_equal(found.toi[found.hit], getattr(expected, f"{kind}_toi"), strict=True)
        np.testing.assert_array_equal(found.start[found.hit], getattr(expected, f"{kind}_start"), strict=True)
        assert np.isinf(found.toi[~found.hit]).all() and not found.start[~found.hit].any()
        for threads in (1, 3):
            for one, other in zip(find(start[points], end[points], threads=threads, **question), found):
                np.testing.assert_array_equal(one, other, strict=True)


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_distances_of_pairs_match_a_search_of_the_mesh(dtype, detector):
    mesh = soup(25, size=0.4, dtype=dtype)
    expected = detector.proximities(mesh, radius=0.1, closest=True)
    assert len(expected)
    for kind, (pairs, points) in zip(("vertex_face", "edge_edge"), all_pairs(mesh, expected.edges)):
        find = functools.partial(crumple.pair_distances, kind)
        found = find(mesh.vertices[points])
        listed = {tuple(pair) for pair in getattr(expected, f"{kind}s").tolist()}
        near = np.array([tuple(pair) in listed for pair in pairs.tolist()])
        for name in ("squared_distance", "touching", "type", "at"):
            of_mesh = getattr(expected, f"{kind}_{name}")
            np.testing.assert_array_equal(getattr(found, name)[near], of_mesh, name, strict=True)
        assert found.squared_distance[~near].min() > 0.099**2
        for one, other in zip(find(mesh.vertices[points], threads=1), found):
            np.testing.assert_array_equal(one, other, strict=True)


def told(found):
    return tuple(array.tolist()[0] for array in found)


def test_vertex_edge_pairs_have_exact_impacts_and_distances():
    edge = [[1, -1, 0], [1, 1, 0]]
    start, end = np.array([[[0, 0, 0], *edge]]), np.array([[[2, 0, 0], *edge]])
    assert told(crumple.pair_impacts("vertex_edge", start, end)) == (True, 0.5, False)
    assert told(crumple.pair_impacts("vertex_edge", start, end, min_distance=0.5)) == (True, 0.25, False)
    aside = np.array([[[0, 0, 2.0**-300], *edge]])
    passed = np.array([[[2, 0, 2.0**-300], *edge]])
    assert told(crumple.pair_impacts("vertex_edge", aside, passed)) == (False, np.inf, False)
    assert told(crumple.pair_distances("vertex_edge", start)) == (1, False, 2, [0.5, 0])


def test_vertex_vertex_pairs_have_exact_impacts_and_distances():
    start, end = np.array([[[0, 0, 0], [3, 4, 0]]]), np.array([[[3, 4, 0], [3, 4, 0]]])
    assert told(crumple.pair_impacts("vertex_vertex", start, end)) == (True, 1, False)
    assert told(crumple.pair_impacts("vertex_vertex", start, end, min_distance_share=0.25)) == (True, 0.75, False)
    assert told(crumple.pair_impacts("vertex_vertex", end, start)) == (True, 0, True)
    assert told(crumple.pair_distances("vertex_vertex", start)) == (25, False, 0, [0, 0])


def test_arrays_in_fortran_order_and_lists_give_the_same_impacts():
    random = np.random.default_rng(1)
    start, end = random.random((2, 40, 4, 3)) - 0.5
    expected = crumple.pair_impacts("vertex_face", start, end)
    assert expected.hit.any()
    turned = np.asfortranarray(start), end[:, ::-1].copy()[:, ::-1]
    for one, other in zip(crumple.pair_impacts("vertex_face", *turned), expected):
        np.testing.assert_array_equal(one, other, strict=True)
    for one, other in zip(crumple.pair_impacts("vertex_face", start.tolist(), end.tolist()), expected):
        np.testing.assert_array_equal(one, other, strict=True)
    expected.toi[:] = 2  # results have writable arrays of their own


@pytest.mark.parametrize("kind, points", KINDS.items())
def test_no_pairs_give_empty_arrays(kind, points):
    empty = np.empty((0, points, 3))
    impacts = functools.partial(crumple.pair_impacts, kind)(empty, [])
    assert [(len(a), a.dtype) for a in impacts] == [(0, bool), (0, float), (0, bool)]
    distances = functools.partial(crumple.pair_distances, kind)(empty)
    assert [a.shape for a in distances] == [(0,), (0,), (0,), (0, 2)]


@pytest.mark.parametrize("kind, points", KINDS.items())
def test_errors_name_the_argument_and_the_pair(kind, points):
    impacts, distances = functools.partial(crumple.pair_impacts, kind), functools.partial(crumple.pair_distances, kind)
    good = np.arange(9.0 * points).reshape(3, points, 3)
    bad = good.copy()
    bad[2, 1, 0] = np.nan
    with pytest.raises(crumple.InvalidInput, match="^start: point 1 of pair 2 is not finite$") as caught:
        impacts(bad, good)
    assert caught.value.code == "not_finite"
    with pytest.raises(crumple.InvalidInput, match="^end: point 1 of pair 2 is not finite$"):
        impacts(good, bad)
    with pytest.raises(crumple.InvalidInput, match="^points: point 1 of pair 2 is not finite$"):
        distances(bad)
    shape = rf"must have shape \(pairs, {points}, 3\), not \(3, {points}, 2\)"
    with pytest.raises(crumple.InvalidInput, match=f"^end {shape}"):
        impacts(good, good[:, :, :2])
    with pytest.raises(crumple.InvalidInput, match=f"^points {shape}"):
        distances(good[:, :, :2])
    with pytest.raises(crumple.InvalidInput, match="end must have as many pairs as start, 3, not 2"):
        impacts(good, good[:2])
    with pytest.raises(crumple.InvalidInput, match="points must be float64 or float32, not complex128"):
        distances(good.astype(complex))
    with pytest.raises(crumple.InvalidInput, match="min_distance must be finite and 0 or more"):
        impacts(good, good, min_distance=-1)
    with pytest.raises(crumple.InvalidInput, match="min_distance_share must be 0 or more, and below 1"):
        impacts(good, good, min_distance_share=1)
    for call in (lambda: impacts(good, good, threads=-1), lambda: distances(good, threads=-1)):
        with pytest.raises(crumple.InvalidInput, match="threads must be 0"):
            call()
    with pytest.raises(TypeError, match="Did you mean 'min_distance'"):
        impacts(good, good, min_distence=1)


def test_unknown_kind_is_refused():
    points = np.zeros((1, 4, 3))
    with pytest.raises(crumple.InvalidInput, match="^kind must be one of vertex_face, edge_edge, .*, not 'face_face'$"):
        crumple.pair_impacts("face_face", points, points)
    with pytest.raises(TypeError, match="^kind must be a string, not int$"):
        crumple.pair_distances(0, points)
