"""Tests that worlds have the same results as brute force, searches of one or two meshes, and a loop over worlds."""

import gc

import numpy as np
import pytest

import crumple
from conftest import soup, sufficient_limit
from worlds import random_columns, random_poses

ARRAYS = ("bodies", "pairs", "world_hit", "world_counts", "world_offsets", "body_offsets", "first_triangle", "hit")
QUESTIONS = [
    {},
    {"neighbours": "skip", "filter": crumple.PairFilter(bodies="between")},
    {"kind": "proper", "filter": crumple.PairFilter(groups="within")},
    {"weld": True, "filter": crumple.PairFilter(bodies="within")},
    {"filter": crumple.PairFilter(excluded_bodies=[(0, 1), (2,) * 2, {3}], excluded_groups=[(0, 1)], groups="between")},
]


@pytest.fixture(scope="module")
def reference():
    return crumple.Detector(backend="reference")


def assert_same(found, expected):
    for name in ARRAYS:
        np.testing.assert_array_equal(getattr(found, name), getattr(expected, name), name, strict=True)
    for name in ("kinds", "offsets", "points"):
        np.testing.assert_array_equal(getattr(found.contacts, name), getattr(expected.contacts, name), name)
    assert (found.any, found.count, len(found)) == (expected.any, expected.count, len(expected))


@pytest.mark.parametrize("question", QUESTIONS, ids=str)
@pytest.mark.parametrize("seed", range(4))
def test_worlds_match_brute_force(seed, question, detector, reference):
    columns = random_columns(seed)
    expected = reference.intersections(columns.world(named=False), output="contacts", index=True, **question)
    assert seed > 0 or question or expected, "something must collide"
    for named in (False, True, True):
        found = detector.intersections(columns.world(named=named), output="contacts", index=True, **question)
        assert_same(found, expected)


@pytest.mark.parametrize("named", [False, True])
def test_smaller_outputs_agree_with_all_pairs(named, detector):
    world = random_columns(5).world(named=named)
    every = detector.intersections(world, index=True)
    assert every.world_hit.any()
    assert detector.intersections(world, output="any").any is every.any is bool(every)
    np.testing.assert_array_equal(detector.intersections(world, output="any_by_world").world_hit, every.world_hit)
    np.testing.assert_array_equal(
        detector.intersections(world, output="body_pairs").bodies, np.unique(every.bodies, axis=0)
    )
    counted = detector.intersections(world, output="count")
    assert counted.count == every.count == len(every.pairs)
    np.testing.assert_array_equal(counted.world_counts, every.world_counts)
    for w, count in enumerate(every.world_counts):
        rows = every.bodies[every.world_offsets[w] : every.world_offsets[w + 1]]
        assert len(rows) == count and set(world.worlds[rows].ravel()) <= {w, -1}


def test_unposed_bodies_give_the_results_of_their_meshes(detector):
    a, b = soup(200, size=0.4), soup(150, size=0.4, seed=2)
    alone, both = crumple.World([a], self_collisions=True), crumple.World([a, b], self_collisions=False)
    expected = detector.intersections(a, output="contacts")
    found = detector.intersections(alone, output="contacts", index=True)
    assert found.pairs.tobytes() == expected.pairs.tobytes() and len(expected)
    assert found.contacts.points.tobytes() == expected.contacts.points.tobytes()
    assert found.hit.tobytes() == expected.hit.tobytes()
    expected = detector.intersections(a, b, output="contacts")
    for found in (
        detector.intersections(both, output="contacts"),
        detector.intersections(
            crumple.World([a, b], self_collisions=True), filter=crumple.PairFilter(bodies="between")
        ),
    ):
        assert found.pairs.tobytes() == expected.pairs.tobytes() and len(expected)
        assert (found.bodies == [0, 1]).all()


