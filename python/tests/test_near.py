"""Tests of proximities, pairs of features that are near, against brute force: meshes, worlds, outputs and options."""

import inspect
import pickle
import re

import numpy as np
import pytest

import crumple
from conftest import OnDevice, soup
from features import BODIES, CLOSEST, FACES, LEAST, LISTS, START, assert_same, check_index
from worlds import random_poses


def test_near_pairs_have_exact_squared_distances(either):
    """The lowest vertex of the upper triangle is at a height of 1 above the inside of the other triangle."""
    found = either.proximities(START, FACES, radius=1)
    assert found.vertex_faces.tolist() == [[3, 0]] and found.vertex_face_squared_distance.tolist() == [1]
    assert found.vertex_face_touching.tolist() == [False] and found.edge_edges.shape == (0, 2)
    assert found.edges.tolist() == [[0, 1], [0, 2], [1, 2], [3, 4], [3, 5], [4, 5]]
    assert found.any and found and len(found) == found.count == 1 and found.world_hit.tolist() == [True]
    assert "1 pair, 1 of vertex and face, 0 of edge and edge" in repr(found)
    every = either.proximities(START, FACES, radius=2)
    assert every.vertex_faces.tolist() == [[0, 1], [3, 0], [4, 0], [5, 0]]
    assert every.vertex_face_squared_distance.tolist() == [3, 1, 4, 4]
    assert every.edges[every.edge_edges[:2]].tolist() == [[[0, 1], [3, 4]], [[0, 1], [3, 5]]]
    assert every.edge_edge_squared_distance.tolist() == [2, 2, 2, 2, 3, 3]
    assert found.vertex_face_squared_distance.dtype == np.float64 and found.vertex_faces.dtype == np.int32


def test_strict_excludes_pairs_at_the_radius(either):
    assert not either.proximities(START, FACES, radius=1, strict=True)
    assert either.proximities(START, FACES, radius=np.nextafter(1, 2), strict=True)
    assert not either.proximities(START, FACES, radius=np.nextafter(1, 0))


def test_squared_distance_that_underflows_to_zero_is_not_touching(either):
    vertices = START.copy()
    vertices[3, 2] = 0
    found = either.proximities(vertices, FACES, radius=0)
    assert found.vertex_face_touching.tolist() == [True] and found.vertex_face_squared_distance.tolist() == [0]
    vertices[3, 2] = 1e-200
    found = either.proximities(vertices, FACES, radius=1e-200)
    assert found.vertex_face_touching.tolist() == [False] and found.vertex_face_squared_distance.tolist() == [0]
    found = either.proximities(START * 1e200, FACES, radius=1e200)
    assert found.vertex_face_squared_distance.tolist() == [np.inf]


def test_closest_points_have_the_reported_distance(either):
    found = either.proximities(START, FACES, radius=2, closest=True)
    kinds = [crumple.VertexFaceType(kind).name for kind in found.vertex_face_type]
    assert found.vertex_faces[:2].tolist() == [[0, 1], [3, 0]] and kinds[:2] == ["P_T0", "P_T"]
    assert found.vertex_face_at.tolist()[:2] == [[0, 0], [0.25, 0.25]], "a corner, and (1, 1) of a face of 4 by 4"
    edges = {tuple(edge): i for i, edge in enumerate(found.edges[found.edge_edges].reshape(-1, 4).tolist())}
    row = edges[0, 1, 3, 4]  # the edges from (0, 0, 0) to (4, 0, 0), and from (1, 1, 1) to (2, 1, 2)
    assert crumple.EdgeEdgeType(found.edge_edge_type[row]).name == "EA_EB0"
    assert found.edge_edge_at[row].tolist() == [0.25, 0] and found.edge_edge_type.dtype == np.uint8
    for pairs, vertex in ((found.vertex_faces, True), (found.edge_edges, False)):
        at = found.vertex_face_at if vertex else found.edge_edge_at
        squares = found.vertex_face_squared_distance if vertex else found.edge_edge_squared_distance
        for (a, b), (u, v), square in zip(pairs, at, squares):
            if vertex:
                x, y, z = START[FACES[b]]
                gap = START[a] - (x + u * (y - x) + v * (z - x))
            else:
                (p, q), (r, s) = START[found.edges[a]], START[found.edges[b]]
                gap = p + u * (q - p) - (r + v * (s - r))
            assert np.isclose(gap @ gap, square, rtol=1e-12)


