"""Tests of distances between bodies against brute force and the reference backend, and of their results as values."""

import copy
import pickle
from fractions import Fraction

import numpy as np
import pytest

import crumple
from conftest import soup, sufficient_limit
from worlds import random_poses

SQUARE = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], np.float32), np.array([[0, 1, 2], [0, 2, 3]])
ARRAYS = ("bodies", "squared_distance", "touching", "triangles", "points")


def moved(*steps):
    poses = np.tile(np.eye(3, 4), (len(steps), 1, 1))
    poses[:, :, 3] = steps
    return poses


def assert_same(found, expected):
    for name in ARRAYS:
        np.testing.assert_array_equal(getattr(found, name), getattr(expected, name), name, strict=True)


def test_distance_of_two_squares_is_exact(either):
    world = crumple.World([SQUARE], [0, 0], poses=moved((0, 0, 0), (0.25, 0.5, 3)))
    found = either.distances(world)
    assert found.bodies.tolist() == [[0, 1]] and found.triangles.tolist() == [[0, 0]] and len(found) == 1
    assert found.squared_distance.tolist() == [9] and found.distance.tolist() == [3] and not found.touching[0]
    assert found.points.shape == (1, 2, 3) and found.points[0, :, 2].tolist() == [0, 3]
    assert "1 pair of bodies, 0 touching" in repr(found)
    touching = either.distances(world.at(moved((0, 0, 0), (1, 1, 0))))
    assert touching.touching.tolist() == [True] and touching.points.tolist() == [[[1, 1, 0], [1, 1, 0]]]


def test_distance_of_vertices_matches_rational_arithmetic(either):
    """All triangles are degenerate, with three equal corners, so the distance is that of two vertices."""
    points = np.random.default_rng(2).uniform(-1, 1, (8, 3))
    shapes = [(points[k : k + 4], np.repeat(np.arange(4)[:, None], 3, axis=1)) for k in (0, 4)]
    found = either.distances(crumple.World(shapes))
    exact = [[sum((Fraction(x) - Fraction(y)) ** 2 for x, y in zip(p, q)) for q in points[4:]] for p in points[:4]]
    a, b = min(((i, j) for i in range(4) for j in range(4)), key=lambda pair: exact[pair[0]][pair[1]])
    assert found.triangles.tolist() == [[a, b]]
    assert found.squared_distance[0] == float(exact[a][b])
    np.testing.assert_array_equal(found.points[0], points[[a, 4 + b]])


def test_distances_match_the_reference():
    random = np.random.default_rng(5)
    reference = crumple.Detector(backend="reference")
    meshes = [soup(12, seed=seed)[:2] for seed in (1, 2, 3)]
    worlds = [0, 0, 1, 1, -1]
    for threads in (1, 3):
        detector = crumple.Detector(threads=threads, backend="cpu")
        shapes = [crumple.Shape(*mesh, name=f"nearest {threads} {i}") for i, mesh in enumerate(meshes)]
        world = crumple.World(shapes, [0, 1, 2, 0, 1], worlds=worlds, groups=[0, 1, 0, 1, 1])
        for spread in (0.5, 2, 6):
            world.poses = random_poses(random, 5, spread)
            for question in (
                {},
                {"radius": spread},
                {"filter": crumple.PairFilter(groups="between")},
                {"filter": crumple.PairFilter(excluded_bodies=[(0, 4), (2, 3)])},
            ):
                expected = reference.distances(world, **question)
                assert_same(detector.distances(world, **question), expected)


def test_each_configuration_has_its_own_distance():
    world = crumple.World([SQUARE, SQUARE], worlds=[0, -1], names=["arm", "room"])
    poses = np.stack([moved((0, 0, z)) for z in (1, 2, 0)])
    found = crumple.distances(world.configurations(poses))
    assert found.bodies.tolist() == [[0, 3], [1, 3], [2, 3]]
    assert found.distance.tolist() == [1, 2, 0] and found.touching.tolist() == [False, False, True]
    assert (
        len(
            crumple.distances(world.configurations(poses), filter=crumple.PairFilter(excluded_bodies=[{"arm", "room"}]))
        )
        == 0
    )
    assert crumple.distances(world.configurations(poses), radius=1).bodies.tolist() == [[0, 3], [2, 3]]


def test_arrays_are_read_only_unless_copied():
    world = crumple.World([SQUARE], [0, 0], poses=moved((0, 0, 0), (0, 0, 3)))
    detector = crumple.Detector()
    found = detector.distances(world)
    assert not any(getattr(found, name).flags.writeable for name in (*ARRAYS, "distance"))
    for z in (4, 5, 6):
        detector.distances(world.at(moved((0, 0, 0), (0, 0, z))))
    assert found.squared_distance.tolist() == [9]
    own = detector.distances(world, copy=True)
    assert all(getattr(own, name).flags.writeable for name in (*ARRAYS, "distance"))
    del detector
    assert found.points[0, 1, 2] == 3


