"""Process that runs one Python peer on pairs of triangles, one after the other.

python -m peers.case_worker MODULE CLASS CASES FIRST     in the folder benchmarks

CASES is a JSON file: for each case the vertices and the two triangles. For each case from number FIRST on, the process prints true
or false: whether the peer finds that the triangles intersect; or null, and the reason to the standard error stream, if it refuses.
The peer gets two meshes of one triangle each, or one mesh of both.
"""

import importlib
import json
import os
import sys
from pathlib import Path

import numpy as np


def finds(kind, vertices, triangles):
    vertices, triangles = np.array(vertices, float), np.array(triangles, np.int32)
    if kind.question == "between":
        meshes = {"": (vertices[triangles[0]], np.array([[0, 1, 2]], np.int32)),
                  "_b": (vertices[triangles[1]], np.array([[0, 1, 2]], np.int32))}
        pair = (0, 0)
    else:
        meshes, pair = {"": (vertices, triangles)}, (0, 1)
    peer = kind(meshes, kind.ways[0][0])
    found = peer.call()
    return pair in peer.pairs(found) if getattr(peer, "pairs", None) else peer.count(found) > 0


def main(module, name, cases, first):
    out = os.fdopen(os.dup(1), "w")
    os.dup2(2, 1)  # keeps output of the library out of the results
    kind = getattr(importlib.import_module(module), name)
    print("ready", file=out, flush=True)
    for vertices, triangles in json.loads(Path(cases).read_text())[int(first) :]:
        try:
            found = bool(finds(kind, vertices, triangles))
        except Exception as error:
            print(f"{type(error).__name__}: {error}", file=sys.stderr, flush=True)
            found = None
        print(json.dumps(found), file=out, flush=True)


if __name__ == "__main__":
    main(*sys.argv[1:])
