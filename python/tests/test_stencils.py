"""Tests of stencils: energies and gradients made from them match brute force over all pairs of features."""

import pickle
from dataclasses import fields

import numpy as np
import pytest

import crumple
from conftest import soup
from test_feature_pairs import all_pairs

RADIUS = 0.1
# A vertex at the height 0.25 above the inside of a face; other pairs are far.
FACES = np.array([[0, 1, 2], [3, 4, 5]])
START = np.array([[0, 0, 0], [4, 0, 0], [0, 4, 0], [1, 1, 0.25], [50, 50, 40], [50, 51, 40]], float)


def barrier(squared, limit):
    """Returns the barrier of IPC for squared distances, and its derivative by the squared distance."""
    inside = squared < limit
    ratio = np.where(inside, squared / limit, 1)
    apart = np.where(inside, squared - limit, 0)
    return -(apart**2) * np.log(ratio), -2 * apart * np.log(ratio) - apart**2 / np.where(inside, squared, 1)


def arrays_of(rows):
    """Returns pairs of name and array."""
    return [(field.name, getattr(rows, field.name)) for field in fields(rows)]


def energy_of_all_pairs(vertices, mesh, edges):
    """Returns the energy of all pairs of features, found without a search and without closest parts."""
    total = 0.0
    for kind, (_, points) in zip(("vertex_face", "edge_edge"), all_pairs(mesh, edges)):
        squared = crumple.pair_distances(kind, vertices[points]).squared_distance
        total += barrier(squared, RADIUS**2)[0].sum()
    return total


@pytest.mark.parametrize("reduced", [False, True])
def test_energy_and_gradient_match_all_pairs_and_differences(reduced, detector):
    mesh = soup(25, size=0.4, dtype=np.float64)
    near = detector.proximities(mesh, radius=RADIUS, closest=True)
    rows = crumple.stencils(mesh, near, reduced=reduced)
    assert len(near) == (rows.multiplicity.sum() if reduced else len(rows))
    count = rows.multiplicity if reduced else 1
    value, slope = barrier(rows.distance**2, RADIUS**2)
    energy = energy_of_all_pairs(mesh.vertices, mesh, near.edges)
    assert energy > 0
    np.testing.assert_allclose((count * value).sum(), energy, rtol=1e-12)

    gradient = rows.scatter((count * slope * 2 * rows.distance)[:, None] * rows.normals, len(mesh.vertices))
    move = np.random.default_rng(2).random(mesh.vertices.shape) - 0.5
    ends = [energy_of_all_pairs(mesh.vertices + h * move, mesh, near.edges) for h in (1e-6, -1e-6)]
    np.testing.assert_allclose((gradient * move).sum(), (ends[0] - ends[1]) / 2e-6, rtol=1e-6)


def test_energy_of_two_tips_is_that_of_a_formula(detector):
    """Two pyramids whose tips are 1 apart: 24 pairs, each with the barrier 0.21**2 * log(1.21) for dhat = 1.1."""
    base = np.array([[0, 0, 0], [2, 0, -1], [0, 2, -1], [-2, 0, -1], [0, -2, -1]], float)
    vertices = np.concatenate([base, base * [1, 1, -1] + [0, 0, 1]])
    faces = np.array([[tip, tip + 1 + k, tip + 1 + (k + 1) % 4] for tip in (0, 5) for k in range(4)])
    rows = crumple.stencils((vertices, faces), detector.proximities(vertices, faces, radius=1.1), reduced=True)
    assert rows.vertices.tolist() == [[0, 5, 5, 5]] and rows.multiplicity.tolist() == [24]
    value, slope = barrier(rows.distance**2, 1.1**2)
    assert (rows.multiplicity * value).sum() == pytest.approx(0.20175258861, rel=1e-9)
    force = rows.scatter(-(rows.multiplicity * slope * 2 * rows.distance)[:, None] * rows.normals, 10)
    assert force[0, 2] == pytest.approx(-5.95970644945, rel=1e-9) and force[5, 2] == -force[0, 2]
    assert np.count_nonzero(force) == 2


