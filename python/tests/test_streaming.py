"""Tests of results that are delivered in blocks: all blocks together are the whole result."""

import threading

import numpy as np
import pytest

import crumple
from conftest import soup

MESH, OTHER = soup(300), soup(200)


def gathered(detector, scene, block_rows, **query):
    blocks = []
    statistics = detector.stream(scene, crumple.IntersectionQuery(**query), blocks.append, block_rows=block_rows)
    assert statistics.pairs == sum(map(len, blocks))
    return blocks


@pytest.mark.parametrize("backend", ["cpu", "reference"])
@pytest.mark.parametrize("size", [1, 7, 100000])
def test_blocks_together_are_the_whole_result(backend, size):
    detector = crumple.Detector(backend=backend, threads=2)
    for whole, scene in (
        (detector.intersections(MESH, output="contacts"), MESH),
        (detector.intersections(MESH, OTHER, output="contacts"), [MESH, OTHER]),
    ):
        assert len(whole) > 20
        blocks = gathered(detector, scene, block_rows=size, output="contacts")
        assert max(map(len, blocks)) <= size
        pairs = np.concatenate([block.pairs for block in blocks])
        points = [contact.tolist() for block in blocks for contact in block.contacts]
        order = np.lexsort(pairs.T[::-1])
        pairs, points = pairs[order], [points[i] for i in order]
        assert np.array_equal(pairs, whole.pairs)
        assert points == [contact.tolist() for contact in whole.contacts]


def test_blocks_outlive_the_call_and_the_detector():
    detector = crumple.Detector()
    expected = detector.intersections(MESH).pairs.tolist()
    blocks = gathered(detector, MESH, block_rows=10)
    assert blocks[0].contacts is None and repr(blocks[0]) == "<crumple.Intersections: a block of 10 colliding pairs>"
    detector.intersections(OTHER)
    del detector
    assert sorted(pair for block in blocks for pair in block.pairs.tolist()) == expected


def test_exception_raised_by_the_consumer_ends_the_call():
    detector = crumple.Detector(threads=2)
    seen = []

    def refuse(block):
        seen.append(block)
        raise KeyError("full")

    with pytest.raises(KeyError, match="full"):
        detector.stream(MESH, crumple.IntersectionQuery(), refuse, block_rows=3)
    assert len(seen) == 1
    assert detector.intersections(MESH).pairs.tolist() == crumple.intersections(MESH).pairs.tolist()


def test_consumer_of_blocks_cannot_call_the_detector():
    detector = crumple.Detector(threads=2)
    messages, other = [], crumple.Detector(threads=1)

    def call(_):
        other.intersections(OTHER)
        try:
            detector.intersections(MESH)
        except crumple.InvalidInput as error:
            messages.append(str(error))

    detector.stream(MESH, crumple.IntersectionQuery(), call, block_rows=5)
    assert messages and set(messages) == {
        "neither a signal handler nor take(block) can call a detector while another call of it is in progress"
    }


def test_cancel_ends_a_stream_between_blocks():
    detector = crumple.Detector(threads=1)
    blocks = []

    def cancel(block):
        blocks.append(block)
        stopper = threading.Thread(target=detector.cancel)
        stopper.start()
        stopper.join()

    with pytest.raises(crumple.Error) as caught:
        detector.stream(MESH, crumple.IntersectionQuery(), cancel, block_rows=2)
    assert caught.value.code == "cancelled" and len(blocks) == 1


def test_error_names_the_wrong_argument(detector):
    with pytest.raises(crumple.InvalidType, match="take must be callable"):
        detector.stream(MESH, crumple.IntersectionQuery(), MESH)
    with pytest.raises(crumple.InvalidInput, match="block_rows"):
        detector.stream(MESH, crumple.IntersectionQuery(), print, block_rows=0)
    with pytest.raises(crumple.InvalidType, match="block_rows"):
        detector.stream(MESH, crumple.IntersectionQuery(), print, block_rows="many")
    with pytest.raises(TypeError, match="block_rows"):
        detector.stream(MESH, crumple.IntersectionQuery(), print, block_row=5)


def test_result_larger_than_the_memory_limit_can_be_streamed():
    rng = np.random.default_rng(1)
    centres = rng.random((3000, 1, 3))
    vertices = (centres + 0.9 * (rng.random((3000, 3, 3)) - 0.5)).reshape(-1, 3).astype(np.float32)
    faces = np.arange(9000, dtype=np.int32).reshape(-1, 3)
    count = len(crumple.intersections(vertices, faces).pairs)
    detector = crumple.Detector(memory_limit=2_500_000)
    with pytest.raises(crumple.MemoryLimit):
        detector.intersections(vertices, faces)
    blocks = gathered(detector, (vertices, faces), block_rows=10_000)
    assert sum(map(len, blocks)) == count > 200_000