def test_least_distance_of_each_feature_is_rounded_down(either):
    found = either.proximities(START, FACES, radius=1.5, least=True)
    assert found.vertex_distance.tolist() == [np.inf, np.inf, np.inf, 1, np.inf, np.inf]
    assert found.face_distance.tolist() == [1, np.inf]
    root = np.sqrt(2)
    down = root if int(root * 2**52) ** 2 <= 2 * 4**52 else np.nextafter(root, 0)
    assert len(found.edges) == 6 and set(found.edge_distance.tolist()) <= {down, np.inf}
    assert np.flatnonzero(np.isfinite(found.edge_distance)).tolist() == np.unique(found.edge_edges).tolist()
    corner = np.concatenate([START[:3], [[-1, -1, 0], [-9, -1, 0], [-9, -9, 9]]])  # vertex 3 is near the corner 0 0 0
    found = either.proximities(corner, FACES, radius=1.5, least=True)
    assert found.vertex_distance[3] == found.face_distance[0] == down


def test_module_function_finds_near_pairs_without_a_detector():
    assert crumple.proximities(START, FACES, radius=1).vertex_faces.tolist() == [[3, 0]]
    assert crumple.proximities((START, FACES), radius=1, output="any")
    assert crumple.proximities(
        crumple.World([(START, FACES)], self_collisions=True), radius=1
    ).vertex_face_bodies.tolist() == [[0, 0]]


QUESTIONS = [
    {},
    {"weld": True},
    {"strict": True},
    {"groups": True, "filter": crumple.PairFilter(groups="between")},
    {"groups": True, "filter": crumple.PairFilter(groups="within")},
    {"groups": True, "filter": crumple.PairFilter(excluded_groups=[(0, 1), (2, 2)])},
]


@pytest.mark.parametrize("question", QUESTIONS, ids=str)
@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_near_pairs_match_brute_force(dtype, question, detector, reference):
    for seed, radius in enumerate((0.2, 0.3, 1)):
        vertices, faces, _ = soup(14, size=0.5, seed=seed, dtype=dtype)
        asked = {**question, "radius": radius, "closest": True, "least": True}
        if "groups" in question:
            asked["groups"] = np.arange(len(faces)) % 3
        expected = reference.proximities(vertices, faces, **asked)
        assert expected, "something must be near"
        assert_same(detector.proximities(vertices, faces, **asked), expected, CLOSEST + LEAST)


def test_smaller_outputs_agree_with_all_near_pairs(either):
    mesh = soup(10, size=0.5)
    for radius in (0.2, 1e-9):
        every = either.proximities(mesh, radius=radius)
        by_world = either.proximities(mesh, radius=radius, output="any_by_world")
        assert every.any is by_world.any is either.proximities(mesh, radius=radius, output="any").any is (radius > 0.1)
        assert by_world.world_hit.tolist() == [every.any] and len(by_world) == 0
        assert ("something is near" if every else "nothing is near") in repr(by_world)


def test_index_lists_the_near_pairs_of_each_feature(either):
    mesh = soup(10, size=0.5)
    check_index(either.proximities(mesh, radius=0.2, index=True), len(mesh.vertices), len(mesh.faces))


