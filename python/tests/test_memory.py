"""Tests of freed memory, and of calls on a machine without free memory. Each test has a process of its own."""

import os
import subprocess
import sys
import textwrap

import pytest


def run(program, **environment):
    command = [sys.executable, "-c", textwrap.dedent(program)]
    process = subprocess.run(command, capture_output=True, text=True, env={**os.environ, **environment})
    assert process.returncode == 0, process.stderr
    return process.stdout.split()


def test_dropped_result_is_freed_under_a_memory_limit():
    """Without a limit, the detector keeps the memory of a dropped result for its next call."""
    program = """
        import numpy as np, crumple
        vertices = np.random.default_rng(1).random((9000, 3)).astype(np.float32)
        faces = np.arange(9000, dtype=np.int32).reshape(-1, 3)

        def resident():
            return int(open("/proc/self/statm").read().split()[1]) * 4096

        for limit in (0, 1 << 30):
            detector = crumple.Detector(threads=1, memory_limit=limit)
            result = detector.intersections(vertices, faces)
            size, before = result.pairs.nbytes, resident()
            del result
            print((before - resident()) / size)
    """
    kept, freed = map(float, run(program, MALLOC_MMAP_THRESHOLD_="65536"))  # large arrays go back to the system at once
    assert kept < 0.1 and freed > 0.9


def test_exhausted_memory_raises_a_memory_error():
    program = """
        import resource, crumple
        few, many = (crumple.make_scene("soup", triangles=n) for n in (10, 400_000))
        detector = crumple.Detector(threads=1)
        detector.intersections(few)
        used = int(open("/proc/self/statm").read().split()[0]) * 4096
        resource.setrlimit(resource.RLIMIT_AS, (used + (20 << 20), -1))
        try:
            detector.intersections(many)
        except MemoryError as error:
            print(type(error).__name__, error, sep=", ")
        try:
            crumple.make_scene("soup", triangles=2_000_000)
        except MemoryError as error:
            print(type(error).__name__, error, sep=", ")
        print(len(detector.intersections(few)) >= 0)  # stays usable
    """
    sentence = "MemoryError, the machine has no memory left for this call"
    assert run(program) == [*sentence.split(), *sentence.split(), "True"]


def test_memory_error_of_an_array_names_the_argument(detector):
    class Raising:
        def __init__(self, *sentence):
            self.error = MemoryError(*sentence)

        def __array__(self, dtype=None, copy=None):
            raise self.error

    with pytest.raises(MemoryError, match="^vertices cannot be read as an array: the machine has no memory left$"):
        detector.intersections(Raising(), [[0, 0, 0]])
    with pytest.raises(MemoryError, match="^faces cannot be read as an array: Unable to allocate 3 GiB$"):
        detector.intersections([[0, 0, 0]], Raising("Unable to allocate 3 GiB"))
