"""Searches a thousand small worlds in one place, in one call: bodies of different worlds never collide.

python a_thousand_worlds.py [PICTURE]

Each world has five rings in a box, as in a simulator that tries many initial states at once. Prints in how many worlds
something collides, and a histogram of the numbers of pairs. The picture shows some of the worlds side by side.
"""

import sys

import numpy as np

import crumple

WORLDS, RINGS, SIDE = 1000, 5, 3.5
ACROSS = 5  # worlds in a row of the picture


def ring(radius=0.8, thickness=0.2, around=24, across=12):
    u, v = np.meshgrid(np.arange(around), np.arange(across), indexing="ij")
    a, b = 2 * np.pi * u / around, 2 * np.pi * v / across
    out = radius + thickness * np.cos(b)
    vertices = np.stack([out * np.cos(a), out * np.sin(a), thickness * np.sin(b)], axis=-1).reshape(-1, 3)

    def at(i, j):
        return across * (i % around) + j % across

    faces = [[at(u, v), at(u + 1, v), at(u + 1, v + 1)], [at(u, v), at(u + 1, v + 1), at(u, v + 1)]]
    return vertices, np.moveaxis(faces, 1, -1).reshape(-1, 3)


def random_poses(count):
    """Returns (count, 3, 4) poses: rotations by random unit quaternions, and positions in a box."""
    random = np.random.default_rng(1)
    q = random.normal(size=(count, 4))
    a, b, c, d = (q / np.linalg.norm(q, axis=1, keepdims=True)).T
    turned = [
        [a * a + b * b - c * c - d * d, 2 * (b * c - a * d), 2 * (b * d + a * c)],
        [2 * (b * c + a * d), a * a - b * b + c * c - d * d, 2 * (c * d - a * b)],
        [2 * (b * d - a * c), 2 * (c * d + a * b), a * a - b * b - c * c + d * d],
    ]
    return np.concatenate([np.moveaxis(turned, -1, 0), SIDE * random.random((count, 3, 1))], axis=2)


def main(picture="a_thousand_worlds.html"):
    shape = crumple.Shape(*ring(), name="ring")
    bodies = np.zeros(WORLDS * RINGS, int)
    of = np.repeat(np.arange(WORLDS), RINGS)
    worlds = crumple.World([shape], bodies, poses=random_poses(len(bodies)), worlds=of)
    detector = crumple.Detector()

    hit = detector.intersections(worlds, output="any_by_world").world_hit
    print(f"{len(worlds)} bodies in {WORLDS} worlds: something collides in {hit.sum()} of them")

    pairs = detector.intersections(worlds, output="body_pairs").bodies
    counts = np.bincount(of[pairs[:, 0]], minlength=WORLDS)
    for pairs_in_world, times in enumerate(np.bincount(counts)):
        print(f"{pairs_in_world:3} pairs of rings in {times:4} worlds {'#' * (times // 8)}")
    assert np.array_equal(counts > 0, hit)

    # Copies some of the worlds into a single one, in a square grid, so far apart that they cannot collide.
    count = ACROSS * ACROSS
    few = worlds.poses[: count * RINGS].reshape(count, RINGS, 3, 4).copy()
    few[:, :, 0, 3] += 2 * SIDE * (np.arange(count) % ACROSS)[:, None]
    few[:, :, 1, 3] += 2 * SIDE * (np.arange(count) // ACROSS)[:, None]
    beside = crumple.World([shape], bodies[: count * RINGS], poses=few.reshape(-1, 3, 4))
    detector.intersections(beside, output="body_pairs").save(picture)


if __name__ == "__main__":
    main(*sys.argv[1:])
