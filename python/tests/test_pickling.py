"""Results, statistics and parts as plain values: pickled and copied, whole or not at all."""

import contextlib
import copy
import pickle
import re
import subprocess
import sys

import numpy as np
import pytest

import crumple
from conftest import OnDevice, soup

PROTOCOLS = range(2, pickle.HIGHEST_PROTOCOL + 1)
MESH, OTHER = soup(200, size=0.4)._replace(groups=np.arange(200, dtype=np.int32) % 3), soup(90, size=0.4, seed=2)
ARRAYS = ("pairs", "offsets", "hit", "hit_second")


def results():
    detector = crumple.Detector(threads=2)
    yield "one soup", detector.find_self(MESH, contacts=True)
    yield "without contacts", detector.find_self(MESH.vertices, MESH.faces.ravel())
    yield "two meshes", detector.find_between(MESH, OTHER, contacts=True)
    yield "an empty second mesh", detector.find_between(MESH, (OTHER.vertices, []))
    yield "nothing", detector.find_self([], [], contacts=True)
    yield "no pairs", detector.find_self(MESH.vertices[:3], MESH.faces[:1], contacts=True)
    yield "lists", detector.find_self(MESH.vertices.tolist(), MESH.faces.tolist())
    yield "integers in lists", detector.find_self([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2], [0, 1, 2]])
    yield "Fortran order", detector.find_self(np.asfortranarray(MESH.vertices), MESH.faces.astype(np.uint8))
    yield "DLPack", detector.find_self(OnDevice(MESH.vertices, kind=1), OnDevice(MESH.faces, kind=1))
    yield "writable", detector.find_self(MESH, copy=True)
    for part in detector.partition(MESH, count=3):
        yield f"part {part.index}", detector.find(part, contacts=True)
    for part in detector.partition(MESH, OTHER, count=2):
        yield f"part {part.index} of two meshes", detector.find(part)
    yield "brute force", crumple.Detector(backend="reference").find_self(MESH, contacts=True)


RESULTS = list(results())


def assert_same(found, expected):
    assert type(found) is crumple.Result and len(found) == len(expected)
    for name in ARRAYS:
        array, other = getattr(found, name), getattr(expected, name)
        np.testing.assert_array_equal(array, other, name, strict=True)
        assert array.flags.writeable == other.flags.writeable, name
    assert (found.contacts is None) == (expected.contacts is None)
    if expected.contacts is not None:
        for name in ("kinds", "offsets", "points"):
            np.testing.assert_array_equal(getattr(found.contacts, name), getattr(expected.contacts, name), name)
    assert found.statistics == expected.statistics and repr(found) == repr(expected)


@pytest.mark.parametrize("result", [r for _, r in RESULTS], ids=[name for name, _ in RESULTS])
def test_a_result_comes_back_whole(result, tmp_path):
    pickled = [pickle.loads(pickle.dumps(result, protocol)) for protocol in PROTOCOLS]
    for found in (*pickled, copy.copy(result), copy.deepcopy(result)):
        assert_same(found, result)
        assert_same(pickle.loads(pickle.dumps(found)), result)
        for name in ("mesh.ply", "mesh.html", "pairs.csv", "pairs.json", "pairs.npz"):
            paths = tmp_path / f"expected.{name}", tmp_path / f"found.{name}"
            for path, saved in zip(paths, (result, found)):
                saved.save(path)
            expected, written = (without_id(path.read_bytes()) for path in paths)
            assert written == expected


def without_id(page):
    return re.sub(b"crumple-[0-9a-f]{32}", b"", page)


def test_a_result_travels_between_processes(tmp_path):
    program = """
import pickle, sys
result = pickle.load(open("result.pickle", "rb"))
result.save("theirs.glb")
pickle.dump(result, open("back.pickle", "wb"))
"""
    result = RESULTS[0][1]
    (tmp_path / "result.pickle").write_bytes(pickle.dumps(result))
    subprocess.run([sys.executable, "-c", program], cwd=tmp_path, check=True)
    assert_same(pickle.loads((tmp_path / "back.pickle").read_bytes()), result)
    result.save(tmp_path / "ours.glb")
    assert (tmp_path / "ours.glb").read_bytes() == (tmp_path / "theirs.glb").read_bytes()