def test_least_distances_respect_group_filters(either):
    mesh, groups = soup(10, size=0.5), np.arange(10) % 2
    found = either.proximities(mesh, groups=groups, radius=0.5, least=True, filter=crumple.PairFilter(groups="between"))
    assert found and (groups[found.vertex_faces[:, 0] // 3] != groups[found.vertex_faces[:, 1]]).all()
    first, second = groups[found.edges[found.edge_edges][:, :, 0] // 3].T
    assert (first != second).all()
    for distances, features, squares in (
        (found.vertex_distance, found.vertex_faces[:, :1], found.vertex_face_squared_distance),
        (found.face_distance, found.vertex_faces[:, 1:], found.vertex_face_squared_distance),
        (found.edge_distance, found.edge_edges, found.edge_edge_squared_distance),
    ):
        least = np.full(len(distances), np.inf)
        np.minimum.at(least, features, squares[:, None])
        np.testing.assert_allclose(distances**2, least)


@pytest.mark.parametrize(
    "mesh, named, message",
    [
        ((START, FACES), {"radius": -1}, "radius must be finite and 0 or more"),
        ((START, FACES), {"radius": np.nan}, "radius must be finite and 0 or more"),
        ((START, FACES), {"radius": "1"}, "radius must be a number, not str"),
        ((START, FACES), {"radius": None}, "a ProximityQuery needs a radius, or radii of the vertices"),
        ((START, FACES), {"radii": np.ones(6)}, "radius cannot be given together with radii"),
        ((START, FACES), {"radius": None, "radii": np.ones(5)}, "radii must be one for each of the 6 vertices, not 5"),
        ((START, FACES), {"radius": None, "radii": []}, "radii must be one for each of the 6 vertices, not 0"),
        ((START, FACES), {"radius": None, "radii": 1.0}, r"radii must have shape \(vertices,\), not \(\)"),
        ((START, FACES), {"radius": None, "radii": np.ones((6, 1))}, r"radii must have shape \(vertices,\)"),
        ((START, FACES), {"radius": None, "radii": np.ones(6, int)}, "radii must be float64 or float32, not int64"),
        ((START, FACES), {"radius": None, "radii": [0, 1, 2, -1, 0, 0]}, "radius of vertex 3 must be finite and 0 or"),
        ((START, FACES), {"radius": None, "radii": OnDevice(np.ones(6))}, "radii lie in the memory of CUDA"),
        ((START, FACES), {"rings": -1}, "rings must be 0 or more"),
        ((START, FACES), {"rings": 1.5}, "rings must be an integer"),
        ((START, FACES), {"rest": START[:5]}, "rest vertices must be as many as those of the mesh, 6, not 5"),
        ((START, FACES), {"rest": START * np.nan}, "rest shape: vertex 0 is not finite"),
        ((START, FACES), {"rest_radius": 1}, "rest_radius needs a rest shape"),
        ((START, FACES), {"rest": START, "rest_radius": -1}, "rest_radius must be finite and 0 or more"),
        ((START, FACES), {"strict": 1}, "strict must be True or False, not int"),
        ((START, FACES), {"closest": 1}, "closest must be True or False, not int"),
        ((START, FACES), {"least": None}, "least must be True or False, not None"),
        ((START, FACES), {"output": "first"}, 'output must be one of "any", "any_by_world", "pairs", not "first"'),
        (
            (START, FACES),
            {"filter": crumple.PairFilter(groups="no")},
            'groups must be one of "both", "between", "within", not "no"',
        ),
        ((START, FACES + 1), {}, "triangle 1 names vertex 6 of 6"),
        ((np.full_like(START, np.inf), FACES), {}, "vertex 0 is not finite"),
        (
            (OnDevice(START), OnDevice(FACES)),
            {},
            "the arrays lie in CUDA memory, which needs the cuda backend",
        ),
    ],
)
def test_wrong_arguments_are_refused(mesh, named, message, detector):
    with pytest.raises(crumple.InvalidInput, match=message):
        detector.proximities(*mesh, **{"radius": 1, **named})
    assert detector.proximities(START, FACES, radius=1), "the detector stays usable"


def test_method_has_name_signature_and_documentation(detector):
    for method in (crumple.Detector.proximities, detector.proximities):
        assert method.__name__ == "proximities" and method.__qualname__ == "Detector.proximities"
        assert inspect.isroutine(method) and len(inspect.getdoc(method)) > 100
    assert list(inspect.signature(detector.proximities).parameters)[:3] == ["vertices", "faces", "groups"]
    for scene in ((START, FACES), (crumple.World([(START, FACES)], self_collisions=True),)):
        with pytest.raises(TypeError, match="a ProximityQuery needs a radius, or radii of the vertices"):
            detector.proximities(*scene)
        with pytest.raises(TypeError, match=r"proximities.*'stric'\. Did you mean 'strict'\?$"):
            detector.proximities(*scene, radius=1, stric=True)


def test_error_explains_how_to_request_a_missing_array(detector):
    nothing = detector.proximities(START, FACES, radius=1, output="any")
    for name in (*LISTS["Proximities"], "count", "edges", "first_edge", "by_second_edge"):
        with pytest.raises(
            crumple.InvalidInput, match=re.escape(f'{name} was not requested: ProximityQuery(output="p')
        ):
            getattr(nothing, name)
    with pytest.raises(crumple.InvalidInput, match=r'world_hit was .* ProximityQuery\(output="any_by_world"\)'):
        _ = nothing.world_hit
    every = detector.proximities(START, FACES, radius=1)
    with pytest.raises(crumple.InvalidInput, match=r"face_offsets was not requested: ProximityQuery\(index=True\)"):
        _ = every.face_offsets
    with pytest.raises(crumple.InvalidInput, match="edge_edge_bodies are for worlds"):
        _ = every.edge_edge_bodies
    for option, names in (("closest", CLOSEST), ("least", LEAST)):
        for name in names:
            with pytest.raises(
                crumple.InvalidInput, match=rf"{name} was not requested: ProximityQuery\({option}=True\)"
            ):
                getattr(every, name)
    of_world = detector.proximities(crumple.World([(START, FACES)], self_collisions=True), radius=1)
    with pytest.raises(crumple.InvalidInput, match="vertex_distance is for one mesh"):
        _ = of_world.vertex_distance


# Worlds.


def random_world(seed, bodies=6, worlds=2):
    random = np.random.default_rng(seed)
    shapes = [soup(6, size=0.5, seed=seed, dtype=np.float64), soup(5, size=0.5, seed=seed + 1, dtype=np.float64)]
    of = np.sort(random.integers(0, worlds, bodies))
    of[-1] = -1
    return crumple.World(
        shapes, random.integers(0, 2, bodies), poses=random_poses(random, bodies, 1), worlds=of, self_collisions=True
    )


@pytest.mark.parametrize(
    "question",
    [
        {},
        {"filter": crumple.PairFilter(bodies="between")},
        {"filter": crumple.PairFilter(bodies="within")},
        {"filter": crumple.PairFilter(excluded_bodies=[(0, 1), {2}])},
        {"strict": True},
    ],
    ids=str,
)
def test_near_pairs_of_worlds_match_brute_force(question, detector, reference):
    for seed in range(3):
        world, asked = random_world(seed), {"radius": 0.1 * (seed + 1), "closest": True, **question}
        expected = reference.proximities(world, **asked)
        assert expected, "something must be near"
        assert_same(detector.proximities(world, **asked), expected, BODIES + CLOSEST)
        hit = detector.proximities(world, output="any_by_world", **asked).world_hit
        assert hit.tolist() == expected.world_hit.tolist()


def test_near_pairs_ignore_end_vertices_and_end_poses(either):
    far = START.copy()
    far[3:, 2] += 9
    still = crumple.World([(START, FACES)], self_collisions=True)
    expected = either.proximities(still, radius=1)
    assert expected.vertex_face_bodies.tolist() == [[0, 0]]
    for world in (
        crumple.World([crumple.Shape(START, FACES, end=far)], self_collisions=True),
        crumple.World([(START, FACES)], self_collisions=True),
    ):
        world.end_poses = 2 * np.eye(3, 4)[None]
        assert_same(either.proximities(world, radius=1), expected)


def test_near_pairs_follow_poses_and_excluded_bodies(either):
    shape = crumple.Mesh(START[:3], FACES[:1])
    poses = np.tile(np.eye(3, 4), (2, 1, 1))
    poses[1, 2, 3] = 3
    world = crumple.World([shape], [0, 0], poses=poses, names=["low", "high"], self_collisions=True)
    assert not either.proximities(world, radius=2.5) and either.proximities(world, radius=3)
    assert not either.proximities(world, radius=3, filter=crumple.PairFilter(excluded_bodies=[{"low", "high"}]))
    poses[1, 2, 3] = 1
    nearer = either.proximities(world, radius=1)
    assert nearer.vertex_face_bodies.tolist() == [[0, 1]] * 3 + [[1, 0]] * 3
    assert nearer.vertex_face_squared_distance.tolist() == [1] * 6
    np.testing.assert_array_equal(either.proximities(world.at(poses.copy()), radius=1).edge_edges, nearer.edge_edges)


def test_radii_of_both_features_add_up(either):
    radii = np.array([0.75, 0, 0, 0.25, 0, 0])
    assert either.proximities(START, FACES, radii=radii).vertex_faces.tolist() == [[3, 0]]
    assert not either.proximities(START, FACES, radii=radii, strict=True)
    radii[3] = np.nextafter(0.25, 0)
    assert not either.proximities(START, FACES, radii=radii)
    for given in (list(radii + 1), (radii + 1).astype(">f8"), np.repeat(radii + 1, 2)[::2], (radii + 1).tolist()):
        assert_same(either.proximities(START, FACES, radii=given), either.proximities(START, FACES, radii=radii + 1))
    half = np.full(len(START), 1, np.float32)
    assert_same(either.proximities(START, FACES, radii=half), either.proximities(START, FACES, radius=2))
    assert not either.proximities([], [], radii=[])


def test_rings_and_rest_shape_exclude_pairs(either):
    mesh = soup(20, size=0.5, seed=3, dtype=np.float64)
    for question in ({"radius": 0.3}, {"radii": np.random.default_rng(1).random(len(mesh.vertices)) * 0.2}):
        every = either.proximities(mesh, **question)
        assert_same(either.proximities(mesh, rings=3, **question), every)  # no shared vertices
        assert not either.proximities(mesh, rest=mesh.vertices, rest_radius=1, **question)
        rest = mesh.vertices.astype(np.float32) * 2
        some = either.proximities(mesh, rest=rest, rest_radius=0.3, **question)
        assert 0 < len(some) < len(every)
        assert either.proximities(mesh, rest=rest, rest_radius=0.3, output="any", **question)
    square = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]], float), [[0, 1, 2], [2, 1, 3]]
    assert either.proximities(*square, radius=1).vertex_faces.tolist() == [[0, 1], [3, 0]]
    assert not either.proximities(*square, radius=1, rings=1)


