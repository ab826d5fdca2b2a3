"""Tests of the pairs of triangles on which benchmarks/misses_python.py compares other packages."""

import sys
from pathlib import Path

import numpy as np
import pytest

import crumple

BENCHMARKS = Path(__file__).parents[2] / "benchmarks"
sys.path.insert(0, str(BENCHMARKS))
import exact_triangles  # noqa: E402
import miss_cases  # noqa: E402
import miss_kinds  # noqa: E402

KINDS = [*miss_kinds.PLAIN, *miss_kinds.SCALES, *miss_kinds.INDEXED]
TOUCHING = [
    "equal edge",
    "equal vertex",
    "vertex on face",
    "edge across edge",
    "edge along edge",
    "edge in face",
    "duplicate",
]


@pytest.mark.parametrize("kind", KINDS)
def test_two_exact_methods_and_the_cpu_backend_decide_each_kind_alike(kind):
    reference, detector = crumple.Detector(backend="reference"), crumple.Detector(backend="cpu", threads=1)
    for case in miss_kinds.cases(kind, 20):
        truth = miss_cases.truth_of(case, reference)  # raises if two exact methods differ
        assert bool(len(detector.intersections(*case.arrays).pairs)) == truth.collides, case
        assert bool(len(detector.intersections(*case.arrays, weld=True).pairs)) == truth.welded, case


@pytest.mark.parametrize("kind", TOUCHING)
def test_triangles_that_touch_collide_but_not_properly(kind):
    reference = crumple.Detector(backend="reference")
    truths = [miss_cases.truth_of(case, reference) for case in miss_kinds.cases(kind, 20)]
    assert all(truth.collides and not truth.proper for truth in truths)


def test_hulls_meet_by_less_than_any_rounding():
    floor = np.array([[-3.0, -3, 0], [3, -3, 0], [0, 3, 0]])
    for height, meets in ((0.0, True), (5e-324, False), (-5e-324, True)):
        assert exact_triangles.hulls_meet(floor, [[0, 0, height], [0, 0, 1], [0, 1, 1]]) == meets


def test_pairs_outside_a_promise_are_not_misses():
    case = miss_kinds.cases("vertex on face", 1)[0]
    truth = miss_cases.truth_of(case, crumple.Detector(backend="reference"))
    full = miss_cases.Column("full", "", "", "")
    crossing_only = miss_cases.Column("crossing only", "", "", "", touching=False)
    assert miss_cases.failure(full, case, truth, False) == "missed"
    assert miss_cases.failure(crossing_only, case, truth, False) == "unpromised"
    assert miss_cases.failure(crossing_only, case, truth, True) is None
    assert miss_cases.failure(full, case, truth, "crashed") == "crashed"
