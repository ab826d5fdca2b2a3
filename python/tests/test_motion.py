"""Tests of impacts during a step, against brute force: meshes, worlds, outputs and options."""

import inspect
import pickle
import re

import numpy as np
import pytest

import crumple
from conftest import OnDevice, soup, toi_of
from features import BODIES, END, FACES, LISTS, START, TRIANGLES, assert_same, check_index, falling_world, moving
from worlds import random_poses


def step_of(start, end, faces):
    return crumple.Mesh(start, faces).moving_to(end)


def firsts_of(impacts):
    """Returns the first impact in the lists, as (toi, kind, pair, start)."""
    return min(
        (toi, kind, tuple(pair), bool(start))
        for kind, name in enumerate(("vertex_face", "edge_edge"))
        for pair, toi, start in zip(
            getattr(impacts, f"{name}s").tolist(),
            getattr(impacts, f"{name}_toi").tolist(),
            getattr(impacts, f"{name}_start").tolist(),
        )
    )


def test_vertex_hits_face_at_the_exact_time(either):
    found = either.impacts(START, END, FACES)
    assert found.vertex_faces.tolist() == [[3, 0]] and found.vertex_face_toi.tolist() == [0.5]
    assert found.vertex_face_start.tolist() == [False] and found.edge_edges.tolist() == []
    assert found.edges.tolist() == [[0, 1], [0, 2], [1, 2], [3, 4], [3, 5], [4, 5]]
    assert found.first_edge.tolist() == [0, 6] and found.any and found and len(found) == found.count == 1
    assert found.statistics.backend == either.backend and found.statistics.pairs == 1
    assert "1 impact, 1 of vertex and face, 0 of edge and edge" in repr(found)


@pytest.mark.parametrize("speed, toi", [(3, 1 / 3), (10, np.nextafter(0.1, 0)), (2, 0.5)])
def test_time_of_edge_edge_impact_is_rounded_down(speed, toi, either):
    """The float64 nearest to 1/3 is less than 1/3. The one nearest to 1/10 is more than 1/10, and must not occur."""
    start = np.array([[-1, 0, 0], [1, 0, 0], [0, 0, -99], [0, -1, 1], [0, 1, 1], [0, 0, 99]], np.float64)
    end = start.copy()
    end[3:, 2] -= speed
    found = either.impacts(start, end, FACES)
    assert found.edges[found.edge_edges].tolist() == [[[0, 1], [3, 4]]]
    assert found.edge_edge_toi.tolist() == [toi] and found.edge_edge_start.tolist() == [False]
    assert found.edge_edges.dtype == np.int32 and found.edges.dtype == np.int32
    assert found.edge_edge_toi.dtype == np.float64 and found.edge_edge_start.dtype == np.bool_


def test_contact_at_the_start_is_flagged(either):
    start = START.copy()
    start[3, 2] = 0
    found = either.impacts(start, END, FACES)
    assert found.vertex_face_start.tolist() == [True] and found.vertex_face_toi.tolist() == [0]
    assert either.impacts(start, END, FACES, output="first").first.start is True


def test_first_impact_is_none_only_if_the_step_is_free(either):
    first = either.impacts(START, END, FACES, output="first").first
    assert first == ("vertex_face", (3, 0), None, 0.5, False) and isinstance(first, crumple.FirstImpact)
    assert toi_of(either.first_impact(START, END, FACES)) == 0.5
    assert (not either.any(crumple.Mesh(START, FACES).moving_to(END), crumple.ImpactQuery())) is False
    above = END.copy()
    above[3, 2] = 0.5  # the vertex falls, but does not reach the face
    for end in (START, above):
        nothing = either.impacts(START, end, FACES, output="first")
        assert nothing.first is None and not nothing and len(nothing) == 0 and nothing.world_first == [None]
        assert toi_of(either.first_impact(START, end, FACES)) is None
        assert either.any(crumple.Mesh(START, FACES).moving_to(end), crumple.ImpactQuery()) is False


def test_functions_of_the_module_need_no_detector():
    assert toi_of(crumple.first_impact(START, END, FACES)) == 0.5
    assert crumple.impacts(end=END, start=START, faces=FACES).vertex_faces.tolist() == [[3, 0]]
    assert crumple.impacts(START, END, FACES, output="any")
    assert crumple.free_step(START, END, FACES).share < 0.5


