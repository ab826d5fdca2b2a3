"""Impacts and Nearby as values: they outlive everything, go through pickle whole or not at all, and are copied."""

import copy
import gc
import pickle
import subprocess
import sys

import numpy as np
import pytest

import crumple
from conftest import OnDevice, soup, sufficient_limit
from features import BODIES, CLOSEST, END, FACES, INDEX, LEAST, LISTS, START, TRIANGLES

MESH = soup(12, size=0.5, dtype=np.float64)
MOVED = MESH.vertices + 0.3 * np.random.default_rng(1).normal(size=MESH.vertices.shape)
HAIR = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 1.5]])
POSES = np.tile(np.eye(3, 4), (3, 1, 1))
POSES[:, 0, 3] = [0, 0.2, 5]
WORLD = crumple.World([crumple.Shape(MESH, end=MOVED)], [0, 0, 0], poses=POSES, worlds=[0, 1, 1], self_collisions=True)

ANSWERS = {
    "impacts of a mesh": lambda d, **how: d.find_impacts(MESH, MOVED, **how),
    "impacts of a world": lambda d, **how: d.find_impacts(WORLD, **how),
    "triangles of a mesh": lambda d, **how: d.find_impacts(MESH, MOVED, triangle_pairs=True, **how),
    "triangles of a world": lambda d, **how: d.find_impacts(WORLD, triangle_pairs=True, **how),
    "pairs of a mesh": lambda d, **how: d.find_near(MESH, radius=0.2, **how),
    "pairs of a world": lambda d, **how: d.find_near(WORLD, radius=0.2, **how),
    "impacts of hair": lambda d, **how: d.find_impacts(HAIR, HAIR[::-1].copy(), edges=[[1, 0], [1, 2]], **how),
    "pairs of particles": lambda d, **how: d.find_near(HAIR, radius=9, points=[3, 0, 2, 3], **how),
    "no impacts": lambda d, **how: d.find_impacts(MESH._replace(faces=MESH.faces[:1]), MOVED, **how),
    "no pairs": lambda d, **how: d.find_near([], [], radius=1, **how),
}
WANTS = {"Impacts": ["any", "any_by_world", "earliest", "impacts"], "Nearby": ["any", "any_by_world", "pairs"]}


def arrays_of(answer):
    """All that it has, what was not asked for included."""
    raw = answer._answer
    names = [*LISTS[type(answer).__name__], *BODIES, *INDEX, "edges", "first_edge", "points", "first_point"]
    made = {name: getattr(raw, name).tolist() for name in names}
    if isinstance(answer, crumple.Nearby):
        made |= {name: getattr(raw, name).tolist() for name in [*CLOSEST, *LEAST]}
    if isinstance(answer, crumple.Impacts):
        made |= {"first": raw.first, "world_first": raw.world_first}
        made |= {name: getattr(raw, name).tolist() for name in TRIANGLES}
    return {**made, "any": answer.any, "rows": len(answer)}


@pytest.mark.parametrize("name", ANSWERS)
def test_an_answer_comes_back_whole(name, either):
    find = ANSWERS[name]
    questions = [{"wants": wants} for wants in WANTS[type(find(either)).__name__]] + [{"copy": True}]
    if "world" not in name:
        questions.append({"index": True})
    if "pairs" in name:
        questions.append({"closest": True} if "world" in name else {"closest": True, "least": True})
    for question in questions:
        answer = find(either, **question)
        again = pickle.loads(pickle.dumps(answer))
        for found in (again, copy.copy(answer), copy.deepcopy(answer), copy.deepcopy(again)):
            assert type(found) is type(answer) and repr(found) == repr(answer) and bool(found) is bool(answer)
            assert arrays_of(found) == arrays_of(answer) and found.statistics == answer.statistics
            if question.get("copy"):
                assert found.vertex_faces.flags.writeable and found.edges.flags.writeable
            elif question.get("wants") == WANTS[type(answer).__name__][-1]:
                assert not len(found.vertex_faces) or not found.vertex_faces.flags.writeable
    assert name.startswith("no ") or find(either)


def test_copies_share_or_do_not(detector):
    answer = detector.find_impacts(MESH, MOVED)
    same, other = copy.copy(answer), copy.deepcopy(answer)
    assert np.shares_memory(same.vertex_faces, answer.vertex_faces)
    assert not np.shares_memory(other.vertex_faces, answer.vertex_faces)


