"""Least squares without packages, because tables and pages are made where there are none."""

from math import sqrt


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def fitted(values, columns):
    """The linear function of the columns, and of 1, that comes nearest to the values: its value in each row.

    Columns are made orthogonal one after another; what is left of one that depends on those before is noise, and dropped.
    """
    result = [0.0] * len(values)
    basis = []
    for column in ([1.0] * len(values), *columns):
        length = sqrt(dot(column, column))
        for q in 2 * basis:  # twice: what rounding left of the first time
            along = dot(column, q)
            column = [x - along * y for x, y in zip(column, q)]
        rest = sqrt(dot(column, column))
        if rest > 1e-9 * length:
            basis.append([x / rest for x in column])
    for q in basis:
        along = dot(values, q)
        result = [x + along * y for x, y in zip(result, q)]
    return result


def explained(values, predicted):
    """The share of the values' variance that the prediction explains."""
    middle = sum(values) / len(values)
    total = sum((value - middle) ** 2 for value in values)
    return 1 - sum((value - p) ** 2 for value, p in zip(values, predicted)) / total if total else 1.0