@pytest.mark.parametrize(
    "min_distance, toi",
    [({"min_distance": 0.5}, 0.25), ({"min_distance_share": 0.25}, 0.375), ({"min_distance": 3.0}, 0.0)],
    ids=str,
)
def test_minimum_distance_makes_impacts_earlier(min_distance, toi, either):
    """The vertex falls from a height of 1 above the face to -1, through the inside of the face."""
    found = either.impacts(START, END, FACES, output="first", **min_distance)
    assert found.first.toi == toi and found.first.start is (toi == 0)
    assert toi_of(either.first_impact(START, END, FACES, **min_distance)) == toi
    end = END.copy()
    end[3:] = START[3:]
    end[3:, 2] -= 0.75
    assert (not either.any(crumple.Mesh(START, FACES).moving_to(end), crumple.ImpactQuery())) and (
        not either.any(crumple.Mesh(START, FACES).moving_to(end), crumple.ImpactQuery(min_distance_share=0.125))
    )
    assert either.any(crumple.Mesh(START, FACES).moving_to(end), crumple.ImpactQuery(min_distance=0.25)), (
        "at most: equal counts"
    )


def test_weld_joins_vertices_equal_at_start_and_end(either):
    """Two triangles of a hinge have separate vertices at the same positions, at the start and at the end."""
    start = np.array([[0, 0, 0], [0, 1, 0], [1, 0, 0], [0, 0, 0], [0, 1, 0], [-1, 0, 0]], np.float64)
    end = start + np.array([0, 0, 1.0])
    assert len(either.impacts(start, end, FACES)) and (
        not either.any(crumple.Mesh(start, FACES).moving_to(end), crumple.ImpactQuery(weld=True))
    )
    end[3] += 1
    assert either.any(crumple.Mesh(start, FACES).moving_to(end), crumple.ImpactQuery(weld=True)), (
        "vertices that part are two"
    )


QUESTIONS = [
    {},
    {"weld": True},
    {"min_distance": 0.05},
    {"min_distance_share": 0.5},
    {"groups": True, "filter": crumple.PairFilter(groups="between")},
    {"groups": True, "min_distance": 0.01, "filter": crumple.PairFilter(groups="within")},
    {"groups": True, "filter": crumple.PairFilter(excluded_groups=[(0, 1), (2, 2)])},
]


@pytest.mark.parametrize("question", QUESTIONS, ids=str)
@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_impacts_match_brute_force(dtype, question, detector, reference):
    for seed in range(3):
        vertices, end, faces = moving(seed, dtype=dtype)
        asked = {**question, "groups": np.arange(len(faces)) % 3} if "groups" in question else question
        expected = reference.impacts(vertices, end, faces, **asked)
        assert len(expected) > 2, "something must touch"
        assert_same(detector.impacts(vertices, end, faces, **asked), expected)


def test_smaller_outputs_agree_with_all_impacts(either):
    for seed in range(4):
        scene = moving(seed)
        every = either.impacts(*scene)
        earliest = either.impacts(*scene, output="first")
        toi, kind, pair, start = firsts_of(every)
        assert earliest.first == (("vertex_face", "edge_edge")[kind], pair, None, toi, start)
        assert earliest.world_first == [earliest.first] and f"first at {toi:.6g}" in repr(earliest)
        np.testing.assert_array_equal(earliest.edges, every.edges)
        assert either.impacts(*scene, output="any").any is either.impacts(*scene, output="any_by_world").any
        assert toi_of(either.first_impact(*scene)) == toi and either.any(step_of(*scene), crumple.ImpactQuery())
        assert either.impacts(*scene, output="any_by_world").world_hit.tolist() == [True]


def test_output_of_pairs_has_the_first_impact_too(either):
    scene = moving(1)
    every, earliest = either.impacts(*scene), either.impacts(*scene, output="first")
    assert every.first == earliest.first is not None and every.world_first == earliest.world_first


def test_index_lists_the_impacts_of_each_feature(either):
    vertices, end, faces = moving(2)
    check_index(either.impacts(vertices, end, faces, index=True), len(vertices), len(faces))


def test_index_with_groups_lists_the_impacts_of_each_feature(either):
    vertices, end, faces = moving(2)
    groups = np.arange(len(faces)) % 2
    found = either.impacts(vertices, end, faces, groups=groups, index=True, filter=crumple.PairFilter(groups="between"))
    check_index(found, len(vertices), len(faces))


