"""Tests of rigid motions that are cut into pieces."""

import numpy as np
import pytest

import crumple


def turn(angle, origin=(0, 0, 0)):
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, -s, 0, origin[0]], [s, c, 0, origin[1]], [0, 0, 1, origin[2]]])


def test_pieces_find_impacts_that_straight_motion_misses(either):
    """A bar that makes half a turn hits a pole beside it. In one straight step its vertices move through its middle."""
    bar = np.array([[-2, 0, -0.1], [2, 0, -0.1], [2, 0, 0.1]])
    pole = np.array([[0, 1.5, -1], [0, 1.5, 1], [0.01, 1.6, 1]])
    faces = np.array([[0, 1, 2]])
    start, end = np.array([turn(0), turn(0)]), np.array([turn(np.pi), turn(0)])
    world = crumple.World([(bar, faces), (pole, faces)], poses=start)
    assert either.first_impact(world.at(start, end)) is None
    radii = [np.linalg.norm(v, axis=1).max() for v in (bar, pole)]
    poses, more = crumple.cut_rigid_motion(start, end, radii, 0.01)
    assert poses.shape[1:] == (2, 3, 4) and 0 < more <= 0.01 + 1e-9
    np.testing.assert_array_equal(poses[[0, -1]], [start, end])
    firsts = [either.first_impact(world.at(a, b), min_distance=more) for a, b in zip(poses, poses[1:])]
    piece = next(k for k, first in enumerate(firsts) if first)
    assert 0.48 < (piece + firsts[piece].toi) / len(firsts) <= 0.5
    square = np.concatenate([start, np.tile([[[0, 0, 0, 1.0]]], (2, 1, 1))], axis=1)
    np.testing.assert_array_equal(crumple.cut_rigid_motion(square, end, radii, 0.01).poses, poses)


def test_error_names_the_argument_or_the_body():
    one = turn(0)[None]
    for arguments, message in (
        ((2 * one, one, [1], 1), "body 0: its pose at the start is not a rotation with a translation"),
        ((one, one, [-1], 1), "body 0: its radius must be finite and 0 or more"),
        ((one, one, [1, 2], 1), "must have the same length"),
        ((one, one, [1], 0), "tolerance must be finite and above 0"),
        ((one[0], one, [1], 1), "start must have shape"),
        ((one, one, [[1]], 1), "radii must be"),
    ):
        with pytest.raises(crumple.InvalidInput, match=message):
            crumple.cut_rigid_motion(*arguments)
    with pytest.raises(crumple.InvalidType, match="tolerance"):
        crumple.cut_rigid_motion(one, one, [1], "x")
