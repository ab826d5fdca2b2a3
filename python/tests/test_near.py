"""What is near what: found as brute force finds it, in meshes and in worlds, as much as is asked for."""

import inspect
import re

import numpy as np
import pytest

import crumple
from conftest import OnDevice, soup
from features import BODIES, FACES, LISTS, START, assert_same, check_index
from worlds import random_poses


def test_pairs_and_distances(either):
    """The lowest vertex of the upper triangle is 1 above the inside of the other one."""
    found = either.find_near(START, FACES, radius=1)
    assert found.vertex_faces.tolist() == [[3, 0]] and found.vertex_face_squared_distance.tolist() == [1]
    assert found.vertex_face_touching.tolist() == [False] and found.edge_edges.shape == (0, 2)
    assert found.edges.tolist() == [[0, 1], [0, 2], [1, 2], [3, 4], [3, 5], [4, 5]]
    assert found.any and found and len(found) == found.count == 1 and found.world_hit.tolist() == [True]
    assert "1 pair, 1 of vertex and face, 0 of edge and edge" in repr(found)
    every = either.find_near(START, FACES, radius=2)
    assert every.vertex_faces.tolist() == [[0, 1], [3, 0], [4, 0], [5, 0]]
    assert every.vertex_face_squared_distance.tolist() == [3, 1, 4, 4]
    assert every.edges[every.edge_edges[:2]].tolist() == [[[0, 1], [3, 4]], [[0, 1], [3, 5]]]
    assert every.edge_edge_squared_distance.tolist() == [2, 2, 2, 2, 3, 3]
    assert found.vertex_face_squared_distance.dtype == np.float64 and found.vertex_faces.dtype == np.int32


def test_strictly_nearer(either):
    assert not either.find_near(START, FACES, radius=1, strict=True)
    assert either.find_near(START, FACES, radius=np.nextafter(1, 2), strict=True)
    assert not either.find_near(START, FACES, radius=np.nextafter(1, 0))


def test_touching_is_told_from_rounding(either):
    vertices = START.copy()
    vertices[3, 2] = 0
    found = either.find_near(vertices, FACES, radius=0)
    assert found.vertex_face_touching.tolist() == [True] and found.vertex_face_squared_distance.tolist() == [0]
    vertices[3, 2] = 1e-200
    found = either.find_near(vertices, FACES, radius=1e-200)
    assert found.vertex_face_touching.tolist() == [False] and found.vertex_face_squared_distance.tolist() == [0]
    found = either.find_near(START * 1e200, FACES, radius=1e200)
    assert found.vertex_face_squared_distance.tolist() == [np.inf]


def test_without_a_detector():
    assert crumple.find_near(START, FACES, radius=1).vertex_faces.tolist() == [[3, 0]]
    assert crumple.find_near((START, FACES), radius=1, wants="any")
    assert crumple.find_near(crumple.World([(START, FACES)]), radius=1).vertex_face_bodies.tolist() == [[0, 0]]


QUESTIONS = [
    {},
    {"weld": True},
    {"strict": True},
    {"groups": True, "wanted": "between"},
    {"groups": True, "wanted": "within"},
    {"groups": True, "excluded_groups": [(0, 1), (2, 2)]},
]


@pytest.mark.parametrize("question", QUESTIONS, ids=str)
@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_brute_force_agrees(dtype, question, detector, reference):
    for seed, radius in enumerate((0.2, 0.3, 1)):
        vertices, faces, _ = soup(14, size=0.5, seed=seed, dtype=dtype)
        asked = {**question, "radius": radius}
        if "groups" in question:
            asked["groups"] = np.arange(len(faces)) % 3
        expected = reference.find_near(vertices, faces, **asked)
        assert expected, "something must be near"
        assert_same(detector.find_near(vertices, faces, **asked), expected)


def test_less_is_the_same_as_all_cut_short(either):
    mesh = soup(10, size=0.5)
    for radius in (0.2, 1e-9):
        every = either.find_near(mesh, radius=radius)
        by_world = either.find_near(mesh, radius=radius, wants="any_by_world")
        assert every.any is by_world.any is either.find_near(mesh, radius=radius, wants="any").any is (radius > 0.1)
        assert by_world.world_hit.tolist() == [every.any] and len(by_world) == 0
        assert ("something is near" if every else "nothing is near") in repr(by_world)


def test_offsets_by_feature(either):
    mesh = soup(10, size=0.5)
    check_index(either.find_near(mesh, radius=0.2, index=True), len(mesh.vertices), len(mesh.faces))