@pytest.mark.parametrize(
    "given",
    [
        np.asfortranarray,
        lambda a: a[::-1].copy()[::-1],
        lambda a: np.repeat(a, 2, axis=0)[::2],
        lambda a: a.astype(">f8"),
        lambda a: a.tolist(),
        lambda a: np.ma.masked_array(a),
        lambda a: OnDevice(a, kind=1),
    ],
    ids=["fortran", "reversed", "strided", "big endian", "lists", "no mask", "dlpack"],
)
def test_layout_of_end_vertices_does_not_change_impacts(given, detector):
    expected = detector.impacts(START, END, FACES)
    assert_same(detector.impacts(START, given(END), FACES), expected)
    assert_same(detector.impacts(given(START), given(END), FACES), expected)


def test_mesh_tuples_flat_faces_and_mixed_precision_are_accepted(detector):
    expected = detector.impacts(START, END, FACES)
    for mesh in ((START, FACES), crumple.Mesh(START, FACES), crumple.Mesh(START, FACES.ravel(), [0, 1])):
        assert_same(detector.impacts(mesh, END), expected)
    single = detector.impacts(START.astype(np.float32), END.astype(np.float32), FACES)
    assert single.vertex_face_toi.tolist() == [0.5]
    for start, end in ((START, END.astype(np.float32)), (START.astype(np.float32), END)):
        assert_same(detector.impacts(start, end, FACES), expected)
    nothing = detector.impacts([], [], [])
    assert not nothing and nothing.edges.shape == (0, 2) and nothing.vertex_faces.shape == (0, 2)


@pytest.mark.parametrize(
    "arguments, named, message",
    [
        ((START, END[:5], FACES), {}, "^end vertices must be as many as those at the start, 6, not 5$"),
        ((START, None, FACES), {}, "the vertices at the end are missing; a query about motion needs them"),
        ((START, END[:, :2], FACES), {}, r"end vertices must have shape \(n, 3\), not \(6, 2\)"),
        ((START, END.astype(int), FACES), {}, "end vertices must be float32 or float64, not int64"),
        ((START, OnDevice(END), FACES), {}, "end vertices lie in the memory of CUDA device 0, but"),
        (
            (OnDevice(START), OnDevice(END), OnDevice(FACES)),
            {},
            "the arrays lie in CUDA memory, which needs the cuda backend",
        ),
        ((START, OnDevice(END, kind=10), FACES), {}, "end vertices lie in ROCm memory"),
        ((START, np.ma.masked_array(END, mask=END > 3), FACES), {}, r"end vertices are masked at \(1, 0\)"),
        ((START, np.full_like(END, np.inf), FACES), {}, "at the end: vertex 0 is not finite"),
        ((np.full_like(END, np.nan), END, FACES), {}, "vertex 0 is not finite"),
        ((START, END, FACES + 3), {}, "triangle 1 names vertex 6 of 6"),
        ((START, END, FACES), {"min_distance": -1}, "min_distance must be finite and 0 or more"),
        ((START, END, FACES), {"min_distance": np.inf}, "min_distance must be finite and 0 or more"),
        ((START, END, FACES), {"min_distance": "1"}, "min_distance must be a number, not str"),
        ((START, END, FACES), {"min_distance_share": 1}, "min_distance_share must be 0 or more, and below 1"),
        ((START, END, FACES), {"weld": 1}, "weld must be True or False, not int"),
        ((START, END, FACES), {"index": None}, "index must be True or False, not None"),
        (
            (START, END, FACES),
            {"filter": crumple.PairFilter(groups="all")},
            'groups must be one of "both", "between", "within", not "all"',
        ),
        ((START, END, FACES), {"output": "all"}, 'output must be one of "any", "any_by_world", "first", "pairs"'),
        ((START, END, FACES), {"groups": [0]}, "groups must be one for each of the 2 faces, not 1"),
        (
            (START, END, FACES),
            {"filter": crumple.PairFilter(excluded_groups=[1])},
            r"excluded_groups must have shape \(n, 2\)",
        ),
        ((START, END, FACES), {"copy": "yes"}, "copy must be True or False, not str"),
    ],
)
def test_wrong_arguments_are_refused(arguments, named, message, detector):
    with pytest.raises(crumple.InvalidInput, match=message):
        detector.impacts(*arguments, **named)
    assert detector.impacts(START, END, FACES), "the detector stays usable"


