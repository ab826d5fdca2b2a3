"""Tests of codimensional edges and points: rods, hair, particles, and meshes with lists of their own."""

import copy
import json
import pickle

import numpy as np
import pytest

import crumple
from conftest import OnDevice, soup, toi_of
from features import END, FACES, START, assert_same

LINE = np.array([[x, 0, 0] for x in range(5)], np.float64)


def test_near_pairs_of_particles_have_exact_distances(either):
    found = either.proximities(LINE, points=[3, 0, 2], radius=2, closest=True, least=True, index=True)
    assert found.vertex_vertices.tolist() == [[0, 2], [1, 2]] and found.points.tolist() == [3, 0, 2]
    assert found.vertex_vertex_squared_distance.tolist() == [1, 4] and found.first_point.tolist() == [0, 3]
    assert found.vertex_vertex_touching.tolist() == [False, False] and found.vertex_distance.tolist() == [1, 2, 1]
    assert found.vertex_vertex_type.tolist() == [crumple.VertexVertexType.P_P] * 2
    assert found.vertex_vertex_at.tolist() == [[0, 0]] * 2 and found.vertex_vertex_offsets.tolist() == [0, 1, 2, 2]
    assert found.by_second_vertex.tolist() == [0, 1] and found.second_vertex_offsets.tolist() == [0, 0, 0, 2]
    assert "2 pairs, 0 of vertex and face, 0 of edge and edge, 2 of vertex and vertex" in repr(found)
    assert not either.proximities(LINE, [], radius=9) and not either.proximities(LINE, points=[], radius=9)


def test_point_that_moves_into_two_rods_has_an_impact_with_each(either):
    end = LINE.copy()
    end[4] = [0.5, 0, 0]
    found = either.impacts(LINE, end, edges=[[1, 0], [1, 2]], points=np.array([4, 2]), index=True)
    assert found.vertex_edges.tolist() == [[0, 0], [0, 1]] and found.edges.tolist() == [[1, 0], [1, 2]]
    assert found.vertex_edge_start.tolist() == [False, False] and (np.diff(found.vertex_edge_toi) < 0).all()
    assert found.first == ("vertex_edge", (0, 1), None, found.vertex_edge_toi[1], False)
    assert found.by_edge.tolist() == [0, 1] and found.edge_vertex_offsets.tolist() == [0, 1, 2]
    assert found.vertex_edge_offsets.tolist() == [0, 2, 2]
    assert toi_of(either.first_impact(LINE, end, edges=[[1, 0], [1, 2]], points=[4])) == found.first.toi
    rods = crumple.Mesh(LINE, [], end=end, edges=[[1, 0], [1, 2]])
    assert not either.any(rods, crumple.ImpactQuery()), "the last vertex is on no edge"
    step = either.free_step(LINE, end, edges=[[1, 0], [1, 2]], points=[4])
    assert 0.5 < step.share < found.first.toi and step.positions.shape == (5, 3)
    near = either.proximities(LINE, edges=[[1, 0]], points=[2], radius=1, closest=True)
    assert near.vertex_edge_type.tolist() == [crumple.VertexEdgeType.P_E0] and near.vertex_edge_at.tolist() == [[0, 0]]


@pytest.mark.parametrize("dtype", [np.int32, np.int64, np.uint8, ">i4"])
def test_listing_the_edges_and_vertices_of_a_mesh_changes_no_near_pairs(dtype, either):
    mesh = soup(14, size=0.5, dtype=np.float64)
    plain = either.proximities(mesh, radius=0.1)
    edges = plain.edges.astype(dtype)
    listed = either.proximities(mesh, edges=edges, points=np.arange(len(mesh.vertices), dtype=dtype), radius=0.1)
    assert plain and listed.count == plain.count and not len(listed.vertex_edges)
    np.testing.assert_array_equal(listed.vertex_faces, plain.vertex_faces)
    np.testing.assert_array_equal(listed.edge_edges, plain.edge_edges)
    turned = either.proximities(mesh, edges=np.asfortranarray(edges[::-1]), radius=0.1)
    assert sorted(map(tuple, np.sort(len(edges) - 1 - turned.edge_edges).tolist())) == list(
        map(tuple, plain.edge_edges.tolist())
    )


