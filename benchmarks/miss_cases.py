"""Runs peers on pairs of triangles (miss_kinds.py) and judges their results: missed and invented pairs, refusals, crashes."""

from __future__ import annotations

import importlib
import json
import selectors
import subprocess
import sys
import tempfile
from collections import Counter
from dataclasses import dataclass, field
from importlib.metadata import version
from pathlib import Path

import exact_triangles
import miss_kinds

import crumple

FOLDER = Path(__file__).resolve().parent
PATIENCE = 60  # seconds without a result after which a peer is stopped


@dataclass(frozen=True)
class Column:
    """A peer's function, and its promise. Pairs outside the promise are counted apart."""

    title: str
    module: str
    kind: str
    promise: str
    touching: bool = True  # promises pairs that do not cross properly
    adjacent: bool = True  # promises pairs with a common index of a vertex
    degenerate: bool = True  # promises pairs with a degenerate triangle
    duplicates: bool = True  # promises triangles with the same three positions
    float32: bool = False  # rounds to float32, so promises nothing for other coordinates
    tolerance: float = 0.0  # promises nothing if all coordinates are smaller
    boxes: bool = False  # returns pairs of boxes, so further pairs are promised
    manifold: bool = False  # its meshes have edges of one or two triangles, oriented alike
    weld: bool = False  # vertices at equal positions are one

    @property
    def worker(self):
        return getattr(importlib.import_module(f"peers.{self.module}"), self.kind)

    @property
    def version(self):
        return crumple.__version__ if self.worker.package == "crumple" else version(self.worker.package)

    def promises(self, case, proper):
        return (
            (self.touching or proper)
            and (self.adjacent or not case.is_adjacent)
            and (self.degenerate or not case.is_degenerate)
            and (self.duplicates or not case.is_duplicate)
            and (not self.float32 or case.is_float32)
            and abs(case.vertices).max() >= self.tolerance
        )


ROUNDED = "in float64, with rounding errors"
BETWEEN = [
    Column("Crumple", "crumple_python", "CrumpleBetween", "exact pairs"),
    Column("libigl, CGAL", "libigl", "LibiglBetween", "exact pairs; no degenerate triangles", degenerate=False),
    Column("trueform", "true_form", "TrueformBetween", "pairs; its docstring does not mention rounding"),
    Column("Coal", "coal", "Coal", f"pairs, {ROUNDED}; tolerance of 1e-6 (`gjk_tolerance`)", tolerance=1e-6),
    Column("python-fcl", "python_fcl", "PythonFcl", f"pairs, {ROUNDED}; trimesh calls it"),
    Column("MeshLib", "mesh_lib", "MeshLibBetween", "pairs in float32; leaves out touching", touching=False, float32=True, manifold=True),
    Column("Open3D", "open_3d", "Open3DBetween", f"yes or no, {ROUNDED}"),
    Column("libigl, no CGAL", "libigl_triangles", "LibiglTriangles", f"yes or no for two triangles, {ROUNDED}"),
]
ITSELF = [
    Column("Crumple", "crumple_python", "CrumpleSelf", "exact pairs"),
    Column("libigl, CGAL", "libigl", "LibiglSelf", "exact pairs; equal positions are one vertex; no degenerate or duplicate triangles",
           degenerate=False, duplicates=False, weld=True),
    Column("trueform", "true_form", "TrueformAny", "yes or no in exact arithmetic, neighbours left out", adjacent=False),
    Column("MeshLib", "mesh_lib", "MeshLib", "pairs in float32, touching included", float32=True, manifold=True),
    Column("Open3D", "open_3d", "Open3DSelf", f"pairs, neighbours left out, {ROUNDED}", adjacent=False),
    Column("PyMeshLab", "py_mesh_lab", "PyMeshLab", f"triangles without partners, {ROUNDED}; nothing about neighbours", adjacent=False),
    Column("IPC Toolkit", "ipc_toolkit", "IpcIntersections", "yes or no, edges against faces in float64, neighbours left out; "
           "nothing about touching or coplanar triangles", touching=False, adjacent=False),
    Column("IPC Toolkit, LBVH", "ipc_toolkit", "IpcBoxes", "pairs of overlapping boxes, neighbours left out", adjacent=False, boxes=True),
]


