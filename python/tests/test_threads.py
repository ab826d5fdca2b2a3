"""Calls release the GIL, detectors work side by side, calls of one detector take turns, and Ctrl-C is not lost."""

import signal
import subprocess
import sys
import textwrap
import threading
import time
from concurrent.futures import ThreadPoolExecutor

import numpy as np

import crumple
from conftest import soup


def test_other_threads_run_meanwhile():
    """With the GIL held, the counting thread would stand still while brute force is at work."""
    mesh, detector = soup(1500, size=0.3), crumple.Detector(backend="reference")
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
    detector.find_self(mesh)
    end = time.perf_counter()
    inside.clear()
    thread.join()
    within = [t for t in ticks if begin < t < end]
    assert end - begin > 0.1, "too short to tell"
    assert len(within) > 10 and within[-1] - within[0] > 0.5 * (end - begin)


def test_two_detectors_at_once():
    """Both are inside the library at one time: each takes as long as the other and their times overlap."""
    mesh = soup(1500, size=0.3)
    spans = []

    def search():
        detector = crumple.Detector(backend="reference")
        begin = time.perf_counter()
        pairs = detector.find_self(mesh).pairs
        spans.append((begin, time.perf_counter()))
        return pairs

    with ThreadPoolExecutor(2) as pool:
        first, second = (f.result() for f in [pool.submit(search), pool.submit(search)])
    np.testing.assert_array_equal(first, second)
    overlap = min(end for _, end in spans) - max(begin for begin, _ in spans)
    assert overlap > 0.5 * min(end - begin for begin, end in spans)


def test_many_threads_with_detectors_of_their_own():
    meshes = [soup(400, seed=s) for s in range(8)]
    expected = [crumple.find_self_intersections(m).tolist() for m in meshes]

    def search(i):
        detector = crumple.Detector(threads=1 + i % 3)
        return all(detector.find_self(meshes[(i + k) % 8]).pairs.tolist() == expected[(i + k) % 8] for k in range(20))

    with ThreadPoolExecutor(8) as pool:
        assert all(pool.map(search, range(8)))


def test_one_detector_and_many_threads(detector):
    """Calls take turns; results of each thread are its own, and are dropped by any."""
    meshes = [soup(300, seed=s) for s in range(6)]
    expected = [crumple.find_self_intersections(m).tolist() for m in meshes]

    def search(i):
        results = [(k % 6, detector.find_self(meshes[k % 6])) for k in range(i, i + 30)]
        return all(result.pairs.tolist() == expected[which] for which, result in results)

    with ThreadPoolExecutor(6) as pool:
        assert all(pool.map(search, range(6)))


def test_interrupt_is_raised_when_the_call_ends():
    """As documented: the call is not cut short, its answer is dropped, the detector stays usable."""
    program = textwrap.dedent("""
        import signal, crumple
        signal.signal(signal.SIGINT, signal.default_int_handler)  # background jobs of a shell ignore it
        mesh = crumple.make_scene("soup", triangles=2000)
        detector = crumple.Detector(backend="reference")
        try:
            print("ready", flush=True)
            while True:
                detector.find_self(mesh)
        except KeyboardInterrupt:
            print("interrupted", detector.has_intersections(mesh))
    """)
    process = subprocess.Popen(
        [sys.executable, "-c", program], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )
    assert process.stdout.readline() == "ready\n"
    time.sleep(0.3)
    process.send_signal(signal.SIGINT)
    out, errors = process.communicate(timeout=60)
    assert (out, errors, process.returncode) == ("interrupted True\n", "", 0)
