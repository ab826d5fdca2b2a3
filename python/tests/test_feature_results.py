"""Tests of Impacts and Proximities as values: they outlive detector and arrays, and can be pickled and copied."""

import copy
import gc
import pickle
import subprocess
import sys

import numpy as np
import pytest

import crumple
from conftest import OnDevice, soup, sufficient_limit
from features import BODIES, CLOSEST, END, FACES, INDEX, LEAST, LISTS, START, TRIANGLES, assert_same, restored

MESH = soup(12, size=0.5, dtype=np.float64)
MOVED = MESH.vertices + 0.3 * np.random.default_rng(1).normal(size=MESH.vertices.shape)
HAIR = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 1.5]])
POSES = np.tile(np.eye(3, 4), (3, 1, 1))
POSES[:, 0, 3] = [0, 0.2, 5]
WORLD = crumple.World([crumple.Shape(MESH, end=MOVED)], [0, 0, 0], poses=POSES, worlds=[0, 1, 1], self_collisions=True)

RESULTS = {
    "impacts of a mesh": lambda d, **how: d.impacts(MESH, MOVED, **how),
    "impacts of a world": lambda d, **how: d.impacts(WORLD, **how),
    "triangles of a mesh": lambda d, **how: d.impacts(MESH, MOVED, triangle_pairs=True, **how),
    "triangles of a world": lambda d, **how: d.impacts(WORLD, triangle_pairs=True, **how),
    "pairs of a mesh": lambda d, **how: d.proximities(MESH, radius=0.2, **how),
    "pairs of a world": lambda d, **how: d.proximities(WORLD, radius=0.2, **how),
    "impacts of hair": lambda d, **how: d.impacts(HAIR, HAIR[::-1].copy(), edges=[[1, 0], [1, 2]], **how),
    "pairs of particles": lambda d, **how: d.proximities(HAIR, points=[3, 0, 2, 3], radius=9, **how),
    "no impacts": lambda d, **how: d.impacts(MESH._replace(faces=MESH.faces[:1]), MOVED, **how),
    "no pairs": lambda d, **how: d.proximities([], [], radius=1, **how),
}
OUTPUTS = {"Impacts": ["any", "any_by_world", "first", "pairs"], "Proximities": ["any", "any_by_world", "pairs"]}


def arrays_of(result):
    """Returns all arrays and values of a result, including those that were not requested."""
    raw = result._found
    names = [*LISTS[type(result).__name__], *BODIES, *INDEX, "edges", "first_edge", "points", "first_point"]
    made = {name: getattr(raw, name).tolist() for name in names}
    if isinstance(result, crumple.Proximities):
        made |= {name: getattr(raw, name).tolist() for name in [*CLOSEST, *LEAST]}
    if isinstance(result, crumple.Impacts):
        made |= {"first": raw.first, "world_first": raw.world_first}
        made |= {name: getattr(raw, name).tolist() for name in TRIANGLES}
    return {**made, "any": result.any, "rows": len(result)}


@pytest.mark.parametrize("name", RESULTS)
def test_copied_or_pickled_result_is_equal_to_the_original(name, either):
    find = RESULTS[name]
    outputs = OUTPUTS[type(find(either)).__name__]
    queries = [{"output": output} for output in outputs] + [{"copy": True}]
    if "world" not in name:
        queries.append({"index": True})
    if "pairs" in name:
        queries.append({"closest": True} if "world" in name else {"closest": True, "least": True})
    for query in queries:
        result = find(either, **query)
        again = pickle.loads(pickle.dumps(result))
        for found in (again, copy.copy(result), copy.deepcopy(result), copy.deepcopy(again)):
            assert type(found) is type(result) and repr(found) == repr(result) and bool(found) is bool(result)
            assert arrays_of(found) == arrays_of(result) and found.statistics == result.statistics
            if query.get("copy"):
                assert found.vertex_faces.flags.writeable and found.edges.flags.writeable
            elif query.get("output") == outputs[-1]:
                assert not len(found.vertex_faces) or not found.vertex_faces.flags.writeable
    assert name.startswith("no ") or find(either)


def test_shallow_copies_share_memory_and_deep_copies_do_not(detector):
    result = detector.impacts(MESH, MOVED)
    same, other = copy.copy(result), copy.deepcopy(result)
    assert np.shares_memory(same.vertex_faces, result.vertex_faces)
    assert not np.shares_memory(other.vertex_faces, result.vertex_faces)


