"""The curve in which two surfaces cut each other: the contacts of two meshes, put end to end.

python two_solids.py [PICTURE]
"""

import sys

import numpy as np

import crumple


def torus(around=96, across=48, tube=0.55):
    """A torus about the z axis; rows of quadrilaterals, cut in two."""
    u, v = np.meshgrid(np.arange(around), np.arange(across), indexing="ij")
    alpha, beta = 2 * np.pi * u / around, 2 * np.pi * v / across
    radius = 1 + tube * np.cos(beta)
    vertices = np.stack([radius * np.cos(alpha), radius * np.sin(alpha), tube * np.sin(beta)], axis=-1)
    a = u * across + v
    b, c, d = (u + 1) % around * across + v, (u + 1) % around * across + (v + 1) % across, u * across + (v + 1) % across
    faces = np.concatenate([np.stack([a, b, c], axis=-1), np.stack([a, c, d], axis=-1)])
    return vertices.reshape(-1, 3), faces.reshape(-1, 3)


def main(picture="two_solids.html"):
    vertices, faces = torus()
    upright = vertices[:, [0, 2, 1]] + [1.1, 0.03, 0.05]  # the other ring of the chain, too fat to pass

    result = crumple.Detector().find_between((vertices, faces), (upright, faces), contacts=True)

    segments = result.contacts.points[
        np.repeat(result.contacts.kinds == crumple.ContactKind.SEGMENT, np.diff(result.contacts.offsets))
    ]
    length = np.linalg.norm(segments[1::2] - segments[::2], axis=1).sum()
    print(f"{len(result)} pairs of triangles cut each other, in curves of length {length:.3f}")
    result.save(picture)


if __name__ == "__main__":
    main(*sys.argv[1:])