@pytest.mark.parametrize(
    "mesh, named, message",
    [
        ((START, FACES), {"radius": -1}, "radius must be finite and 0 or more"),
        ((START, FACES), {"radius": np.nan}, "radius must be finite and 0 or more"),
        ((START, FACES), {"radius": None}, "radius must be a number, not None"),
        ((START, FACES), {"strict": 1}, "strict must be True or False, not int"),
        ((START, FACES), {"wants": "impacts"}, 'wants must be one of "any", "any_by_world", "pairs", not "impacts"'),
        ((START, FACES), {"wanted": "no"}, 'wanted must be one of "both", "between", "within", not "no"'),
        ((START, FACES + 1), {}, "triangle 1 names vertex 6 of 6"),
        ((np.full_like(START, np.inf), FACES), {}, "vertex 0 is not finite"),
        ((OnDevice(START), OnDevice(FACES)), {}, "vertices lie in CUDA memory, but those of motion and nearness"),
    ],
)
def test_wrong_arguments_are_refused(mesh, named, message, detector):
    with pytest.raises(crumple.InvalidInput, match=message):
        detector.find_near(*mesh, **{"radius": 1, **named})
    assert detector.find_near(START, FACES, radius=1), "the detector stays usable"


def test_the_method_tells_what_it_is(detector):
    for method in (crumple.Detector.find_near, detector.find_near):
        assert method.__name__ == "find_near" and method.__qualname__ == "Detector.find_near"
        assert inspect.isroutine(method) and len(inspect.getdoc(method)) > 100
    assert list(inspect.signature(detector.find_near).parameters)[:3] == ["vertices", "faces", "radius"]
    for scene in ((START, FACES), (crumple.World([(START, FACES)]),)):
        with pytest.raises(TypeError, match="missing 1 required keyword-only argument: 'radius'"):
            detector.find_near(*scene)
        with pytest.raises(TypeError, match=r"find_near.*'stric'\. Did you mean 'strict'\?$"):
            detector.find_near(*scene, radius=1, stric=True)


def test_what_was_not_asked_for_says_how_to_ask(detector):
    nothing = detector.find_near(START, FACES, radius=1, wants="any")
    for name in (*LISTS["Nearby"], "count", "edges", "first_edge", "by_second_edge"):
        with pytest.raises(crumple.InvalidInput, match=re.escape(f'{name} was not asked for: find_near(..., wants="p')):
            getattr(nothing, name)
    with pytest.raises(crumple.InvalidInput, match=r'world_hit was .* find_near\(\.\.\., wants="any_by_world"\)'):
        _ = nothing.world_hit
    every = detector.find_near(START, FACES, radius=1)
    with pytest.raises(crumple.InvalidInput, match=r"face_offsets was not asked for: find_near\(\.\.\., index=True\)"):
        _ = every.face_offsets
    with pytest.raises(crumple.InvalidInput, match="edge_edge_bodies are those of a world"):
        _ = every.edge_edge_bodies


# Worlds.


def random_world(seed, bodies=6, worlds=2):
    random = np.random.default_rng(seed)
    shapes = [soup(6, size=0.5, seed=seed, dtype=np.float64), soup(5, size=0.5, seed=seed + 1, dtype=np.float64)]
    of = np.sort(random.integers(0, worlds, bodies))
    of[-1] = -1
    return crumple.World(shapes, random.integers(0, 2, bodies), poses=random_poses(random, bodies, 1), worlds=of)


@pytest.mark.parametrize(
    "question",
    [{}, {"bodies": "between"}, {"bodies": "within"}, {"excluded": [(0, 1), {2}]}, {"strict": True}],
    ids=str,
)
def test_brute_force_agrees_about_worlds(question, detector, reference):
    for seed in range(3):
        world, asked = random_world(seed), {"radius": 0.1 * (seed + 1), **question}
        expected = reference.find_near(world, **asked)
        assert expected, "something must be near"
        assert_same(detector.find_near(world, **asked), expected, BODIES)
        hit = detector.find_near(world, wants="any_by_world", **asked).world_hit
        assert hit.tolist() == expected.world_hit.tolist()


def test_worlds_are_those_of_the_start(either):
    far = START.copy()
    far[3:, 2] += 9
    still = crumple.World([(START, FACES)])
    expected = either.find_near(still, radius=1)
    assert expected.vertex_face_bodies.tolist() == [[0, 0]]
    for world in (crumple.World([crumple.Shape(START, FACES, end=far)]), crumple.World([(START, FACES)])):
        world.end_poses = 2 * np.eye(3, 4)[None]
        assert_same(either.find_near(world, radius=1), expected)


def test_poses_and_exclusions(either):
    shape = crumple.Mesh(START[:3], FACES[:1])
    poses = np.tile(np.eye(3, 4), (2, 1, 1))
    poses[1, 2, 3] = 3
    world = crumple.World([shape], [0, 0], poses=poses, names=["low", "high"])
    assert not either.find_near(world, radius=2.5) and either.find_near(world, radius=3)
    assert not either.find_near(world, radius=3, excluded=[{"low", "high"}])
    poses[1, 2, 3] = 1
    nearer = either.find_near(world, radius=1)
    assert nearer.vertex_face_bodies.tolist() == [[0, 1]] * 3 + [[1, 0]] * 3
    assert nearer.vertex_face_squared_distance.tolist() == [1] * 6
    np.testing.assert_array_equal(either.find_near(world, radius=1, poses=poses.copy()).edge_edges, nearer.edge_edges)
