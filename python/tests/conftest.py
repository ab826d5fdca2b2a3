"""Helpers that several test files use: small triangle soups, and imports of packages that may be missing."""

from __future__ import annotations

import ctypes
import importlib
import os

import hypothesis
import numpy as np
import pytest

import crumple


def peer(name: str):
    """Returns another package. Skips the test, with a hint how to install the package, if it is missing."""
    try:
        return importlib.import_module(name)
    except ImportError as error:
        pytest.skip(
            f"{name} is not installed ({error}); scripts/test_python.sh --all installs what pip can",
            allow_module_level=True,
        )


def examples(usual: int) -> hypothesis.settings:
    """Returns settings for `usual` random examples, the same in each run, so that none fails on an unrelated change.

    As for the tests in C++, the environment variable CRUMPLE_ROUNDS multiplies their number.
    """
    rounds = int(os.environ.get("CRUMPLE_ROUNDS", "1"))
    return hypothesis.settings(max_examples=rounds * usual, derandomize=True, deadline=None)


def sufficient_limit(call, limit: int, **options) -> int:
    """Returns a memory limit under which `call(detector)` succeeds. Starts from `limit`, which must be too small."""
    with pytest.raises(crumple.MemoryLimit):
        call(crumple.Detector(memory_limit=limit, **options))
    while True:
        try:
            call(crumple.Detector(memory_limit=limit, **options))
            return limit
        except crumple.MemoryLimit as error:
            assert error.bytes_needed > limit
            limit = max(2 * limit, error.bytes_needed)


def soup(triangles: int, size: float = 0.2, seed: int = 1, dtype=np.float32) -> crumple.Mesh:
    """Returns random triangles in the unit cube. With the default size, many of them collide."""
    random = np.random.default_rng(seed)
    centres = random.random((triangles, 1, 3))
    vertices = (centres + size * (random.random((triangles, 3, 3)) - 0.5)).reshape(-1, 3).astype(dtype)
    return crumple.Mesh(vertices, np.arange(3 * triangles, dtype=np.int32).reshape(-1, 3))


def toi_of(first: crumple.FirstImpact | None) -> float | None:
    return None if first is None else first.toi


def as_set(pairs) -> set[tuple[int, int]]:
    return set(map(tuple, np.asarray(pairs).tolist()))


class OnDevice:
    """Array in host memory that claims to be in device memory, by default of a CUDA device (DLPack's kind 2)."""

    def __init__(self, array, device=0, kind=2):
        self.array, self.place = array, (kind, device)

    def __dlpack_device__(self):
        return self.place

    def __dlpack__(self, **_):
        """Returns NumPy's own capsule, with another device written into its DLTensor, where it follows the pointer."""
        capsule = self.array.__dlpack__()
        address = ctypes.pythonapi.PyCapsule_GetPointer
        address.restype, address.argtypes = ctypes.c_void_p, [ctypes.py_object, ctypes.c_char_p]
        tensor = address(capsule, b"dltensor")
        (ctypes.c_int32 * 2).from_address(tensor + 8)[:] = self.place
        return capsule


@pytest.fixture
def detector() -> crumple.Detector:
    return crumple.Detector(threads=2)


@pytest.fixture(params=["cpu", "reference"])
def either(request) -> crumple.Detector:
    """Detector of the cpu and of the reference backend: each test runs with both. For small scenes."""
    return crumple.Detector(backend=request.param, threads=2)


@pytest.fixture(scope="module")
def reference() -> crumple.Detector:
    return crumple.Detector(backend="reference")


@pytest.fixture
def crossing() -> crumple.Mesh:
    """Mesh of three triangles: 0 and 1 cross in a segment, 2 is far away."""
    vertices = np.array(
        [[0, 0, 0], [4, 0, 0], [0, 4, 0], [1, 1, -1], [1, 1, 2], [3, 1, 2], [9, 9, 9], [9, 9, 8], [9, 8, 9]], np.float64
    )
    return crumple.Mesh(vertices, np.arange(9, dtype=np.int32).reshape(3, 3))
