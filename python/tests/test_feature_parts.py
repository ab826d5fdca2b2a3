"""Tests of parts of meshes: impacts and proximities of all parts together are the whole result."""

import pickle

import numpy as np
import pytest

import crumple
from conftest import soup
from features import CLOSEST, LISTS

MESH = soup(60, size=0.4, dtype=np.float64)
MOVED = MESH.vertices + 0.2 * np.random.default_rng(1).normal(size=MESH.vertices.shape)
GROUPS = np.arange(60, dtype=np.int32) % 3
HAIR = np.random.default_rng(2).normal(size=(40, 3))
SEGMENTS = np.stack([np.arange(39), np.arange(1, 40)], axis=1)

# Members of queries: first those that the parts are made for, then those that may differ when parts are searched. The
# search of the whole mesh uses both.
MOTION = {
    "impacts": ({}, {}),
    "separated": ({"min_distance": 0.05, "weld": True}, {}),
    "a share": ({"min_distance_share": 0.5}, {}),
    "groups": ({}, {"filter": crumple.PairFilter(groups="between", excluded_groups=[(0, 1)])}),
}
NEAR = {
    "pairs": ({"radius": 0.1}, {"closest": True}),
    "rings": ({"radius": 0.2, "rings": 1}, {"strict": True}),
    "radii": ({"radii": np.linspace(0, 0.1, len(MESH.vertices))}, {}),
    "at rest": ({"radius": 0.2, "rest": MOVED}, {"rest_radius": 0.1}),
}


def sorted_rows(results, pairs, names):
    """Returns the rows of all results together, in the order of the result of the whole mesh."""
    joined = {name: np.concatenate([getattr(result, name) for result in results]) for name in (pairs, *names)}
    order = np.lexsort((joined[pairs][:, 1], joined[pairs][:, 0]))
    return {name: array[order] for name, array in joined.items()}


def assert_union(results, whole, more=()):
    names = [*LISTS[type(whole).__name__], *more]
    for kind, pairs in (
        ("vertex_face", "vertex_faces"),
        ("edge_edge", "edge_edges"),
        ("vertex_edge", "vertex_edges"),
        ("vertex_vertex", "vertex_vertices"),
    ):
        of_kind = [name for name in names if name.startswith(f"{kind}_")]
        for name, array in sorted_rows(results, pairs, of_kind).items():
            np.testing.assert_array_equal(array, getattr(whole, name), name, strict=True)
    assert sum(len(result) for result in results) == len(whole) > 0
    assert any(result.any for result in results)


@pytest.mark.parametrize("name", MOTION)
def test_parts_together_have_the_impacts_of_the_mesh(name, either):
    made, asked = MOTION[name]
    mesh = MESH._replace(groups=GROUPS)
    whole = either.impacts(mesh, MOVED, **made, **asked)
    parts = either.partition(mesh.moving_to(MOVED), crumple.ImpactQuery(**made), count=5)
    assert [part.index for part in parts] == list(range(5))
    results = [either.impacts(pickle.loads(pickle.dumps(part)), **made, **asked) for part in parts]
    assert_union(results, whole)
    first = min((result.first for result in results if result), key=lambda f: (f.toi, f.kind != "vertex_face", f.pair))
    assert first == whole.first
    firsts = [either.first_impact(part, **made, **asked) for part in parts]
    assert min(first.toi for first in firsts if first is not None) == whole.first.toi
    query = crumple.ImpactQuery(**made, **asked)
    assert [either.any(part, query) for part in parts] == [bool(result) for result in results]


@pytest.mark.parametrize("name", NEAR)
def test_parts_together_have_the_near_pairs_of_the_mesh(name, either):
    made, asked = NEAR[name]
    whole = either.proximities(MESH, **made, **asked)
    parts = either.partition(MESH, crumple.ProximityQuery(**made), count=5)
    again = {key: value for key, value in made.items() if key not in ("radii", "rest")}
    results = [either.proximities(pickle.loads(pickle.dumps(part)), **again, **asked) for part in parts]
    assert_union(results, whole, CLOSEST if "closest" in asked else ())


def test_parts_of_rods_and_particles_have_all_near_pairs(either):
    mesh = crumple.Mesh(HAIR, [], edges=SEGMENTS[::3], points=np.arange(39, -1, -1))
    query = crumple.ProximityQuery(radius=0.5)
    whole = either.find(mesh, query)
    assert_union([either.find(part, query) for part in either.partition(mesh, query, count=4)], whole)
    assert len(whole.vertex_edges)


