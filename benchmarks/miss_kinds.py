"""Pairs of triangles on small integer grids, by kind of degeneracy: the cases of misses_python.py.

A kind is a function from a random generator to two triangles, each three rows of integers, or None if the draw is not of that
kind. Kinds of SCALES make pairs of all other kinds, and scale or move them by powers of two, so that coordinates stay exact in
float64. Kinds of INDEXED share vertices by index, as triangles of one mesh do.
"""

from dataclasses import dataclass
from functools import partial

import numpy as np

GRID = 5  # coordinates of most kinds are 0 to GRID - 1


@dataclass
class Case:
    kind: str
    rows: list  # integer coordinates: three rows of each triangle, or fewer rows if vertices have one index
    triangles: list  # two rows of indices of vertices
    factor: float = 1.0
    offset: float = 0.0

    @property
    def vertices(self):
        return np.array(self.rows, float) * self.factor + self.offset

    @property
    def arrays(self):
        return self.vertices, np.array(self.triangles, np.int32)

    @property
    def is_adjacent(self):
        return not set(self.triangles[0]).isdisjoint(self.triangles[1])

    @property
    def is_degenerate(self):
        rows = np.array(self.rows, object)
        return any(is_degenerate(rows[t]) for t in self.triangles)

    @property
    def is_duplicate(self):
        """True if both triangles have the same set of positions."""
        first, second = ({tuple(self.rows[i]) for i in t} for t in self.triangles)
        return first == second

    @property
    def is_float32(self):
        """True if float32 represents all coordinates."""
        with np.errstate(over="ignore"):
            return bool((self.vertices.astype(np.float32) == self.vertices).all())

    @property
    def size(self):
        """Sorts cases by how large their coordinates are."""
        return max(abs(x) for row in self.rows for x in row), sum(abs(x) for row in self.rows for x in row)

    def __str__(self):
        scale = f" * 2.0**{round(np.log2(self.factor))}" if self.factor != 1 else ""
        shift = f" + 2.0**{round(np.log2(self.offset))}" if self.offset else ""
        indices = f", triangles {self.triangles}" if len(self.rows) < 6 else ""
        return f"{self.rows}{scale}{shift}{indices}".replace(", ", ",").replace("],[", "], [")


def points(rng, count, size=GRID):
    return rng.integers(0, size, (count, 3)).astype(object)  # Python's integers, which do not overflow


def normal(t):
    return np.cross(t[1] - t[0], t[2] - t[0])


def is_degenerate(t):
    return not any(normal(t))


def sides(of, point_rows):
    """Returns the signs of rows of points with respect to the plane of the triangle `of`."""
    return np.sign((point_rows - of[0]) @ normal(of))


def anywhere(rng):
    a, b = points(rng, 3), points(rng, 3)
    return None if is_degenerate(a) or is_degenerate(b) else (a, b)


def apart_from_plane(rng):
    """Triangles of which one lies strictly on one side of the other one's plane."""
    pair = anywhere(rng)
    return pair if pair and abs(sides(*pair).sum()) == 3 else None


def crossing_planes(rng):
    """Triangles of which each has vertices strictly on both sides of the other one's plane, and none on it."""
    pair = anywhere(rng)
    if not pair:
        return None
    s, t = sides(*pair), sides(*pair[::-1])
    return pair if s.all() and t.all() and abs(s.sum()) == abs(t.sum()) == 1 else None


def coplanar(rng):
    origin, u, v = points(rng, 3, 3)
    steps = rng.integers(-2, 3, (6, 2))
    all_points = origin + steps[:, :1] * u + steps[:, 1:] * v
    a, b = all_points[:3], all_points[3:]
    return None if is_degenerate(a) or is_degenerate(b) else (a, b)


def equal_edge(rng):
    a, p = points(rng, 3), points(rng, 1)
    b = rng.permutation(np.vstack([a[:2], p]))
    return None if is_degenerate(a) or is_degenerate(b) or not sides(a, p).any() else (a, b)


def equal_vertex(rng):
    """Triangles with one equal vertex; the rest of the second one lies strictly on one side of the first."""
    a, p = points(rng, 3), points(rng, 2)
    b = rng.permutation(np.vstack([a[:1], p]))
    return None if is_degenerate(a) or is_degenerate(b) or abs(sides(a, p).sum()) != 2 else (a, b)


def vertex_on_face(rng, size=GRID):
    """A vertex inside a face; the other two vertices lie strictly on one side."""
    p, d, e = points(rng, 3, size)
    b = np.array([p + d, p + e, p - d - e])  # p is their centre
    a = rng.permutation(np.vstack([p, points(rng, 2, size)]))
    if is_degenerate(a) or is_degenerate(b):
        return None
    return (a, b) if abs(sides(b, a).sum()) == 2 else None


def edge_across_edge(rng):
    """Two edges that cross at their midpoints; the triangles lie strictly on different sides of the plane of these edges."""
    p, d, e, x, y = points(rng, 5)
    a, b = np.array([p - d, p + d, x]), np.array([p - e, p + e, y])
    plane = np.array([p, p + d, p + e])
    return (a, b) if sides(plane, np.array([x, y])).tolist() in ([1, -1], [-1, 1]) else None


def edge_along_edge(rng):
    """Two edges on one line with more than a point in common; the triangles are not coplanar."""
    p, d, x, y = points(rng, 4)
    i = int(rng.integers(0, 2))
    a, b = np.array([p, p + 2 * d, x]), np.array([p + d, p + (3 - i) * d, y])
    return None if is_degenerate(a) or is_degenerate(b) or not sides(a, b).any() else (a, b)


