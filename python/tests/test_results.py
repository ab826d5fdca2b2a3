"""Tests of the arrays of results: read-only views that keep their memory alive as long as they are in use."""

import gc
import sys
import weakref

import numpy as np
import pytest

import crumple
from conftest import soup


def address(array) -> int:
    return array.__array_interface__["data"][0]


def fields(result):
    contacts = result.contacts
    return {
        "pairs": result.pairs,
        "offsets": result.offsets,
        "hit": result.hit,
        "kinds": contacts.kinds,
        "contact offsets": contacts.offsets,
        "points": contacts.points,
    }


def test_arrays_have_documented_shapes_types_and_order(detector):
    result = detector.intersections(soup(300), output="contacts")
    k, p = len(result), len(result.contacts.points)
    expected = {
        "pairs": ((k, 2), np.int32),
        "offsets": ((301,), np.int64),
        "hit": ((300,), np.bool_),
        "kinds": ((k,), np.uint8),
        "contact offsets": ((k + 1,), np.int64),
        "points": ((p, 3), np.float64),
    }
    for name, array in fields(result).items():
        assert (array.shape, array.dtype) == expected[name], name
    assert k > 30 and (result.pairs[:, 0] < result.pairs[:, 1]).all()
    assert result.pairs.tolist() == sorted(result.pairs.tolist())
    assert result.hit.nonzero()[0].tolist() == sorted(set(result.pairs.ravel().tolist()))
    for i in range(300):
        assert (result.pairs[result.offsets[i] : result.offsets[i + 1], 0] == i).all()
    assert result.hit_second.shape == (0,)
    assert [points.tolist() for points in result.contacts] == [result.contacts[i].tolist() for i in range(k)]
    assert result.contacts.offsets[-1] == p == sum(len(result.contacts[i]) for i in range(k))


def test_each_of_two_meshes_has_its_own_hit_flags(detector):
    result = detector.intersections(soup(40, seed=1, size=0.5), soup(70, seed=2, size=0.5))
    assert result.offsets.shape == (41,) and result.hit.shape == (40,) and result.hit_second.shape == (70,)
    assert result.hit.nonzero()[0].tolist() == sorted(set(result.pairs[:, 0].tolist()))
    assert result.hit_second.nonzero()[0].tolist() == sorted(set(result.pairs[:, 1].tolist()))
    assert result.contacts is None


def test_arrays_are_read_only_views(detector):
    result = detector.intersections(soup(300), output="contacts")
    for name, array in fields(result).items():
        assert not array.flags.writeable and not array.flags.owndata, name
        with pytest.raises(ValueError):
            array[...] = 0
    assert result.pairs is result.pairs
    assert address(result._found.pairs) == address(result.pairs), "no copy is made"


def test_arrays_of_a_result_made_with_copy_are_writable(detector):
    result = detector.intersections(soup(300), output="contacts", copy=True)
    for array in fields(result).values():
        array[...] = 0
    assert not result.pairs.any()
    assert crumple.intersections(soup(300), copy=True).pairs.flags.writeable


def test_later_searches_and_errors_do_not_change_a_result(detector):
    results = []
    for seed in range(6):
        results.append(detector.intersections(soup(200 + 50 * seed, seed=seed), output="contacts"))
        if seed == 2:
            with pytest.raises(crumple.InvalidInput):
                detector.intersections([[0, 0, np.nan]], [])
    for seed, result in enumerate(results):
        fresh = crumple.Detector().intersections(soup(200 + 50 * seed, seed=seed), output="contacts")
        for name, array in fields(fresh).items():
            np.testing.assert_array_equal(fields(result)[name], array, name)


def test_a_view_outlives_result_detector_and_input():
    mesh = soup(500)
    expected = crumple.intersections(mesh).pairs.tolist()
    for warm in (0, 3):
        detector = crumple.Detector()
        for _ in range(warm):
            detector.intersections(mesh)
        own = soup(500)
        pairs = detector.intersections(own).pairs
        del detector, own
        gc.collect()
        churn = [crumple.intersections(soup(500, seed=s)).pairs for s in range(5)]
        assert pairs.tolist() == expected and len(churn) == 5


def test_result_is_freed_with_its_last_reference(detector):
    """A result is freed without the garbage collector, because neither its views nor its meshes refer to it."""
    gc.disable()
    try:
        result = detector.intersections(soup(300), output="contacts")
        gone, storage = weakref.ref(result), address(result.pairs)
        assert len(fields(result)) > 3 and result.statistics
        del result
        assert gone() is None
        assert address(detector.intersections(soup(300)).pairs) == storage, "its memory is used again"
    finally:
        gc.enable()


def test_arrays_of_a_result_are_created_once(detector):
    result = detector.intersections(soup(50), output="contacts")
    for name in ("pairs", "offsets", "hit", "hit_second", "contacts"):
        assert getattr(result, name) is getattr(result, name)
        assert getattr(crumple.Intersections, name).__doc__