@pytest.mark.parametrize("name", ["impacts", "first_impact", "free_step"])
def test_methods_have_names_signatures_and_documentation(name, detector):
    for method in (getattr(crumple.Detector, name), getattr(detector, name)):
        assert method.__name__ == name and method.__qualname__ == f"Detector.{name}"
        assert inspect.isroutine(method) and len(inspect.getdoc(method)) > 100
    parameters = inspect.signature(getattr(detector, name)).parameters
    assert list(parameters)[:3] == ["start", "end", "faces"] and parameters["min_distance"].default == 0
    defaults = {name: p.default for name, p in parameters.items() if p.default is not inspect.Parameter.empty}
    assert defaults.pop("faces") is None and defaults.pop("end") is None and len(defaults) > 4
    mesh, world = (
        crumple.Mesh(START, FACES),
        crumple.World([crumple.Shape(START, FACES, end=END)], self_collisions=True),
    )
    found, plain = (getattr(detector, name)(mesh, END, **given) for given in (defaults, {}))
    assert repr(found).split(", ")[:-1] == repr(plain).split(", ")[:-1]
    for scene in ((mesh, END), (world,)):
        with pytest.raises(TypeError, match=r"'min_distanc'\. Did you mean 'min_distance'\?$") as caught:
            getattr(detector, name)(*scene, min_distanc=1)
        assert not isinstance(caught.value, crumple.Error)


def test_error_explains_how_to_request_a_missing_array(detector):
    nothing = detector.impacts(START, END, FACES, output="any")
    for name, output in (
        [("world_hit", "any_by_world")]
        + [(name, "first") for name in ("first", "world_first", "edges", "first_edge")]
        + [(name, "pairs") for name in (*LISTS["Impacts"], "count", "vertex_offsets")]
    ):
        message = f'^{name} was not requested: ImpactQuery(output="{output}")'
        with pytest.raises(crumple.InvalidInput, match=re.escape(message).replace("\\^", "^")):
            getattr(nothing, name)
    assert len(nothing) == 0 and nothing
    every = detector.impacts(START, END, FACES)
    with pytest.raises(crumple.InvalidInput, match=r"by_face was not requested: ImpactQuery\(index=True\)"):
        _ = every.by_face
    with pytest.raises(crumple.InvalidInput, match="vertex_face_bodies are for worlds"):
        _ = every.vertex_face_bodies


def test_triangle_pairs_include_those_stuck_from_the_start(either, tmp_path):
    """One blade is stuck in a plate and moves sideways; another one comes down on the plate."""
    start = np.array([[-9, -9, 0], [9, -9, 0], [0, 9, 0], [0, 0, -1], [0.5, 0, 1], [-0.5, 0.2, 1]])
    start = np.vstack([start, np.array([1, 0, 2]) + start[3:]])
    end = start.copy()
    end[3:6, 0] += 0.25
    end[6:, 2] -= 2
    faces = np.arange(9).reshape(3, 3)
    assert not either.any(crumple.Mesh(start[:6], faces[:2]).moving_to(end[:6]), crumple.ImpactQuery())
    assert not (
        not either.any(crumple.Mesh(start[:6], faces[:2]).moving_to(end[:6]), crumple.ImpactQuery(triangle_pairs=True))
    )
    assert either.free_step(start[:6], end[:6], faces[:2]).share == 1
    assert either.free_step(start[:6], end[:6], faces[:2], triangle_pairs=True).share == 0
    found = either.impacts(start, end, faces, triangle_pairs=True, index=True)
    assert found.triangle_pairs.tolist() == [[0, 1], [0, 2]]
    assert found.triangle_pair_toi.tolist() == [0, 0.5]
    assert found.triangle_pair_start.tolist() == [True, False]
    assert found.triangle_offsets.tolist() == [0, 2, 2, 2]
    assert found.second_triangle_offsets.tolist() == [0, 0, 1, 2] and found.by_second_triangle.tolist() == [0, 1]
    assert found.count == 1 and found.vertex_faces.tolist() == [[6, 0]]
    assert_same(pickle.loads(pickle.dumps(found)), found, more=TRIANGLES[:3])
    for answer in (found, pickle.loads(pickle.dumps(found))):
        answer.save(tmp_path / "a.txt")
        assert (tmp_path / "a.txt").read_text() == "vf 6 0 0.5 0\nff 0 1 0 1\nff 0 2 0.5 0\n"
    stuck = either.impacts(start[:6], end[:6], faces[:2], triangle_pairs=True)
    assert stuck.any and stuck.first is None and len(stuck) == 0
    assert pickle.loads(pickle.dumps(stuck)).triangle_pairs.tolist() == [[0, 1]]
    plain = either.impacts(start, end, faces)
    for answer, hint in ((plain, "triangle_pairs=True"), (found, "index=True")):
        name = "triangle_pairs" if answer is plain else "triangle_offsets"
        if answer is found:
            answer = either.impacts(start, end, faces, triangle_pairs=True)
        with pytest.raises(crumple.InvalidInput, match=rf"^{name} was not requested: ImpactQuery\({hint}\)"):
            getattr(answer, name)
    with pytest.raises(crumple.InvalidInput, match="triangle_pair_bodies are for worlds"):
        _ = found.triangle_pair_bodies


