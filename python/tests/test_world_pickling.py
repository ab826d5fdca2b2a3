"""Tests of worlds and their results as plain values: they can be pickled and copied; inconsistent pickles fail."""

import copy
import pickle
import subprocess
import sys

import numpy as np
import pytest

import crumple
from conftest import OnDevice, soup
from crumple._mesh import restore_shape
from crumple._world import restore_configurations, restore_world
from features import restored
from worlds import random_columns, random_poses

ARRAYS = (
    *("bodies", "pairs", "world_hit", "world_counts", "world_offsets", "body_offsets", "first_triangle", "hit"),
    *("contact_kinds", "contact_offsets", "contact_points"),
)


def configurations():
    random = np.random.default_rng(1)
    base = crumple.World(
        [crumple.Shape(soup(20, size=0.5), name="pickled")],
        [0, 0, 0],
        worlds=[0, 0, -1],
        names=["a", "b", "table"],
        poses=random_poses(random, 3, 1),
        self_collisions=True,
    )
    many = base.configurations(random_poses(random, 10, 1).reshape(5, 2, 3, 4))
    base.poses = None  # the static body of `many` keeps its pose
    return many


WORLDS = {
    "columns": random_columns(1).world(),
    "without names": random_columns(1).world(named=False, poses=None),
    "dlpack": crumple.World(
        [(OnDevice(soup(9).vertices, kind=1), OnDevice(soup(9).faces, kind=1))], self_collisions=True
    ),
    "lists": crumple.World([([[0, 0, 0], [1, 0, 0], [0, 1, 0.5]], [[0, 1, 2]])], [0, 0], self_collisions=True),
    "nothing": crumple.World([([], [])], [], self_collisions=True),
    "configurations": configurations(),
}
QUERIES = [{"output": output} for output in ("any", "any_by_world", "body_pairs", "count", "pairs", "contacts")]
QUERIES += [{"index": True}, {"output": "contacts", "index": True, "copy": True}]


def arrays_of(result):
    """Returns all arrays of a result, including those that were not requested."""
    return {name: getattr(result._found, name).tolist() for name in ARRAYS}


@pytest.mark.parametrize("query", QUERIES, ids=str)
@pytest.mark.parametrize("name", WORLDS)
def test_copied_or_pickled_result_is_equal_to_the_original(name, query, detector):
    result = detector.intersections(WORLDS[name], **query)
    for found in (pickle.loads(pickle.dumps(result)), copy.copy(result), copy.deepcopy(result)):
        assert type(found) is crumple.Intersections and repr(found) == repr(result) and bool(found) is bool(result)
        assert arrays_of(found) == arrays_of(result) and found.statistics == result.statistics
        again = detector.intersections(found.world, **query)
        assert arrays_of(again) == arrays_of(result), "the world came back as well"
        if query.get("output") == "contacts":
            assert not len(found) or found.pairs.flags.writeable is bool(query.get("copy"))
            assert len(found.contacts) == len(result.pairs)


def test_copied_or_pickled_worlds_are_equal_to_the_original():
    world = WORLDS["columns"]
    for found in (pickle.loads(pickle.dumps(world)), copy.copy(world), copy.deepcopy(world)):
        assert found is not world and found.names == world.names and found.bodies.tolist() == world.bodies.tolist()
        assert found.self_collisions.tolist() == world.self_collisions.tolist()
        assert found.worlds.tolist() == world.worlds.tolist() and found.groups.tolist() == world.groups.tolist()
        assert [s.name for s in found.shapes] == [s.name for s in world.shapes]
        for shape, original in zip(found.shapes, world.shapes):
            for array, expected in zip(shape.mesh, original.mesh):
                np.testing.assert_array_equal(array, expected)
        np.testing.assert_array_equal(found.poses, world.poses)
    many = WORLDS["configurations"]
    for found in (pickle.loads(pickle.dumps(many)), copy.copy(many), copy.deepcopy(many)):
        assert found.names == ("a", "b", "table") and found.originals.tolist() == [0, 1] * 5 + [2]
        np.testing.assert_array_equal(found.poses, many.poses)


def test_pickled_world_gives_the_same_result_in_another_process(detector, tmp_path):
    result = detector.intersections(WORLDS["columns"], output="contacts")
    (tmp_path / "result").write_bytes(pickle.dumps(result))
    code = (
        "import crumple, pickle; r = pickle.load(open('result', 'rb'))\n"
        "f = crumple.Detector().intersections(r.world, output='contacts')\n"
        "print(f.pairs.tolist() == r.pairs.tolist() and f.contacts.points.tolist() == r.contacts.points.tolist())"
    )
    done = subprocess.run([sys.executable, "-c", code], cwd=tmp_path, capture_output=True, text=True, check=True)
    assert done.stdout == "True\n" and result