def test_parts_keep_their_vertices_and_ids_if_the_mesh_is_overwritten(either):
    mesh, moved = soup(60, size=0.4, dtype=np.float64), MOVED.copy()
    whole = either.impacts(mesh, moved)
    parts = either.partition(mesh.moving_to(moved), crumple.ImpactQuery(), count=3)
    vertices = mesh.vertices.copy()
    mesh.vertices[:] = moved[:] = 0
    assert_union([either.impacts(part) for part in parts], whole)
    for part in parts:
        np.testing.assert_array_equal(part.mesh[0], vertices[part.vertex_ids])
        assert len(part.edge_ids) == len(set(part.edge_ids)) > 0
        assert len(part.point_ids) == 0 and not part.has_radii
    assert sorted(np.concatenate([part.edge_ids for part in parts]).tolist())[-1] == len(whole.edges) - 1
    plain = either.partition(MESH, count=2)[0]
    assert plain.vertex_ids is plain.edge_ids is plain.point_ids is None


def test_result_of_a_part_has_no_edge_list_and_cannot_be_saved(either, tmp_path):
    part = either.partition(MESH.moving_to(MOVED), crumple.ImpactQuery(), count=2)[0]
    result = either.impacts(part, index=True)
    for name in ("edges", "first_edge", "points", "first_point"):
        with pytest.raises(
            crumple.InvalidInput, match=f"^{name} is part of the result of a whole mesh, but the scene is a part"
        ):
            getattr(result, name)
    with pytest.raises(crumple.InvalidInput, match="a result of a part cannot be saved"):
        result.save(tmp_path / "part.txt")
    assert len(result.vertex_offsets) == len(part.vertex_ids) + 1
    for copied in (pickle.loads(pickle.dumps(result)), result):
        np.testing.assert_array_equal(copied.edge_edges, result.edge_edges)
        np.testing.assert_array_equal(copied.edge_offsets, result.edge_offsets)


def test_part_refuses_queries_it_was_not_made_for(either):
    step = MESH.moving_to(MOVED)
    moving = either.partition(step, crumple.ImpactQuery(min_distance=0.1), count=2)[0]
    at_rest = either.partition(MESH, crumple.ProximityQuery(radius=0.1), count=2)[0]
    plain = either.partition(MESH, count=2)[0]
    for message, call in {
        "min_distance and min_distance_share must be at most": lambda: either.impacts(moving, min_distance=0.2),
        "weld must be as in the query that the part was made for": lambda: either.impacts(moving, weld=True),
        "the part was made for a query about motion": lambda: either.proximities(moving, radius=0.1),
        "the part was made for a query about nearness": lambda: either.impacts(at_rest),
        "radius must be at most that of the query": lambda: either.proximities(at_rest, radius=0.2),
        "the part was not made for a query about features": lambda: either.proximities(plain, radius=0.2),
        "the part was made for a query about features": lambda: either.find(moving),
        "the number of parts must be 1 to 262144": lambda: either.partition(step, crumple.ImpactQuery(), count=0),
    }.items():
        with pytest.raises(crumple.InvalidInput, match=message):
            call()
    with pytest.raises(crumple.InvalidType, match="a ProximityQuery needs a radius"):
        either.proximities(at_rest)
    for of_the_mesh in ({"radii": np.ones(len(MESH.vertices))}, {"radius": 0.1, "rest": MOVED}):
        with pytest.raises(crumple.InvalidInput, match="radii and rest are for .* parts, have their own"):
            either.proximities(at_rest, **of_the_mesh)


def test_inconsistent_pickled_part_is_refused():
    part = crumple.Detector(backend="reference").partition(MESH, crumple.ProximityQuery(radius=0.1), count=2)[0]
    state = list(part.__getstate__())
    for name, value in (("owned", state[5]["owned"].astype(np.int64)), ("edges_of", state[5]["owned"]), ("faces", "3")):
        with pytest.raises(crumple.InvalidType, match=f"the state of a Part's features needs {name}"):
            crumple.Part.__new__(crumple.Part).__setstate__((*state[:5], {**state[5], name: value}))
    lacking = {key: value for key, value in state[5].items() if key != "ring"}
    with pytest.raises(crumple.InvalidType, match="needs ring"):
        crumple.Part.__new__(crumple.Part).__setstate__((*state[:5], lacking))
    broken = {**state[5], "owned": state[5]["owned"][1:].copy()}
    bad = crumple.Part.__new__(crumple.Part)
    bad.__setstate__((*state[:5], broken))
    with pytest.raises(crumple.InvalidInput, match="owned and edges_of must have an entry"):
        crumple.Detector(backend="reference").proximities(bad, radius=0.1)
