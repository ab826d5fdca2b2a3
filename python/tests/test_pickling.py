"""Tests of results, statistics and parts as plain values: they can be pickled and copied; inconsistent pickles fail."""

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
from features import restored

PROTOCOLS = range(2, pickle.HIGHEST_PROTOCOL + 1)
MESH, OTHER = soup(200, size=0.4)._replace(groups=np.arange(200, dtype=np.int32) % 3), soup(90, size=0.4, seed=2)
ARRAYS = ("pairs", "offsets", "hit", "hit_second")


def results():
    detector = crumple.Detector(threads=2)
    yield "one soup", detector.intersections(MESH, output="contacts")
    yield "without contacts", detector.intersections(MESH.vertices, MESH.faces.ravel())
    yield "two meshes", detector.intersections(MESH, OTHER, output="contacts")
    yield "an empty second mesh", detector.intersections(MESH, (OTHER.vertices, []))
    yield "nothing", detector.intersections([], [], output="contacts")
    yield "no pairs", detector.intersections(MESH.vertices[:3], MESH.faces[:1], output="contacts")
    yield "lists", detector.intersections(MESH.vertices.tolist(), MESH.faces.tolist())
    yield "integers in lists", detector.intersections([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2], [0, 1, 2]])
    yield "Fortran order", detector.intersections(np.asfortranarray(MESH.vertices), MESH.faces.astype(np.uint8))
    yield "DLPack", detector.intersections(OnDevice(MESH.vertices, kind=1), OnDevice(MESH.faces, kind=1))
    yield "writable", detector.intersections(MESH, copy=True)
    for part in detector.partition(MESH, count=3):
        yield f"part {part.index}", detector.intersections(part, output="contacts")
    for part in detector.partition([MESH, OTHER], count=2):
        yield f"part {part.index} of two meshes", detector.intersections(part)
    yield "brute force", crumple.Detector(backend="reference").intersections(MESH, output="contacts")


RESULTS = list(results())


def assert_same(found, expected):
    assert type(found) is crumple.Intersections and len(found) == len(expected)
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
def test_copied_or_pickled_result_is_equal_to_the_original(result, tmp_path):
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


@pytest.mark.parametrize("output", ["any", "any_by_world", "body_pairs", "count"])
def test_copied_or_pickled_results_without_pairs_are_equal(output, detector):
    for scene in (MESH, [MESH, OTHER]):
        result = detector.find(scene, crumple.IntersectionQuery(output=output))
        for found in (pickle.loads(pickle.dumps(result)), copy.copy(result), copy.deepcopy(result)):
            assert repr(found) == repr(result) and found.any is result.any is True and len(found) == 0
            assert found.statistics == result.statistics
            if output == "count":
                assert found.count == result.count
            if output == "body_pairs":
                assert found.bodies.tolist() == result.bodies.tolist()
            with pytest.raises(crumple.InvalidInput, match=r'pairs was not requested: .*output="pairs"'):
                _ = found.pairs
        if output == "count":
            with pytest.raises(crumple.InvalidInput, match=": statistics"):
                restored(result, count=lambda n: n + 1)


def test_result_survives_pickling_between_processes(tmp_path):
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


def test_buffers_can_be_pickled_out_of_band():
    result, buffers = RESULTS[0][1], []
    pickled = pickle.dumps(result, 5, buffer_callback=buffers.append)
    assert len(pickled) < 3000 and sum(len(buffer.raw()) for buffer in buffers) > 10_000
    assert_same(pickle.loads(pickled, buffers=buffers), result)


def test_shallow_copies_share_memory_and_deep_copies_do_not():
    vertices, faces = MESH.vertices.copy(), MESH.faces.copy()
    result = crumple.Detector().intersections(vertices, faces, output="contacts")
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