def test_pickled_world_gives_the_same_impacts_in_another_process(detector, tmp_path):
    (tmp_path / "result").write_bytes(pickle.dumps((detector.impacts(WORLD), WORLD)))
    code = (
        "import crumple, pickle; result, world = pickle.load(open('result', 'rb'))\n"
        "found = crumple.Detector().impacts(world)\n"
        "names = [kind + part for kind in ('vertex_face', 'edge_edge') for part in 's _bodies _toi _start'.split()]\n"
        "same = [getattr(found, name).tolist() == getattr(result, name).tolist() for name in names]\n"
        "print(all(same) and len(result) > 9)"
    )
    done = subprocess.run([sys.executable, "-c", code], cwd=tmp_path, capture_output=True, text=True, check=True)
    assert done.stdout == "True\n"


@pytest.mark.parametrize(
    "name, field, value, message",
    [
        ("impacts of a mesh", "vertex_faces", lambda a: a[:-1], "count"),
        ("impacts of a mesh", "vertex_faces", lambda a: -1 - a, "vertex_faces"),
        ("impacts of a mesh", "vertex_faces", lambda a: a.astype(np.int64), r"as an array \(n, 2\) of int32"),
        ("impacts of a mesh", "edge_edges", lambda a: a + 999, "edge_edges and edges"),
        ("impacts of a mesh", "edge_edge_toi", lambda a: a + 2, "the values of edge_edges"),
        ("impacts of a mesh", "edge_edge_toi", lambda a: a * np.nan, "the values of edge_edges"),
        ("impacts of a mesh", "edge_edge_toi", lambda a: a[1:], "the lengths of edge_edges"),
        ("impacts of a mesh", "vertex_face_start", lambda a: ~a, "the flags of vertex_faces"),
        ("impacts of a mesh", "edges", lambda a: a[:, :1].repeat(2, axis=1), "edges"),
        ("impacts of hair", "vertex_edges", lambda a: a + 999, "vertex_edges and edges"),
        ("impacts of hair", "by_edge", lambda a: a[:0], "by_edge"),
        ("impacts of hair", "vertex_edge_start", lambda a: a[1:], "the lengths of vertex_edges"),
        ("pairs of particles", "vertex_vertices", lambda a: a + 999, "vertex_vertices and points"),
        ("pairs of particles", "points", lambda a: a[1:], "first_point"),
        ("pairs of particles", "first_point", lambda a: a[:1], "first_point"),
        ("pairs of particles", "vertex_vertex_squared_distance", lambda a: -1 - a, "the values of vertex_vertices"),
        ("impacts of a mesh", "first_edge", lambda a: a[:1], "first_edge"),
        ("impacts of a mesh", "by_face", lambda a: a[::-1], "by_face"),
        ("impacts of a mesh", "vertex_offsets", lambda a: a[:3], "vertex_offsets"),
        ("impacts of a mesh", "output", lambda a: "all", "output"),
        ("impacts of a mesh", "output", lambda a: "any", "count"),
        ("impacts of a mesh", "any", lambda a: 1, "needs any as bool"),
        ("impacts of a mesh", "statistics", lambda a: None, "needs statistics as Statistics"),
        ("impacts of a mesh", "first", lambda a: (1, 2), "first"),
        ("impacts of a mesh", "first", lambda a: None, "first"),
        ("triangles of a mesh", "triangle_pairs", lambda a: a[1:], "the lengths of triangle_pairs"),
        ("triangles of a mesh", "triangle_pair_toi", lambda a: a + 2, "the values of triangle_pairs"),
        ("triangles of a mesh", "triangle_pair_start", lambda a: ~a, "the flags of triangle_pairs"),
        ("triangles of a mesh", "options", lambda a: a - {"triangle_pairs"}, "triangle_pairs"),
        ("triangles of a mesh", "by_second_triangle", lambda a: a[1:], "by_second_triangle"),
        ("triangles of a world", "triangle_pair_bodies", lambda a: a + 3, "triangle_pair_bodies"),
        ("impacts of a world", "vertex_face_bodies", lambda a: a + 3, "vertex_face_bodies"),
        ("impacts of a world", "of_bodies", lambda a: False, "scene"),
        ("impacts of a world", "block", lambda a: True, "block"),
        ("pairs of a mesh", "vertex_face_squared_distance", lambda a: -1 - a, "the values of vertex_faces"),
        ("pairs of a mesh", "vertex_face_touching", lambda a: ~a, "the flags of vertex_faces"),
        ("pairs of a world", "options", lambda a: a | {"index"}, "index"),
        ("pairs of a mesh", "options", lambda a: a | {"closest"}, "vertex_face_type"),
        ("pairs of a mesh", "options", lambda a: a | {"least"}, "edge_distance"),
        ("pairs of a mesh", "vertex_distance", lambda a: np.ones(3), "vertex_distance"),
        ("pairs of a mesh", "edge_edge_type", lambda a: np.full(2, 9, np.uint8), "edge_edge_type"),
    ],
)
def test_inconsistent_pickled_state_is_refused(name, field, value, message, detector):
    result = RESULTS[name](detector, **({} if "world" in name else {"index": True}))
    assert arrays_of(restored(result)) == arrays_of(result)
    with pytest.raises(crumple.InvalidInput, match=message):
        restored(result, **{field: value})


