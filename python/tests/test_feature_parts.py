"""Parts of meshes that are asked about motion and nearness: together they are the whole answer."""

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

# What is asked, of the whole and to make parts; and of the whole and of each part.
MOTION = {
    "impacts": ({}, {}),
    "separated": ({"min_distance": 0.05, "weld": True}, {}),
    "a share": ({"min_distance_share": 0.5}, {}),
    "groups": ({}, {"wanted": "between", "excluded_groups": [(0, 1)]}),
}
NEAR = {
    "pairs": ({"radius": 0.1}, {"closest": True}),
    "rings": ({"radius": 0.2, "rings": 1}, {"strict": True}),
    "radii": ({"radii": np.linspace(0, 0.1, len(MESH.vertices))}, {}),
    "at rest": ({"radius": 0.2, "rest": MOVED}, {"rest_radius": 0.1}),
}


def sorted_rows(answers, pairs, names):
    """Rows of all answers in the order of the whole one."""
    joined = {name: np.concatenate([getattr(answer, name) for answer in answers]) for name in (pairs, *names)}
    order = np.lexsort((joined[pairs][:, 1], joined[pairs][:, 0]))
    return {name: array[order] for name, array in joined.items()}


def assert_union(answers, whole, more=()):
    names = [*LISTS[type(whole).__name__], *more]
    for kind, pairs in (
        ("vertex_face", "vertex_faces"),
        ("edge_edge", "edge_edges"),
        ("vertex_edge", "vertex_edges"),
        ("vertex_vertex", "vertex_vertices"),
    ):
        of_kind = [name for name in names if name.startswith(f"{kind}_")]
        for name, array in sorted_rows(answers, pairs, of_kind).items():
            np.testing.assert_array_equal(array, getattr(whole, name), name, strict=True)
    assert sum(len(answer) for answer in answers) == len(whole) > 0
    assert any(answer.any for answer in answers)


@pytest.mark.parametrize("name", MOTION)
def test_parts_have_the_impacts_of_the_whole(name, either):
    made, asked = MOTION[name]
    mesh = MESH._replace(groups=GROUPS)
    whole = either.find_impacts(mesh, MOVED, **made, **asked)
    parts = either.partition_motion(mesh, MOVED, count=5, **made)
    assert [part.index for part in parts] == list(range(5))
    answers = [either.find_impacts(pickle.loads(pickle.dumps(part)), **made, **asked) for part in parts]
    assert_union(answers, whole)
    first = min((answer.first for answer in answers if answer), key=lambda f: (f.toi, f.kind != "vertex_face", f.pair))
    assert first == whole.first
    times = [either.time_of_first_impact(part, **made, **asked) for part in parts]
    assert min(toi for toi in times if toi is not None) == whole.first.toi
    assert [either.is_free(part, **made, **asked) for part in parts] == [not answer for answer in answers]


@pytest.mark.parametrize("name", NEAR)
def test_parts_have_the_near_pairs_of_the_whole(name, either):
    made, asked = NEAR[name]
    whole = either.find_near(MESH, **made, **asked)
    parts = either.partition_near(MESH, count=5, **made)
    again = {key: value for key, value in made.items() if key not in ("radii", "rest")}
    answers = [either.find_near(pickle.loads(pickle.dumps(part)), **again, **asked) for part in parts]
    assert_union(answers, whole, CLOSEST if "closest" in asked else ())


def test_rods_and_particles_have_parts(either):
    made = {"edges": SEGMENTS[::3], "points": np.arange(39, -1, -1)}
    whole = either.find_near(HAIR, radius=0.5, **made)
    answers = [either.find_near(part, radius=0.5) for part in either.partition_near(HAIR, radius=0.5, count=4, **made)]
    assert_union(answers, whole)
    assert len(whole.vertex_edges)


def test_parts_outlive_the_mesh_and_name_its_features(either):
    mesh, moved = soup(60, size=0.4, dtype=np.float64), MOVED.copy()
    whole = either.find_impacts(mesh, moved)
    parts = either.partition_motion(mesh, moved, count=3)
    vertices = mesh.vertices.copy()
    mesh.vertices[:] = moved[:] = 0
    assert_union([either.find_impacts(part) for part in parts], whole)
    for part in parts:
        np.testing.assert_array_equal(part.mesh[0], vertices[part.vertex_ids])
        assert len(part.edge_ids) == len(set(part.edge_ids)) > 0
        assert len(part.point_ids) == 0 and not part.has_radii
    assert sorted(np.concatenate([part.edge_ids for part in parts]).tolist())[-1] == len(whole.edges) - 1
    plain = either.partition(MESH, count=2)[0]
    assert plain.vertex_ids is plain.edge_ids is plain.point_ids is None


def test_an_answer_of_a_part_says_what_it_does_not_know(either, tmp_path):
    part = either.partition_motion(MESH, MOVED, count=2)[0]
    answer = either.find_impacts(part, index=True)
    for name in ("edges", "first_edge", "points", "first_point"):
        with pytest.raises(
            crumple.InvalidInput, match=f"^{name} is told of a whole mesh, but this was asked of a part"
        ):
            getattr(answer, name)
    with pytest.raises(crumple.InvalidInput, match="an answer of a part is not saved"):
        answer.save(tmp_path / "part.txt")
    assert len(answer.vertex_offsets) == len(part.vertex_ids) + 1
    for copied in (pickle.loads(pickle.dumps(answer)), answer):
        np.testing.assert_array_equal(copied.edge_edges, answer.edge_edges)
        np.testing.assert_array_equal(copied.edge_offsets, answer.edge_offsets)


def test_a_part_refuses_other_questions(either):
    moving = either.partition_motion(MESH, MOVED, count=2, min_distance=0.1)[0]
    at_rest = either.partition_near(MESH, count=2, radius=0.1)[0]
    plain = either.partition(MESH, count=2)[0]
    for message, call in {
        "min_distance and min_distance_share must be at most": lambda: either.find_impacts(moving, min_distance=0.2),
        "weld must be as the part was made": lambda: either.find_impacts(moving, weld=True),
        "the part was made for a question about motion": lambda: either.find_near(moving, radius=0.1),
        "the part was made for a question about nearness": lambda: either.find_impacts(at_rest),
        "radius must be at most that which": lambda: either.find_near(at_rest, radius=0.2),
        "the part was not made for a query about features": lambda: either.find_near(plain, radius=0.2),
        "the part was made for a query about features": lambda: either.find(moving),
        "the number of parts must be 1 to 262144": lambda: either.partition_motion(MESH, MOVED, count=0),
    }.items():
        with pytest.raises(crumple.InvalidInput, match=message):
            call()
    with pytest.raises(crumple.InvalidType, match="find_near needs a radius"):
        either.find_near(at_rest)
    with pytest.raises(TypeError, match="radii"):
        either.find_near(at_rest, radius=0.1, radii=[1])


def test_a_state_that_does_not_fit_is_refused():
    part = crumple.Detector(backend="reference").partition_near(MESH, count=2, radius=0.1)[0]
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
    with pytest.raises(crumple.InvalidInput, match="what it owns"):
        crumple.Detector(backend="reference").find_near(bad, radius=0.1)
