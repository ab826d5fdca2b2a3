"""Races peers against crumple on whole scenes, one thread each, and counts the pairs that they miss and invent.

Exact results of the scenes in $CRUMPLE_DATA come with them; crumple's reference backend decides the soups that are made here.
Processes and races are those of peers_python.py.
"""

from __future__ import annotations

import json
import signal
import tempfile
import warnings
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from overlap_pairs import DATA
from peers_python import Ended, Peer, number, race
from peers_python import judge as judge_race

import crumple

NEEDLES = "CAD part, all needles"
PATIENCE = 60  # seconds for the race of one peer on one scene
SELF = {  # scene: file, precision, exact result
    "soup, all kinds of contact": ("soups/soup_grid.ply", "float32", "soup_grid.txt"),
    "soup, degenerate": ("soups/soup_degenerate.ply", "float32", "soup_degenerate.txt"),
    "soup, repeated indices": ("soups/soup_repeat.ply", "float32", "soup_repeat.txt"),
    "soup, largest float32": ("soups/soup_huge32.ply", "float32", "soup_huge32.txt"),
    "soup, subnormal float64": ("soups/soup_tiny64.ply", "float64", "soup_tiny64.f64.txt"),
    "Funnel, frame 227": ("scalable-ccd/cloth-funnel/frames/227.ply", "float64", "cloth_funnel227.txt"),
    "self_intersectA": ("meshes/self_intersectA_17k.obj", "float32", "self_intersectA_17k.txt"),
    NEEDLES: ("meshes/Generic_Twin_right.obj", "float32", "Generic_Twin_right.f32.txt"),
    "dragon_100k": ("meshes/dragon_100k.ply", "float32", "dragon_100k.txt"),
    "305 bodies, frame 18": ("scalable-ccd/n-body-simulation/frames/balls16_18.ply", "float32", "balls16_18.txt"),
    "Cloth on Ball, frame 92": ("scalable-ccd/cloth-ball/frames/cloth_ball92.ply", "float32", "cloth_ball92.txt"),
}
BETWEEN = {
    "Thingi10K 88566 and 58011": ("case016_a_88566.ply", "case016_b_58011.ply", "ember_case016.a_vs_b.txt"),
    "Thingi10K 908460 and 73416": ("case260_a_908460.ply", "case260_b_73416.ply", "ember_case260.a_vs_b.txt"),
    "Thingi10K 1063852 and 72214": ("case406_a_1063852.ply", "case406_b_72214.ply", "ember_case406.a_vs_b.txt"),
}
GRID_SOUP = "random soup on a 6^3 grid"


@dataclass
class Scene:
    name: str
    meshes: list  # one or two of (vertices, triangles)
    pairs: np.ndarray
    proper: np.ndarray  # flag of each pair

    @property
    def question(self):
        return "between" if len(self.meshes) == 2 else "self"

    @property
    def triangles(self):
        return sum(len(triangles) for _, triangles in self.meshes)


def read(file, precision):
    """Returns vertices and triangles of the file below $CRUMPLE_DATA, or None if it is missing."""
    if not (DATA / file).exists():
        return None
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", crumple.FileWarning)
        mesh = crumple.read_mesh(DATA / file, precision=precision, weld="no")
    return np.array(mesh.vertices, float), np.array(mesh.faces, np.int32)


def grid_soup(seed, count=300):
    rng = np.random.default_rng(seed)
    corners = rng.integers(0, 6, (2 * count, 3, 3)).astype(float)
    corners = corners[~is_degenerate(corners)][:count]
    return corners.reshape(-1, 3), np.arange(3 * count, dtype=np.int32).reshape(-1, 3)


def by_reference(name, meshes):
    detector = crumple.Detector(backend="reference")
    scene = [crumple.Mesh(*mesh) for mesh in meshes]
    pairs, proper = (detector.intersections(*scene, kind=kind).pairs for kind in ("all", "proper"))
    kept = set(map(tuple, proper.tolist()))
    return Scene(name, meshes, pairs.copy(), np.array([tuple(p) in kept for p in pairs.tolist()]))


def scenes(question, quick):
    """Yields the scenes whose files exist."""
    yield by_reference(GRID_SOUP, [grid_soup(k) for k in range(2 if question == "between" else 1)])
    for name, source in (BETWEEN if question == "between" else SELF).items():
        if question == "between":
            meshes = [read(f"thingi10k-ember/{file}", "float32") for file in source[:2]]
        else:
            meshes = [read(*source[:2])]
        if any(mesh is None for mesh in meshes):
            print(f"{name} is left out: its files are missing in {DATA}")
            continue
        if quick and sum(len(mesh[1]) for mesh in meshes) > 20_000:
            continue
        rows = np.loadtxt(DATA / "gt" / source[-1], int, ndmin=2).reshape(-1, 4 if question == "between" else 6)
        yield Scene(name, meshes, rows[:, :2], rows[:, -1] == 1)


