"""Tests of overlaps from parts of meshes: combine() makes of the results of all parts the result of the whole."""

import copy
import pickle

import numpy as np
import pytest

import crumple
from crumple._results import Array

ARRAYS = [name for name, value in vars(crumple.Overlaps).items() if isinstance(value, Array)]
OPTIONS = {
    "gradient": True,
    "curves": True,
    "windings": True,
    "depths": True,
    "depth_tolerance": 0.1,
    "directions": [(0, 0, 1), (1, 2, 3)],
    "translation": True,
    "unions": True,
    "regions": True,
}


def balls(count, seed):
    """Returns a mesh of several tetrahedra, which may meet."""
    rng = np.random.default_rng(seed)
    corners = rng.normal(size=(count, 4, 3))
    inside_out = np.linalg.det(corners[:, 1:] - corners[:, :1]) < 0
    corners[inside_out] = corners[inside_out][:, [0, 2, 1, 3]]
    faces = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]) + 4 * np.arange(count)[:, None, None]
    return crumple.Mesh(corners.reshape(-1, 3), faces.reshape(-1, 3).astype(np.int32))


ONE, OTHER = balls(6, 1), balls(5, 2)


def found_in_parts(detector, scene, query, count):
    """Finds the result of each part, each with a pickled part and a detector of its own, and pickles the results."""
    parts = [pickle.loads(pickle.dumps(part)) for part in detector.partition(scene, query, count=count)]
    elsewhere = crumple.Detector(backend=detector.backend, threads=1)
    return [pickle.loads(pickle.dumps(elsewhere.find(part, query))) for part in parts]


def assert_same(found, whole):
    for name in ARRAYS:
        if not name.startswith("part_"):
            assert getattr(found._found, name).tobytes() == getattr(whole._found, name).tobytes(), name
    assert (found.any, found.count) == (whole.any, whole.count)


@pytest.mark.parametrize("count", [1, 7])  # C++ tests have more
@pytest.mark.parametrize("scene", [ONE, [ONE, OTHER]], ids=["one", "two"])
def test_parts_together_have_the_overlaps_of_the_whole(scene, count, either):
    query = crumple.OverlapQuery(**OPTIONS)
    found = found_in_parts(either, scene, query, count)
    assert sorted(result.part for result in found) == [(i, count) for i in range(count)]
    whole = either.find(scene, query)
    assert_same(either.combine(scene, query, reversed(found)), whole)
    assert len(whole) == 1 and len(whole.curve_points) == 0 if scene is ONE else len(whole.curve_points)


def test_parts_of_two_meshes_have_overlaps_of_each_with_itself(detector):
    query = crumple.OverlapQuery(self_overlaps=True, gradient=True)
    found = found_in_parts(detector, [ONE, OTHER], query, 3)
    combined = detector.combine([ONE, OTHER], query, found)
    assert_same(combined, detector.find([ONE, OTHER], query))
    assert combined.bodies.tolist() == [[0, 0], [0, 1], [1, 1]]
    bodies = np.concatenate([result.part_bodies for result in found])
    assert np.unique(bodies, axis=0).tolist() == [[0, 0], [0, 1], [1, 1]]
    without = found_in_parts(detector, [ONE, OTHER], crumple.OverlapQuery(), 3)
    with pytest.raises(crumple.InvalidInput, match=r"result 0 of combine\(\) was found without self_overlaps"):
        detector.combine([ONE, OTHER], query, without)


def test_result_about_a_part_has_pairs_of_triangles_only(detector):
    (part,) = detector.partition(ONE, crumple.OverlapQuery(), count=1)
    assert detector.supports(part, crumple.OverlapQuery())
    found = detector.overlaps(part)
    assert found.part == (0, 1) and not found and len(found) == 0
    np.testing.assert_array_equal(found.part_pairs, detector.intersections(ONE).pairs)
    assert repr(found) == f"<crumple.Overlaps: part 0 of 1, {len(found.part_pairs)} pairs of triangles>"
    for same in (copy.copy(found), copy.deepcopy(found), pickle.loads(pickle.dumps(found))):
        assert same.part == (0, 1) and same.part_pairs.tobytes() == found.part_pairs.tobytes()
    for name in ("volume", "bodies", "world_hit"):
        with pytest.raises(crumple.InvalidInput, match=f"Detector.combine makes rows .*, not {name}$"):
            getattr(found, name)
    whole = detector.overlaps(ONE)
    assert whole.part is None
    with pytest.raises(crumple.InvalidInput, match="part_pairs is about a part"):
        whole.part_pairs  # noqa: B018
    with pytest.raises(crumple.InvalidInput, match="one part does not determine which bodies overlap"):
        detector.any(part, crumple.OverlapQuery())


def test_results_that_do_not_fit_together_are_errors(detector):
    query = crumple.OverlapQuery()
    found = found_in_parts(detector, ONE, query, 3)
    for results, message in (
        ([], r"combine\(\) needs the results of all parts"),
        (found[:2], "is about one of another number of parts"),
        ([found[0], found[1], found[0]], "is about the same part as an earlier one"),
        ([*found[:2], detector.overlaps(ONE)], "is not about a part of the scene"),
    ):
        with pytest.raises(crumple.InvalidInput, match=message):
            detector.combine(ONE, query, results)
    with pytest.raises(crumple.InvalidInput, match="a triangle that the scene lacks"):
        detector.combine(balls(1, 1), query, found)
    with pytest.raises(crumple.InvalidType, match=r"parts must be results of crumple.OverlapQuery, not Part"):
        detector.combine(ONE, query, detector.partition(ONE, query, count=2))
    with pytest.raises(crumple.InvalidInput, match="combine does not support IntersectionQuery"):
        detector.combine(ONE, crumple.IntersectionQuery(), found)
    with pytest.raises(crumple.InvalidInput, match="needs the mesh or the two meshes that were cut into parts"):
        detector.combine(crumple.World([ONE, OTHER]), query, found)


def test_pickles_of_results_about_parts_are_validated(detector):
    (part,) = detector.partition(ONE, crumple.OverlapQuery(), count=1)
    restore, (kind, request, state) = detector.overlaps(part).__reduce__()
    for changes in (
        {"part": (1, 1, True)},
        {"part": (0, 1)},
        {"part": (0, 0, True)},
        {"part_bodies": state["part_bodies"][1:]},
        {"part_bodies": state["part_bodies"] + np.int32(2)},
        {"part_pairs": -state["part_pairs"] - np.int32(1)},
        {"any": True},
    ):
        with pytest.raises((crumple.InvalidInput, crumple.InvalidType)):
            restore(kind, request, {**state, **changes})
    assert restore(kind, request, state).part == (0, 1)