def test_triangle_pairs_include_static_bodies_that_intersect(either):
    plate = crumple.Shape(np.array([[-9, -9, 0], [9, -9, 0], [0, 9, 0.0]]), FACES[:1])
    blade = crumple.Shape(np.array([[0, 0, -1], [0.5, 0, 1], [-0.5, 0.2, 1]]), FACES[:1])
    world = crumple.World(
        [plate, blade], [crumple.Body(0, self_collisions=True), crumple.Body(1, self_collisions=True)]
    )
    assert (not either.any(world, crumple.ImpactQuery())) and not (
        not either.any(world, crumple.ImpactQuery(triangle_pairs=True))
    )
    found = either.impacts(world, triangle_pairs=True)
    assert found.triangle_pairs.tolist() == [[0, 0]] and found.triangle_pair_bodies.tolist() == [[0, 1]]
    assert found.world_hit.tolist() == [True] and found.world_first == [None]
    assert either.impacts(
        world, triangle_pairs=True, filter=crumple.PairFilter(excluded_bodies=[(0, 1)])
    ).triangle_pairs.shape == (0, 2)


@pytest.mark.parametrize("weld", [False, True])
def test_triangle_pairs_match_brute_force(weld, detector, reference):
    for seed in range(4):
        scene = moving(seed)
        found, expected = (
            d.impacts(
                *scene,
                groups=np.arange(14) % 3,
                triangle_pairs=True,
                weld=weld,
                filter=crumple.PairFilter(groups="between"),
            )
            for d in (detector, reference)
        )
        assert len(expected.triangle_pairs)
        assert_same(found, expected, more=TRIANGLES[:3])


# Worlds.


def test_impacts_of_a_world_have_bodies_and_times(either):
    world = falling_world()
    found = either.impacts(world)
    assert found.vertex_faces.tolist() == [[0, 0]] and found.vertex_face_bodies.tolist() == [[1, 0]]
    assert found.vertex_face_toi.tolist() == [0.5] and found.edge_edge_bodies.shape == (0, 2)
    assert found.edges.tolist() == [[0, 1], [0, 2], [1, 2]] * 2 and found.first_edge.tolist() == [0, 3, 6]
    first = either.impacts(world, output="first").first
    assert first == ("vertex_face", (0, 0), (1, 0), 0.5, False)
    assert toi_of(either.first_impact(world)) == 0.5 and either.any(world, crumple.ImpactQuery())
    for rules in ({"excluded_bodies": [{"floor", "chip"}]}, {"bodies": "within"}):
        assert not either.any(world, crumple.ImpactQuery(filter=crumple.PairFilter(**rules)))
    assert not either.any(falling_world(worlds=[0, 1]), crumple.ImpactQuery())
    assert either.first_impact(world, filter=crumple.PairFilter(excluded_bodies=[(0, 1)])) is None
    with pytest.raises(crumple.InvalidInput, match="vertex_offsets is for one mesh"):
        _ = found.vertex_offsets
    with pytest.raises(crumple.InvalidInput, match="only a single mesh has offsets by feature"):
        either.impacts(world, index=True)