def test_another_process_finds_the_same(detector, tmp_path):
    (tmp_path / "answer").write_bytes(pickle.dumps((detector.find_impacts(WORLD), WORLD)))
    code = (
        "import crumple, pickle; answer, world = pickle.load(open('answer', 'rb'))\n"
        "found = crumple.Detector().find_impacts(world)\n"
        "print(found.edge_edge_toi.tolist() == answer.edge_edge_toi.tolist() and len(answer) > 9)"
    )
    done = subprocess.run([sys.executable, "-c", code], cwd=tmp_path, capture_output=True, text=True, check=True)
    assert done.stdout == "True\n"


@pytest.mark.parametrize(
    "name, field, value, message",
    [
        ("impacts of a mesh", "vertex_faces", lambda a: a[:-1], "count"),
        ("impacts of a mesh", "vertex_faces", lambda a: -1 - a, "vertex_faces"),
        (
            "impacts of a mesh",
            "vertex_faces",
            lambda a: a.astype(np.int64),
            r"as an array \(n, 2\) of int32",
        ),
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
        ("impacts of a mesh", "wants", lambda a: "all", "wants"),
        ("impacts of a mesh", "wants", lambda a: "any", "count"),
        ("impacts of a mesh", "any", lambda a: 1, "needs any as bool"),
        ("impacts of a mesh", "statistics", lambda a: None, "needs statistics as Statistics"),
        ("impacts of a mesh", "first", lambda a: (1, 2), "first"),
        ("impacts of a mesh", "first", lambda a: None, "first"),
        ("triangles of a mesh", "triangle_pairs", lambda a: a[1:], "the lengths of triangle_pairs"),
        ("triangles of a mesh", "triangle_pair_toi", lambda a: a + 2, "the values of triangle_pairs"),
        ("triangles of a mesh", "triangle_pair_start", lambda a: ~a, "the flags of triangle_pairs"),
        ("triangles of a mesh", "has_triangle_pairs", lambda a: False, "triangle_pairs"),
        ("triangles of a mesh", "by_second_triangle", lambda a: a[1:], "by_second_triangle"),
        ("triangles of a world", "triangle_pair_bodies", lambda a: a + 3, "triangle_pair_bodies"),
        ("impacts of a world", "vertex_face_bodies", lambda a: a + 3, "vertex_face_bodies"),
        ("impacts of a world", "of_world", lambda a: False, "first_edge"),
        ("pairs of a mesh", "vertex_face_squared_distance", lambda a: -1 - a, "the values of vertex_faces"),
        ("pairs of a mesh", "vertex_face_touching", lambda a: ~a, "the flags of vertex_faces"),
        ("pairs of a world", "has_index", lambda a: True, "has_index"),
        ("pairs of a mesh", "has_closest", lambda a: True, "vertex_face_type"),
        ("pairs of a mesh", "has_least", lambda a: True, "edge_distance"),
        ("pairs of a mesh", "vertex_distance", lambda a: np.ones(3), "vertex_distance"),
        ("pairs of a mesh", "edge_edge_type", lambda a: np.full(2, 9, np.uint8), "edge_edge_type"),
    ],
)
def test_what_does_not_fit_together_is_refused(name, field, value, message, detector):
    restore, (kind, state) = ANSWERS[name](detector, **({} if "world" in name else {"index": True})).__reduce__()
    assert restore(kind, state)
    with pytest.raises(crumple.InvalidInput, match=message):
        restore(kind, {**state, field: value(state[field])})
    for wrong in (("Result", state), (kind, {}), (kind, None)):
        with pytest.raises(crumple.InvalidType, match="the state of"):
            restore(*wrong)


def test_a_first_that_cannot_be_is_refused(detector):
    restore, (kind, state) = detector.find_impacts(START, END, FACES, wants="earliest").__reduce__()
    assert restore(kind, state).first.toi == 0.5
    for first in (
        ("face_face", (3, 0), None, 0.5, False),
        ("vertex_face", (3, 0), (0, 0), 0.5, False),
        ("vertex_face", (3, 0), None, 1.5, False),
    ):
        with pytest.raises(crumple.InvalidInput, match="first impact"):
            restore(kind, {**state, "first": first})