def test_copies_and_pickles_keep_the_distances():
    world = crumple.World([SQUARE], [0, 0, 0], poses=moved((0, 0, 0), (0, 0, 3), (0, 0, 0)))
    found = crumple.distances(world)
    for other in (copy.copy(found), copy.deepcopy(found), pickle.loads(pickle.dumps(found))):
        assert_same(other, found)
        assert repr(other) == repr(found)
    restore, (kind, asked, state) = found.__reduce__()
    for name, wrong, error in (
        ("bodies", state["bodies"][::-1], crumple.InvalidInput),
        ("bodies", state["bodies"][:, ::-1], crumple.InvalidInput),
        ("squared_distance", -1 - state["squared_distance"], crumple.InvalidInput),
        ("touching", ~state["touching"], crumple.InvalidInput),
        ("touching", state["touching"][:1], crumple.InvalidInput),
        ("triangles", state["triangles"] - 9, crumple.InvalidInput),
        ("triangles", state["triangles"].astype(float), crumple.InvalidType),
        ("points", state["points"] * np.nan, crumple.InvalidInput),
        ("points", state["points"][:, 0], crumple.InvalidType),
    ):
        with pytest.raises(error, match="the state of Distances"):
            restore(kind, asked, {**state, name: wrong})
    with pytest.raises(crumple.InvalidType, match="the state of Distances"):
        restore(kind, asked, {})


def test_output_nearest_has_the_nearest_pair_of_each_world(either):
    poses = np.stack([moved((0, 0, 0), (0, 0, z), (3 * z, 0, 0)) for z in (1, 2, 5)])
    world = crumple.World([SQUARE], [0] * 4, poses=moved(*[(0, 0, 0)] * 3, (0, 0, -4)), worlds=[0, 0, 0, -1])
    world = world.configurations(poses)
    every, found = either.distances(world), either.distances(world, output="nearest")
    assert found.bodies.tolist() == [[0, 1], [3, 4], [6, 9]] and found.distance.tolist() == [1, 2, 4]
    rows = [every.bodies.tolist().index(pair) for pair in found.bodies.tolist()]
    for name in ARRAYS:
        np.testing.assert_array_equal(getattr(found, name), getattr(every, name)[rows], name, strict=True)
    assert found.world_rows.dtype == np.int64 and found.world_rows.tolist() == [0, 1, 2]
    near = either.distances(world, output="nearest", radius=2)
    assert len(near) == 2 and near.world_rows.tolist() == [0, 1, -1]
    for other in (copy.deepcopy(near), pickle.loads(pickle.dumps(near))):
        assert_same(other, near)
        assert other.world_rows.tolist() == [0, 1, -1]
    restore, (kind, asked, state) = near.__reduce__()
    with pytest.raises(crumple.InvalidInput, match="the state of Distances"):
        restore(kind, asked, {**state, "world_rows": state["world_rows"] + 1})
    with pytest.raises(crumple.InvalidInput, match='world_rows was not requested: DistanceQuery\\(output="nearest"\\)'):
        every.world_rows


@pytest.mark.parametrize(
    "question, message",
    [
        ({"output": "any"}, 'output must be one of "nearest", "pairs"'),
        ({"radius": -1}, "radius must be 0 or more, or infinite"),
        ({"radius": np.nan}, "radius must be 0 or more, or infinite"),
        ({"radius": "1"}, "radius must be"),
        ({"filter": crumple.PairFilter(groups="all")}, 'groups must be one of "both", '),
        ({"filter": crumple.PairFilter(excluded_bodies=[(0, 7)])}, "excluded names body 7 of 2"),
    ],
)
def test_invalid_queries_and_poses_are_refused(either, question, message):
    world = crumple.World([SQUARE], [0, 0])
    with pytest.raises(crumple.InvalidInput, match=message):
        either.distances(world, **question)
    with pytest.raises(crumple.InvalidInput, match="body 1: its pose is not finite"):
        either.distances(world.at(moved((0, 0, 0), (np.nan, 0, 0))))
    assert len(either.distances(world)) == 1, "usable still"


def test_distances_need_a_world_or_two_meshes():
    with pytest.raises(crumple.InvalidInput, match=r"distances need bodies: a world or two meshes"):
        crumple.distances(SQUARE)
    assert crumple.distances(SQUARE, SQUARE).bodies.tolist() == [[0, 1]]
    assert crumple.distances(crumple.World([SQUARE, SQUARE])).bodies.tolist() == [[0, 1]]
    with pytest.raises(TypeError, match="Did you mean 'radius'"):
        crumple.distances(crumple.World([SQUARE]), radios=1)


def test_sufficient_memory_limit_gives_the_same_distances():
    vertices, faces, _ = soup(3000, seed=1)
    world = crumple.World([(vertices, faces)], [0, 0], poses=moved((0, 0, 0), (3, 0, 0)))
    limit = sufficient_limit(lambda detector: detector.distances(world), 20_000, backend="cpu")
    enough = crumple.Detector(backend="cpu", memory_limit=limit)
    assert_same(enough.distances(world), crumple.distances(world))
