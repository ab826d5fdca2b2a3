"""How figures are written to benchmarks/results: JSON, one record a line, so that a difference shows what was measured anew.

A record is an object without lists. A list of numbers is a line, too. crumple_benchmark writes the same (report.cpp).
"""

import json
from pathlib import Path


def has_list(value):
    if isinstance(value, dict):
        return any(map(has_list, value.values()))
    return isinstance(value, list)


def lines(value, indent=""):
    """The value, its first line without indentation."""
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
