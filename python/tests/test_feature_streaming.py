"""Answers about features in blocks: together they are the whole answer."""

import pickle

import numpy as np
import pytest

import crumple
from conftest import soup
from features import BODIES, CLOSEST, INDEX, LISTS

MESH = soup(90, 0.3)
END = MESH.vertices + np.float32(0.2) * np.random.default_rng(2).random(MESH.vertices.shape).astype(np.float32)
SEARCHES = {
    "impacts": ((MESH, END), {}),
    "near": ((MESH,), {"radius": 0.03, "closest": True}),
    "candidates": ((MESH,), {"end": END, "kinds": ["vertex_face", "edge_edge", "face_face"]}),
}
KIND_OF = {"impacts": "Impacts", "near": "Nearby", "candidates": "Candidates"}
PAIRS = ("vertex_faces", "edge_edges", "vertex_edges", "vertex_vertices")


def arrays_of(answer):
    """Those that blocks have: of what was asked for."""
    name = type(answer).__name__
    listed = ["vertex_faces", "edge_edges", "face_faces"] if name == "Candidates" else LISTS[name]
    return [*listed, *(CLOSEST if name == "Nearby" else [])]


def gathered(stream, *scene, **question):
    blocks = []
    statistics = stream(blocks.append, *scene, **question)
    assert statistics.pairs == sum(map(len, blocks))
    return blocks


def joined(blocks, names):
    return {name: np.concatenate([getattr(block, name) for block in blocks]) for name in names}


def kind_of(name):
    """The array of pairs whose rows an array belongs to."""
    return next(pairs for pairs in (*PAIRS, "face_faces") if name.startswith(pairs.rpartition("s")[0][:9]))


def in_order(found):
    """The same arrays with the rows of each kind by their pairs, and by bodies where those are there."""
    orders = {}
    for kind in set(map(kind_of, found)):
        keys = [found[name] for name in found if kind_of(name) == kind and (name == kind or name.endswith("_bodies"))]
        orders[kind] = np.lexsort(np.column_stack(keys).T[::-1])
    return {name: rows[orders[kind_of(name)]] for name, rows in found.items()}


