"""Shows all ways in which two triangles meet: at a point, along a segment, in an area of three to six corners.

python kinds_of_contact.py [PICTURE]
"""

import sys

import numpy as np

import crumple

GROUND = np.array([[0, 0, 0], [4, 0, 0], [0, 4, 0]])
OTHERS = {
    "a corner that touches": [[1, 1, 0], [1, 1, 2], [2, 1, 2]],
    "crossing": [[1, 1, -1], [1, 1, 2], [3, 1, 2]],
    "an edge that lies in the other": [[0.5, 1, 0], [2, 1, 0], [1, 1, 2]],
    "coplanar, a triangle": [[0.5, 0.5, 0], [1.5, 0.5, 0], [0.5, 1.5, 0]],
    "coplanar, a hexagon": [[3, 3, 0], [-1, 3, 0], [3, -1, 0]],
    "coplanar, a quadrilateral": [[2, -1, 0], [2, 5, 0], [-1, -1, 0]],
}


def main(picture="kinds_of_contact.html"):
    """Places the pairs six units apart, finds their contacts, and draws them."""
    places = [np.array([6 * (i % 3), -6 * (i // 3), 0]) for i in range(len(OTHERS))]
    pairs = [np.concatenate([GROUND, other]) + place for other, place in zip(OTHERS.values(), places)]
    vertices = np.concatenate(pairs)
    faces = np.arange(len(vertices)).reshape(-1, 3)

    result = crumple.Detector().intersections(vertices, faces, output="contacts")

    for (name, place), kind, points in zip(zip(OTHERS, places), result.contacts.kinds, result.contacts):
        corners = " ".join("({:g}, {:g}, {:g})".format(*point) for point in points - place)
        print(f"{name}: {crumple.ContactKind(kind).name.lower()} {corners}")
    result.save(picture)


if __name__ == "__main__":
    main(*sys.argv[1:])