def test_buffers_may_travel_apart():
    result, buffers = RESULTS[0][1], []
    pickled = pickle.dumps(result, 5, buffer_callback=buffers.append)
    assert len(pickled) < 3000 and sum(len(buffer.raw()) for buffer in buffers) > 10_000
    assert_same(pickle.loads(pickled, buffers=buffers), result)


def test_copies_share_and_deep_copies_do_not():
    vertices, faces = MESH.vertices.copy(), MESH.faces.copy()
    result = crumple.Detector().find_self(vertices, faces, contacts=True)
    shared, own = copy.copy(result), copy.deepcopy(result)
    assert shared is not result and np.shares_memory(shared.pairs, result.pairs)
    assert not np.shares_memory(own.pairs, result.pairs)
    page_of = lambda r: without_id(r.to_html().encode())  # noqa: E731
    page, pairs = page_of(result), result.pairs.tolist()
    vertices[...] *= 2
    assert page_of(shared) == page_of(result) != page == page_of(own)
    del result, shared
    assert own.pairs.tolist() == pairs and copy.deepcopy([own, own])[0].pairs.tolist() == pairs
    twice = copy.deepcopy([own, own])
    assert twice[0] is twice[1]


def test_a_copy_keeps_its_memory():
    detector = crumple.Detector(threads=1)
    kept = copy.copy(detector.find_self(MESH))
    expected = kept.pairs.tolist()
    for seed in range(5):
        detector.find_self(soup(200, seed=seed))
    assert kept.pairs.tolist() == expected


def test_what_was_written_into_copies_is_not_carried():
    result = crumple.Detector().find_self(MESH, copy=True)
    expected = result.pairs.tolist()
    result.pairs[...] = 0
    for found in (pickle.loads(pickle.dumps(result)), copy.copy(result), copy.deepcopy(result)):
        assert found.pairs.tolist() == expected and found.pairs.flags.writeable


def test_the_size_of_a_pickle():
    result = crumple.Detector().find_between(MESH, OTHER, contacts=True)
    meshes = sum(array.nbytes for mesh in (MESH, OTHER) for array in mesh if array is not None)
    answer = 8 * len(result) + 9 * 200 + 8 + 90 + 9 * len(result) + 8 + 24 * len(result.contacts.points)
    assert 0 < len(pickle.dumps(result)) - meshes - answer < 3000


def test_meshes_that_cannot_be_pickled_are_named():
    vertices, faces = MESH.vertices.tolist(), MESH.faces.tolist()
    changed = crumple.Detector().find_self(vertices, faces)
    faces.pop()
    with pytest.raises(crumple.InvalidInput, match="^the mesh was changed after the search"):
        pickle.dumps(changed)
    array = OnDevice(MESH.vertices, kind=1)
    moved = crumple.Detector().find_self(array, MESH.faces)
    array.place = (2, 0)
    with pytest.raises(crumple.InvalidInput, match="vertices in CUDA memory|vertices lie in CUDA memory"):
        pickle.dumps(moved)


def state_of(result):
    restore, (state,) = result.__reduce__()
    return restore, state


