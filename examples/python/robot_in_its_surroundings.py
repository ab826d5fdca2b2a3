"""Checks hundreds of configurations of a robot arm in its surroundings in one call; draws one that collides.

python robot_in_its_surroundings.py [PICTURE]

Adjacent links overlap at their joint, which is allowed: these pairs are excluded. The surroundings are in all worlds.
Shapes have names, so that the detector reads them only once.
"""

import itertools
import sys

import numpy as np

import crumple

LENGTHS = {"shoulder": 0.5, "upper arm": 1.4, "forearm": 1.2, "wrist": 0.4, "hand": 0.3}
RADII = [0.25, 0.18, 0.14, 0.1, 0.15]
LINKS = list(LENGTHS)
NEIGHBOURS = [set(pair) for pair in itertools.pairwise(LINKS)]


def tube(radius, length, sides=32, rings=12):
    """Returns a closed cylinder along z, with round ends, that begins at 0."""
    profile = np.linspace(0, np.pi, 2 * rings)
    height = radius * -np.cos(profile) + length * (np.arange(2 * rings) >= rings)
    turn = 2 * np.pi * np.arange(sides) / sides
    around = radius * np.sin(profile)
    vertices = np.stack(
        [
            np.outer(around, np.cos(turn)),
            np.outer(around, np.sin(turn)),
            np.repeat(height[:, None], sides, axis=1),
        ],
        axis=-1,
    ).reshape(-1, 3)
    a = (sides * np.arange(2 * rings - 1)[:, None] + np.arange(sides)).ravel()
    b = (sides * np.arange(2 * rings - 1)[:, None] + (np.arange(sides) + 1) % sides).ravel()
    return vertices, np.concatenate([np.stack([a, b, b + sides], 1), np.stack([a, b + sides, a + sides], 1)])


def box(*size):
    """Returns a box centred at the origin."""
    corners = np.array([[i, j, k] for i in (-0.5, 0.5) for j in (-0.5, 0.5) for k in (-0.5, 0.5)]) * size
    faces = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
    return corners, np.array([[f[0], f[i], f[i + 1]] for f in faces for i in (1, 2)])


def at(*place):
    return np.concatenate([np.eye(3), np.reshape(place, (3, 1))], axis=1)


def turned(axis, angles):
    """Returns (k, 4, 4) rotations about x, y or z."""
    i, j = (axis + 1) % 3, (axis + 2) % 3
    matrix = np.tile(np.eye(4), (len(angles), 1, 1))
    matrix[:, i, i] = matrix[:, j, j] = np.cos(angles)
    matrix[:, j, i] = np.sin(angles)
    matrix[:, i, j] = -matrix[:, j, i]
    return matrix


def arm(angles):
    """Returns (k, links, 3, 4) poses: the first link turns about z, each other about y at the end of the one before."""
    poses = np.empty((len(angles), len(LINKS), 3, 4))
    frame = turned(2, angles[:, 0])
    for i, length in enumerate(LENGTHS.values()):
        if i:
            frame = frame @ turned(1, angles[:, i])
        poses[:, i] = frame[:, :3]
        frame = frame.copy()
        frame[:, :3, 3] += length * frame[:, :3, 2]
    return poses


def surroundings():
    yield "table", box(4, 4, 0.1), at(0, 0, -0.35)
    for i, (x, y) in enumerate([(1.3, 0.9), (1.3, -0.9), (-1.5, 0.2)]):
        yield f"post {i}", box(0.15, 0.15, 2.4), at(x, y, 0.9)
    yield "shelf", box(0.5, 2, 0.05), at(1.3, 0, 1.4)
    yield "bowl", tube(0.35, 0.0), at(-0.9, -1.1, 0.1)


def main(picture="robot_in_its_surroundings.html"):
    links = [
        crumple.Body(crumple.Shape(*tube(radius, length), name=name), name=name)
        for radius, (name, length) in zip(RADII, LENGTHS.items())
    ]
    rest = [
        crumple.Body(crumple.Shape(*mesh, name=name), pose, group=1, world=-1, name=name)
        for name, mesh, pose in surroundings()
    ]
    bodies = links + rest
    world = crumple.World([body.shape for body in bodies], bodies)
    print(world)

    random = np.random.default_rng(1)
    angles = random.uniform(-1, 1, (500, len(LINKS))) * [np.pi, 1.6, 2.4, 2, 2]
    many = world.configurations(arm(angles))
    detector = crumple.Detector()
    # Adjacent links may overlap, and the surroundings touch each other.
    allowed = crumple.PairFilter(excluded_bodies=NEIGHBOURS, excluded_groups=[(1, 1)])
    free = ~detector.intersections(many, output="any_by_world", filter=allowed).world_hit
    print(f"{free.sum()} of {len(free)} configurations are free")

    result = detector.intersections(many, output="body_pairs", filter=allowed)
    hits = {}
    for pair, body in zip(result.names, result.bodies[:, 0]):
        hits.setdefault(int(many.worlds[body]), []).append(pair)
    shown = max((c for c in hits if "shelf" in sum(hits[c], ())), key=lambda c: len(hits[c]))
    print(f"configuration {shown}: {', '.join(f'{a} hits {b}' for a, b in hits[shown])}")

    poses = np.concatenate([arm(angles[shown : shown + 1])[0], world.poses[len(LINKS) :]])
    detector.intersections(world.at(poses), output="body_pairs", filter=allowed).save(picture)


if __name__ == "__main__":
    main(*sys.argv[1:])