def test_touching_points_of_two_bodies_of_a_world_are_a_near_pair(either):
    strand = crumple.Shape(LINE, edges=[[0, 1], [3, 4]], points=[2, 0])
    world = crumple.World(
        [strand, crumple.Shape(START, FACES, end=END)], [0, 0, 1], poses=poses_at([0, 0, 9]), self_collisions=True
    )
    found = either.proximities(world, radius=0.5, filter=crumple.PairFilter(bodies="between"))
    assert found.points.tolist() == [2, 0, 2, 0] and found.first_point.tolist() == [0, 2, 4, 4]
    assert found.first_edge.tolist() == [0, 2, 4, 10]
    assert found.vertex_vertices.tolist() == [[0, 0]] and found.vertex_vertex_bodies.tolist() == [[0, 1]]
    assert found.vertex_vertex_touching.tolist() == [True]
    for again in (pickle.loads(pickle.dumps(world)), copy.deepcopy(world)):
        assert_same(either.proximities(again, radius=0.5, filter=crumple.PairFilter(bodies="between")), found)
        np.testing.assert_array_equal(again.shapes[0].edges, strand.edges)
    assert strand.points == [2, 0] and world.shapes[1].edges is None


def poses_at(places):
    poses = np.tile(np.eye(3, 4), (len(places), 1, 1))
    poses[:, 2, 3] = places
    return poses


def test_files_hold_pairs_of_codimensional_features(detector, tmp_path):
    found = detector.proximities(LINE, edges=[[1, 0]], points=[3, 2, 4], radius=1)
    again = pickle.loads(pickle.dumps(found))
    for answer in (found, again):
        answer.save(tmp_path / "near.txt")
        assert (tmp_path / "near.txt").read_text() == "ve 2 0 1 1\nvv 2 3 1\nvv 3 4 1\n"
        answer.save(tmp_path / "near.json")
        lists = json.loads((tmp_path / "near.json").read_text())
        assert lists["vertex_vertices"] == [[3, 2], [3, 4]] and lists["vertex_edges"] == [[2, 0]]
        answer.save(tmp_path / "near.npz")
        with np.load(tmp_path / "near.npz") as arrays:
            assert arrays["vertex_edge_squared_distance"].tolist() == [1]
    first = detector.impacts(LINE, LINE[::-1].copy(), points=[0, 4])
    pickle.loads(pickle.dumps(first)).save(tmp_path / "impacts.json")
    earliest = json.loads((tmp_path / "impacts.json").read_text())["earliest"]
    assert earliest == {"kind": "vertex_vertex", "pair": [0, 4], "toi": 0.5, "start": 0}


@pytest.mark.parametrize(
    "lists, message",
    [
        ({"edges": [[0, 1], [2, 2]]}, "^edge 1 has vertex 2 at both ends$"),
        ({"edges": [[0, 5]]}, "^edge 0 names vertex 5 of 5$"),
        ({"points": [0, -1]}, "^point 1 names vertex -1 of 5$"),
        ({"edges": [0, 1]}, r"^edges must have shape \(n, 2\), not \(2,\)$"),
        ({"edges": [[0, 1.5]]}, "^edges must be integers, not float64$"),
        ({"edges": [[0, 2**40]]}, "^edges: vertex 1099511627776 at 0 does not fit int32$"),
        ({"points": [[0, 1]]}, r"^points must have shape \(n,\), indices of vertices, not \(1, 2\)$"),
        ({"points": OnDevice(np.arange(2))}, "^points in CUDA memory must be"),
    ],
)
def test_wrong_edges_and_points_are_refused(lists, message, either):
    for ask in (
        lambda: either.proximities(LINE, radius=1, **lists),
        lambda: either.impacts(LINE, LINE, **lists),
        lambda: either.free_step(LINE, LINE, **lists),
    ):
        with pytest.raises(crumple.InvalidInput, match=message):
            ask()


def test_error_names_the_wrong_edge_or_point(detector):
    with pytest.raises(crumple.InvalidInput) as caught:
        detector.proximities(LINE, edges=[[0, 1], [3, 3]], radius=1)
    assert (caught.value.element, caught.value.index) == ("edge", 1)
    world = crumple.World([crumple.Shape(LINE, points=[7])], names=["dust"], self_collisions=True)
    with pytest.raises(crumple.InvalidInput, match=r"body 0 \('dust'\): point 0 names vertex 7 of 5"):
        detector.proximities(world, radius=1)
