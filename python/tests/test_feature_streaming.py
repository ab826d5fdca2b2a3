"""Tests of results about features that are delivered in blocks: all blocks together are the whole result."""

import pickle

import numpy as np
import pytest

import crumple
from conftest import soup
from features import BODIES, CLOSEST, INDEX, LISTS

MESH = soup(90, 0.3)
END = MESH.vertices + np.float32(0.2) * np.random.default_rng(2).random(MESH.vertices.shape).astype(np.float32)
STEP = MESH.moving_to(END)
SEARCHES = {
    "Impacts": (STEP, crumple.ImpactQuery()),
    "Proximities": (MESH, crumple.ProximityQuery(radius=0.03, closest=True)),
    "Candidates": (STEP, crumple.CandidateQuery(kinds=["vertex_face", "edge_edge", "face_face"])),
}
PAIRS = ("vertex_faces", "edge_edges", "vertex_edges", "vertex_vertices")


def arrays_of(answer):
    """Returns the names of the arrays that blocks of a result of this type have."""
    name = type(answer).__name__
    listed = ["vertex_faces", "edge_edges", "face_faces"] if name == "Candidates" else LISTS[name]
    return [*listed, *(CLOSEST if name == "Proximities" else [])]


def gathered(detector, scene, query, block_rows):
    blocks = []
    statistics = detector.stream(scene, query, blocks.append, block_rows=block_rows)
    assert statistics.pairs == sum(map(len, blocks))
    return blocks


def joined(blocks, names):
    return {name: np.concatenate([getattr(block, name) for block in blocks]) for name in names}


def kind_of(name):
    """Returns the name of the array of pairs to which the array `name` belongs."""
    return next(pairs for pairs in (*PAIRS, "face_faces") if name.startswith(pairs.rpartition("s")[0][:9]))


def in_order(found):
    """Returns the same arrays, with the rows of each kind sorted by pairs and, if there are bodies, by bodies."""
    orders = {}
    for kind in set(map(kind_of, found)):
        keys = [found[name] for name in found if kind_of(name) == kind and (name == kind or name.endswith("_bodies"))]
        orders[kind] = np.lexsort(np.column_stack(keys).T[::-1])
    return {name: rows[orders[kind_of(name)]] for name, rows in found.items()}