def test_later_searches_do_not_change_a_copy():
    detector = crumple.Detector(threads=1)
    kept = copy.copy(detector.intersections(MESH))
    expected = kept.pairs.tolist()
    for seed in range(5):
        detector.intersections(soup(200, seed=seed))
    assert kept.pairs.tolist() == expected


def test_writes_to_the_arrays_are_not_pickled_or_copied():
    result = crumple.Detector().intersections(MESH, copy=True)
    expected = result.pairs.tolist()
    result.pairs[...] = 0
    for found in (pickle.loads(pickle.dumps(result)), copy.copy(result), copy.deepcopy(result)):
        assert found.pairs.tolist() == expected and found.pairs.flags.writeable


def test_pickle_is_hardly_larger_than_its_arrays():
    result = crumple.Detector().intersections(MESH, OTHER, output="contacts")
    meshes = sum(array.nbytes for mesh in (MESH, OTHER) for array in mesh if array is not None)
    arrays = 8 * len(result) + 9 * 200 + 8 + 90 + 9 * len(result) + 8 + 24 * len(result.contacts.points)
    assert 0 < len(pickle.dumps(result)) - meshes - arrays < 3000


def test_result_with_a_changed_or_device_mesh_cannot_be_pickled():
    vertices, faces = MESH.vertices.tolist(), MESH.faces.tolist()
    changed = crumple.Detector().intersections(vertices, faces)
    faces.pop()
    with pytest.raises(crumple.InvalidInput, match="^the mesh was changed after the search"):
        pickle.dumps(changed)
    array = OnDevice(MESH.vertices, kind=1)
    moved = crumple.Detector().intersections(array, MESH.faces)
    array.place = (2, 0)
    with pytest.raises(crumple.InvalidInput, match="vertices in CUDA memory|vertices lie in CUDA memory"):
        pickle.dumps(moved)


def changes():
    """Yields invalid changes to the state of a result of two meshes with contacts.

    Each is (name of the change, name of the array or value, function that changes it, part of the expected message).
    """

    def at(index, value):
        def change(array):
            array = array.copy()
            array[index] = value
            return array

        return change

    def put(value):
        return lambda _: value

    for name in ("pairs", "offsets", "hit", "hit_second", "contact_kinds", "contact_offsets", "contact_points"):
        yield f"{name} as list", name, lambda a: a.tolist(), f"needs {name} as an array "
        yield f"{name} of another type", name, lambda a: a.astype(np.int16), f"needs {name} as an array "
        yield f"{name} of another shape", name, lambda a: a[None], f"needs {name} as an array "
        yield f"{name} cut", name, lambda a: a[:-1], "is inconsistent"
        yield f"{name} empty", name, lambda a: a[:0], "is inconsistent"
        yield f"{name} longer", name, lambda a: np.concatenate([a, a[-1:]]), "is inconsistent"
    for value in (-1, 2**31 - 1, 0):
        yield f"first of a pair {value}", "pairs", at((-1, 0), value), "offsets of pairs"
    for value in (-1, 90, 2**31 - 1):
        yield f"second of a pair {value}", "pairs", at((-1, 1), value), ": pairs"
    yield "pairs in another order", "pairs", lambda a: a[::-1], "is inconsistent"
    yield "the same pair twice", "pairs", lambda a: np.repeat(a[::2], 2, axis=0)[: len(a)], "is inconsistent"
    for value in (-1, 2**62, -(2**63)):
        yield f"offset {value}", "offsets", at(5, value), ": offsets"
        yield f"offset of contacts {value}", "contact_offsets", at(5, value), ": offsets of contacts"
    yield "another hit", "hit", lambda a: ~a, ": hit"
    yield "hit that is no bool", "hit", lambda a: (a * np.uint8(7)).view(np.bool_), ": hit"
    yield "another hit in the second mesh", "hit_second", lambda a: ~a, ": hit_second"
    yield "another kind", "contact_kinds", at(3, 9), ": kinds of contacts"
    yield "NaN", "contact_points", at((3, 1), np.nan), ": points of contacts"
    yield "no contacts", "output", put("pairs"), ": contacts"
    yield "pairs that were not asked for", "output", put("count"), ": pairs"
    yield "no output", "output", put("all"), ": output"
    yield "no str", "output", put(1), "needs output as str"
    yield "no bool", "copy", put(None), "needs copy as bool"
    yield "no options", "options", put(["index"]), "needs options as frozenset"
    yield "no scene", "scene", put("meshs"), ": scene"
    yield "no bodies", "of_bodies", put(True), ": scene"
    yield "no block", "block", put(True), ": offsets"
    yield "nothing", "any", put(False), ": count"
    yield "another count", "count", lambda n: n + 1, ": count"
    yield "a count that is no int", "count", float, "needs count as int"
    yield "no statistics", "statistics", put(None), "needs statistics as Statistics"
    raw = crumple.Statistics.__new__(crumple.Statistics)
    yield "statistics without anything", "statistics", put(raw), "needs statistics as Statistics"
    yield "other statistics", "statistics", put(RESULTS[4][1].statistics), ": statistics"
    yield "no mesh", "first", put(None), "needs first as a tuple"
    yield "no second mesh", "second", put(None), ": pairs|: offsets|: hit"
    yield "a mesh of two", "second", lambda m: m[:2], "needs second as a tuple"
    yield "faces cut", "first", lambda m: (m[0], m[1][:-1], None), ": the number of faces"
    yield "groups cut", "first", lambda m: (*m[:2], m[2][:-1]), "first mesh: groups must be one for each"
    yield "vertices cut", "second", lambda m: (m[0][:, :2], *m[1:]), "second mesh: vertices must have shape"
    yield "words", "second", lambda m: ("vertices", *m[1:]), "second mesh: vertices must have"
    yield "objects", "second", lambda m: (m[0].astype(object), *m[1:]), "second mesh: vertices must be"
    yield "ids as list", "ids", put([1, 2]), "needs ids as an array"
    yield "ids of another mesh", "ids", put(np.arange(9, dtype=np.int32)), ": ids"


