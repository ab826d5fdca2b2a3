"""Answers in blocks: together they are the whole answer."""

import threading

import numpy as np
import pytest

import crumple
from conftest import soup

MESH, OTHER = soup(300), soup(200)


def gathered(stream, *meshes, **arguments):
    blocks = []
    statistics = stream(blocks.append, *meshes, **arguments)
    assert statistics.pairs == sum(map(len, blocks))
    return blocks


@pytest.mark.parametrize("backend", ["cpu", "reference"])
@pytest.mark.parametrize("size", [1, 7, 100000])
def test_blocks_are_the_whole_answer(backend, size):
    detector = crumple.Detector(backend=backend, threads=2)
    for whole, stream, meshes in (
        (detector.find_self(MESH, contacts=True), detector.stream_self, (MESH,)),
        (detector.find_between(MESH, OTHER, contacts=True), detector.stream_between, (MESH, OTHER)),
    ):
        assert len(whole) > 20
        blocks = gathered(stream, *meshes, block_rows=size, contacts=True)
        assert max(map(len, blocks)) <= size
        pairs = np.concatenate([block.pairs for block in blocks])
        points = [contact.tolist() for block in blocks for contact in block.contacts]
        order = np.lexsort(pairs.T[::-1])
        pairs, points = pairs[order], [points[i] for i in order]
        assert np.array_equal(pairs, whole.pairs)
        assert points == [contact.tolist() for contact in whole.contacts]


def test_blocks_outlive_the_call_and_the_detector():
    detector = crumple.Detector()
    expected = detector.find_self(MESH).pairs.tolist()
    blocks = gathered(detector.stream_self, MESH, block_rows=10)
    assert blocks[0].contacts is None and repr(blocks[0]).startswith("<crumple.Block: ")
    detector.find_self(OTHER)
    del detector
    assert sorted(pair for block in blocks for pair in block.pairs.tolist()) == expected


def test_what_take_raises_ends_the_call():
    detector = crumple.Detector(threads=2)
    seen = []

    def refuse(block):
        seen.append(block)
        raise KeyError("full")

    with pytest.raises(KeyError, match="full"):
        detector.stream_self(refuse, MESH, block_rows=3)
    assert len(seen) == 1
    assert detector.find_self(MESH).pairs.tolist() == crumple.find_self_intersections(MESH).tolist()


def test_take_cannot_call_the_detector():
    detector = crumple.Detector(threads=2)
    messages, other = [], crumple.Detector(threads=1)

    def call(_):
        other.find_self(OTHER)
        try:
            detector.find_self(MESH)
        except crumple.InvalidInput as error:
            messages.append(str(error))

    detector.stream_self(call, MESH, block_rows=5)
    assert messages and set(messages) == {
        "neither a signal handler nor what takes a block can call the detector whose call goes on"
    }


def test_cancel_ends_a_stream_between_blocks():
    detector = crumple.Detector(threads=1)

    def cancel(_):
        stopper = threading.Thread(target=detector.cancel)
        stopper.start()
        stopper.join()

    with pytest.raises(crumple.Error) as caught:
        detector.stream_self(cancel, MESH, block_rows=2)
    assert caught.value.code == "cancelled"


def test_wrong_arguments_are_named(detector):
    with pytest.raises(crumple.InvalidType, match="take must be callable"):
        detector.stream_self(MESH, MESH)
    with pytest.raises(crumple.InvalidInput, match="block_rows"):
        detector.stream_self(print, MESH, block_rows=0)
    with pytest.raises(crumple.InvalidType, match="block_rows"):
        detector.stream_self(print, MESH, block_rows="many")
    with pytest.raises(TypeError, match="block_rows"):
        detector.stream_self(print, MESH, block_row=5)


def test_a_memory_limit_that_the_answer_exceeds():
    rng = np.random.default_rng(1)
    centres = rng.random((3000, 1, 3))
    vertices = (centres + 0.9 * (rng.random((3000, 3, 3)) - 0.5)).reshape(-1, 3).astype(np.float32)
    faces = np.arange(9000, dtype=np.int32).reshape(-1, 3)
    count = len(crumple.find_self_intersections(vertices, faces))
    detector = crumple.Detector(memory_limit=2_500_000)
    with pytest.raises(crumple.MemoryLimit):
        detector.find_self(vertices, faces)
    blocks = gathered(detector.stream_self, vertices, faces, block_rows=10_000)
    assert sum(map(len, blocks)) == count > 200_000