def test_pickled_result_of_a_world_cannot_become_one_of_a_mesh(detector):
    result, of_mesh = detector.impacts(WORLD), {"scene": lambda _: "mesh", "of_bodies": lambda _: False}
    with pytest.raises(crumple.InvalidInput, match="the state of Impacts is inconsistent: first_edge"):
        restored(result, **of_mesh)


def test_malformed_pickled_state_is_refused(detector):
    restore, (kind, asked, state) = detector.impacts(MESH, MOVED).__reduce__()
    for wrong in (("Result", asked, state), (kind, asked, {}), (kind, asked, None), (kind, asked, state, WORLD)):
        with pytest.raises(crumple.InvalidType, match="the state of Impacts|a result must be one of"):
            restore(*wrong)


def test_pickled_state_with_impossible_first_impact_is_refused(detector):
    result = detector.impacts(START, END, FACES, output="first")
    assert restored(result).first.toi == 0.5
    for first in (
        ("face_face", (3, 0), (0, 0), 0.5, False),
        ("vertex_face", (3, 0), None, 0.5, False),
        ("vertex_face", (3, 0), (1, 0), 0.5, False),
        ("vertex_face", (3, -1), (0, 0), 0.5, False),
        ("vertex_face", (3, 2**31), (0, 0), 0.5, False),
        ("vertex_face", (3, 0), (0, 0), 1.5, False),
        ("vertex_face", (3, 0), (0, 0), 0.5, 0),
    ):
        with pytest.raises(crumple.InvalidInput, match="is inconsistent: .*first"):
            restored(result, first=lambda _, first=first: first)


@pytest.mark.parametrize("name", ["impacts of a world", "pairs of a mesh"])
def test_arrays_outlive_result_and_detector(name, detector):
    result = RESULTS[name](detector)
    arrays = [getattr(result, field) for field in LISTS[type(result).__name__]]
    before = [array.copy() for array in arrays]
    del result
    for _ in range(4):
        detector.impacts(START, END, FACES)
        detector.proximities(START, FACES, radius=9)
    del detector
    gc.collect()
    for array, expected in zip(arrays, before):
        np.testing.assert_array_equal(array, expected)
        assert not len(array) or not array.flags.writeable


@pytest.mark.parametrize("name", ["impacts of a mesh", "pairs of a mesh"])
def test_repeated_searches_reuse_memory(name, detector):
    """Results alternate between at most three arrays: those of two results, and one that the search swaps with them."""
    places = {RESULTS[name](detector).edge_edges.ctypes.data for _ in range(12)}
    assert len(places) <= 3
    held = [RESULTS[name](detector).edge_edges for _ in range(4)]
    assert len({pairs.ctypes.data for pairs in held}) == 4


def test_results_made_with_copy_can_be_written_to(detector):
    for result in (detector.impacts(MESH, MOVED, copy=True), detector.proximities(MESH, radius=0.2, copy=True)):
        for name in (*LISTS[type(result).__name__], "edges"):
            assert getattr(result, name).flags.writeable, name
        result.edge_edges[:] = 0
        assert not result.edge_edges.any() and result._found.edge_edges.any()


def test_intersections_leave_earlier_impacts_and_near_pairs_unchanged(detector):
    """Intersections, impacts and proximities each have their own storage in the detector."""
    expected = arrays_of(detector.impacts(MESH, MOVED)), arrays_of(detector.proximities(MESH, radius=0.2))
    pairs = detector.intersections(MESH).pairs.tolist()
    impacts, near, result = detector.impacts(MESH, MOVED), detector.proximities(MESH, radius=0.2), None
    for _ in range(3):
        result = detector.intersections(MESH)
        detector.intersections(WORLD)
    assert (arrays_of(impacts), arrays_of(near)) == expected and result.pairs.tolist() == pairs