def promised(column, scene):
    """Returns the pairs that a peer promises, and all pairs that it may return."""
    pairs, keep = scene.pairs, np.ones(len(scene.pairs), bool)
    if column.weld:
        welded = crumple.Detector().intersections(*scene.meshes[0], weld=True).pairs
        kept = set(map(tuple, welded.tolist()))
        pairs, keep = welded.copy(), np.ones(len(kept), bool)
    elif not column.touching:
        keep &= scene.proper
    first, second = scene.meshes[0], scene.meshes[-1]
    rows = first[1][pairs[:, 0]], second[1][pairs[:, 1]]
    if not column.adjacent:
        keep &= ~(rows[0][:, :, None] == rows[1][:, None]).any((1, 2))
    corners = [mesh[0][row] for mesh, row in zip((first, second), rows)]
    if not column.degenerate:
        keep &= ~(is_degenerate(corners[0]) | is_degenerate(corners[1]))
    if not column.duplicates:
        keep &= ~(corners[0][:, :, None] == corners[1][:, None]).all(3).any(2).all(1)
    return pairs[keep], pairs


def is_degenerate(corners):
    """True for each triangle whose points are equal or on one line, on coordinates that are small integers after scaling."""
    size = np.abs(corners).max(initial=0)
    scaled = np.ldexp(corners, -int(np.frexp(size)[1])) if size else corners
    return ~np.cross(scaled[:, 1] - scaled[:, 0], scaled[:, 2] - scaled[:, 0]).any(1)


def write_arrays(folder, column, scene):
    """Writes what peers/worker.py reads."""
    description = {}
    for (vertices, triangles), which in zip(scene.meshes, ("", "_b")):
        description["scalar" + which] = "float64"
        np.ascontiguousarray(vertices, float).tofile(folder / f"vertices{which}")
        np.ascontiguousarray(triangles, np.int32).tofile(folder / f"triangles{which}")
    (folder / "description").write_text(json.dumps(description))
    required, pairs = promised(column, scene)
    pairs.astype(np.int32).tofile(folder / "pairs")
    required.astype(np.int32).tofile(folder / "promised")
    return required


def excluded(column, scene):
    """Returns why a peer is left out of a scene, or an empty string."""
    if scene.triangles > getattr(column.worker, "most_triangles", scene.triangles):
        return "too slow"
    if column.float32 and any((mesh[0].astype(np.float32) != mesh[0]).any() for mesh in scene.meshes):
        return "not float32"
    if column.manifold and any(has_equal_edges(triangles) for _, triangles in scene.meshes):
        return "not a manifold"
    if column.boxes and scene.name == NEEDLES:
        return "millions of boxes"
    return ""


def has_equal_edges(triangles):
    """True if two triangles traverse an edge in the same direction, or one has a vertex twice."""
    edges = np.vstack([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
    return len(np.unique(edges, axis=0)) < len(edges) or bool((edges[:, 0] == edges[:, 1]).any())


def expired(*_):
    raise TimeoutError


def entry_of(column, ours, scene, quick):
    """Returns the result of one peer on one scene: figures of peers_python.py, or why there are none."""
    if reason := excluded(column, scene):
        return {"left_out": reason}
    rival = replace(ours, kind=ours.kind + "Any") if column.worker.computes == "yes or no" else ours
    with tempfile.TemporaryDirectory() as name:
        folder, contestants = Path(name), []
        required = write_arrays(folder, column, scene)
        signal.signal(signal.SIGALRM, expired)
        signal.alarm(PATIENCE)
        try:
            for each in (rival, column) if column is not ours else (ours,):
                contestants.append(Peer(f"peers.{each.module}", each.worker, each.worker.ways[0][0], 1, folder))
            race(contestants, 3 if quick else 9, 0.02, 2 if quick else 6)
            entry = judge_race(contestants)[-1]
            if column is ours:
                entry.update(contestants[0].pairs())
        except Ended as reason:
            if not contestants or reason.process is contestants[0].process.process:
                raise  # crumple's own process
            return {"left_out": "refused" if reason.process.wait() == 1 else "crashed"}  # 1: an exception in Python
        except TimeoutError:
            return {"left_out": f"no result in {PATIENCE} s"}
        finally:
            signal.alarm(0)
            for contestant in contestants:
                contestant.process.process.kill()
    entry["promised"] = len(required)
    entry["hit_triangles"] = [len(np.unique(required)), len(np.unique(scene.pairs))]
    return entry


def differences(entry):
    """Describes pairs that are missing or extra; for peers that return no pairs, their result beside the exact one."""
    if "missing" in entry:
        words = [f"{entry[key]:,} {word}" for key, word in (("missing", "missed"), ("extra", "invented")) if entry[key]]
        return ", ".join(words) or "exact"
    if entry["computes"] == "yes or no":
        least, most = (count > 0 for count in entry["hit_triangles"])
        right = least <= bool(entry["size"]) <= most
        return "correct" if right else "wrong"
    least, most = entry["hit_triangles"]
    return f"{entry['size']:,} triangles (exact: {least:,}, with neighbours {most:,})"


def cell(entry):
    if "left_out" in entry:
        return entry["left_out"]
    ratio = f", {number(entry['ratio']['median'])}x" if "ratio" in entry else f", {number(entry['milliseconds']['median'])} ms"
    return differences(entry) + ratio


def measure(columns, question, quick):
    """Returns [(scene, {column: entry})]. The first column is crumple's."""
    rows = []
    for scene in scenes(question, quick):
        row = {}
        for column in columns:
            if getattr(column.worker, "most_triangles", 2) > 1:
                row[column] = entry_of(column, columns[0], scene, quick)
                print(f"{scene.name}, {column.title}: {cell(row[column])}", flush=True)
        rows.append((scene, row))
    return rows