def test_end_poses_move_bodies(either):
    shape = crumple.Mesh(START[3:], FACES[:1])
    poses = np.tile(np.eye(3, 4), (2, 1, 1))
    poses[1, 2, 3] = -5
    lowered = poses.copy()
    lowered[0, 2, 3] = -10
    world = crumple.World([shape], [0, 0], poses=poses, self_collisions=True)
    assert world.end_poses is None and (not either.any(world, crumple.ImpactQuery()))
    expected = either.impacts(world.at(world.poses, lowered))
    assert len(expected) and (not either.any(world, crumple.ImpactQuery())), "for that call alone"
    world.end_poses = lowered
    assert world.end_poses is lowered
    assert_same(either.impacts(world), expected)
    assert_same(
        either.impacts(crumple.World([shape], [0, 0], poses=poses, end_poses=lowered, self_collisions=True)),
        expected,
    )
    bodies = [
        crumple.Body(0, poses[0], end_pose=lowered[0], self_collisions=True),
        crumple.Body(0, poses[1], self_collisions=True),
    ]
    assert_same(either.impacts(crumple.World([shape], bodies)), expected)
    lowered[0, 2, 3] = 0
    assert not either.any(world, crumple.ImpactQuery()), "read where they lie"
    world.end_poses = None
    assert not either.any(world.at(world.poses, None), crumple.ImpactQuery())


def bodies_in_motion(seed, bodies=6, worlds=2):
    random = np.random.default_rng(seed)
    shapes = [crumple.Shape(v, f, end=e) for v, e, f in (moving(seed, 6), moving(seed + 1, 5))]
    of = np.sort(random.integers(0, worlds, bodies))
    of[-1] = -1
    poses = random_poses(random, bodies, 1)
    ends = poses + 0.1 * random.normal(size=poses.shape)
    return crumple.World(
        shapes, random.integers(0, 2, bodies), poses=poses, end_poses=ends, worlds=of, self_collisions=True
    )


@pytest.mark.parametrize(
    "question",
    [
        {},
        {"filter": crumple.PairFilter(bodies="between")},
        {"filter": crumple.PairFilter(bodies="within")},
        {"filter": crumple.PairFilter(excluded_bodies=[(0, 1), {2}])},
        {"min_distance": 0.02},
    ],
    ids=str,
)
def test_impacts_of_worlds_match_brute_force(question, detector, reference):
    for seed in range(3):
        world = bodies_in_motion(seed)
        expected = reference.impacts(world, **question)
        assert expected, "something must touch"
        assert_same(detector.impacts(world, **question), expected, BODIES)
        earliest = [d.impacts(world, output="first", **question) for d in (detector, reference)]
        assert earliest[0].first == earliest[1].first and earliest[0].world_first == earliest[1].world_first
        tois = [first.toi for first in earliest[0].world_first if first is not None]
        assert tois and earliest[0].first.toi <= min(tois)
        hit = detector.impacts(world, output="any_by_world", **question).world_hit
        assert hit.tolist() == [first is not None for first in earliest[0].world_first] == expected.world_hit.tolist()


def test_one_unposed_body_gives_the_impacts_of_its_mesh(either):
    vertices, end, faces = moving(5)
    found = either.impacts(crumple.World([crumple.Shape(vertices, faces, end=end)], self_collisions=True))
    assert_same(found, either.impacts(vertices, end, faces))
    assert found.vertex_face_bodies.shape == found.vertex_faces.shape and not found.vertex_face_bodies.any()


def test_configurations_give_the_first_impacts_of_separate_searches(detector):
    random = np.random.default_rng(3)
    shape, far = soup(6, size=0.5, dtype=np.float64), 2.5
    base = crumple.World(
        [shape], [0, 0, 0], worlds=[0, 0, -1], self_collisions=False, poses=random_poses(random, 3, far)
    )
    poses = random_poses(random, 2 * 20, far).reshape(20, 2, 3, 4)
    ends = poses + 0.1 * random.normal(size=poses.shape)
    many = base.configurations(poses, ends)
    assert many.end_poses is ends
    found, rest = detector.impacts(many, output="first"), base.poses[2:]
    hits = []
    for c, first in enumerate(found.world_first):
        moved, moved_to = (np.concatenate([of[c], rest]) for of in (poses, ends))
        one = detector.impacts(base.at(moved, moved_to), output="first").first
        assert (first is None) == (one is None)
        if one is not None:
            bodies = tuple(many.originals[list(first.bodies)].tolist())
            assert first._replace(bodies=bodies) == one
        hits.append(one is not None)
    assert 0 < sum(hits) < 20
    np.testing.assert_array_equal(detector.impacts(many, output="any_by_world").world_hit, hits)
    many.end_poses = None
    resting = detector.impacts(many, output="any_by_world").world_hit
    assert not np.array_equal(resting, hits)