def test_radii_rings_and_rest_shape_match_brute_force(detector, reference):
    random = np.random.default_rng(5)
    mesh = soup(14, size=0.6, seed=6, dtype=np.float64)
    mesh.faces[3:9] = mesh.faces[2:8] // 2  # these triangles have vertices in common
    for rings in range(4):
        asked = {
            "radii": random.random(len(mesh.vertices)) * 0.3,
            "rings": rings,
            "rest": mesh.vertices + random.normal(size=mesh.vertices.shape) * 0.3,
            "rest_radius": 0.1,
            "least": True,
            "closest": True,
        }
        expected = reference.proximities(mesh, **asked)
        assert expected, "something must be near"
        assert_same(detector.proximities(mesh, **asked), expected, CLOSEST + LEAST)


def test_radii_and_rest_shape_of_world_shapes_decide_the_near_pairs(either):
    radii = np.full(6, 0.5)
    shape = crumple.Shape(START, FACES, radii=radii, rest=START)
    assert shape.radii is radii and shape.rest is START
    for kept in (shape, pickle.loads(pickle.dumps(shape))):
        world = crumple.World([kept], self_collisions=True)
        assert either.proximities(world).vertex_faces.tolist() == [[3, 0]]
        assert not either.proximities(world, rest_radius=1)
        with pytest.raises(crumple.InvalidInput, match="radius cannot be given together with radii"):
            either.proximities(world, radius=1)
    with pytest.raises(crumple.InvalidInput, match="^shape 1: the radius of vertex 2 must be finite and 0 or more$"):
        either.proximities(
            crumple.World([shape, crumple.Shape(START, FACES, radii=[0, 0, -1, 0, 0, 0])], self_collisions=True)
        )
    with pytest.raises(crumple.InvalidInput, match="radii must be one for each of the 6 vertices, not 2"):
        crumple.Shape(START, FACES, radii=[1.0, 2.0])
    with pytest.raises(crumple.InvalidInput, match="radii and rest are for the vertices of one mesh"):
        either.proximities(world, radii=radii)
