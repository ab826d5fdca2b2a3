"""Tests that calls release the GIL, detectors run in parallel, calls of one detector wait, and Ctrl-C ends a call."""

import signal
import subprocess
import sys
import textwrap
import threading
import time
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

import crumple
from conftest import soup


def test_other_threads_run_during_a_search():
    """If the call held the GIL, the counting thread would stop during the search, which is by brute force."""
    mesh, detector = soup(3000, size=0.3), crumple.Detector(backend="reference")
    inside, ticks = threading.Event(), []

    def count():
        inside.wait()
        while inside.is_set():
            ticks.append(time.perf_counter())
            time.sleep(0.001)

    thread = threading.Thread(target=count)
    thread.start()
    inside.set()
    begin = time.perf_counter()
    detector.intersections(mesh)
    end = time.perf_counter()
    inside.clear()
    thread.join()
    within = [t for t in ticks if begin < t < end]
    assert end - begin > 0.1, "too short to tell"
    assert len(within) > 10 and within[-1] - within[0] > 0.5 * (end - begin)


def test_two_detectors_search_at_the_same_time():
    """Both are inside the library at the same time: their searches overlap for more than half of the shorter one."""
    mesh = soup(1500, size=0.3)
    spans = []

    def search():
        detector = crumple.Detector(backend="reference")
        begin = time.perf_counter()
        pairs = detector.intersections(mesh).pairs
        spans.append((begin, time.perf_counter()))
        return pairs

    with ThreadPoolExecutor(2) as pool:
        first, second = (f.result() for f in [pool.submit(search), pool.submit(search)])
    np.testing.assert_array_equal(first, second)
    overlap = min(end for _, end in spans) - max(begin for begin, _ in spans)
    assert overlap > 0.5 * min(end - begin for begin, end in spans)


def test_threads_with_own_detectors_get_the_same_pairs_as_one_thread():
    meshes = [soup(400, seed=s) for s in range(8)]
    expected = [crumple.intersections(m).pairs.tolist() for m in meshes]

    def search(i):
        detector = crumple.Detector(threads=1 + i % 3)
        return all(
            detector.intersections(meshes[(i + k) % 8]).pairs.tolist() == expected[(i + k) % 8] for k in range(20)
        )

    with ThreadPoolExecutor(8) as pool:
        assert all(pool.map(search, range(8)))


def test_threads_that_share_a_detector_get_their_own_results(detector):
    """Calls run one after another. Each thread gets its own results, and any thread may free them."""
    meshes = [soup(300, seed=s) for s in range(6)]
    expected = [crumple.intersections(m).pairs.tolist() for m in meshes]

    def search(i):
        results = [(k % 6, detector.intersections(meshes[k % 6])) for k in range(i, i + 30)]
        return all(result.pairs.tolist() == expected[which] for which, result in results)

    with ThreadPoolExecutor(6) as pool:
        assert all(pool.map(search, range(6)))


def test_cancel_ends_the_call_of_another_thread():
    mesh, detector = soup(20_000, size=0.3), crumple.Detector(backend="reference")  # the search would take minutes
    detector.cancel()
    assert detector.any(mesh), "there was nothing to cancel"
    with ThreadPoolExecutor(1) as pool:
        call = pool.submit(detector.intersections, mesh)
        while not call.done():  # a cancel() before the call begins has no effect
            detector.cancel()
            time.sleep(0.01)
    with pytest.raises(crumple.Error, match="cancel") as caught:
        call.result()
    assert caught.value.code == "cancelled" and not isinstance(caught.value, crumple.InvalidInput)
    assert detector.any(mesh), "the detector stays usable"


@pytest.mark.parametrize("backend", ["cpu", "reference"])
@pytest.mark.parametrize("name", ["impacts", "proximities"])
def test_cancel_ends_searches_for_impacts_and_proximities(name, backend):
    mesh, small, detector = soup(20_000, size=0.3), soup(20), crumple.Detector(backend=backend, threads=2)

    def find(mesh):
        step = {"radius": 0.3} if name == "proximities" else {"end": mesh.vertices[::-1].copy()}
        return getattr(detector, name)(mesh, **step)

    expected = find(small).edge_edges.tolist()
    with ThreadPoolExecutor(1) as pool:
        call = pool.submit(find, mesh)
        while not call.done():
            detector.cancel()
            time.sleep(0.01)
    with pytest.raises(crumple.Error, match="cancel") as caught:
        call.result()
    assert caught.value.code == "cancelled" and find(small).edge_edges.tolist() == expected