def test_arrays_have_the_documented_types_and_can_be_pickled(detector):
    near = detector.proximities(START, FACES, radius=0.5)
    rows = crumple.stencils((START, FACES), near)
    expected = {"vertices": ("int32", (1, 4)), "weights": ("float64", (1, 4)), "normals": ("float64", (1, 3)),
                "distance": ("float64", (1,)), "normal_from": ("uint8", (1,)), "type": ("uint8", (1,)),
                "first": ("int64", (5,)), "multiplicity": ("int32", (0,)), "row_of_pair": ("int64", (0,)),
                "first_vertex": ("int64", (2,))}  # fmt: skip
    assert {name: (array.dtype.name, array.shape) for name, array in arrays_of(rows)} == expected
    assert len(rows) == 1 and repr(rows).startswith("<crumple.Stencils: 1 rows (1 vertex_face, 0 edge_edge,")
    assert rows.vertices.tolist() == [[3, 0, 1, 2]] and rows.weights.tolist() == [[1, -0.5, -0.25, -0.25]]
    assert rows.normals.tolist() == [[0, 0, 1]] and rows.distance.tolist() == [0.25]
    assert rows.normal_from[0] == crumple.NormalFrom.APART and rows.type[0] == crumple.VertexFaceType.P_T
    assert rows.rows("vertex_face") == slice(0, 1) and rows.rows("edge_edge") == slice(1, 1)
    assert rows.vectors(START).tolist() == [[0, 0, 0.25]]
    assert rows.scatter([[0, 0, 4]], 6)[:, 2].tolist() == [-2, -1, -1, 4, 0, 0]
    for same in (pickle.loads(pickle.dumps(rows)), crumple.stencils((START, FACES), pickle.loads(pickle.dumps(near)))):
        for (_, one), (_, other) in zip(arrays_of(same), arrays_of(rows)):
            np.testing.assert_array_equal(one, other, strict=True)


def test_selected_rows_keep_their_kinds(detector):
    mesh = soup(25, size=0.4, dtype=np.float64)
    near = detector.proximities(mesh, radius=RADIUS)
    for reduced in (False, True):
        rows = crumple.stencils(mesh, near, reduced=reduced)
        mask = rows.distance < RADIUS / 2
        selected = rows.select(mask)
        assert 0 < len(selected) < len(rows)
        for kind in ("vertex_face", "edge_edge", "vertex_edge", "vertex_vertex"):
            part = rows.rows(kind)
            np.testing.assert_array_equal(selected.vertices[selected.rows(kind)], rows.vertices[part][mask[part]])
        np.testing.assert_array_equal(selected.multiplicity, rows.multiplicity[mask] if reduced else [])


def test_arrays_of_wrong_sizes_are_refused():
    """Made by hand: two rows, of which the second one has the vertex 8."""
    arrays = {"vertices": np.array([[0, 1, 2, 3], [4, 8, 8, 8]], np.int32), "weights": np.array([[1.0, -1, 0, 0]] * 2)}
    names = [field.name for field in fields(crumple.Stencils)][2:]
    zeros = {name: np.zeros((2, 3)) if name == "normals" else np.zeros(2) for name in names}
    rows = crumple.Stencils(**arrays, **zeros | {"first": np.array([0, 1, 1, 1, 2])})
    assert len(rows) == 2 and len(rows.select([False, True])) == 1
    assert rows.scatter(np.ones((2, 3)), 9)[8].tolist() == [-1, -1, -1] and rows.vectors(np.eye(9, 3)).shape == (2, 3)
    for call, message in (
        (lambda: rows.scatter(np.ones((2, 3)), 8), "vertices must be above the largest index, 8, not 8"),
        (lambda: rows.scatter(np.ones((1, 3)), 9), r"vectors must have shape \(2, 3\), not \(1, 3\)"),
        (lambda: rows.vectors(np.ones((8, 3))), "the number of rows of x must be above the largest index, 8, not 8"),
        (lambda: rows.vectors(np.ones(9)), r"x must have shape \(vertices, 3\), not \(9,\)"),
    ):
        with pytest.raises(crumple.InvalidInput, match=message):
            call()


