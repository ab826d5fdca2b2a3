"""Worlds and their results as plain values: pickled and copied, whole or not at all."""

import copy
import pickle
import subprocess
import sys

import numpy as np
import pytest

import crumple
from conftest import OnDevice, soup
from worlds import random_columns, random_poses

ARRAYS = ("bodies", "pairs", "world_hit", "world_counts", "world_offsets", "body_offsets", "first_triangle", "hit")


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
    base.poses = None  # those at rest stay where they were
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
QUESTIONS = [{"wants": wants} for wants in ("any", "any_by_world", "body_pairs", "count", "pairs", "contacts")]
QUESTIONS += [{"index": True}, {"wants": "contacts", "index": True, "copy": True}]


def arrays_of(result):
    answer = result._answer
    return {name: getattr(answer, name).tolist() for name in (*ARRAYS, "contact_kinds", "contact_points")}


@pytest.mark.parametrize("question", QUESTIONS, ids=str)
@pytest.mark.parametrize("name", WORLDS)
def test_a_result_comes_back_whole(name, question, detector):
    result = detector.find(WORLDS[name], **question)
    for found in (pickle.loads(pickle.dumps(result)), copy.copy(result), copy.deepcopy(result)):
        assert type(found) is crumple.WorldResult and repr(found) == repr(result) and bool(found) is bool(result)
        assert arrays_of(found) == arrays_of(result) and found.statistics == result.statistics
        again = detector.find(found.world, **question)
        assert arrays_of(again) == arrays_of(result), "the world came back as well"
        if question.get("wants") == "contacts":
            assert not len(found) or found.pairs.flags.writeable is bool(question.get("copy"))
            assert len(found.contacts) == len(result.pairs)


def test_worlds_come_back():
    world = WORLDS["columns"]
    for found in (pickle.loads(pickle.dumps(world)), copy.copy(world), copy.deepcopy(world)):
        assert found is not world and found.names == world.names and [s.name for s in found.shapes]
        assert found.worlds.tolist() == world.worlds.tolist() and found.groups.tolist() == world.groups.tolist()
        assert [s.name for s in found.shapes] == [s.name for s in world.shapes]
        np.testing.assert_array_equal(found.poses, world.poses)
    many = pickle.loads(pickle.dumps(WORLDS["configurations"]))
    assert many.names == ("a", "b", "table") and many.originals.tolist() == [0, 1] * 5 + [2]


def test_another_process_finds_the_same(detector, tmp_path):
    result = detector.find(WORLDS["columns"], wants="contacts")
    (tmp_path / "result").write_bytes(pickle.dumps(result))
    code = (
        "import crumple, pickle; r = pickle.load(open('result', 'rb'))\n"
        "f = crumple.Detector().find(r.world, wants='contacts')\n"
        "print(f.pairs.tolist() == r.pairs.tolist() and f.contacts.points.tolist() == r.contacts.points.tolist())"
    )
    done = subprocess.run([sys.executable, "-c", code], cwd=tmp_path, capture_output=True, text=True, check=True)
    assert done.stdout == "True\n" and result


@pytest.mark.parametrize(
    "field, value, message",
    [
        ("bodies", np.array([[0, 99]], np.int32), "does not fit together"),
        ("pairs", np.array([[0, 99]], np.int32), "does not fit together: pairs"),
        ("pairs", np.array([[0, 1]], np.int64), "needs pairs as an array of int32"),
        ("pairs", [[0, 1]], "needs pairs as an array of int32"),
        ("world_hit", np.array([True]), "world_hit"),
        ("count", 2.0, "needs count as int"),
        ("count", -1, "count"),
        ("wants", "all", "wants"),
        ("hit", np.zeros(3, bool), "hit"),
        ("first_triangle", np.zeros(9, np.int64), "first_triangle"),
        ("body_offsets", np.zeros(2, np.int64), "body_offsets"),
        ("contact_points", np.full((99999, 3), np.nan), "points of contacts"),
        ("statistics", None, "needs statistics as Statistics"),
    ],
)
def test_what_does_not_fit_together_is_refused(field, value, message, detector):
    from crumple._world_pickling import StoredAnswer

    restore, (answer, world, poses) = detector.find(WORLDS["columns"], wants="contacts", index=True).__reduce__()
    assert restore(answer, world, poses)
    state = StoredAnswer(*answer)
    if field == "pairs" and isinstance(value, np.ndarray) and value.dtype == np.int32:
        value = np.repeat(value, len(state.bodies), axis=0)
    with pytest.raises(crumple.InvalidInput, match=message):
        restore(tuple(state._replace(**{field: value})), world, poses)
    with pytest.raises(crumple.InvalidType, match="must be"):
        restore((), world, poses)