def test_threads_that_share_a_detector_get_their_own_near_pairs(detector):
    meshes = [soup(40, size=0.5, seed=s) for s in range(4)]

    def pairs_of(near):
        return near.vertex_faces.tolist(), near.edge_edges.tolist()

    expected = [pairs_of(crumple.proximities(m, radius=0.1)) for m in meshes]
    assert all(edge_edges for _, edge_edges in expected)

    def search(i):
        for k in range(i, i + 20):
            mesh = meshes[k % 4]
            assert pairs_of(detector.proximities(mesh, radius=0.1)) == expected[k % 4]
            assert not detector.any(mesh.moving_to(mesh.vertices), crumple.ImpactQuery())
        return True

    with ThreadPoolExecutor(4) as pool:
        assert all(pool.map(search, range(4)))


def run_interrupted(program):
    """Runs a program, sends SIGINT 0.3 s after it has printed "ready", and returns its further output."""
    process = subprocess.Popen(
        [sys.executable, "-c", textwrap.dedent(program)], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )
    assert process.stdout.readline() == "ready\n"
    time.sleep(0.3)
    process.send_signal(signal.SIGINT)
    out, errors = process.communicate(timeout=60)
    assert (errors, process.returncode) == ("", 0)
    return out


@pytest.mark.parametrize(
    ("options", "triangles", "size"),
    [("backend='reference'", 20000, 0.3), ("threads=1", 200000, 0.3), ("threads=2", 200000, 0.3)],
)
def test_interrupt_ends_a_search_early(options, triangles, size):
    """The search would take many seconds, but the call ends at once; the detector stays usable."""
    program = f"""
        import signal, time, crumple
        import numpy as np
        signal.signal(signal.SIGINT, signal.default_int_handler)  # background jobs of a shell ignore it
        corners = np.random.default_rng(1).random(({triangles}, 1, 3)) + {size} * np.random.random(({triangles}, 3, 3))
        mesh = (corners.reshape(-1, 3), np.arange(3 * {triangles}).reshape(-1, 3))
        detector = crumple.Detector({options})
        try:
            print("ready", flush=True)
            detector.intersections(mesh)
        except KeyboardInterrupt:
            print("interrupted", detector.any(mesh))
    """
    assert run_interrupted(program) == "interrupted True\n"


def test_interrupt_leaves_the_search_of_another_thread_running():
    """The interrupt ends the wait of the main thread at once; the other thread's call continues."""
    program = """
        import signal, threading, time, crumple
        signal.signal(signal.SIGINT, signal.default_int_handler)
        mesh = crumple.make_scene("soup", triangles=2000)
        detector, stop = crumple.Detector(backend="reference"), threading.Event()
        failures = []

        def search():
            while not stop.is_set():
                try:
                    detector.intersections(mesh)
                except BaseException as error:
                    failures.append(error)

        thread = threading.Thread(target=search)
        thread.start()
        try:
            print("ready", flush=True)
            while True:
                detector.intersections(mesh)
        except KeyboardInterrupt:
            print("interrupted", failures)
        stop.set()
        thread.join()
    """
    assert run_interrupted(program) == "interrupted []\n"


def test_a_signal_handler_cannot_call_the_detector_it_interrupts():
    program = """
        import signal, crumple
        mesh = crumple.make_scene("soup", triangles=6000)  # a call takes far longer than the 20 ms between checks
        detector = crumple.Detector(backend="reference")
        interrupted = []

        def handle(*_):
            interrupted.append(True)
            detector.intersections(mesh)

        signal.signal(signal.SIGINT, handle)
        print("ready", flush=True)
        try:
            while not interrupted:
                detector.intersections(mesh)
            print("between two calls")
        except crumple.InvalidInput as error:
            print(error)
    """
    outputs = [run_interrupted(program)]
    while outputs[-1] == "between two calls\n" and len(outputs) < 5:
        outputs.append(run_interrupted(program))
    assert outputs[-1] == (
        "neither a signal handler nor take(block) can call a detector while another call of it is in progress\n"
    )