@pytest.mark.parametrize("search", SEARCHES)
@pytest.mark.parametrize("backend", ["cpu", "reference"])
@pytest.mark.parametrize("size", [1, 7, 100000])
def test_blocks_are_the_whole_answer(search, backend, size):
    detector = crumple.Detector(backend=backend, threads=2)
    scene, question = SEARCHES[search]
    whole = getattr(crumple, f"find_{search}")(*scene, **question)
    assert len(whole) > 50
    if size == 1 and len(whole) > 1000:
        size = 40
    blocks = gathered(getattr(detector, f"stream_{search}"), *scene, **question, block_rows=size)
    assert len(blocks) == -(-len(whole) // size) and max(map(len, blocks)) <= size
    assert all(type(block).__name__ == KIND_OF[search] and block for block in blocks)
    for name, rows in in_order(joined(blocks, arrays_of(whole))).items():
        np.testing.assert_array_equal(rows, getattr(whole, name), name, strict=True)
    for block in blocks:
        for name in ("edges", "first_edge", "points", "first_point"):
            np.testing.assert_array_equal(getattr(block, name), getattr(whole, name))


def test_blocks_of_rods_and_particles(detector):
    edges, points = np.arange(180).reshape(-1, 2), np.arange(170, 270)
    question = {"radius": 0.05, "edges": edges, "points": points}
    whole = detector.find_near(MESH, **question)
    blocks = gathered(detector.stream_near, MESH, **question, block_rows=50)
    assert len(blocks) > 2 and len(whole.vertex_edges)
    for name, rows in in_order(joined(blocks, LISTS["Nearby"])).items():
        np.testing.assert_array_equal(rows, getattr(whole, name), name)
    assert all(np.array_equal(block.edges, edges) and np.array_equal(block.points, points) for block in blocks)


def test_blocks_of_worlds(detector):
    shape = crumple.Shape(MESH.vertices, MESH.faces, end=END)
    world = crumple.World([shape], [crumple.Body(0, world=number, self_collisions=True) for number in (0, 0, 1, -1)])
    for search, question in (("impacts", {}), ("near", {"radius": 0.01}), ("candidates", {"bodies": "between"})):
        whole = getattr(detector, f"find_{search}")(world, **question)
        blocks = gathered(getattr(detector, f"stream_{search}"), world, **question, block_rows=300)
        assert len(blocks) > 2
        names = [*PAIRS[:2], *(name for name in BODIES[:2])]
        expected = in_order({name: getattr(whole, name) for name in names})
        for name, rows in in_order(joined(blocks, names)).items():
            np.testing.assert_array_equal(rows, expected[name], name)
        assert all(np.array_equal(block.first_edge, whole.first_edge) for block in blocks)


def test_a_block_outlives_all_and_can_be_pickled_and_saved(tmp_path):
    detector = crumple.Detector(threads=2)
    for search, (scene, question) in SEARCHES.items():
        blocks = gathered(getattr(detector, f"stream_{search}"), *scene, **question, block_rows=20)
        copied = pickle.loads(pickle.dumps(blocks[1]))
        assert repr(copied) == repr(blocks[1]) and len(copied) == 20
        for name in arrays_of(copied):
            np.testing.assert_array_equal(getattr(copied, name), getattr(blocks[1], name))
        copied.save(tmp_path / "block.txt")
        assert len((tmp_path / "block.txt").read_text().splitlines()) == 20


def test_a_block_tells_what_it_has_not(detector):
    impacts = gathered(detector.stream_impacts, MESH, END, block_rows=50)[0]
    near = gathered(detector.stream_near, MESH, radius=0.02, block_rows=50)[0]
    for answer, names in ((impacts, ("first", "world_first", "world_hit")), (near, ("world_hit",))):
        for name in names:
            with pytest.raises(crumple.InvalidInput, match=f"{name} is told of a whole answer"):
                getattr(answer, name)
        with pytest.raises(crumple.InvalidInput, match="index"):
            getattr(answer, INDEX[0])
    with pytest.raises(crumple.InvalidInput, match="closest"):
        _ = near.vertex_face_type


@pytest.mark.parametrize("search", SEARCHES)
def test_what_take_raises_ends_the_call(search):
    detector = crumple.Detector(threads=2)
    scene, question = SEARCHES[search]
    seen = []

    def refuse(block):
        seen.append(block)
        with pytest.raises(crumple.InvalidInput, match="can call the detector whose call goes on"):
            detector.find_self(MESH)
        raise KeyError("full")

    with pytest.raises(KeyError, match="full"):
        getattr(detector, f"stream_{search}")(refuse, *scene, **question, block_rows=3)
    assert len(seen) == 1
    whole = getattr(crumple, f"find_{search}")(*scene, **question)
    assert len(getattr(detector, f"find_{search}")(*scene, **question)) == len(whole)


def test_wrong_arguments_are_named(detector):
    for stream, kind, scene, question in (
        (detector.stream_impacts, "Impacts", (MESH, END), {}),
        (detector.stream_near, "Nearby", (MESH,), {"radius": 1}),
        (detector.stream_candidates, "Candidates", (MESH,), {}),
    ):
        with pytest.raises(crumple.InvalidType, match=f"take must be callable with a crumple.{kind}"):
            stream(MESH, *scene, **question)
        with pytest.raises(crumple.InvalidInput, match="block_rows"):
            stream(print, *scene, **question, block_rows=0)
        with pytest.raises(TypeError, match="index"):
            stream(print, *scene, **question, index=True)
        with pytest.raises(crumple.InvalidInput, match="triangle 0"):
            stream(print, crumple.Mesh(MESH.vertices, [[0, 1, 900]]), *scene[1:], **question)
    with pytest.raises(crumple.InvalidType, match="stream_near needs a radius"):
        detector.stream_near(print, MESH)


def test_a_memory_limit_that_the_answer_exceeds():
    mesh = soup(1500, 0.6)
    count = len(crumple.find_candidates(mesh))
    detector = crumple.Detector(memory_limit=4_000_000)
    with pytest.raises(crumple.MemoryLimit):
        detector.find_candidates(mesh)
    rows = []
    detector.stream_candidates(lambda block: rows.append(len(block)), mesh, block_rows=20_000)
    assert sum(rows) == count > 300_000