@pytest.mark.parametrize("named", [False, True])
def test_configurations_give_the_results_of_one_search_each(named, detector):
    random = np.random.default_rng(3)
    shape = crumple.Shape(soup(20, size=0.5), name="of configurations" if named else None)
    names = ["upper", "lower", "hand", "table", "wall"]
    base = crumple.World(
        [shape],
        [0] * 5,
        worlds=[0, 0, 0, -1, -1],
        names=names,
        self_collisions=False,
        poses=random_poses(random, 5, 3),
    )
    poses = random_poses(random, 3 * 40, 3).reshape(40, 3, 3, 4)
    many = base.configurations(poses)
    assert len(many) == 40 * 3 + 2 and many.worlds.tolist() == [*np.repeat(range(40), 3), -1, -1]
    excluded = [{"upper", "lower"}, {"hand", "table"}]
    every = detector.intersections(many, index=True, filter=crumple.PairFilter(excluded_bodies=excluded))
    hits = []
    for c, moved in enumerate(poses):
        one = detector.intersections(
            base.at(np.concatenate([moved, base.poses[3:]])), filter=crumple.PairFilter(excluded_bodies=excluded)
        )
        resting = (one.bodies >= 3).all(axis=1)  # pairs of static bodies are listed once, at the end
        rows = slice(every.world_offsets[c], every.world_offsets[c + 1])
        np.testing.assert_array_equal(many.originals[every.bodies[rows]], one.bodies[~resting])
        np.testing.assert_array_equal(every.pairs[rows], one.pairs[~resting])
        np.testing.assert_array_equal(every.bodies[every.world_offsets[-1] :] - 40 * 3 + 3, one.bodies[resting])
        hits.append(bool(len(one.pairs[~resting])))
    assert 0 < sum(hits) < 40
    np.testing.assert_array_equal(
        detector.intersections(
            many, output="any_by_world", filter=crumple.PairFilter(excluded_bodies=excluded)
        ).world_hit,
        hits,
    )
    names = {name for pair in every.names for name in pair}
    assert names == {"upper", "lower", "hand", "table", "wall"} and ("upper", "lower") not in every.names


def test_poses_of_configurations_can_be_replaced(detector):
    random = np.random.default_rng(4)
    base = crumple.World([soup(20, size=0.5)], [0, 0, 0], worlds=[0, 0, -1], self_collisions=False)
    one, other = random_poses(random, 40).reshape(2, 10, 2, 3, 4)
    many = base.configurations(one)
    expected = detector.intersections(base.configurations(other))
    assert expected.pairs.tolist() != detector.intersections(many).pairs.tolist()
    np.testing.assert_array_equal(detector.intersections(many.at(other)).pairs, expected.pairs)
    assert many.poses is one
    many.poses = other
    np.testing.assert_array_equal(detector.intersections(many).pairs, expected.pairs)
    np.testing.assert_array_equal(detector.intersections(many.at(other.reshape(20, 3, 4))).pairs, expected.pairs)


def square(poses):
    """Returns the same poses as (..., 4, 4)."""
    return np.concatenate([poses, np.broadcast_to([0, 0, 0, 1.0], (*poses.shape[:-2], 1, 4))], axis=-2)


class Dlpack:
    """Array that can be read only through DLPack."""

    def __init__(self, array):
        self.array = array

    def __dlpack_device__(self):
        return self.array.__dlpack_device__()

    def __dlpack__(self, **how):
        return self.array.__dlpack__(**how)


@pytest.mark.parametrize(
    "given",
    [
        square,
        np.asfortranarray,
        Dlpack,
        lambda p: p[::-1].copy()[::-1],
        lambda p: np.repeat(p, 2, axis=0)[::2],
        lambda p: square(p).tolist(),
        lambda p: p.astype(">f8"),
        lambda p: np.ma.masked_array(p),
        lambda p: Dlpack(square(p)),
    ],
    ids=["square", "fortran", "dlpack", "reversed", "strided", "lists", "big endian", "no mask", "square dlpack"],
)
def test_layout_of_poses_does_not_change_the_pairs(given, detector):
    columns = random_columns(6)
    expected = detector.intersections(columns.world())
    assert expected
    for found in (
        detector.intersections(columns.world(poses=given(columns.poses))),
        detector.intersections(columns.world().at(given(columns.poses))),
    ):
        np.testing.assert_array_equal(found.pairs, expected.pairs)