@pytest.mark.parametrize(
    "field, value, message",
    [
        ("bodies", np.array([[0, 99]], np.int32), "is inconsistent"),
        ("pairs", np.array([[0, 99]], np.int32), "is inconsistent: pairs"),
        ("pairs", np.array([[0, 1]], np.int64), r"needs pairs as an array \(n, 2\) of int32"),
        ("pairs", [[0, 1]], r"needs pairs as an array \(n, 2\) of int32"),
        ("world_hit", np.array([True]), "world_hit"),
        ("count", 2.0, "needs count as int"),
        ("count", -1, "count"),
        ("output", "all", "output"),
        ("output", "count", ": pairs"),
        ("output", "pairs", ": contacts"),
        ("any", False, ": count"),
        ("hit", np.zeros(3, bool), "hit"),
        ("first_triangle", np.zeros(9, np.int64), "first_triangle"),
        ("body_offsets", np.zeros(2, np.int64), "body_offsets"),
        ("contact_points", np.full((99999, 3), np.nan), "points of contacts"),
        ("statistics", None, "needs statistics as Statistics"),
    ],
)
def test_inconsistent_pickled_state_is_refused(field, value, message, detector):
    result = detector.intersections(WORLDS["columns"], output="contacts", index=True)
    assert arrays_of(restored(result)) == arrays_of(result)
    if field == "pairs" and isinstance(value, np.ndarray) and value.dtype == np.int32:
        value = np.repeat(value, len(result), axis=0)
    with pytest.raises(crumple.InvalidInput, match=message):
        restored(result, **{field: lambda _: value})


def test_pickled_result_without_its_world_is_refused(detector):
    result = detector.intersections(WORLDS["columns"])
    restore, state = result.__reduce__()
    for wrong in ((*state[:3],), (*state[:3], None, None), (*state, None)):
        with pytest.raises(crumple.InvalidType, match="needs the world and its poses"):
            restore(*wrong)


class Reduced:
    """Object that is pickled as a call of a function, like the shapes and worlds of version 0.2."""

    def __init__(self, *call):
        self.call = call

    def __reduce__(self):
        return self.call


def test_pickled_shapes_and_worlds_of_version_0_2_are_read():
    vertices, faces, _ = soup(9, size=0.5)
    poses, moved = random_poses(np.random.default_rng(1), 2, 1), vertices + 1
    edges, radii = np.array([[0, 1]], np.int32), np.ones(27)
    arm = Reduced(restore_shape, (vertices, faces, None, "arm"))
    rope = Reduced(restore_shape, (vertices, np.empty((0, 3), np.int32), None, None, moved, edges, None, radii, None))
    columns = (*np.array([[0, 1], [2, 3], [0, -1]], np.int32), np.array([True, True]))
    world = Reduced(restore_world, ((arm, rope), *columns, ("arm", "rope"), poses), {"unit": "mm"})
    later = Reduced(restore_world, ((arm,), *(column[:1] for column in columns), None, None, poses[:1]))
    many = Reduced(restore_configurations, (world, poses[None, :1].repeat(3, axis=0)))
    given = pickle.dumps((world, later, many), 0)  # names modules in plain text
    for restore in (restore_shape, restore_world, restore_configurations):
        name = f"c{restore.__module__}\n{restore.__name__}\n".encode()
        assert name in given
        given = given.replace(name, f"ccrumple._world_pickling\n{restore.__name__}\n".encode())

    world, later, many = pickle.loads(given)
    assert world.names == ("arm", "rope") and world.unit == "mm" and world.shapes[0].name == "arm"
    assert world.bodies.tolist() == [0, 1] and world.groups.tolist() == [2, 3] and world.worlds.tolist() == [0, -1]
    np.testing.assert_array_equal(world.poses, poses)
    for found, expected in zip(world.shapes[0].mesh, (vertices, faces)):
        np.testing.assert_array_equal(found, expected)
    shape = world.shapes[1]
    for found, expected in ((shape.end, moved), (shape.edges, edges), (shape.radii, radii)):
        np.testing.assert_array_equal(found, expected)
    assert shape.points is None and shape.rest is None
    assert later.poses is None
    np.testing.assert_array_equal(later.end_poses, poses[:1])
    assert repr(many) == "<crumple.World: 3 configurations of 1 bodies, 4 in all>"
