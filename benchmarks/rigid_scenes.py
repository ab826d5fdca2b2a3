"""Shapes and poses for the benchmarks that are called from Python. They are the same on every machine."""

from __future__ import annotations

import numpy as np

import crumple


def ball(cuts, radius=1.0):
    """Returns float32 vertices and int32 faces of a sphere of 20 cuts**2 triangles.

    It is an icosahedron whose edges are divided into `cuts` pieces, projected to the sphere.
    """
    golden = (1 + 5**0.5) / 2
    corners = np.array([p for s in (-1, 1) for t in (-golden, golden) for p in ((0, s, t), (s, t, 0), (t, 0, s))])
    far = np.linalg.norm(corners[:, None] - corners, axis=2)
    joined = {(a, b) for a in range(12) for b in range(12) if abs(far[a, b] - 2) < 1e-9}
    sides = [(a, b, c) for a, b in joined for c in range(12) if a < b < c and (b, c) in joined and (a, c) in joined]
    points, faces = [], []
    for a, b, c in sorted(sides):
        if np.linalg.det(corners[[a, b, c]]) < 0:
            b, c = c, b
        first = len(points)
        number = {}
        for i in range(cuts + 1):
            for j in range(cuts + 1 - i):
                number[i, j] = first + len(number)
                points.append(((cuts - i - j) * corners[a] + i * corners[b] + j * corners[c]) / cuts)
        for i in range(cuts):
            for j in range(cuts - i):
                faces.append((number[i, j], number[i + 1, j], number[i, j + 1]))
                if i + j < cuts - 1:
                    faces.append((number[i + 1, j], number[i + 1, j + 1], number[i, j + 1]))
    points = np.array(points)
    points *= radius / np.linalg.norm(points, axis=1, keepdims=True)
    return _joined(points, faces)


def _joined(points, faces):
    """Returns float32 vertices and int32 faces, after merging points whose coordinates are equal to nine digits."""
    _, kept, new = np.unique(points.round(9) + 0.0, axis=0, return_index=True, return_inverse=True)
    return points[kept].astype(np.float32), new.reshape(-1)[np.array(faces)].astype(np.int32)


def box(size=1.0):
    """Returns float64 vertices and int32 faces of a cube around the origin: 12 triangles, edges of length `size`."""
    corners = np.array([(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]) * size / 2
    sides = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    return corners, np.array([t for a, b, c, d in sides for t in ((a, b, c), (a, c, d))], np.int32)


def sheets(side, apart):
    """Returns float64 vertices and int32 faces of two flat sheets in the plane z = 0.

    Each is a grid of side * side unit squares. The second sheet is moved by (apart, 0.21, 0). The first half of the
    vertices and of the faces belongs to the first sheet.
    """
    x, y = np.meshgrid(np.arange(side + 1.0), np.arange(side + 1.0), indexing="ij")
    vertices = np.stack([x.ravel(), y.ravel(), 0 * x.ravel()], 1)
    corner = (np.arange(side)[:, None] * (side + 1) + np.arange(side)).ravel()
    steps = np.array([(0, side + 1, side + 2), (0, side + 2, 1)])
    faces = (corner[:, None, None] + steps).reshape(-1, 3)
    both = np.concatenate([faces, faces + len(vertices)]).astype(np.int32)
    return np.concatenate([vertices, vertices + (apart, 0.21, 0)]), both


def tents(along):
    """Returns two prisms with the same ridge, a crooked line of `along` points: the first one lies below the ridge, the
    second one above it. Each is (float64 vertices, int32 faces) with 3 * along vertices."""
    random = np.random.default_rng(5)
    ridge = np.stack([np.arange(along) / 8, random.uniform(-0.1, 0.1, along), random.uniform(-0.01, 0.01, along)], 1)
    lines = [np.arange(along) + first * along for first in range(3)]
    faces = [np.array([(0, 2 * along, along), (along - 1, 2 * along - 1, 3 * along - 1)])]
    for a, b in zip(lines, [*lines[1:], lines[0]]):
        faces += [np.stack([a[:-1], b[:-1], b[1:]], 1), np.stack([a[:-1], b[1:], a[1:]], 1)]
    faces = np.concatenate(faces).astype(np.int32)
    lower, upper = (
        np.concatenate([ridge, *(ridge * (1, 0, 0) + (0, side, height) for side in (-1, 1))]) for height in (-1, 1)
    )
    return [(lower, faces), (upper, faces[:, ::-1].copy())]


def mirrored(vertices, faces):
    """Returns a mesh and its mirror image, with float64 vertices, which touch where the mesh's x is greatest.

    Moves the mesh so that the plane of the mirror is x = 0.
    """
    vertices = vertices.astype(float)
    vertices[:, 0] -= vertices[:, 0].max()
    return [(vertices, faces), (vertices * (-1, 1, 1), faces[:, ::-1].copy())]


def link(around, along, length, radius):
    """Returns float32 vertices and int32 faces of a rod with round ends, from the origin along z. It has
    2 * around * (along - 1) triangles."""
    height = np.linspace(0, np.pi, along + 1)
    z = np.where(height < np.pi / 2, 0, length) - radius * np.cos(height)
    turn = 2 * np.pi * np.arange(around) / around
    ring = radius * np.sin(height)[1:-1, None]
    rings = np.stack(np.broadcast_arrays(ring * np.cos(turn), ring * np.sin(turn), z[1:-1, None]), axis=-1)
    points = np.concatenate([rings.reshape(-1, 3), [[0, 0, z[0]], [0, 0, z[-1]]]])
    bottom, top = len(points) - 2, len(points) - 1
    faces = []
    for k in range(around):
        n = (k + 1) % around
        faces += [(bottom, n, k), (top, (along - 2) * around + k, (along - 2) * around + n)]
        for row in range(along - 2):
            p, q = row * around, (row + 1) * around
            faces += [(p + k, p + n, q + n), (p + k, q + n, q + k)]
    return points.astype(np.float32), np.array(faces, np.int32)


def rotations(random, n):
    """Returns n uniformly distributed rotations, as an array (n, 3, 3)."""
    w, x, y, z = np.moveaxis(_unit(random, n, 4), -1, 0)
    rows = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ]
    return np.moveaxis(np.array(rows), -1, 0)