def test_poses_can_be_float32_or_integers(detector):
    world = crumple.World([soup(30, size=0.5)], [0, 0], self_collisions=False)
    poses = np.zeros((2, 3, 4), int)
    poses[0, range(3), range(3)] = poses[1, range(3), [1, 2, 0]] = 1
    expected = detector.intersections(world.at(poses.astype(float))).pairs.tolist()
    assert expected and expected != detector.intersections(world).pairs.tolist()
    for given in (poses, poses.astype(np.float32), poses.tolist()):
        assert detector.intersections(world.at(given)).pairs.tolist() == expected
    with pytest.raises(crumple.InvalidType, match="poses must be float64 or float32, not float16"):
        detector.intersections(world.at(poses.astype(np.float16)))


def test_changes_of_the_array_of_poses_affect_the_next_search(detector):
    """A search uses the poses that were written into the array since the previous search."""
    world = crumple.World([soup(30, size=0.5)], [0, 0], self_collisions=False)
    poses = np.tile(np.eye(3, 4), (2, 1, 1))
    world.poses = poses
    assert world.poses is poses and detector.intersections(world)
    poses[1, 0, 3] = 9
    assert not detector.intersections(world)
    world.poses = None
    assert world.poses is None and detector.intersections(world)


def test_body_objects_and_arrays_of_bodies_give_the_same_result(detector):
    columns = random_columns(7)
    shapes = [crumple.Shape(shape) for shape in columns.shapes]
    bodies = [
        crumple.Body(
            shapes[shape] if i % 2 else shape,
            square(pose) if i % 3 else pose,
            group,
            world,
            own,
            f"body {i}",
        )
        for i, (shape, pose, group, world, own) in enumerate(zip(*columns[1:]))
    ]
    world = crumple.World(shapes, bodies)
    assert world.names[3] == "body 3" and world.index("body 3") == 3
    assert_same(
        detector.intersections(world, output="contacts", index=True),
        detector.intersections(columns.world(), output="contacts", index=True),
    )


def test_arrays_outlive_result_and_detector(detector):
    result = detector.intersections(random_columns(8).world(), output="contacts", index=True)
    arrays = {name: getattr(result, name) for name in ARRAYS}
    points = result.contacts.points
    before = {name: array.copy() for name, array in arrays.items()}, points.copy()
    del result
    for seed in range(9, 13):
        detector.intersections(random_columns(seed).world(), output="contacts", index=True)
    del detector
    gc.collect()
    for name, array in arrays.items():
        np.testing.assert_array_equal(array, before[0][name])
        assert not array.flags.writeable
    np.testing.assert_array_equal(points, before[1])


def test_repeated_searches_alternate_between_two_buffers(detector):
    world, places = random_columns(8).world(), set()
    for _ in range(8):
        result = detector.intersections(world)
        places.add(result.pairs.ctypes.data)
    assert len(places) == 2
    held = [detector.intersections(world).pairs for _ in range(4)]
    assert len({pairs.ctypes.data for pairs in held}) == 4


def test_world_keeps_its_arrays_alive(detector):
    def made():
        columns = random_columns(9)
        return columns.world(named=False), detector.intersections(columns.world()).pairs.tolist()

    world, expected = made()
    gc.collect()
    others = [random_columns(seed) for seed in range(20)]  # they would reuse freed memory
    assert detector.intersections(world).pairs.tolist() == expected and expected and others


def test_results_made_with_copy_can_be_written_to(detector):
    result = detector.intersections(random_columns(10).world(), index=True, copy=True)
    result.pairs[:] = 0
    result.hit[:] = False
    assert not result.pairs.any()


def test_error_explains_how_to_request_a_missing_array(detector):
    world = random_columns(11).world()
    nothing = detector.intersections(world, output="any")
    for name in ("count", "bodies", "pairs", "world_hit", "world_counts", "hit", "body_offsets"):
        with pytest.raises(crumple.InvalidInput, match=rf"{name} was not requested: IntersectionQuery\(output="):
            getattr(nothing, name)
    assert nothing.contacts is None and len(nothing) == 0
    with pytest.raises(crumple.InvalidInput, match="index=True"):
        _ = detector.intersections(world).hit


def test_sufficient_memory_limit_gives_the_same_pairs():
    world = random_columns(12, bodies=30).world()
    expected = crumple.Detector().intersections(world).pairs
    enough = crumple.Detector(memory_limit=sufficient_limit(lambda detector: detector.intersections(world), 10_000))
    for _ in range(3):
        np.testing.assert_array_equal(enough.find(world).pairs, expected)
