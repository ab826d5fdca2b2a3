"""Tests of candidates, features whose boxes overlap, against brute force: meshes, worlds, outputs and options."""

import copy
import itertools
import pickle
from fractions import Fraction

import numpy as np
import pytest

import crumple
from conftest import OnDevice, soup
from features import CANDIDATE_KINDS as KINDS
from features import END, FACES, START

LISTS = dict(zip(KINDS, ("vertex_faces", "edge_edges", "edge_faces", "face_faces", "vertex_edges", "vertex_vertices")))


def assert_same(found, expected):
    for name in (*(LISTS[kind] for kind in expected.kinds), "edges", "first_edge", "points", "first_point"):
        np.testing.assert_array_equal(getattr(found, name), getattr(expected, name), name, strict=True)
    assert (found.count, found.kinds, bool(found)) == (expected.count, expected.kinds, bool(expected))


def by_brute_force(vertices, end, faces, kind, inflation):
    """Returns the candidates by their definition (docs/candidates.md), computed in rational numbers."""
    edges = sorted({tuple(sorted(p)) for f in faces.tolist() for p in itertools.combinations(f, 2) if p[0] != p[1]})
    features = {"vertex": [(v,) for v in sorted(set(faces.ravel().tolist()))], "edge": edges, "face": faces.tolist()}
    index = {"vertex": [v for (v,) in features["vertex"]], "edge": range(len(edges)), "face": range(len(faces))}

    def box(feature):
        at = np.concatenate([vertices[list(feature)], end[list(feature)]])
        return [[Fraction(float(x)) for x in side] for side in (at.min(0), at.max(0))]

    def near(p, q):
        (a, b), (c, d) = box(p), box(q)
        return all(max(c[k] - b[k], a[k] - d[k]) <= 2 * Fraction(inflation) for k in range(3))

    first, second = kind.split("_")
    rows = []
    for i, p in zip(index[first], features[first]):
        for j, q in zip(index[second], features[second]):
            if (first != second or i < j) and not set(p) & set(q) and near(p, q):
                rows.append([i, j])
    return rows


@pytest.mark.parametrize("kind", KINDS)
def test_candidates_match_brute_force(either, kind):
    vertices, faces, _ = soup(24, seed=3)
    end = vertices + np.random.default_rng(1).uniform(-0.1, 0.1, vertices.shape).astype(vertices.dtype)
    for inflation in (0, 0.05):
        found = either.candidates(vertices, faces, end=end, kinds=kind, inflation=inflation)
        assert getattr(found, LISTS[kind]).tolist() == by_brute_force(vertices, end, faces, kind, inflation)
    rest = either.candidates((vertices, faces), kinds=[kind], inflation=0.02)
    assert getattr(rest, LISTS[kind]).tolist() == by_brute_force(vertices, vertices, faces, kind, 0.02)


def test_boxes_one_ulp_too_far_apart_are_not_candidates(either):
    vertices = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [0, 1, 1]], float)
    assert either.candidates(vertices, FACES, inflation=0.5)
    vertices[3:, 2] = np.nextafter(1, 2)
    assert not either.candidates(vertices, FACES, inflation=0.5)
    assert either.candidates(vertices, FACES, inflation=np.nextafter(0.5, 1))


def test_error_explains_how_to_request_a_missing_list():
    found = crumple.Detector().candidates(START, FACES, end=END, kinds=["face_face"])
    assert found.face_faces.tolist() == [[0, 1]] and found.kinds == ("face_face",)
    assert "1 candidate, 1 face_face" in repr(found) and len(found) == 1
    with pytest.raises(crumple.InvalidInput, match=r'CandidateQuery\(kinds=\["edge_edge"\]\)'):
        _ = found.edge_edges
    with pytest.raises(crumple.InvalidInput, match="are for worlds"):
        _ = found.face_face_bodies


def test_arrays_are_read_only_unless_copied():
    detector = crumple.Detector()
    found = detector.candidates(START, FACES, end=END)
    assert found.vertex_faces.dtype == np.int32
    for name in ("vertex_faces", "edge_edges", "edges"):
        assert len(getattr(found, name)) and not getattr(found, name).flags.writeable, name
    kept = found.edge_edges.copy()
    detector.candidates(START, FACES, inflation=9)
    detector.candidates(START, FACES, inflation=8)
    np.testing.assert_array_equal(found.edge_edges, kept)
    copied = detector.candidates(START, FACES, end=END, copy=True)
    assert all(getattr(copied, name).flags.writeable for name in ("vertex_faces", "edge_edges", "edges"))
    assert_same(crumple.candidates(START, FACES, end=END), found)


