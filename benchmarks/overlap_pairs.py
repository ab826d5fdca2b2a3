"""Pairs of closed bodies for the benchmarks of overlaps, from the data below $CRUMPLE_DATA (default: ../shared/data beside
the checkout)."""

from __future__ import annotations

import itertools
import json
import os
import warnings
from dataclasses import dataclass
from pathlib import Path

import numpy as np

import crumple

TOP = Path(__file__).resolve().parent.parent
DATA = Path(os.environ.get("CRUMPLE_DATA", TOP.parent / "shared" / "data"))
DRAGON, LUCY = "meshes/dragon_100k.ply", "meshes/lucy_100k.ply"

# Pairs in addition to those of gt-overlap/large.json, in the same format; their exact volumes are not known.
MORE_PAIRS = [
    {
        "name": "ember260",
        "A": {"file": "thingi10k-ember/case260_a_908460.ply"},
        "B": {"file": "thingi10k-ember/case260_b_73416.ply"},
    },
    {
        "name": "ember406",
        "A": {"file": "thingi10k-ember/case406_a_1063852.ply"},
        "B": {"file": "thingi10k-ember/case406_b_72214.ply"},
    },
    {"name": "dragon_twice", "A": {"file": DRAGON}, "B": {"file": DRAGON, "shift": [13, 5, 3]}},
    {"name": "lucy_twice", "A": {"file": LUCY}, "B": {"file": LUCY, "shift": [40, 20, 10]}},
]


@dataclass
class Pair:
    name: str
    bodies: tuple  # two of (vertices, faces)
    exact: float | None  # exact volume of the overlap, rounded to the nearest float64; None if unknown


def read_body(told):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", crumple.FileWarning)
        weld = "yes" if told.get("weld") else "no"
        mesh = crumple.read_mesh(DATA / told["file"], precision="float64", weld=weld)
    return np.asarray(mesh.vertices) * told.get("scale", 1.0) + np.array(
        told.get("shift", (0, 0, 0)), float
    ), mesh.faces


def real_pairs(names):
    """Yields the pairs with these names (all, if empty) whose files exist."""
    truth = DATA / "gt-overlap" / "large.json"
    told = json.loads(truth.read_text())["cases"] if truth.exists() else []
    told = [c for c in told if c["B"]]
    known = {c["name"] for c in told}
    for case in told + [c for c in MORE_PAIRS if c["name"] not in known]:
        if names and case["name"] not in names:
            continue
        if missing := [body["file"] for body in (case["A"], case["B"]) if not (DATA / body["file"]).exists()]:
            print(f"{case['name']} is left out: {missing[0]} is missing in {DATA}")
            continue
        exact = float.fromhex(case["volume_float64"]) if "volume_float64" in case else None
        yield Pair(case["name"], (read_body(case["A"]), read_body(case["B"])), exact)


def deformed(vertices):
    """Returns the vertices, moved along each axis by less than a thousandth of their bounding box's longest edge."""
    size = np.ptp(vertices, axis=0).max()
    return vertices + 2**-12 * size * np.sin(np.roll(vertices, 1, axis=1) * (4 / size))


def states_of(bodies):
    """Returns two lists of bodies between which calls alternate: unchanged ones, and deformed ones."""
    return [list(bodies), [(deformed(vertices), faces) for vertices, faces in bodies]]


def alternating(call):
    """Returns a contestant that calls call(0) and call(1) alternately, once each time it is called itself."""
    states = itertools.cycle((0, 1))
    return lambda turn: call(next(states))
