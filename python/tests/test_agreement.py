"""Tests that results of the Python package have the same bytes as the command line's, and as those of brute force."""

import functools
import subprocess
import sys

import numpy as np
import pytest

import crumple
from conftest import as_set, soup

SCENES = [scene.name for scene in crumple.scenes()]
QUERIES = {
    "default": {},
    "skip": {"neighbours": "skip"},
    "proper": {"kind": "proper"},
    "welded": {"weld": True},
    "between groups": {"filter": crumple.PairFilter(groups="between")},
    "within groups": {"filter": crumple.PairFilter(groups="within")},
    "excluded groups": {"filter": crumple.PairFilter(excluded_groups=[(0, 0), (1, -1)])},
}


@functools.cache
def small(name: str, triangles: int = 300) -> crumple.Mesh:
    """Returns the last frame of a scene. If the scene has no groups, adds three."""
    mesh = crumple.make_scene(name, triangles=triangles)
    return mesh if mesh.groups is not None else mesh._replace(groups=np.arange(len(mesh.faces)) % 3)


def same(found: crumple.Intersections, expected: crumple.Intersections) -> None:
    assert as_set(found.pairs) == as_set(expected.pairs)
    for field in ("pairs", "offsets", "hit", "hit_second"):
        np.testing.assert_array_equal(getattr(found, field), getattr(expected, field), field)
    for field in ("kinds", "offsets", "points"):
        if expected.contacts is not None:
            np.testing.assert_array_equal(getattr(found.contacts, field), getattr(expected.contacts, field), field)


@pytest.mark.installed
@pytest.mark.parametrize("name", SCENES)
def test_intersections_equal_those_of_the_command_line(name, tmp_path, detector):
    crumple.write_mesh(tmp_path / "mesh.ply", small(name, 3000))
    command = [sys.executable, "-m", "crumple", "detect", "mesh.ply", "--contacts", "-o", "answer.npz"]
    subprocess.run(command, cwd=tmp_path, check=True)
    expected = np.load(tmp_path / "answer.npz")
    result = detector.intersections(crumple.read_mesh(tmp_path / "mesh.ply"), output="contacts")
    found = {
        "pairs": result.pairs,
        "offsets": result.offsets,
        "hit": result.hit,
        "contact_kinds": result.contacts.kinds,
        "contact_offsets": result.contacts.offsets,
        "contact_points": result.contacts.points,
    }
    for field, array in found.items():
        np.testing.assert_array_equal(array, expected[field], field)
    assert len(result) == len(expected["pairs"]) and (len(result) > 0) == (name != "shells")


@pytest.mark.parametrize("query", QUERIES)
@pytest.mark.parametrize("name", SCENES)
def test_intersections_with_query_options_match_brute_force(name, query, detector):
    mesh, reference = small(name), crumple.Detector(backend="reference")
    options = {**QUERIES[query], "output": "contacts"}
    same(detector.intersections(mesh, **options), reference.intersections(mesh, **options))
    a, b = (crumple.Mesh(mesh.vertices, mesh.faces[side::2], mesh.groups[side::2]) for side in (0, 1))
    same(detector.intersections(a, b, **options), reference.intersections(a, b, **options))


@pytest.mark.parametrize("name", SCENES)
def test_any_is_true_exactly_if_there_are_pairs(name, detector):
    mesh = small(name)
    for query in QUERIES.values():
        assert detector.any(mesh, crumple.IntersectionQuery(**query)) == bool(detector.intersections(mesh, **query))
        assert detector.any([mesh, mesh], crumple.IntersectionQuery(**query)) == bool(
            detector.intersections(mesh, mesh, **query)
        )


@pytest.mark.parametrize("count", [1, 3, 64, 100])
def test_pairs_of_all_parts_are_the_pairs_of_the_mesh(count, detector):
    mesh = small("cloth", 3000)
    whole = detector.intersections(mesh)
    parts = detector.partition(mesh, count=count)
    assert [part.index for part in parts] == list(range(count))
    joined = np.concatenate([detector.intersections(part).pairs for part in reversed(parts)])
    np.testing.assert_array_equal(joined[np.lexsort(joined.T[::-1])], whole.pairs)

    a, b = soup(200, seed=3), soup(200, seed=4)
    parts = detector.partition([a, b], count=count)
    joined = np.concatenate([detector.intersections(part).pairs for part in parts])
    np.testing.assert_array_equal(joined[np.lexsort(joined.T[::-1])], detector.intersections(a, b).pairs)


def test_pickled_part_gives_the_same_pairs(detector):
    import pickle

    mesh = soup(500)
    for part in detector.partition(mesh, count=4):
        copy = pickle.loads(pickle.dumps(part))
        assert repr(copy) == repr(part)
        np.testing.assert_array_equal(copy.triangles, part.triangles)
        for array, other in zip(copy.mesh, part.mesh):
            np.testing.assert_array_equal(array, other)
        assert len(part.triangles_second) == 0
        found = detector.intersections(copy)
        np.testing.assert_array_equal(found.pairs, detector.intersections(part).pairs)
        np.testing.assert_array_equal(part.triangles[found.hit], np.unique(found.pairs))


def test_threads_clusters_simd_and_memory_limit_do_not_change_results():
    mesh = soup(800)
    expected = crumple.Detector().intersections(mesh, output="contacts")
    for options in [
        {"threads": 1},
        {"threads": 3, "clusters": 33, "leaf_size": 20},
        {"simd": "scalar"},
        {"fuzzy_c_means": crumple.FuzzyCMeans(1.5, 0, 1, 0.5, 0.5)},
        {"leaf_size": 30, "method": crumple.Method(sweep="z")},
        {"leaf_size": 30, "method": crumple.Method(sweep=np.array([1, -2, 0.5]))},
        {"memory_limit": expected.statistics.peak_memory_bytes},
    ]:
        detector = crumple.Detector(**options)
        assert options.items() <= detector.options.items()
        same(detector.intersections(mesh, output="contacts"), expected)


def test_intersections_and_any_accept_one_or_two_meshes(crossing):
    pairs = crumple.intersections(crossing.vertices, crossing.faces).pairs
    assert pairs.tolist() == [[0, 1]] and pairs.dtype == np.int32
    assert crumple.Detector().any(crossing) is True
    assert crumple.Detector().any(crossing, crumple.IntersectionQuery(neighbours="skip", kind="proper")) is True
    far = crumple.Mesh(crossing.vertices + 100, crossing.faces)
    assert crumple.intersections(crossing, far).pairs.shape == (0, 2)
    assert crumple.Detector().any([crossing, far]) is False
    assert crumple.intersections(crossing, crossing).pairs.tolist() == [[0, 0], [0, 1], [1, 0], [1, 1], [2, 2]]


def test_contacts_are_where_the_triangles_meet(crossing, detector):
    contacts = detector.intersections(crossing, output="contacts").contacts
    assert crumple.ContactKind(contacts.kinds[0]) is crumple.ContactKind.SEGMENT
    np.testing.assert_allclose(contacts[0], [[1, 1, 0], [5 / 3, 1, 0]])
    np.testing.assert_array_equal(contacts[-1], contacts[0])
    with pytest.raises(IndexError, match=r"contact 1 does not exist \(number of contacts: 1\)"):
        contacts[1]
