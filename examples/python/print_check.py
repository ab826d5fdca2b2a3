"""Checks a part before it is printed: is it closed, does it pass through itself, and do its shells overlap?

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


def check(path, picture):
    report = crumple.check(path, unit="mm")
    print(report)
    kinds = {item.kind for item in report.items if item.finding}
    overlaps = {"touching", "overlapping", "piercing"}  # shells that a slicer should unite
    if not kinds:
        print("closed, and free of itself")
    else:
        print("unite the shells first" if kinds <= overlaps else "repair the surface first")
    crumple.intersections(crumple.read_mesh(path), output="contacts").save(picture)


def main(picture="print_check.html", part=None):
    with TemporaryDirectory() as folder:
        if part is None:
            part = Path(folder) / "part.stl"
            make_part(part)
        check(part, picture)


if __name__ == "__main__":
    main(*sys.argv[1:])