def installed(columns):
    """Returns the columns whose package can be imported, and reasons for the other ones by title."""
    kept, left_out = [], {}
    for column in columns:
        try:
            kept.append(column if column.worker else None)
        except ImportError as error:
            left_out[column.title] = str(error).splitlines()[0]
    return kept, left_out


def run_worker(column, path, first, results):
    """Appends results of cases from number `first` on. Returns the reason why the process has ended early, or None."""
    command = [sys.executable, "-m", "peers.case_worker", f"peers.{column.module}", column.kind, path, str(first)]
    with tempfile.TemporaryFile() as messages:
        process = subprocess.Popen(command, cwd=FOLDER, stdout=subprocess.PIPE, stderr=messages)
        selector = selectors.DefaultSelector()
        selector.register(process.stdout, selectors.EVENT_READ)
        rest, ready = b"", False
        while selector.select(PATIENCE):
            read = process.stdout.read1(1 << 16)
            if not read:
                break
            *lines, rest = (rest + read).split(b"\n")
            for line in lines:
                if ready:
                    found = json.loads(line)
                    results.append("refused" if found is None else found)
                ready = True
        else:
            process.kill()
            process.wait()
            return "no result"
        status = process.wait()
        if not ready:
            messages.seek(0)
            raise RuntimeError(f"{column.title} does not start: {messages.read().decode()[-500:]}")
    return "crashed" if status else None


def results_of(column, cases):
    """Returns, for each case, True or False; or "refused", "crashed" or "no result"."""
    results = []
    with tempfile.TemporaryDirectory() as folder:
        path = f"{folder}/cases.json"
        Path(path).write_text(json.dumps([(case.vertices.tolist(), case.triangles) for case in cases]))
        while len(results) < len(cases):
            ended = run_worker(column, path, len(results), results)
            if len(results) < len(cases):
                results.append(ended or "crashed")
    return results


@dataclass
class Truth:
    """Exact result of a case."""

    collides: bool
    proper: bool
    welded: bool  # collides if vertices at equal positions are one


def welded_indices(case):
    positions = list(map(tuple, case.rows))
    return [[positions.index(positions[i]) for i in triangle] for triangle in case.triangles]


def truth_of(case, detector):
    """Decides by crumple's reference backend, and compares with exact_triangles.py, except welded degenerate triangles."""
    collides, proper, welded = (
        bool(len(detector.intersections(*case.arrays, **options).pairs)) for options in ({}, {"kind": "proper"}, {"weld": True})
    )
    again = [exact_triangles.triangles_collide(case.vertices, *case.triangles)]
    if not case.is_degenerate:
        again.append(exact_triangles.triangles_collide(case.vertices, *welded_indices(case)))
    if again != [collides, welded][: len(again)]:
        raise RuntimeError(f"two exact methods differ: {case}")
    return Truth(collides, proper, welded)


@dataclass
class Cell:
    """Counts of a peer's failures for a kind, and the smallest case of each."""

    counts: Counter = field(default_factory=Counter)
    smallest: dict = field(default_factory=dict)

    def add(self, what, case):
        self.counts[what] += 1
        if what not in self.smallest or case.size < self.smallest[what].size:
            self.smallest[what] = case

    def __str__(self):
        words = [f"{n} {what}" for what, n in sorted(self.counts.items()) if what != "unpromised"]
        if self.counts["unpromised"]:
            words.append(f"({self.counts['unpromised']})")
        return ", ".join(words) or "0"


def failure(column, case, truth, found):
    """Returns the name of a failure, or None if the result is correct."""
    if isinstance(found, str):
        return found
    collides = truth.welded if column.weld else truth.collides
    if found == collides:
        return None
    if not column.promises(case, truth.proper) or (column.boxes and found):
        return "unpromised"
    return "missed" if collides else "invented"


def judge(columns, kinds, count):
    """Returns [(kind, number of colliding cases, {column: Cell})] for `count` cases of each kind."""
    detector = crumple.Detector(backend="reference")
    cases = [case for kind in kinds for case in miss_kinds.cases(kind, count)]
    truths = [truth_of(case, detector) for case in cases]
    cells = {kind: {} for kind in kinds}
    for column in columns:
        for case, truth, found in zip(cases, truths, results_of(column, cases)):
            cell = cells[case.kind].setdefault(column, Cell())
            if what := failure(column, case, truth, found):
                cell.add(what, case)
    hits = Counter(case.kind for case, truth in zip(cases, truths) if truth.collides)
    return [(kind, hits[kind], cells[kind]) for kind in kinds]