def test_impacts_have_normals_on_the_side_before(either):
    for height in (1, -1):
        start, end = START.copy(), START.copy()
        start[3, 2], end[3, 2] = height, -height
        impacts = either.impacts(start, end, FACES)
        rows = crumple.stencils(crumple.Mesh(start, FACES).moving_to(end), impacts)
        assert rows.vertices[0].tolist() == [3, 0, 1, 2] and rows.normals[0].tolist() == [0, 0, height]
        assert rows.normal_from[0] == crumple.NormalFrom.BEFORE and rows.distance[0] == 0


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_earlier_positions_and_rest_shape_give_touching_pairs_a_normal(dtype, detector):
    flat = START.copy()
    flat[3, 2] = 0
    near = detector.proximities(flat, FACES, radius=0.5)
    unknown = crumple.stencils((flat, FACES), near)
    assert unknown.normal_from.tolist() == [crumple.NormalFrom.NONE] and not unknown.normals.any()
    for option, source in (("before", crumple.NormalFrom.BEFORE), ("rest", crumple.NormalFrom.REST)):
        rows = crumple.stencils((flat, FACES), near, **{option: START.astype(dtype)})
        assert rows.normal_from.tolist() == [source] and rows.normals.tolist() == [[0, 0, 1]]


def test_bodies_of_a_world_have_one_range_of_vertices_each(detector):
    face, other = crumple.Shape(START[:3], FACES[:1]), crumple.Shape(START[3:], FACES[:1])
    world = crumple.World([other, face])
    near = detector.proximities(world, radius=0.5)
    rows = crumple.stencils(world, near)
    assert rows.first_vertex.tolist() == [0, 3, 6] and rows.vertices.tolist() == [[0, 3, 4, 5]]
    meshes = [(START[:3], FACES[:1]), (START[3:], FACES[:1])]
    rows = crumple.stencils(meshes, detector.proximities(*meshes, radius=0.5))
    assert rows.vertices.tolist() == [[3, 0, 1, 2]]


def test_errors_name_the_argument(detector):
    near = detector.proximities(START, FACES, radius=0.5)
    mesh = START, FACES
    for message, kind, call in (
        ("found must be crumple.Proximities or crumple.Impacts, not int", TypeError, lambda: crumple.stencils(mesh, 3)),
        ("before must be", ValueError, lambda: crumple.stencils(mesh, near, before=START[:, :2])),
        ("before has 3 rows for 6 vertices", ValueError, lambda: crumple.stencils(mesh, near, before=START[:3])),
        ("does not fit the scene", ValueError, lambda: crumple.stencils((START[:3], FACES[:1]), near)),
        ("parallel must be finite", ValueError, lambda: crumple.stencils(mesh, near, parallel=-1)),
        ("kind must be one of", ValueError, lambda: crumple.stencils(mesh, near).rows("faces")),
        ("Did you mean 'reduced'", TypeError, lambda: crumple.stencils(mesh, near, reduce=True)),
    ):
        with pytest.raises(kind, match=message):
            call()
    found = detector.proximities(START, FACES, radius=0.5, output="any")
    with pytest.raises(crumple.InvalidInput, match="the list that stencils read was not requested"):
        crumple.stencils(mesh, found)
    impacts = detector.impacts(START, START - [0, 0, 1], FACES)
    with pytest.raises(
        crumple.InvalidInput,
        match=r"positions at the end of the step: pass the scene of the query, such as Mesh\(start, faces\)",
    ):
        crumple.stencils(mesh, impacts)
    (part,) = detector.partition(crumple.Mesh(*mesh), crumple.ProximityQuery(radius=0.5), count=1)
    with pytest.raises(crumple.InvalidInput, match="the scene of this result is a part"):
        crumple.stencils(mesh, detector.find(part, crumple.ProximityQuery(radius=0.5)))