CHANGES = list(changes())


@pytest.mark.parametrize("name, change, message", [c[1:] for c in CHANGES], ids=[c[0] for c in CHANGES])
def test_inconsistent_pickled_state_is_refused(name, change, message):
    assert_same(restored(RESULTS[2][1]), RESULTS[2][1])
    with pytest.raises(crumple.InvalidInput, match=message):
        restored(RESULTS[2][1], **{name: change})


def test_pickled_state_of_another_form_is_refused():
    restore, (kind, asked, state, *scene) = RESULTS[2][1].__reduce__()
    for given, message in (
        (("Result", asked, state, *scene), "a result must be one of Intersections, Impacts, .*, not 'Result'"),
        (([], asked, state, *scene), "a result must be one of"),
        ((kind, None, state, *scene), "needs the request as a tuple of scene, "),
        ((kind, asked[1:], state, *scene), "needs the request as a tuple of scene, "),
        ((kind, asked, [state], *scene), "the state of Intersections must be a dict of any, bodies, "),
        ((kind, asked, {**state, "colour": "red"}, *scene), "must be a dict of any, bodies, "),
        ((kind, asked, {name: state[name] for name in state if name != "hit"}, *scene), "must be a dict of any, "),
        ((kind, asked, state, *scene[1:]), "needs two meshes, and ids of their triangles"),
        ((kind, ("world", True, *asked[2:]), state, *scene), "needs the world and its poses"),
    ):
        with pytest.raises(crumple.InvalidType, match=message):
            restore(*given)


