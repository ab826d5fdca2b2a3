"""Checks a part before it is printed: is it closed, does it pass through itself, and which shells does it have?

python print_check.py [PICTURE [PART.stl]]
"""

import sys
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

import crumple
from two_solids import torus


def make_part(path):
    """Writes a ring with a handle that overlaps the ring instead of being united with it."""
    vertices, faces = torus()
    handle = vertices * [0.45, 0.45, 1.2] + [1.5, 0.01, 0.02]
    crumple.write_mesh(path, (np.concatenate([vertices, handle]), np.concatenate([faces, faces + len(vertices)])))


def shells(mesh):
    """Returns the connected component of each triangle: lowers labels along shared vertices until nothing changes."""
    label = np.arange(len(mesh.vertices))
    while True:
        lowest = label[mesh.faces].min(axis=1)
        sunk = label.copy()
        np.minimum.at(sunk, mesh.faces, lowest[:, None])
        sunk = sunk[sunk]
        if (sunk == label).all():
            return np.unique(label[mesh.faces[:, 0]], return_inverse=True)[1]
        label = sunk


def open_edges(mesh):
    """Counts the edges that belong to one triangle only. A surface that has such edges is not closed."""
    edges = np.sort(mesh.faces[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
    return int((np.unique(edges, axis=0, return_counts=True)[1] == 1).sum())


def check(path, picture):
    part = crumple.read_mesh(path)  # an STL file has no vertex indices: vertices at equal positions are merged
    result = crumple.Detector().intersections(part, output="contacts")
    piece = shells(part)
    across = int((piece[result.pairs[:, 0]] != piece[result.pairs[:, 1]]).sum())
    gaps, within = open_edges(part), len(result) - across
    print(f"{len(part.faces)} triangles in {piece.max() + 1} shells, {gaps} open edges")
    print(f"{across} pairs between shells, {within} within one: ", end="")
    if gaps or within:
        print("repair the surface first")
    else:
        print("unite the shells first" if across else "closed, and free of itself")
    result.save(picture)


def main(picture="print_check.html", part=None):
    with TemporaryDirectory() as folder:
        if part is None:
            part = Path(folder) / "part.stl"
            make_part(part)
        check(part, picture)


if __name__ == "__main__":
    main(*sys.argv[1:])
