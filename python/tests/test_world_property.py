"""Tests of random worlds, which hypothesis generates, against brute force in rational arithmetic."""

import dataclasses

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays

import crumple
from conftest import examples

WARM = crumple.Detector(threads=2, leaf_size=4)
REFERENCE = crumple.Detector(backend="reference")
ARRAYS = ("bodies", "pairs", "world_hit", "world_counts", "world_offsets", "body_offsets", "first_triangle", "hit")

# On a small grid, triangles often touch, overlap or are degenerate exactly. Integer poses keep vertices on the grid.
grid = st.integers(-2, 2).map(float)


@st.composite
def shapes(draw):
    vertices = draw(arrays.arrays(np.float64, (draw(st.integers(1, 8)), 3), elements=grid))
    faces = draw(arrays.arrays(np.int32, (draw(st.integers(0, 6)), 3), elements=st.integers(0, len(vertices) - 1)))
    groups = draw(st.none() | arrays.arrays(np.int32, len(faces), elements=st.integers(0, 2)))
    return crumple.Mesh(vertices.astype(draw(st.sampled_from([np.float32, np.float64]))), faces, groups)


@st.composite
def worlds(draw):
    given_shapes = draw(st.lists(shapes(), min_size=1, max_size=3))
    n = draw(st.integers(0, 5))
    column = st.integers(0, 2)
    of = sorted(draw(st.lists(column, min_size=n, max_size=n)))
    at_rest = draw(st.integers(0, n))
    return {
        "shapes": given_shapes,
        "bodies": draw(arrays.arrays(np.int32, n, elements=st.integers(0, len(given_shapes) - 1))),
        "poses": draw(st.none() | arrays.arrays(np.float64, (n, 3, 4), elements=grid)),
        "groups": draw(arrays.arrays(np.int32, n, elements=column)),
        "worlds": np.array(of[: n - at_rest] + [-1] * at_rest, np.int32),
        "self_collisions": draw(arrays.arrays(np.bool_, n)),
    }


scopes = st.sampled_from(["both", "between", "within"])
filters = st.builds(
    crumple.PairFilter,
    bodies=scopes,
    groups=scopes,
    excluded_groups=st.lists(st.tuples(st.integers(0, 2), st.integers(0, 2)), max_size=2),
)
questions = st.fixed_dictionaries(
    {
        "neighbours": st.sampled_from(["geometric", "skip"]),
        "kind": st.sampled_from(["all", "proper"]),
        "weld": st.booleans(),
        "filter": filters,
    }
)


@examples(200)
@given(worlds(), questions, st.lists(st.tuples(st.integers(0, 4), st.integers(0, 4)), max_size=3), st.booleans())
def test_random_worlds_match_brute_force(columns, question, excluded, named):
    n = len(columns["bodies"])
    excluded = [pair for pair in excluded if max(pair) < n]
    columns = dict(columns)
    given_shapes = columns.pop("shapes")
    question["filter"] = dataclasses.replace(question["filter"], excluded_bodies=excluded)
    world = crumple.World(given_shapes, **columns)
    expected = REFERENCE.intersections(world, output="contacts", index=True, **question)
    # Each example needs new names, because hypothesis generates new shapes.
    made = [crumple.Shape(*shape, name=f"{id(columns)} {i}" if named else None) for i, shape in enumerate(given_shapes)]
    world = crumple.World(made, **columns)
    detector = crumple.Detector(threads=1) if named else WARM
    found = detector.intersections(world, output="contacts", index=True, **question)
    for name in ARRAYS:
        np.testing.assert_array_equal(getattr(found, name), getattr(expected, name), name)
    np.testing.assert_array_equal(found.contacts.points, expected.contacts.points)
    assert detector.intersections(world, output="any", **question).any is expected.any
    flags = detector.intersections(world, output="any_by_world", **question)
    np.testing.assert_array_equal(flags.world_hit, expected.world_hit)
    bodies = detector.intersections(world, output="body_pairs", **question).bodies
    np.testing.assert_array_equal(bodies, np.unique(expected.bodies, axis=0).reshape(-1, 2))