@pytest.mark.parametrize("name", ["impacts of a world", "pairs of a mesh"])
def test_an_answer_outlives_everything(name, detector):
    answer = ANSWERS[name](detector)
    arrays = [getattr(answer, field) for field in LISTS[type(answer).__name__]]
    before = [array.copy() for array in arrays]
    del answer
    for _ in range(4):
        detector.find_impacts(START, END, FACES)
        detector.find_near(START, FACES, radius=9)
    del detector
    gc.collect()
    for array, expected in zip(arrays, before):
        np.testing.assert_array_equal(array, expected)
        assert not len(array) or not array.flags.writeable


@pytest.mark.parametrize("name", ["impacts of a mesh", "pairs of a mesh"])
def test_frames_use_memory_again(name, detector):
    """Two answers, and the rows that a search swaps with its answer."""
    places = {ANSWERS[name](detector).edge_edges.ctypes.data for _ in range(12)}
    assert len(places) <= 3
    held = [ANSWERS[name](detector).edge_edges for _ in range(4)]
    assert len({pairs.ctypes.data for pairs in held}) == 4


def test_copies_may_be_written_to(detector):
    for answer in (detector.find_impacts(MESH, MOVED, copy=True), detector.find_near(MESH, radius=0.2, copy=True)):
        answer.edge_edges[:] = 0
        assert not answer.edge_edges.any() and answer._answer.edge_edges.any()


def test_answers_of_one_detector_do_not_disturb_each_other(detector):
    """Each kind has its own storage: pairs of triangles, impacts, near pairs."""
    expected = arrays_of(detector.find_impacts(MESH, MOVED)), arrays_of(detector.find_near(MESH, radius=0.2))
    pairs = detector.find_self(MESH).pairs.tolist()
    impacts, near, result = detector.find_impacts(MESH, MOVED), detector.find_near(MESH, radius=0.2), None
    for _ in range(3):
        result = detector.find_self(MESH)
        detector.find(WORLD)
    assert (arrays_of(impacts), arrays_of(near)) == expected and result.pairs.tolist() == pairs


def test_a_memory_limit_holds(detector):
    mesh = soup(300, size=0.5, dtype=np.float64)
    for ask in (lambda d: d.find_impacts(mesh, mesh.vertices + 0.01), lambda d: d.find_near(mesh, radius=0.05)):
        expected = ask(detector)
        enough = crumple.Detector(memory_limit=sufficient_limit(ask, 10_000))
        for _ in range(3):
            np.testing.assert_array_equal(ask(enough).edge_edges, expected.edge_edges)


def test_the_raw_answers_are_not_made_in_python():
    for make in (crumple.Impacts, crumple.Nearby, crumple._core.ImpactsAnswer, crumple._core.NearbyAnswer):
        with pytest.raises(TypeError):
            make()


def test_shapes_and_poses_at_the_end_come_back():
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
            "are those of each crumple.Body",
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
def test_a_wrong_end_is_refused(make, message):
    with pytest.raises(crumple.InvalidInput, match=message):
        make()


def test_a_search_names_the_body_that_goes_wrong(detector):
    ends = np.tile(np.eye(4), (2, 1, 1))
    world = crumple.World([MESH], [0, 0], names=["arm", "hand"], end_poses=ends, self_collisions=True)
    ends[1, 3, 0] = 2
    with pytest.raises(crumple.InvalidInput, match=r"body 1 \('hand'\): the last row of its end pose must be 0 0 0 1"):
        detector.find_impacts(world)
    ends[1, 3, 0], ends[1, 0, 0] = 0, np.nan
    with pytest.raises(crumple.InvalidInput, match=r"body 1 \('hand'\): its pose is not finite"):
        detector.is_free(world)
    assert detector.find_near(world, radius=0.2), "the end is no business of nearness"
    moved = MOVED.copy()
    moved[7, 1] = np.inf
    world = crumple.World([MESH, crumple.Shape(MESH, end=moved)], names=["arm", "hand"], self_collisions=True)
    with pytest.raises(crumple.InvalidInput, match=r"body 1 \('hand'\): vertex 7 is not finite at the end"):
        detector.time_of_first_impact(world)
    with pytest.raises(crumple.InvalidInput, match="excluded: there is no body 'han'; did you mean 'hand'"):
        detector.find_impacts(world, excluded=[{"arm", "han"}])