def _unit(random, n, dimensions):
    v = random.normal(size=(n, dimensions))
    return v / np.linalg.norm(v, axis=1, keepdims=True)


def poses_of(rotation, translation):
    """Returns poses (..., 3, 4) made of rotations (..., 3, 3) and translations (..., 3)."""
    return np.concatenate([rotation, translation[..., None]], axis=-1)


def on_the_cloth(cloth, n, radius):
    """Returns n poses (n, 3, 4) of a ball of this radius that collides with the cloth: its centre is less than `radius`
    away from a random vertex of the cloth."""
    random = np.random.default_rng(1)
    near = cloth.vertices[random.integers(len(cloth.vertices), size=n)].astype(float)
    away = _unit(random, n, 3) * random.uniform(0.2, 0.95, size=(n, 1)) * radius
    return poses_of(rotations(random, n), near + away)


def beside_each_other(n, apart):
    """Returns n pairs of poses of two bodies, (n, 2, 3, 4), with random rotations. The distance of their origins is
    uniformly distributed between the two values of `apart`."""
    random = np.random.default_rng(2)
    poses = poses_of(rotations(random, 2 * n), np.zeros((2 * n, 3))).reshape(n, 2, 3, 4)
    poses[:, 1, :, 3] = _unit(random, n, 3) * random.uniform(*apart, size=(n, 1))
    return poses


def spread(poses, step):
    """Returns the poses (n, bodies, 3, 4) of n worlds, moved so that each world is in its own cell of a cubic grid with
    cells of size `step`."""
    n = len(poses)
    side = int(np.ceil(n ** (1 / 3)))
    cell = np.stack(np.unravel_index(np.arange(n), (side, side, side)), axis=-1)
    moved = poses.copy()
    moved[..., 3] += step * cell[:, None, :]
    return moved


def arm(n, links, length, bases, bend):
    """Returns poses (n, links, 3, 4) of n chains of rods along z of this length. The first rod starts at a random point
    of `bases` in a random direction. Each later rod starts at the end of the rod before, rotated against it about its
    x or y axis by at most `bend` radians."""
    random = np.random.default_rng(3)
    rotation = rotations(random, n)
    origin = bases[random.integers(len(bases), size=n)]
    poses = np.empty((n, links, 3, 4))
    for k in range(links):
        poses[:, k] = poses_of(rotation, origin)
        origin = origin + length * rotation[:, :, 2]
        about = np.take_along_axis(rotation, random.integers(2, size=(n, 1, 1)), axis=2)[:, :, 0]
        rotation = _turn(about, random.uniform(-bend, bend, n)) @ rotation
    return poses


def _turn(axis, angle):
    """Returns the rotations (n, 3, 3) about n unit axes by n angles in radians, by Rodrigues' formula."""
    x, y, z = axis.T
    zero = np.zeros_like(x)
    cross = np.moveaxis(np.array([[zero, -z, y], [z, zero, -x], [-y, x, zero]]), -1, 0)
    sine, cosine = np.sin(angle)[:, None, None], np.cos(angle)[:, None, None]
    return np.eye(3) + sine * cross + (1 - cosine) * (cross @ cross)


def cloth(triangles):
    return crumple.make_scene("cloth", triangles=triangles)


def obstacles(triangles):
    """Returns a mesh of about so many triangles: balls, boxes and rings that are distributed in a room."""
    return crumple.make_scene("bodies", triangles=triangles)