def test_copied_and_pickled_candidates_equal_the_original():
    found = crumple.candidates(START, FACES, end=END, kinds=KINDS)
    for other in (copy.copy(found), copy.deepcopy(found), pickle.loads(pickle.dumps(found))):
        assert_same(other, found)
    restore, (kind, asked, state) = found.__reduce__()
    of = crumple._results.Request(*asked)
    for name, wrong, error in (
        ("count", 3, crumple.InvalidInput),
        ("edges", state["edges"][:1], crumple.InvalidInput),
        ("edge_edges", state["edge_edges"] + 99, crumple.InvalidInput),
        ("edge_edges", state["edge_edges"].astype(float), crumple.InvalidType),
    ):
        with pytest.raises(error, match="the state of Candidates"):
            restore(kind, asked, {**state, name: wrong})
    for name, wrong, error in (
        ("kinds", ("vertex_face",), crumple.InvalidInput),
        ("of_bodies", 1, crumple.InvalidType),
        ("of_bodies", True, crumple.InvalidInput),
    ):
        with pytest.raises(error, match="the state of Candidates"):
            restore(kind, tuple(of._replace(**{name: wrong})), state)
    with pytest.raises(crumple.InvalidType, match="the state of Candidates"):
        restore(kind, asked, {})


def test_candidates_of_a_world_match_those_of_the_joined_mesh(either):
    vertices, faces, _ = soup(20, seed=5)
    faces = np.sort(faces, axis=1)
    half = len(faces) // 2
    used = [np.unique(f) for f in (faces[:half], faces[half:])]
    parts = [(vertices[u], np.searchsorted(u, f).astype(np.int32)) for u, f in zip(used, (faces[:half], faces[half:]))]
    if set(used[0]) & set(used[1]):
        pytest.skip("the halves share vertices")
    world = crumple.World(parts, names=["a", "b"], self_collisions=True)
    found = either.candidates(world, kinds=KINDS, inflation=0.05)
    whole = either.candidates(vertices, faces, kinds=KINDS, inflation=0.05)
    assert found.count == whole.count and len(found.first_edge) == 3
    start = {"vertex": [0, len(used[0])], "edge": found.first_edge, "face": [0, half]}
    for kind in KINDS:
        first, second = kind.split("_")
        rows = zip(getattr(found, LISTS[kind]).tolist(), getattr(found, f"{kind}_bodies").tolist())
        joined = sorted([a + start[first][p], b + start[second][q]] for (a, b), (p, q) in rows)
        assert joined == getattr(whole, LISTS[kind]).tolist()
    apart = either.candidates(world, kinds="face_face", inflation=0.05, filter=crumple.PairFilter(bodies="between"))
    assert apart.face_face_bodies.tolist() == [[0, 1]] * len(apart)
    assert not either.candidates(world, filter=crumple.PairFilter(excluded_bodies=[{"a", "b"}], bodies="between"))
    moved = either.candidates(world.at(world.poses, np.tile(np.eye(3, 4), (2, 1, 1))), kinds=KINDS, inflation=0.05)
    assert_same(moved, found)


def test_codimensional_edges_and_points_are_candidates(either):
    vertices = np.array([[0, 0, 0], [1, 0, 0], [2, 0, 0], [0, 0.5, 0]], float)
    found = either.candidates(vertices, edges=[[2, 1], [0, 3]], points=[3, 1], kinds=KINDS, inflation=0.5)
    assert found.edges.tolist() == [[2, 1], [0, 3]] and found.points.tolist() == [3, 1]
    assert found.edge_edges.tolist() == [[0, 1]] and found.vertex_vertices.tolist() == [[0, 1]]
    assert found.vertex_edges.tolist() == [[0, 0], [1, 1]] and not len(found.vertex_faces)


@pytest.mark.parametrize(
    "question, message",
    [
        ({"inflation": -1}, "inflation must be finite and 0 or more"),
        ({"inflation": np.nan}, "inflation must be finite and 0 or more"),
        ({"inflation": "1"}, "inflation must be"),
        ({"kinds": []}, "kinds must have at least one kind of candidates"),
        ({"kinds": "face_vertex"}, 'kinds must be one of "vertex_face", '),
        ({"kinds": 3}, "kinds must be an iterable of str, not int"),
        ({"end": END[:3]}, "end"),
        ({"weld": 2}, "weld must be True or False"),
    ],
)
def test_error_names_the_wrong_option(question, message):
    with pytest.raises((crumple.InvalidInput, crumple.InvalidType), match=message):
        crumple.Detector().candidates(START, FACES, **question)
    with pytest.raises(TypeError, match="Did you mean 'inflation'"):
        crumple.Detector().candidates(START, FACES, inflaton=1)


def test_meshes_in_cuda_memory_need_the_cuda_backend():
    with pytest.raises(crumple.InvalidInput, match="CUDA memory"):
        crumple.Detector().candidates(OnDevice(START), OnDevice(FACES))