def edge_in_face(rng):
    """An edge that begins inside a face and lies in its plane; the third vertex does not."""
    p, d, e, x = points(rng, 4)
    i, j = rng.integers(-2, 3, 2)
    b = np.array([p + d, p + e, p - d - e])
    a = rng.permutation(np.array([p, p + i * d + j * e, x]))
    return None if is_degenerate(a) or is_degenerate(b) else (a, b)


def segment(rng):
    p, d, e = points(rng, 3)
    b = np.array([p + d, p + e, p - d - e])
    n = rng.integers(-1, 2, 3)
    a = np.array([p, p + n, p + 2 * n]) + rng.integers(-1, 2, 3)
    return None if not n.any() or is_degenerate(b) else (rng.permutation(a), b)


def point(rng):
    p, d, e = points(rng, 3)
    b = np.array([p + d, p + e, p - d - e])
    return None if is_degenerate(b) else (np.tile(p + rng.integers(-1, 2, 3) // 2, (3, 1)), b)


def duplicate(rng):
    a = points(rng, 3)
    return None if is_degenerate(a) else (a, a[rng.permutation(3)])


def beside_face(rng, size):
    """As vertex_on_face on a large grid, but the vertex has moved from the face by one step of the grid or none."""
    pair = vertex_on_face(rng, size)
    if pair:
        on_face = pair[0][sides(pair[1], pair[0]) == 0][0]
        moved = np.where((pair[0] == on_face).all(1)[:, None], pair[0] + rng.integers(-1, 2, 3), pair[0])
        return moved, pair[1]
    return None


PLAIN = {
    "crossing planes": crossing_planes,
    "no vertex near the plane": apart_from_plane,
    "coplanar": coplanar,
    "equal edge": equal_edge,
    "equal vertex": equal_vertex,
    "vertex on face": vertex_on_face,
    "edge across edge": edge_across_edge,
    "edge along edge": edge_along_edge,
    "edge in face": edge_in_face,
    "segment as triangle": segment,
    "point as triangle": point,
    "duplicate": duplicate,
    "vertex on face, 2^17 grid": partial(vertex_on_face, size=2**17),
    "vertex beside face, 2^17 grid": partial(beside_face, size=2**17),
    "vertex on face, 2^50 grid": partial(vertex_on_face, size=2**50),
    "vertex beside face, 2^50 grid": partial(beside_face, size=2**50),
}
SMALL = [make for name, make in PLAIN.items() if "grid" not in name]
SCALES = {  # factor, offset
    "far: plus 2^16": (1.0, 2.0**16),
    "far: plus 2^48": (1.0, 2.0**48),
    "tiny: times 2^-100": (2.0**-100, 0.0),
    "huge: times 2^100": (2.0**100, 0.0),
    "tiny: times 2^-400": (2.0**-400, 0.0),
    "huge: times 2^400": (2.0**400, 0.0),
    "least: times 2^-1074": (2.0**-1074, 0.0),
    "greatest: times 2^1019": (2.0**1019, 0.0),
}


def hinge(rng):
    pair = equal_edge(rng)
    return pair and (np.vstack([pair[0], pair[1][~(pair[1][:, None] == pair[0]).all(2).any(1)]]), [[0, 1, 2], [1, 0, 3]])


def coplanar_edge(rng):
    """Coplanar triangles with a common edge, on the same side of it (a fold) or not."""
    pair = coplanar(rng)
    rows = pair and np.vstack([pair[0], pair[1][2:]])
    return None if pair is None or is_degenerate(rows[[1, 0, 3]]) else (rows, [[0, 1, 2], [1, 0, 3]])


def common_vertex(rng):
    rows = points(rng, 5)
    return None if is_degenerate(rows[:3]) or is_degenerate(rows[[0, 3, 4]]) else (rows, [[0, 1, 2], [0, 3, 4]])


def coplanar_vertex(rng):
    pair = coplanar(rng)
    rows = pair and np.vstack([pair[0], pair[1][:2]])
    return None if pair is None or is_degenerate(rows[[0, 3, 4]]) else (rows, [[0, 1, 2], [0, 3, 4]])


def same_indices(rng):
    rows = points(rng, 3)
    return None if is_degenerate(rows) else (rows, [[0, 1, 2], rng.permutation(3).tolist()])


INDEXED = {
    "hinge, common edge": hinge,
    "coplanar, common edge": coplanar_edge,
    "common vertex": common_vertex,
    "coplanar, common vertex": coplanar_vertex,
    "duplicate by index": same_indices,
}
SEPARATE = [[0, 1, 2], [3, 4, 5]]


def draw(rng, make):
    while (drawn := make(rng)) is None:
        pass
    return drawn


def cases(kind, count, seed=1):
    """Returns `count` cases of a kind: the same ones in each run."""
    rng = np.random.default_rng([seed, *kind.encode()])
    made = []
    for _ in range(count):
        factor, offset = SCALES.get(kind, (1.0, 0.0))
        if kind in INDEXED:
            rows, triangles = draw(rng, INDEXED[kind])
        else:
            make = SMALL[rng.integers(len(SMALL))] if kind in SCALES else PLAIN[kind]
            rows, triangles = np.vstack(draw(rng, make)), SEPARATE
        made.append(Case(kind, rows.tolist(), triangles, factor, offset))
    return made
