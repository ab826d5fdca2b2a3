"""What the tests share: small soups, and packages that may be missing."""

from __future__ import annotations

import importlib

import numpy as np
import pytest

import crumple


def peer(name: str):
    """Another package, or a skip that says how to get it."""
    try:
        return importlib.import_module(name)
    except ImportError as error:
        pytest.skip(f"{name} is not installed ({error}); scripts/test_python.sh --all installs what pip can")


def soup(triangles: int, size: float = 0.2, seed: int = 1, dtype=np.float32) -> crumple.Mesh:
    """Random triangles in the unit cube; those of size 0.2 collide a lot."""
    random = np.random.default_rng(seed)
    centres = random.random((triangles, 1, 3))
    vertices = (centres + size * (random.random((triangles, 3, 3)) - 0.5)).reshape(-1, 3).astype(dtype)
    return crumple.Mesh(vertices, np.arange(3 * triangles, dtype=np.int32).reshape(-1, 3))


def as_set(pairs) -> set[tuple[int, int]]:
    return set(map(tuple, np.asarray(pairs).tolist()))


@pytest.fixture
def detector() -> crumple.Detector:
    return crumple.Detector(threads=2)


@pytest.fixture
def crossing() -> crumple.Mesh:
    """Triangles 0 and 1 cross in a segment, triangle 2 is far away."""
    vertices = np.array(
        [[0, 0, 0], [4, 0, 0], [0, 4, 0], [1, 1, -1], [1, 1, 2], [3, 1, 2], [9, 9, 9], [9, 9, 8], [9, 8, 9]], np.float64
    )
    return crumple.Mesh(vertices, np.arange(9, dtype=np.int32).reshape(3, 3))
