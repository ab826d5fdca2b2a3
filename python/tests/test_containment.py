"""Tests of intersections with containment, in which a body inside another one counts as a collision."""

import copy
import pickle

import numpy as np
import pytest
from test_overlaps import CORNERS, FACES, UNIT, box

import crumple
from features import restored

ROOM = box([-1, -1, -1], 4.0)
INSIDE = {"output": "body_pairs", "containment": True}


def world():
    """World of a room with two bodies inside, a body in the room's wall that meets one of them, and a body far away."""
    bodies = [UNIT, ROOM, box([0.5, 0.5, 0.5]), box([2.5, 0, 0]), box([9, 9, 9])]
    return crumple.World(bodies, names=["unit", "room", "box", "wall", "far"])


def test_body_pairs_report_which_are_inside(detector):
    assert detector.intersections(world(), output="body_pairs").names == [("unit", "box"), ("room", "wall")]
    found = detector.intersections(world(), **INSIDE)
    assert found.names == [("unit", "room"), ("unit", "box"), ("room", "box"), ("room", "wall")]
    assert found.inside.tolist() == [True, False, True, False] and found.inside.dtype == bool
    assert found.skipped.tolist() == [] and found.world_hit.tolist() == [True]
    assert found.bodies.tolist() == detector.overlaps(world(), output="body_pairs").bodies.tolist()
    reference = crumple.Detector(backend="reference").intersections(world(), **INSIDE)
    assert reference.inside.tolist() == found.inside.tolist()


def test_mesh_inside_another_collides_only_with_containment(detector):
    assert not detector.any([UNIT, ROOM])
    assert detector.any([UNIT, ROOM], crumple.IntersectionQuery(containment=True))
    assert detector.intersections(UNIT, ROOM, output="any", containment=True)
    found = detector.intersections(UNIT, ROOM, **INSIDE)
    assert found.bodies.tolist() == [[0, 1]] and found.inside.tolist() == [True]
    assert not detector.intersections(UNIT, box([9, 9, 9]), **INSIDE)


def test_containment_flags_configurations_with_a_body_inside_another_as_hit(detector):
    poses = np.tile(np.eye(3, 4), (4, 1, 1, 1))
    poses[:, 0, 0, 3] = [0, 2.5, 9, 0.5]
    many = crumple.World([UNIT, ROOM], worlds=[0, -1]).configurations(poses)
    assert detector.intersections(many, output="any_by_world").world_hit.tolist() == [False, True, False, False]
    found = detector.intersections(many, output="any_by_world", containment=True)
    assert found.world_hit.tolist() == [True, True, False, True]


def test_open_bodies_are_refused_unless_skipped_and_contain_nothing(detector):
    opened = crumple.Mesh(CORNERS, FACES[1:])
    open_room = crumple.Mesh(CORNERS * 4 - 1, FACES[1:])
    with pytest.raises(crumple.InvalidInput, match='crumple.open_edges lists them all, weld=True closes seams, open="skip" leaves such bodies out'):
        detector.intersections(opened, ROOM, **INSIDE)
    found = detector.intersections(opened, ROOM, open="skip", **INSIDE)
    assert found.inside.tolist() == [True] and found.skipped.tolist() == [0]
    found = detector.intersections(UNIT, open_room, open="skip", **INSIDE)
    assert not found and found.skipped.tolist() == [1]
    soup = crumple.Mesh((CORNERS * 4 - 1)[FACES].reshape(-1, 3), np.arange(36).reshape(-1, 3))
    assert detector.intersections(UNIT, soup, weld=True, **INSIDE).inside.tolist() == [True]


@pytest.mark.parametrize("output", ["any", "any_by_world", "body_pairs"])
def test_results_can_be_copied_and_pickled(detector, output):
    opened = crumple.Mesh(CORNERS, FACES[1:])
    for scene in (crumple.World([opened, ROOM]), [opened, ROOM]):
        found = detector.intersections(scene, output=output, containment=True, open="skip")
        for other in (copy.copy(found), copy.deepcopy(found), pickle.loads(pickle.dumps(found))):
            assert other.any and other.skipped.tolist() == found.skipped.tolist() == [0]
            if output == "body_pairs":
                assert other.inside.tolist() == [True] and other.bodies.tolist() == [[0, 1]]


def test_inconsistent_pickled_states_are_refused(detector):
    found = detector.intersections(world(), **INSIDE)
    with pytest.raises(crumple.InvalidInput, match="is inconsistent: inside"):
        restored(found, inside=lambda array: array[1:])
    for skipped in ([-1], [1, 1]):
        with pytest.raises(crumple.InvalidInput, match="is inconsistent: skipped"):
            restored(found, skipped=lambda array, skipped=skipped: np.array(skipped, np.int32))
    plain = detector.intersections(world(), output="body_pairs")
    with pytest.raises(crumple.InvalidInput, match="is inconsistent: skipped"):
        restored(plain, skipped=lambda array: np.array([0], np.int32))


def test_error_explains_how_to_request_a_missing_array(detector):
    with pytest.raises(crumple.InvalidInput, match=r"inside was not requested: IntersectionQuery\(containment=True\)"):
        _ = detector.intersections(world(), output="body_pairs").inside
    with pytest.raises(
        crumple.InvalidInput, match=r'inside was not requested: IntersectionQuery\(output="body_pairs"\)'
    ):
        _ = detector.intersections(world(), output="any", containment=True).inside


@pytest.mark.parametrize(
    "options, message",
    [
        ({}, "output must be any, any_by_world or body_pairs with containment"),
        ({"output": "any", "kind": "proper"}, "kind must be all with containment"),
        ({"output": "any", "weld": True, "neighbours": "skip"}, "neighbours must be geometric"),
        ({"output": "any", "filter": crumple.PairFilter(bodies="within")}, "bodies must not be within"),
        ({"output": "any", "open": "maybe"}, "open must be"),
    ],
)
def test_options_that_conflict_with_containment_are_refused(detector, options, message):
    with pytest.raises(crumple.InvalidInput, match=message):
        detector.intersections(world(), containment=True, **options)


def test_containment_of_a_single_mesh_is_refused(detector):
    query = crumple.IntersectionQuery(output="any", containment=True)
    assert not detector.supports(ROOM, query)
    assert detector.supports(ROOM) and detector.supports([UNIT, ROOM], query) and detector.supports(world(), query)
    with pytest.raises(crumple.InvalidInput, match="containment needs bodies: a world or two meshes"):
        detector.find(ROOM, query)


def test_result_with_containment_can_be_saved_as_glb(detector, tmp_path):
    found = detector.intersections(world(), **INSIDE)
    found.save(tmp_path / "found.glb")
    assert (tmp_path / "found.glb").read_bytes()[:4] == b"glTF"