def changes():
    """Name, what is changed in the state of a result of two meshes with contacts, and what the error is about."""

    def at(name, index, value):
        def change(state):
            state[name] = state[name].copy()
            state[name][index] = value

        return change

    def put(name, value):
        return lambda state: state.__setitem__(name, value(state[name]) if callable(value) else value)

    yield "no dict", None, "must be a dict"
    yield "a field too few", lambda s: s.pop("hit"), "must be a dict of pairs, offsets"
    yield "a field too many", put("colour", "red"), "must be a dict of pairs, offsets"
    for name in ("pairs", "offsets", "hit", "hit_second", "contact_kinds", "contact_offsets", "contact_points"):
        yield f"{name} as list", put(name, lambda a: a.tolist()), f"needs {name} as an array of "
        yield f"{name} of another type", put(name, lambda a: a.astype(np.int16)), f"needs {name} as an array of "
        yield f"{name} of another shape", put(name, lambda a: a[None]), f"needs {name} of shape "
        yield f"{name} cut", put(name, lambda a: a[:-1]), "does not fit together"
        yield f"{name} empty", put(name, lambda a: a[:0]), "does not fit together"
        yield f"{name} longer", put(name, lambda a: np.concatenate([a, a[-1:]])), "does not fit together"
    for value in (-1, 2**31 - 1, 0):
        yield f"first of a pair {value}", at("pairs", (-1, 0), value), "offsets of pairs"
    for value in (-1, 90, 2**31 - 1):
        yield f"second of a pair {value}", at("pairs", (-1, 1), value), ": pairs"
    yield "pairs in another order", put("pairs", lambda a: a[::-1]), "does not fit together"
    yield "the same pair twice", put("pairs", lambda a: np.repeat(a[::2], 2, axis=0)[: len(a)]), "does not fit"
    for value in (-1, 2**62, -(2**63)):
        yield f"offset {value}", at("offsets", 5, value), ": offsets"
        yield f"offset of contacts {value}", at("contact_offsets", 5, value), ": offsets of contacts"
    yield "another hit", put("hit", lambda a: ~a), ": hit"
    yield "hit that is no bool", put("hit", lambda a: (a * np.uint8(7)).view(np.bool_)), ": hit"
    yield "another hit in the second mesh", put("hit_second", lambda a: ~a), ": hit_second"
    yield "another kind", at("contact_kinds", 3, 9), ": kinds of contacts"
    yield "NaN", at("contact_points", (3, 1), np.nan), ": points of contacts"
    yield "no contacts", put("has_contacts", False), ": contacts"
    yield "no bool", put("has_contacts", 1), "needs has_contacts as bool"
    yield "no bool either", put("copy", None), "needs copy as bool"
    yield "no statistics", put("statistics", None), "statistics must be crumple.Statistics"
    raw = crumple.Statistics.__new__(crumple.Statistics)
    yield "statistics without anything", put("statistics", raw), "statistics must be crumple.Statistics with something"
    other = RESULTS[4][1].statistics
    yield "other statistics", put("statistics", other), ": statistics"
    yield "no mesh", put("first", None), "needs first as a tuple"
    yield "no second mesh", put("second", None), ": pairs|: offsets|: hit"
    yield "a mesh of two", put("second", lambda m: m[:2]), "needs second as a tuple"
    yield "faces cut", put("first", lambda m: (m[0], m[1][:-1], None)), ": the number of faces"
    yield "groups cut", put("first", lambda m: (*m[:2], m[2][:-1])), "first mesh: groups must be one for each"
    yield "vertices cut", put("second", lambda m: (m[0][:, :2], *m[1:])), "second mesh: vertices must have shape"
    yield "words", put("second", lambda m: ("vertices", *m[1:])), "second mesh: vertices must have"
    yield "objects", put("second", lambda m: (m[0].astype(object), *m[1:])), "second mesh: vertices must be"


CHANGES = list(changes())


@pytest.mark.parametrize("change, message", [c[1:] for c in CHANGES], ids=[c[0] for c in CHANGES])
def test_a_state_that_does_not_fit_together_is_refused(change, message):
    restore, state = state_of(RESULTS[2][1])
    assert_same(restore(state), RESULTS[2][1])
    if change:
        change(state)
    with pytest.raises(crumple.InvalidInput, match=message):
        restore(state if change else [state])


