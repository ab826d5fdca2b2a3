"""Tests of random soups, which hypothesis generates, against brute force in rational arithmetic."""

import numpy as np
from hypothesis import assume, given
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays

import crumple
from conftest import examples

WARM = crumple.Detector(threads=2, leaf_size=4)
REFERENCE = crumple.Detector(backend="reference")

# On a small grid, triangles often touch, overlap or are degenerate exactly. Scales reach the limits of float64.
grid = st.integers(-3, 3).map(float)
free = st.floats(-1e3, 1e3, allow_subnormal=True)
scales = st.sampled_from([1.0, 1e-3, 3e7, 1e-300, 1e300])


@st.composite
def soups(draw):
    vertex_count = draw(st.integers(1, 12))
    coordinates = draw(st.sampled_from([grid, free]))
    vertices = draw(arrays.arrays(np.float64, (vertex_count, 3), elements=coordinates))
    if draw(st.booleans()):
        vertices = vertices.astype(np.float32)
    else:
        vertices = vertices * draw(scales)
    faces = draw(
        arrays.arrays(
            draw(arrays.integer_dtypes() | arrays.unsigned_integer_dtypes()),
            (draw(st.integers(0, 15)), 3),
            elements=st.integers(0, vertex_count - 1),
        )
    )
    groups = draw(st.none() | arrays.arrays(np.int32, len(faces), elements=st.integers(-2, 2)))
    return crumple.Mesh(draw(st.sampled_from([np.ascontiguousarray, np.asfortranarray]))(vertices), faces, groups)


filters = st.builds(
    crumple.PairFilter,
    groups=st.sampled_from(["both", "between", "within"]),
    excluded_groups=st.lists(st.tuples(st.integers(-2, 2), st.integers(-2, 2)), max_size=3),
)
queries = st.fixed_dictionaries(
    {
        "neighbours": st.sampled_from(["geometric", "skip"]),
        "kind": st.sampled_from(["all", "proper"]),
        "weld": st.booleans(),
        "filter": filters,
    }
)


def same(found, expected):
    assert found.pairs.tolist() == expected.pairs.tolist()
    assert found.hit.tolist() == expected.hit.tolist() and found.hit_second.tolist() == expected.hit_second.tolist()
    assert found.contacts.offsets.tolist() == expected.contacts.offsets.tolist()
    assert found.contacts.points.tobytes() == expected.contacts.points.tobytes()


def sensible(query, *meshes):
    """Rejects queries that need groups for meshes without groups, which are errors."""
    needs_groups = query["filter"].groups == "between" or query["filter"].excluded_groups
    assume(not needs_groups or any(mesh.groups is not None for mesh in meshes))


@examples(300)
@given(soups(), queries)
def test_pairs_within_a_random_soup_match_brute_force(mesh, query):
    sensible(query, mesh)
    result = WARM.intersections(mesh, output="contacts", **query)
    same(result, REFERENCE.intersections(mesh, output="contacts", **query))
    assert WARM.any(mesh, crumple.IntersectionQuery(**query)) == bool(result)


@examples(200)
@given(soups(), soups(), queries)
def test_pairs_between_random_soups_match_brute_force(a, b, query):
    sensible(query, a, b)
    result = WARM.intersections(a, b, output="contacts", **query)
    same(result, REFERENCE.intersections(a, b, output="contacts", **query))
    assert WARM.any([a, b], crumple.IntersectionQuery(**query)) == bool(result)


@examples(200)
@given(
    arrays.arrays(arrays.scalar_dtypes(), arrays.array_shapes(max_dims=3, max_side=4)),
    arrays.arrays(arrays.scalar_dtypes(), arrays.array_shapes(max_dims=3, max_side=4)),
)
def test_random_arrays_give_a_result_or_an_input_error(vertices, faces):
    """Any arrays give a result or InvalidInput, but never a crash or another exception."""
    try:
        pairs = WARM.intersections(vertices, faces).pairs
    except crumple.InvalidInput as error:
        assert str(error)
    else:
        assert vertices.shape[1] == 3 and pairs.shape[1] == 2
        assert faces.shape[1] == 3 if faces.ndim == 2 else faces.size % 3 == 0