def test_sufficient_memory_limit_gives_the_same_result(detector):
    mesh = soup(300, size=0.5, dtype=np.float64)
    for find in (lambda d: d.impacts(mesh, mesh.vertices + 0.01), lambda d: d.proximities(mesh, radius=0.05)):
        expected = find(detector)
        enough = crumple.Detector(memory_limit=sufficient_limit(find, 10_000))
        for _ in range(3):
            assert_same(find(enough), expected)


def test_results_cannot_be_constructed_in_python():
    for make in (crumple.Impacts, crumple.Proximities, crumple._core.Impacts, crumple._core.Proximities):
        with pytest.raises(TypeError):
            make()


def test_copied_worlds_keep_end_vertices_and_end_poses():
    world = crumple.World(
        [crumple.Shape(MESH, end=MOVED, name="falls")], [0], poses=POSES[:1], end_poses=POSES[1:2], self_collisions=True
    )
    for found in (pickle.loads(pickle.dumps(world)), copy.copy(world), copy.deepcopy(world)):
        np.testing.assert_array_equal(found.shapes[0].end, MOVED)
        np.testing.assert_array_equal(found.end_poses, POSES[1:2])
        assert found.shapes[0].name == "falls"
    many = crumple.World([MESH], [0, 0], worlds=[0, -1], poses=POSES[:2], self_collisions=True).configurations(
        POSES[:, None], POSES[::-1, None]
    )
    again = pickle.loads(pickle.dumps(many))
    np.testing.assert_array_equal(again.end_poses, many.end_poses)
    np.testing.assert_array_equal(again.poses, many.poses)


@pytest.mark.parametrize(
    "make, message",
    [
        (lambda: crumple.Shape(MESH, end=MOVED[:9]), "^end vertices must be as many as those at the start, 36, not 9$"),
        (lambda: crumple.Shape(MESH, end=OnDevice(MOVED)), "^end vertices lie in the memory of CUDA device 0"),
        (lambda: crumple.Shape(MESH, end=MOVED.astype(int)), "^end vertices must be float32 or float64, not int64"),
        (
            lambda: crumple.World([MESH], end_poses=POSES, self_collisions=True),
            r"^end_poses must have shape \(1, 3, 4\) or",
        ),
        (
            lambda: crumple.World([MESH], end_poses=np.eye(4), self_collisions=True),
            r"^end_poses must have shape \(bodies, 3, 4\)",
        ),
        (
            lambda: crumple.World([MESH], end_poses=OnDevice(POSES[:, ::-1]), self_collisions=True),
            "^end_poses in CUDA memory must be",
        ),
        (
            lambda: crumple.World([MESH], [crumple.Body(0, self_collisions=True)], end_poses=POSES[:1]),
            "must be given in each crumple.Body",
        ),
        (
            lambda: crumple.World([MESH], [crumple.Body(0, end_pose=np.eye(3), self_collisions=True)]),
            "body 0: its end pose must have shape",
        ),
        (
            lambda: crumple.World([MESH], [crumple.Body(0, end_pose=np.ones((4, 4)), self_collisions=True)]),
            r"body 0: the last row of its end pose must be 0 0 0 1, not 1\.0",
        ),
    ],
)
def test_invalid_end_vertices_and_end_poses_are_refused(make, message):
    with pytest.raises(crumple.InvalidInput, match=message):
        make()


def test_error_names_the_body_with_an_invalid_end(detector):
    ends = np.tile(np.eye(4), (2, 1, 1))
    world = crumple.World([MESH], [0, 0], names=["arm", "hand"], end_poses=ends, self_collisions=True)
    ends[1, 3, 0] = 2
    with pytest.raises(crumple.InvalidInput, match=r"body 1 \('hand'\): the last row of its end pose must be 0 0 0 1"):
        detector.impacts(world)
    ends[1, 3, 0], ends[1, 0, 0] = 0, np.nan
    with pytest.raises(crumple.InvalidInput, match=r"body 1 \('hand'\): its pose is not finite"):
        detector.any(world, crumple.ImpactQuery())
    assert detector.proximities(world, radius=0.2), "the end is no business of nearness"
    moved = MOVED.copy()
    moved[7, 1] = np.inf
    world = crumple.World([MESH, crumple.Shape(MESH, end=moved)], names=["arm", "hand"], self_collisions=True)
    with pytest.raises(crumple.InvalidInput, match=r"body 1 \('hand'\): vertex 7 is not finite at the end"):
        detector.first_impact(world)
    with pytest.raises(crumple.InvalidInput, match="excluded: there is no body 'han'; did you mean 'hand'"):
        detector.impacts(world, filter=crumple.PairFilter(excluded_bodies=[{"arm", "han"}]))