def test_memory_of_results_in_use_is_not_reused(detector):
    """A detector alternates between the memory of two results. It allocates more if the caller keeps more results."""
    mesh, other = soup(300), soup(300, seed=2)
    expected, others = crumple.intersections(mesh).pairs.tolist(), crumple.intersections(other).pairs.tolist()
    loop, seen = None, set()
    for _ in range(6):
        loop = detector.intersections(mesh)
        seen.add(address(loop.pairs))
    assert len(seen) == 2
    kept = [detector.intersections(scene).pairs for scene in 3 * (mesh, other)]
    assert [pairs.tolist() for pairs in kept] == 3 * [expected, others]
    assert len({address(pairs) for pairs in (loop.pairs, *kept)}) == 7
    with pytest.raises(crumple.InvalidInput):
        detector.intersections(mesh.vertices * np.nan, mesh.faces)
    assert loop.pairs.tolist() == expected and detector.intersections(mesh).pairs.tolist() == expected


def test_reference_cycle_of_mesh_and_result_is_collected(detector):
    class Owner:
        def __init__(self):
            self.vertices, self.faces, _ = soup(30)

    owner = Owner()
    owner.result = detector.intersections(owner.vertices, Faces(owner))
    gone = weakref.ref(owner)
    del owner
    gc.collect()
    assert gone() is None


class Faces:
    """Array-like that supports only __array__, and is part of a reference cycle: it refers to the result's owner."""

    def __init__(self, owner):
        self.owner = owner

    def __array__(self, dtype=None, copy=None):
        return self.owner.faces


def test_arrays_of_a_result_do_not_keep_the_input_alive():
    mesh = soup(300)
    vertices = mesh.vertices.copy()
    gone = weakref.ref(vertices)
    result = crumple.Detector().intersections(vertices, mesh.faces, output="contacts")
    arrays = fields(result)
    del vertices
    assert gone() is not None, "a result keeps its input for pictures"
    del result
    gc.collect()
    assert gone() is None and all(map(len, arrays.values()))


def test_inputs_are_released_after_queries_and_errors(detector):
    mesh = soup(300)
    arrays = (mesh.vertices, mesh.faces)
    counts = [sys.getrefcount(a) for a in arrays]
    detector.any(mesh)
    detector.intersections(mesh)
    with pytest.raises(crumple.InvalidInput):
        detector.intersections(mesh.vertices, mesh.faces, groups=[1])
    with pytest.raises(crumple.InvalidInput):
        detector.intersections(mesh.vertices[:5], mesh.faces)
    gc.collect()
    assert [sys.getrefcount(a) for a in arrays] == counts


def test_loop_over_frames_uses_memory_of_two_results(detector):
    """A loop that keeps one result at a time has the pairs of all results in the same two arrays, once it is warm."""
    mesh = soup(2000)
    addresses = []
    result = None
    for _ in range(10):
        result = detector.intersections(mesh)
        addresses.append(address(result.pairs))
    assert len(set(addresses[-6:])) <= 2
    assert result.statistics.pairs == len(result)


def test_freeing_results_in_random_order_does_not_change_the_others(detector):
    random = np.random.default_rng(5)
    held, mesh = [], [soup(int(n), seed=int(n)) for n in random.integers(1, 400, 10)]
    expected = [crumple.intersections(m).pairs.tolist() for m in mesh]
    for _ in range(200):
        which = int(random.integers(10))
        held.append((which, detector.intersections(mesh[which]).pairs))
        if len(held) > 5:
            index, pairs = held.pop(int(random.integers(5)))
            assert pairs.tolist() == expected[index]


def test_repeated_searches_do_not_leak_memory():
    import resource

    mesh = soup(20_000, size=0.05)
    detector = crumple.Detector()

    def loop(n):
        for _ in range(n):
            detector.intersections(mesh, output="contacts")
            crumple.intersections(mesh)
        return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss

    before = loop(20)
    assert loop(40) - before < 20_000  # KiB


def test_statistics_have_counts_memory_and_stage_times(detector):
    mesh = crumple.make_scene("cloth", triangles=3000, frame=93)
    result = detector.intersections(mesh)
    s = result.statistics
    assert (s.triangles, s.pairs, s.backend, s.threads) == (len(mesh.faces), len(result), "cpu", 2)
    assert s.simd and s.box_overlaps >= s.pairs and s.peak_memory_bytes > 8 * s.pairs and s.leaves >= s.clusters >= 1
    assert list(s.stage_milliseconds) == ["bounds", "subdivide", "align", "sort", "sweep", "narrow", "output"]
    assert 0 < s.milliseconds and all(t >= 0 for t in s.stage_milliseconds.values())
    assert f"pairs={s.pairs}" in repr(s)
    # One thread, because with two it is chance which of them searches the largest leaf, and the peak depends on it. If
    # results did not count, the peaks of warm calls would be lower.
    one = crumple.Detector(threads=1)
    peaks = [one.intersections(mesh).statistics.peak_memory_bytes for _ in range(4)]
    assert max(peaks) - min(peaks) < 4 * s.pairs, "the result counts in cold and warm calls"


def test_reprs_describe_result_contacts_and_detector(detector, crossing):
    result = detector.intersections(crossing, output="contacts")
    assert repr(result).startswith("<crumple.Intersections: 1 colliding pairs of 3 triangles, ")
    assert repr(result.contacts) == "<crumple.Contacts: 1 pairs, 2 points>"
    assert repr(detector).startswith("crumple.Detector(backend='automatic', threads=2, ")
    assert len(result) == 1 and result and not detector.intersections([], [])
