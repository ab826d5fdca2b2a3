"""Small random worlds, for tests of worlds."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

import crumple
from conftest import soup


class Columns(NamedTuple):
    """Arguments of crumple.World, as arrays."""

    shapes: list[crumple.Mesh]
    bodies: np.ndarray
    poses: np.ndarray
    groups: np.ndarray
    worlds: np.ndarray
    self_collisions: np.ndarray

    def world(self, named=True, **others) -> crumple.World:
        name = f"soup {id(self)}" if named else None
        shapes = [
            crumple.Shape(shape, name=name and f"{name} {i}", groups=shape.groups)
            for i, shape in enumerate(self.shapes)
        ]
        columns = {**self._asdict(), "shapes": shapes, **others}
        return crumple.World(columns.pop("shapes"), columns.pop("bodies"), **columns)


def rotation(random) -> np.ndarray:
    """Returns a (3, 3) rotation about a random axis by a random angle."""
    q = random.normal(size=4)
    a, b, c, d = q / np.linalg.norm(q)
    return np.array(
        [
            [a * a + b * b - c * c - d * d, 2 * (b * c - a * d), 2 * (b * d + a * c)],
            [2 * (b * c + a * d), a * a - b * b + c * c - d * d, 2 * (c * d - a * b)],
            [2 * (b * d - a * c), 2 * (c * d + a * b), a * a - b * b - c * c + d * d],
        ]
    )


def random_poses(random, count, spread=1.5) -> np.ndarray:
    """Returns (count, 3, 4) float64 poses: random rotations, and translations within a cube of side `spread`."""
    poses = np.empty((count, 3, 4))
    for pose in poses:
        pose[:, :3], pose[:, 3] = rotation(random), spread * random.random(3)
    return poses


def random_columns(seed, bodies=8, worlds=3, triangles=30) -> Columns:
    random = np.random.default_rng(seed)
    shapes = [
        soup(triangles, size=0.4, seed=seed, dtype=np.float32),
        soup(triangles, size=0.4, seed=seed + 1, dtype=np.float64)._replace(
            groups=np.arange(triangles, dtype=np.int32) % 3
        ),
    ]
    of = np.sort(random.integers(0, worlds, bodies))
    of[bodies - bodies // 4 :] = -1
    return Columns(
        shapes,
        random.integers(0, 2, bodies),
        random_poses(random, bodies),
        random.integers(0, 3, bodies),
        of,
        random.random(bodies) < 0.5,
    )
