"""Tests that searches of worlds release the GIL, can share worlds between threads, and end at Ctrl-C."""

import threading
import time
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest
from test_threads import run_interrupted

import crumple
from conftest import soup
from worlds import random_poses


@pytest.mark.parametrize(
    ("options", "output", "name", "count"),
    [
        ("threads=1", "any_by_world", "'ball'", 200_000),
        ("threads=2", "any_by_world", "'ball'", 200_000),
        ("threads=2", "pairs", "'ball'", 200_000),
        ("threads=2", "count", "None", 200_000),
        ("backend='reference'", "any", "'ball'", 100),
    ],
)
def test_interrupt_ends_a_search_early(options, output, name, count):
    """In each of many configurations, one ball is inside another: their boxes overlap, but nothing collides."""
    program = f"""
        import signal, crumple
        import numpy as np
        signal.signal(signal.SIGINT, signal.default_int_handler)  # background jobs of a shell ignore it
        u, v = np.meshgrid(np.linspace(0, 2 * np.pi, 31), np.linspace(0.1, 3, 30), indexing="ij")
        ball = np.stack([np.sin(v) * np.cos(u), np.sin(v) * np.sin(u), np.cos(v)], axis=-1).reshape(-1, 3)
        a = (30 * np.arange(30)[:, None] + np.arange(29)).ravel()
        faces = np.concatenate([np.stack([a, a + 1, a + 31], 1), np.stack([a, a + 31, a + 30], 1)])
        shapes = [crumple.Shape(r * ball, faces, name={name} and {name} + str(r)) for r in (1, 1.01)]
        base = crumple.World(shapes, worlds=[0, -1], self_collisions=False)
        many = base.configurations(np.tile(np.eye(3, 4), ({count}, 1, 1, 1)))
        detector = crumple.Detector({options})
        try:
            print("ready", flush=True)
            detector.intersections(many, output="{output}")
        except KeyboardInterrupt:
            print("interrupted", detector.any(base))
    """
    assert run_interrupted(program) == "interrupted False\n"


def test_cancel_ends_the_call_of_another_thread():
    base = crumple.World([soup(1000, size=0.3)], [0, 0], worlds=[0, -1], self_collisions=True)
    many = base.configurations(np.tile(np.eye(3, 4), (20_000, 1, 1, 1)))
    detector, failures = crumple.Detector(threads=1), []

    def search():
        try:
            detector.intersections(many)
        except crumple.Error as error:
            failures.append(error.code)

    thread = threading.Thread(target=search)
    thread.start()
    while thread.is_alive():
        detector.cancel()
        time.sleep(0.01)
    assert failures == ["cancelled"]


def test_calls_keep_their_own_poses_if_threads_share_a_world():
    """Each call searches with the poses it was given, even if other threads change the poses of the world meanwhile."""
    random = np.random.default_rng(1)
    world = crumple.World([crumple.Shape(soup(40, size=0.5), name="shared")], [0, 0, 0], self_collisions=False)
    placed = random_poses(random, 8 * 3, 0.5).reshape(8, 3, 3, 4)
    square = np.concatenate([placed, np.broadcast_to([0, 0, 0, 1.0], (8, 3, 1, 4))], axis=2)
    expected = [crumple.Detector().intersections(world.at(poses)).pairs.tolist() for poses in placed]
    assert len(set(map(str, expected))) > 4
    shared = crumple.Detector(threads=2)

    def search(i):
        detector = shared if i % 2 else crumple.Detector(threads=1)
        for k in range(50):
            n = (i + k) % 8
            world.poses = placed[(i * k) % 8]
            assert detector.intersections(world.at((square if k % 2 else placed)[n])).pairs.tolist() == expected[n]
        return True

    with ThreadPoolExecutor(8) as pool:
        assert all(pool.map(search, range(8)))


def test_poses_replaced_during_a_call_do_not_change_its_result():
    """If poses were freed during a call, the result would change or the process crash."""
    base = crumple.World([soup(60, size=0.5)], [0], worlds=[0], self_collisions=True)
    poses = random_poses(np.random.default_rng(2), 500, 9).reshape(500, 1, 3, 4)
    many, detector = base.configurations(poses.copy()), crumple.Detector(threads=1)
    expected = detector.intersections(many).pairs
    found = []
    for _ in range(5):
        many.poses = poses.copy()
        thread = threading.Thread(target=lambda: found.append(detector.intersections(many).pairs))
        thread.start()
        while thread.is_alive():
            many.poses = np.full_like(poses, 1.0)
            many.poses = poses.copy()
    for pairs in found:
        np.testing.assert_array_equal(pairs, expected)
