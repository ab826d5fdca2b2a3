"""Finds the curve in which two surfaces intersect: the contacts of two meshes, joined end to end.

python two_solids.py [PICTURE]
"""

import sys

import numpy as np

import crumple


def torus(around=96, across=48, tube=0.55):
    """Returns a torus about the z axis; each of its quadrilaterals is cut into two triangles."""
    u, v = np.meshgrid(np.arange(around), np.arange(across), indexing="ij")
    alpha, beta = 2 * np.pi * u / around, 2 * np.pi * v / across
    radius = 1 + tube * np.cos(beta)
    vertices = np.stack([radius * np.cos(alpha), radius * np.sin(alpha), tube * np.sin(beta)], axis=-1)
    a = u * across + v
    b, c, d = (u + 1) % around * across + v, (u + 1) % around * across + (v + 1) % across, u * across + (v + 1) % across
    faces = np.concatenate([np.stack([a, b, c], axis=-1), np.stack([a, c, d], axis=-1)])
    return vertices.reshape(-1, 3), faces.reshape(-1, 3)


def count_curves(segments):
    """Counts the closed curves that segments form. Ends that meet have the same bits, so they are one point."""
    _, ends = np.unique(segments, axis=0, return_inverse=True)
    ends = ends.reshape(-1, 2)
    assert (np.bincount(ends.ravel()) == 2).all(), "each end is that of one other segment"
    label = np.arange(ends.max() + 1)
    while True:  # lowers labels along segments until nothing changes
        sunk = label.copy()
        lowest = label[ends].min(axis=1)
        np.minimum.at(sunk, ends, lowest[:, None])
        if (sunk == label).all():
            return len(np.unique(label))
        label = sunk


def main(picture="two_solids.html"):
    vertices, faces = torus()
    upright = vertices[:, [0, 2, 1]] + [1.1, 0.03, 0.05]  # the next link of the chain, too thick for the first one

    result = crumple.Detector().intersections((vertices, faces), (upright, faces), output="contacts")

    segments = result.contacts.points[
        np.repeat(result.contacts.kinds == crumple.ContactKind.SEGMENT, np.diff(result.contacts.offsets))
    ]
    length = np.linalg.norm(segments[1::2] - segments[::2], axis=1).sum()
    curves = count_curves(segments)
    print(f"{len(result)} pairs of triangles cut each other, in closed curves: {curves}, {length:.3f} long in all")
    result.save(picture)


if __name__ == "__main__":
    main(*sys.argv[1:])