def test_copied_or_pickled_blocks_are_equal_to_the_original(detector, tmp_path):
    world = crumple.World([MESH, OTHER], worlds=[0, 0], self_collisions=True)
    for scene in (MESH, [MESH, OTHER], world):
        blocks = []
        detector.stream(scene, crumple.IntersectionQuery(output="contacts"), blocks.append, block_rows=20)
        for found in (pickle.loads(pickle.dumps(blocks[1])), copy.copy(blocks[1]), copy.deepcopy(blocks[1])):
            assert repr(found) == repr(blocks[1]) and len(found) == found.count == 20
            assert found.pairs.tolist() == blocks[1].pairs.tolist()
            assert [p.tolist() for p in found.contacts] == [p.tolist() for p in blocks[1].contacts]
            if scene is world:
                assert found.bodies.tolist() == blocks[1].bodies.tolist()
                continue
            for name, block in (("expected.csv", blocks[1]), ("found.csv", found)):
                block.save(tmp_path / name)
            assert (tmp_path / "found.csv").read_bytes() == (tmp_path / "expected.csv").read_bytes()
            with pytest.raises(crumple.InvalidInput, match="offsets is part of a whole result"):
                _ = found.offsets
        for change in (lambda a: -1 - a, lambda a: a[1:]):
            with pytest.raises(crumple.InvalidInput, match="is inconsistent"):
                restored(blocks[1], pairs=change)


def test_pickled_results_of_version_0_2_are_refused():
    """Pickles of results of version 0.2 name the functions that restored them."""
    functions = ["_pickling.restore", "_feature_pickling.restore", "_world_pickling.restore_result"]
    functions += ["_candidates._restore", "_nearest._restore"]
    program = r"""
import pickle, sys
for function in sys.argv[1:]:
    module, _, name = function.rpartition(".")
    try:
        pickle.loads(f"ccrumple.{module}\n{name}\n(I1\ntR.".encode())
    except ValueError as error:
        print(f"{type(error).__name__}: {error}")
"""
    process = subprocess.run([sys.executable, "-c", program, *functions], capture_output=True, text=True, check=True)
    refusal = "InvalidInput: this was pickled by crumple 0.2, whose results crumple 0.3 does not read: "
    lines = process.stdout.splitlines()
    assert len(lines) == 5 and all(line.startswith(refusal) for line in lines)


def test_class_names_of_older_pickles_load_the_current_classes():
    """Old pickles name classes by the modules that they were in then."""
    for path, kind in (
        ("_fuzzy_c_means.FuzzyCMeans", crumple.FuzzyCMeans),
        ("_impacts.FirstImpact", crumple.FirstImpact),
        ("_impacts.FreeStep", crumple.FreeStep),
        ("_proximities.EdgeEdgeType", crumple.EdgeEdgeType),
        ("_proximities.VertexEdgeType", crumple.VertexEdgeType),
        ("_proximities.VertexFaceType", crumple.VertexFaceType),
        ("_proximities.VertexVertexType", crumple.VertexVertexType),
        ("_result.ContactKind", crumple.ContactKind),
        ("_result.Contacts", crumple.Contacts),
    ):
        module, name = path.split(".")
        assert pickle.loads(f"ccrumple.{module}\n{name}\n.".encode()) is kind
    own, other = (pickle.loads(f"ccrumple.{module}\nOwnName\n.".encode()) for module in ("_shape", "_world"))
    assert own is other
    with pytest.raises(AttributeError, match="Block"):
        pickle.loads(b"ccrumple._result\nBlock\n.")


