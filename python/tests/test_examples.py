"""Every example runs and says what its documentation says; with PyVista it also paints its picture."""

import importlib
import importlib.util
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from conftest import peer

EXAMPLES = Path(__file__).parents[2] / "examples" / "python"
SAYS = {
    "quick_start": r"\d+ pairs; \d+ of 20144 triangles collide\nthe first pair meets in a segment:",
    "two_solids": r"858 pairs of triangles cut each other, in curves of length 9.789",
    "animation": r"frame 54:  1827 pairs of triangles,  31 pairs of bodies",
    "robot": r"is free\n.*base hits forearm, .*\n.*table hits hand\n",
    "robot_in_its_surroundings": r"11 bodies .*\n354 of 500 configurations are free\n.*hand hits shelf\n",
    "a_thousand_worlds": r"5000 bodies in 1000 worlds: something collides in 864 of them\n  0 pairs .* 136 worlds #+\n",
    "print_check": r"18432 triangles in 2 shells\n688 pairs between shells, 0 within one: unite the shells first",
    "kinds_of_contact": r"crossing: segment \(1, 1, 0\) \(1.66667, 1, 0\)\n(.*\n)*.*hexagon: area( \(\S+ \S+ 0\)){6}\n",
    "parts_in_processes": r"together: \d+ pairs, each once, the same bytes as from one detector",
    "cloth_that_never_passes_through_itself": r"2330 triangles, 18 frames: 0 pairs .*\nimpacts held back: \d+;",
    "ipc_broad_phase": r"frame 0\n.*clean\n  Crumple         0 candidates: clean\nframe 60\n(.*intersects\n){2}",
}
MORE_ARGUMENTS = {"cloth_that_never_passes_through_itself": ["0.6"]}
ANIMATED = {"cloth_that_never_passes_through_itself"}
WITHOUT_PICTURE = {"parts_in_processes", "ipc_broad_phase"}


def test_every_example_is_tested():
    assert {path.stem for path in EXAMPLES.glob("*.py")} == set(SAYS)


CROSSED = np.array([[0, 0, 0], [4, 0, 0], [0, 4, 0], [1, 1, -1], [1, 1, 2], [3, 1, 2.0]])
BOTH = np.array([[0, 1, 2], [3, 4, 5]])


@pytest.fixture
def broad_phase(monkeypatch):
    peer("ipctk")
    monkeypatch.syspath_prepend(EXAMPLES)
    return importlib.import_module("ipc_broad_phase").CrumpleBroadPhase()


@pytest.mark.parametrize("faces, rods", [(BOTH, []), (BOTH[:1], [[3, 4]]), (BOTH[:1], [[4, 5]]), (BOTH[:0], [[3, 4]])])
def test_the_broad_phase_finds_edges_of_no_triangle(faces, rods, broad_phase):
    ipctk = peer("ipctk")
    edges = np.array([*ipctk.edges(faces).tolist(), *rods]) if len(faces) else np.array(rods)
    mesh = ipctk.CollisionMesh(CROSSED, edges, faces)
    assert ipctk.has_intersections(mesh, CROSSED, broad_phase) == ipctk.has_intersections(mesh, CROSSED, ipctk.LBVH())


@pytest.mark.parametrize("edges, found", [([[0, 1], [5, 3]], [(0, 1), (1, 0)]), ([[5, 3]], [(0, 0)]), ([], [])])
def test_the_broad_phase_leaves_out_edges_without_a_number(edges, found, broad_phase):
    broad_phase.build(CROSSED, np.reshape(edges, (-1, 2)).astype(int), BOTH)
    assert [(c.edge_id, c.face_id) for c in broad_phase.detect_edge_face_candidates()] == found


@pytest.mark.parametrize("name", SAYS)
def test_example(name, tmp_path):
    if name == "ipc_broad_phase":
        peer("ipctk")
    painted = ("gif" if name in ANIMATED else "png") if importlib.util.find_spec("pyvista") else "html"
    pictures = [] if name in WITHOUT_PICTURE else [f"picture.{painted}"]
    arguments = pictures + MORE_ARGUMENTS.get(name, [])
    done = subprocess.run(
        [sys.executable, EXAMPLES / f"{name}.py", *arguments], cwd=tmp_path, capture_output=True, text=True
    )
    assert done.returncode == 0, done.stderr
    assert re.search(SAYS[name], done.stdout), done.stdout
    for picture in pictures:
        assert (tmp_path / picture).stat().st_size > 5_000