@pytest.mark.parametrize("search", SEARCHES)
@pytest.mark.parametrize("backend", ["cpu", "reference"])
@pytest.mark.parametrize("size", [1, 7, 100000])
def test_blocks_together_are_the_whole_result(search, backend, size):
    detector = crumple.Detector(backend=backend, threads=2)
    scene, query = SEARCHES[search]
    whole = detector.find(scene, query)
    assert len(whole) > 50
    if size == 1 and len(whole) > 1000:
        size = 40
    blocks = gathered(detector, scene, query, size)
    assert len(blocks) == -(-len(whole) // size) and max(map(len, blocks)) <= size
    assert all(type(block).__name__ == search and block for block in blocks)
    for name, rows in in_order(joined(blocks, arrays_of(whole))).items():
        np.testing.assert_array_equal(rows, getattr(whole, name), name, strict=True)
    for block in blocks:
        for name in ("edges", "first_edge", "points", "first_point"):
            np.testing.assert_array_equal(getattr(block, name), getattr(whole, name))


def test_blocks_of_rods_and_particles_are_the_whole_result(detector):
    edges, points = np.arange(180).reshape(-1, 2), np.arange(170, 270)
    scene, query = crumple.Mesh(*MESH, edges=edges, points=points), crumple.ProximityQuery(radius=0.05)
    whole = detector.find(scene, query)
    blocks = gathered(detector, scene, query, 50)
    assert len(blocks) > 2 and len(whole.vertex_edges)
    for name, rows in in_order(joined(blocks, LISTS["Proximities"])).items():
        np.testing.assert_array_equal(rows, getattr(whole, name), name)
    assert all(np.array_equal(block.edges, edges) and np.array_equal(block.points, points) for block in blocks)


def test_blocks_of_worlds_are_the_whole_result(detector):
    shape = crumple.Shape(MESH.vertices, MESH.faces, end=END)
    world = crumple.World([shape], [crumple.Body(0, world=number, self_collisions=True) for number in (0, 0, 1, -1)])
    between = crumple.PairFilter(bodies="between")
    for query in (
        crumple.ImpactQuery(),
        crumple.ProximityQuery(radius=0.01),
        crumple.CandidateQuery(filter=between),
    ):
        whole = detector.find(world, query)
        blocks = gathered(detector, world, query, 300)
        assert len(blocks) > 2
        values = [name for name in LISTS[type(whole).__name__] if name.startswith(("vertex_face_", "edge_edge_"))]
        names = [*PAIRS[:2], *BODIES[:2], *values]
        expected = in_order({name: getattr(whole, name) for name in names})
        for name, rows in in_order(joined(blocks, names)).items():
            np.testing.assert_array_equal(rows, expected[name], name)
        assert all(np.array_equal(block.first_edge, whole.first_edge) for block in blocks)


def test_block_can_be_kept_pickled_and_saved(tmp_path):
    detector = crumple.Detector(threads=2)
    for scene, query in SEARCHES.values():
        blocks, rows = [], []

        def keep(block, blocks=blocks, rows=rows):
            blocks.append(block)
            rows.append({name: getattr(block, name).copy() for name in arrays_of(block)})

        detector.stream(scene, query, keep, block_rows=20)
        for block, copies in zip(blocks, rows):
            for name, expected in copies.items():
                np.testing.assert_array_equal(getattr(block, name), expected, name)
        copied = pickle.loads(pickle.dumps(blocks[1]))
        assert repr(copied) == repr(blocks[1]) and len(copied) == 20
        for name in arrays_of(copied):
            np.testing.assert_array_equal(getattr(copied, name), getattr(blocks[1], name))
        copied.save(tmp_path / "block.txt")
        assert len((tmp_path / "block.txt").read_text().splitlines()) == 20


def test_block_has_no_first_impact_world_flags_or_index(detector):
    impacts = gathered(detector, STEP, crumple.ImpactQuery(), 50)[0]
    near = gathered(detector, MESH, crumple.ProximityQuery(radius=0.02), 50)[0]
    for answer, names in ((impacts, ("first", "world_first", "world_hit")), (near, ("world_hit",))):
        for name in names:
            with pytest.raises(crumple.InvalidInput, match=f"{name} is part of a whole result"):
                getattr(answer, name)
        with pytest.raises(crumple.InvalidInput, match="index"):
            getattr(answer, INDEX[0])
    with pytest.raises(crumple.InvalidInput, match="closest"):
        _ = near.vertex_face_type


@pytest.mark.parametrize("search", SEARCHES)
def test_exception_raised_by_the_consumer_ends_the_call(search):
    detector = crumple.Detector(threads=2)
    scene, query = SEARCHES[search]
    seen = []

    def refuse(block):
        seen.append(block)
        with pytest.raises(crumple.InvalidInput, match="can call a detector while another call of it is in progress"):
            detector.intersections(MESH)
        raise KeyError("full")

    with pytest.raises(KeyError, match="full"):
        detector.stream(scene, query, refuse, block_rows=3)
    assert len(seen) == 1
    assert len(detector.find(scene, query)) == len(crumple.Detector().find(scene, query))


@pytest.mark.parametrize("search", SEARCHES)
def test_error_names_the_wrong_argument(search, detector):
    scene, query = SEARCHES[search]
    with pytest.raises(crumple.InvalidType, match="take must be callable with a block, not Mesh"):
        detector.stream(scene, query, MESH)
    with pytest.raises(crumple.InvalidInput, match="block_rows"):
        detector.stream(scene, query, print, block_rows=0)
    wrong = crumple.Mesh(MESH.vertices, [[0, 1, 900]]).moving_to(END)
    with pytest.raises(crumple.InvalidInput, match="triangle 0"):
        detector.stream(wrong, query, print)


def test_stream_refuses_distances_and_options_index_and_least(detector):
    for option, query in (
        ("index", crumple.ImpactQuery(index=True)),
        ("least", crumple.ProximityQuery(radius=1, least=True)),
    ):
        with pytest.raises(crumple.InvalidInput, match=f"^{option} must be false: blocks have no "):
            detector.stream(STEP, query, print)
    with pytest.raises(crumple.InvalidType, match="a ProximityQuery needs a radius"):
        detector.stream(MESH, crumple.ProximityQuery(), print)
    with pytest.raises(crumple.InvalidInput, match="stream does not support DistanceQuery: see docs/supported.md"):
        detector.stream([MESH, MESH], crumple.DistanceQuery(), print)


def test_result_larger_than_the_memory_limit_can_be_streamed():
    mesh = soup(1500, 0.6)
    count = len(crumple.candidates(mesh))
    detector = crumple.Detector(memory_limit=4_000_000)
    with pytest.raises(crumple.MemoryLimit):
        detector.candidates(mesh)
    rows = []
    detector.stream(mesh, crumple.CandidateQuery(), lambda block: rows.append(len(block)), block_rows=20_000)
    assert sum(rows) == count > 300_000
