"""Writes figures to benchmarks/results as JSON, one record per line, so that a diff shows what was measured again.

A record is an object without lists. A list of numbers takes one line, too. crumple_benchmark writes the same format
(report.cpp).
"""

import json
from pathlib import Path


def has_list(value):
    if isinstance(value, dict):
        return any(map(has_list, value.values()))
    return isinstance(value, list)


def lines(value, indent=""):
    """Returns the value as JSON; `indent` applies to all lines but the first."""
    if isinstance(value, dict) and has_list(value):
        opening, items, closing = "{", [(json.dumps(key) + ": ", item) for key, item in value.items()], "}"
    elif isinstance(value, list) and any(isinstance(item, (dict, list)) for item in value):
        opening, items, closing = "[", [("", item) for item in value], "]"
    else:
        return json.dumps(value)
    inner = indent + " "
    return f"{opening}\n" + ",\n".join(inner + key + lines(item, inner) for key, item in items) + f"\n{indent}{closing}"


def write(path, figures):
    Path(path).write_text(lines(figures) + "\n")
