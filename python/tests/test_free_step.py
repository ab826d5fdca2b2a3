"""Tests of free steps: shares, objects that are held back, and `approaching_only`."""

import pickle

import numpy as np
import pytest

import crumple
from features import END, FACES, START, falling_world, moving


def test_rounded_positions_of_a_free_step_have_no_impact(either):
    """The rounded positions are reached without an impact; vertices + toi * (end - vertices) might not be."""
    for dtype in (np.float32, np.float64):
        for seed in range(3):
            vertices, end, faces = moving(seed, dtype=dtype)
            step = either.free_step(vertices, end, faces)
            share, positions = step.share, step.positions
            assert isinstance(step, crumple.FreeStep) and positions.dtype == dtype and positions.shape == vertices.shape
            first = either.first_impact(vertices, end, faces)
            toi = first.toi
            assert step.first == first and step[3:] == (None,) * 5
            assert 0 < share < toi < 1 and share > 0.9 * toi and positions.flags.writeable
            np.testing.assert_allclose(positions, vertices + share * (end - vertices), rtol=1e-5, atol=1e-6)
            assert not either.any(crumple.Mesh(vertices, faces).moving_to(positions), crumple.ImpactQuery())
    whole = either.free_step(START, START + 1, FACES)
    assert whole.share == 1 and whole.positions.tolist() == (START + 1).tolist()
    none = either.free_step((START, FACES), END, min_distance=5)
    assert none.share == 0 and none.positions.tolist() == START.tolist()
    with pytest.raises(crumple.InvalidType, match="end is for meshes, but the scene is a crumple.World"):
        either.free_step(crumple.World([(START, FACES)]), END)
    with pytest.raises(TypeError, match=r"Detector\.free_step.*'wel'\. Did you mean 'weld'\?$"):
        either.free_step(START, END, FACES, wel=True)
    with pytest.raises(crumple.InvalidInput, match="end vertices must be as many"):
        either.free_step(START, END[:5], FACES)


def beside(offset, count=6):
    """Returns a step with two copies of the falling triangle, side by side. The second one is higher by `offset`."""
    shift = np.array([10, 0, 0])
    high = np.array([0, 0, 0] * 3 + [0, 0, offset] * 3).reshape(6, 3)
    start, end = np.concatenate([START, START + shift + high]), np.concatenate([END, END + shift + high])
    return start, end, np.concatenate([FACES, FACES + count])


def test_option_held_vertices_holds_back_only_vertices_of_an_impact(either):
    start, end, faces = beside(5)
    whole = either.free_step(start, end, faces)
    assert whole.vertex_shares is None and whole.share < 0.5
    step = either.free_step(start, end, faces, held="vertices")
    assert step.share == whole.share and step.first == whole.first == ("vertex_face", (3, 0), None, 0.5, False)
    assert np.flatnonzero(step.vertex_shares < 1).tolist() == [0, 1, 2, 3] and step.vertex_shares.dtype == np.float64
    np.testing.assert_array_equal(step.positions[6:], end[6:])
    assert not either.any(crumple.Mesh(start, faces).moving_to(step.positions), crumple.ImpactQuery())
    copy = pickle.loads(pickle.dumps(step))
    assert copy.first == step.first and copy.positions.tolist() == step.positions.tolist()


def test_colliding_bodies_of_a_world_are_held_back(either):
    world = falling_world()
    step = either.free_step(world)
    assert step.first == ("vertex_face", (0, 0), (1, 0), 0.5, False)
    assert step.first_vertex.tolist() == [0, 3, 6] and step.positions.shape == (6, 3)
    assert step.body_shares.tolist() == [step.share, step.share] and 0.49 < step.share < 0.5
    for held in ("bodies", "vertices"):
        np.testing.assert_array_equal(either.free_step(world, held=held).positions[3], step.positions[3])
    apart = either.free_step(falling_world(worlds=[0, 1]))
    assert apart.body_shares.tolist() == [1, 1] and apart.first is None
    two = either.free_step([crumple.Mesh(START[:3], FACES[:1]), crumple.Mesh(START[3:], FACES[:1]).moving_to(END[3:])])
    assert two.share == step.share and two.first == step.first


def test_intersecting_triangles_are_reported_on_request(either):
    start = START.copy()
    start[3, 2] = -1
    step = either.free_step(start, END, FACES, triangle_pairs=True)
    assert step.share == 0 and step.intersecting == (0, 1) and step.intersecting_bodies is None
    assert either.free_step(start, END, FACES).intersecting is None


def test_approaching_only_ignores_features_that_move_apart(either):
    """The vertex starts at a height of 1, nearer than the minimum distance, and moves up."""
    up = START + [0, 0, 1] * np.arange(6)[:, None].clip(2, 3).astype(float) - [0, 0, 2]
    up[:3] = START[:3]
    near = {"min_distance": 1.5, "approaching_only": True}
    assert either.first_impact(START, up, FACES, min_distance=1.5).start
    assert either.first_impact(START, up, FACES, **near) is None
    assert either.free_step(START, up, FACES, **near).share == 1
    assert either.first_impact(START, END, FACES, **near) == ("vertex_face", (3, 0), None, 0.0, True)
    assert either.free_step(START, END, FACES, **near).share == 0
    down = crumple.pair_impacts("vertex_face", START[None, [3, 0, 1, 2]], END[None, [3, 0, 1, 2]], **near)
    apart = crumple.pair_impacts("vertex_face", START[None, [3, 0, 1, 2]], up[None, [3, 0, 1, 2]], **near)
    assert down.hit.tolist() == [True] and apart.hit.tolist() == [False]


def test_unknown_value_of_held_is_refused(either):
    with pytest.raises(crumple.InvalidInput, match='held must be one of "worlds", "bodies", "vertices"'):
        either.free_step(START, END, FACES, held="edges")