def test_arrays_with_wrong_bytes_do_not_crash(tmp_path):
    """Whatever comes back fits together, but for the meshes, which writers check."""
    buffers = []
    pickled = pickle.dumps(RESULTS[0][1], 5, buffer_callback=buffers.append)
    buffers = [bytes(buffer) for buffer in buffers]
    random, restored = np.random.default_rng(1), 0
    for _ in range(1000):
        wrong = [bytearray(buffer) for buffer in buffers]
        buffer = wrong[random.integers(len(wrong))]
        for place in random.integers(0, max(len(buffer), 1), random.integers(1, 4)) if buffer else ():
            buffer[place] = random.integers(256)
        try:
            found = pickle.loads(pickled, buffers=wrong)
        except crumple.InvalidInput:
            continue
        restored += 1
        assert found.offsets[-1] == len(found.pairs) and len(list(found.contacts)) == len(found)
        for name in ("pairs.npz", "mesh.glb", "mesh.html"):
            with contextlib.suppress(crumple.InvalidInput), np.errstate(all="ignore"):
                found.save(tmp_path / name)
    assert 100 < restored < 900


@pytest.mark.parametrize("thing", ["statistics", "part", "contacts"])
def test_other_values_are_copied_and_pickled(thing, detector):
    result = detector.find_self(MESH, contacts=True)
    one = {"statistics": result.statistics, "part": detector.partition(MESH, count=2)[1], "contacts": result.contacts}[
        thing
    ]
    copies = [pickle.loads(pickle.dumps(one, protocol)) for protocol in PROTOCOLS]
    for other in (*copies, copy.copy(one), copy.deepcopy(one)):
        assert type(other) is type(one) and other is not one and repr(other) == repr(one)
        if thing == "part":
            assert pickle.dumps(other) == pickle.dumps(one)
            answer, expected = (detector.find(part).pairs for part in (other, one))
            assert answer.tolist() == expected.tolist()
        if thing == "contacts":
            assert [p.tolist() for p in other] == [p.tolist() for p in one]


def test_statistics_are_equal_field_by_field(detector):
    one, other = (detector.find_self(mesh).statistics for mesh in (MESH, OTHER))
    same = pickle.loads(pickle.dumps(one))
    fields = [name for name in dir(crumple.Statistics) if not name.startswith("_")]
    assert set(one.__getstate__()) == set(fields) and len(fields) == 18
    assert all(getattr(same, name) == getattr(one, name) for name in fields)
    assert one == same != other and not one != same and one != 3 and one is not None
    for name in fields:
        state = one.__getstate__()
        state[name] = {str: "none", dict: [0.0] * 7, list: [0.0] * 7}.get(type(state[name]), 12345)
        changed = crumple.Statistics.__new__(crumple.Statistics)
        changed.__setstate__(state)
        assert changed != one, name
    with pytest.raises(TypeError, match="unhashable"):
        hash(one)


@pytest.mark.parametrize("name", [None, "pairs", "milliseconds", "stage_milliseconds", "threads", "backend", "simd"])
@pytest.mark.parametrize("value", ["missing", None, [], 2**70])
def test_the_state_of_statistics_is_checked(name, value):
    state = RESULTS[0][1].statistics.__getstate__()
    if name is None:
        state = value
    elif value == "missing":
        del state[name]
    elif (name, value) == ("milliseconds", 2**70):
        return  # a number like any other
    else:
        state[name] = value
    with pytest.raises(crumple.InvalidType, match=f"the state of Statistics (must be a dict|needs another {name})$"):
        crumple.Statistics.__new__(crumple.Statistics).__setstate__(state)


def test_names_in_statistics_are_kept_once():
    """And only so many of them: hostile states shall not fill the memory."""
    program = """
import crumple
state = crumple.Detector().find_self([], []).statistics.__getstate__()
one = crumple.Statistics.__new__(crumple.Statistics)
one.__setstate__(state)
try:
    for i in range(1000):
        crumple.Statistics.__new__(crumple.Statistics).__setstate__({**state, "simd": f"set {i}"})
except crumple.InvalidInput as error:
    print(i, error)
one = crumple.Statistics.__new__(crumple.Statistics)
one.__setstate__(state)
print(one.__getstate__() == state)
"""
    process = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    out = process.stdout.splitlines()
    assert out[0].endswith("the state of Statistics has a name that nobody knows") and out[1] == "True"
