"""Decides in rational arithmetic (Python's fractions) whether two triangles collide, by another method than crumple's.

Two convex hulls have a common point if and only if the origin is a convex combination of the differences of their points. The
simplex method with Bland's rule, which cannot cycle, decides this. Source: R. G. Bland, New finite pivoting rules for the simplex
method, Mathematics of Operations Research 2(2), 1977.
"""

from fractions import Fraction


def hulls_meet(a, b):
    """True if the convex hulls of the points a and b (rows of finite numbers) have a common point. Costs milliseconds."""
    exact_a, exact_b = ([[Fraction(float(x)) for x in p] for p in hull] for hull in (a, b))
    columns = [[x - y for x, y in zip(p, q)] + [Fraction(1)] for p in exact_a for q in exact_b]
    rows = [[column[r] for column in columns] + [Fraction(int(r == 3))] for r in range(4)]
    return is_feasible(rows)


def is_feasible(rows):
    """True if weights >= 0 exist whose combination of the columns is the last column, which has no negative entry."""
    count = len(rows[0]) - 1
    basis = [count + r for r in range(len(rows))]  # artificial variables, whose columns are not stored
    cost = [sum(column) for column in zip(*rows)]  # sum of the artificial variables as a function of the others
    while cost[-1] > 0:
        enters = next((j for j in range(count) if cost[j] > 0), None)
        if enters is None:
            return False
        limits = [(row[-1] / row[enters], basis[r], r) for r, row in enumerate(rows) if row[enters] > 0]
        _, _, leaves = min(limits)
        pivot = rows[leaves]
        pivot[:] = [x / pivot[enters] for x in pivot]
        for row in [*(row for row in rows if row is not pivot), cost]:
            factor = row[enters]
            row[:] = [x - factor * y for x, y in zip(row, pivot)]
        basis[leaves] = enters
    return True


def orientation(a, b, c, d):
    rows = [[Fraction(float(x)) - Fraction(float(y)) for x, y in zip(p, a)] for p in (b, c, d)]
    (a1, a2, a3), (b1, b2, b3), (c1, c2, c3) = rows
    return a1 * (b2 * c3 - b3 * c2) - a2 * (b1 * c3 - b3 * c1) + a3 * (b1 * c2 - b2 * c1)


def on_one_side(u, v, p, q):
    """True if the points p and q, coplanar with the line through u and v, lie strictly on the same side of it."""
    along, to_p, to_q = ([Fraction(float(x)) - Fraction(float(y)) for x, y in zip(e, u)] for e in (v, p, q))

    def cross(s, t):
        return [s[i - 2] * t[i - 1] - s[i - 1] * t[i - 2] for i in range(3)]

    return sum(x * y for x, y in zip(cross(along, to_p), cross(along, to_q))) > 0


def triangles_collide(vertices, first, second):
    """True if the triangles, three indices each, collide by the definition of docs/contract.md (neighbours "geometric").
    Triangles with shared indices must not be degenerate."""
    shared = [i for i in first if i in set(second)]
    own, others = ([vertices[i] for i in t if i not in shared] for t in (first, second))
    whole, whole_other = ([vertices[i] for i in t] for t in (first, second))
    if len(shared) == 0:
        return hulls_meet(whole, whole_other)
    if len(shared) == 1:  # a further common point exists if and only if the edge opposite to the vertex meets the other triangle
        return hulls_meet(own, whole_other) or hulls_meet(whole, others)
    if len(shared) == 2:
        u, v = (vertices[i] for i in shared)
        return orientation(u, v, own[0], others[0]) == 0 and on_one_side(u, v, own[0], others[0])
    return True