def test_pickle_with_corrupt_arrays_is_refused_or_consistent(tmp_path):
    """Any result that can be restored is consistent, except for its meshes, which the writers of files check."""
    buffers = []
    pickled = pickle.dumps(RESULTS[0][1], 5, buffer_callback=buffers.append)
    buffers = [bytes(buffer) for buffer in buffers]
    random, whole = np.random.default_rng(1), 0
    for _ in range(1000):
        wrong = [bytearray(buffer) for buffer in buffers]
        buffer = wrong[random.integers(len(wrong))]
        for place in random.integers(0, max(len(buffer), 1), random.integers(1, 4)) if buffer else ():
            buffer[place] = random.integers(256)
        try:
            found = pickle.loads(pickled, buffers=wrong)
        except crumple.InvalidInput:
            continue
        whole += 1
        first, second = found.pairs.T
        assert np.repeat(np.arange(len(found.hit)), np.diff(found.offsets)).tolist() == first.tolist()
        assert (first < second).all() and found.hit.nonzero()[0].tolist() == np.unique(found.pairs).tolist()
        assert len(list(found.contacts)) == len(found) and np.isfinite(found.contacts.points).all()
        for name in ("pairs.npz", "mesh.glb", "mesh.html"):
            with contextlib.suppress(crumple.InvalidInput), np.errstate(all="ignore"):
                found.save(tmp_path / name)
    assert 100 < whole < 900


@pytest.mark.parametrize("thing", ["statistics", "part", "contacts"])
def test_statistics_parts_and_contacts_can_be_pickled(thing, detector):
    result = detector.intersections(MESH, output="contacts")
    one = {"statistics": result.statistics, "part": detector.partition(MESH, count=2)[1], "contacts": result.contacts}[
        thing
    ]
    copies = [pickle.loads(pickle.dumps(one, protocol)) for protocol in PROTOCOLS]
    for other in (*copies, copy.copy(one), copy.deepcopy(one)):
        assert type(other) is type(one) and other is not one and repr(other) == repr(one)
        if thing == "part":
            assert pickle.dumps(other) == pickle.dumps(one)
            pairs, expected = (detector.intersections(part).pairs for part in (other, one))
            assert pairs.tolist() == expected.tolist()
        if thing == "contacts":
            assert [p.tolist() for p in other] == [p.tolist() for p in one]


def test_statistics_are_equal_if_all_fields_are(detector):
    one, other = (detector.intersections(mesh).statistics for mesh in (MESH, OTHER))
    same = pickle.loads(pickle.dumps(one))
    fields = [name for name in dir(crumple.Statistics) if not name.startswith("_")]
    assert set(one.__getstate__()) == set(fields) and len(fields) == 19
    assert all(getattr(same, name) == getattr(one, name) for name in fields)
    assert one == same != other and not one != same and one != 3 and one is not None
    for name in fields:
        state = one.__getstate__()
        state[name] = {str: "none", dict: [0.0] * 7, list: [0.0] * 7, bool: False}.get(type(state[name]), 12345)
        changed = crumple.Statistics.__new__(crumple.Statistics)
        changed.__setstate__(state)
        assert changed != one, name
    with pytest.raises(TypeError, match="unhashable"):
        hash(one)
    old = one.__getstate__()
    del old["complete"]  # as older versions pickled it
    restored = crumple.Statistics.__new__(crumple.Statistics)
    restored.__setstate__(old)
    assert restored == one and restored.complete is True


@pytest.mark.parametrize("name", [None, "pairs", "milliseconds", "stage_milliseconds", "threads", "backend", "simd"])
@pytest.mark.parametrize("value", ["missing", None, [], 2**70])
def test_malformed_state_of_statistics_is_refused(name, value):
    state = RESULTS[0][1].statistics.__getstate__()
    if name is None:
        state = value
    elif value == "missing":
        del state[name]
    elif (name, value) == ("milliseconds", 2**70):
        return  # 2**70 is a valid float
    else:
        state[name] = value
    with pytest.raises(crumple.InvalidType, match=f"the state of Statistics (must be a dict|needs a valid {name})$"):
        crumple.Statistics.__new__(crumple.Statistics).__setstate__(state)


def test_number_of_names_in_pickled_statistics_is_limited():
    """Only a limited number of names is stored, so that hostile states cannot fill the memory."""
    program = """
import crumple
state = crumple.Detector().intersections([], []).statistics.__getstate__()
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
    assert out[0].endswith("the state of Statistics has an unknown backend or simd") and out[1] == "True"
