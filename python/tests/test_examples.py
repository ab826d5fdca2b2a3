"""Tests that every example runs and prints what its documentation says; with PyVista it also draws its picture."""

import importlib.util
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

import mpi
from conftest import peer

EXAMPLES = Path(__file__).parents[2] / "examples" / "python"
SAYS = {
    "quick_start": r"\d+ pairs; \d+ of 20144 triangles collide\nthe first pair meets in a segment:",
    "two_solids": r"858 pairs of triangles cut each other, in closed curves: 1, 9.789 long in all",
    "animation": r"frame 54:  1827 pairs of triangles,  31 pairs of bodies",
    "robot": r"is free\n.*base hits forearm, .*\n.*table hits hand\n",
    "robot_in_its_surroundings": r"11 bodies .*\n354 of 500 configurations are free\n.*hand hits shelf\n",
    "plan_a_path": r"are free: True\n.*collides: True\na path of \d+ configurations, \d after .*; 0 of its motions collide",
    "a_thousand_worlds": r"5000 bodies in 1000 worlds: something collides in 864 of them\n  0 pairs .* 136 worlds #+\n",
    "print_check": r"part: closed, volume \S+ mm\^3, 18,432 triangles, 2 shells\n  .* passes through .*\n1 finding\nunite the shells first",
    "kinds_of_contact": r"crossing: segment \(1, 1, 0\) \(1.66667, 1, 0\)\n(.*\n)*.*hexagon: area( \(\S+ \S+ 0\)){6}\n",
    "parts_in_processes": r"together: \d+ pairs, each once, the same bytes as from one detector",
    "cloth_that_never_passes_through_itself": r"2330 triangles, 18 frames: 0 pairs .*\nimpacts held back: \d+;",
    "cloth_on_a_device": r"on the (host|device): \d+ queries, \d\d+ times a vertex stayed\n0 pairs of triangles",
    "ranks": r"(frame \d: \d{3,} pairs, \d+ on rank 0, \d+ on rank 1\n){4}"
    r"to frame 4: \d{3,} impacts; \d{3,} pairs of features are near\none process alone: \d{3,} pairs\n",
    "rigid_drop": r"(step 1/\d+ s: the contact stores up to 9\d% .*\n){2}a quarter .*: \d+ times less error\n",
    "untangle_cloth": r"step   0:  479 pairs .*\n(step .*\n)*step .*:    0 pairs .*\nno pair intersects; edges have",
    "fit_by_volume": r"(derivative .* by differences .*\n){3}step   0: IoU 0\.12301\n(.*\n)*step  60: IoU 0\.99",
    "ipc_toolkit": r"LBVH .* intersects at the start\nCrumple        2 candidates, .* intersects .*\nexact    0.164",
}
MORE_ARGUMENTS = {
    "cloth_that_never_passes_through_itself": ["0.6"],
    "rigid_drop": ["1"],
    "untangle_cloth": ["25"],
    "fit_by_volume": ["60"],
}
ANIMATED = {"cloth_that_never_passes_through_itself"}
WITHOUT_PICTURE = {"parts_in_processes", "ipc_toolkit", "cloth_on_a_device", "ranks"}


def test_every_python_example_is_tested():
    assert {path.stem for path in EXAMPLES.glob("*.py")} == set(SAYS)


@pytest.mark.parametrize("name", SAYS)
def test_example_prints_the_expected_output_and_saves_its_picture(name, tmp_path):
    if name == "ipc_toolkit":
        peer("ipctk")
    if name == "plan_a_path":
        peer("yourdfpy")
    if name == "fit_by_volume":
        pytest.importorskip("torch")
    if name == "ranks" and mpi.missing():
        pytest.skip(mpi.missing())
    painted = ("gif" if name in ANIMATED else "png") if importlib.util.find_spec("pyvista") else "html"
    pictures = [] if name in WITHOUT_PICTURE else [f"picture.{painted}"]
    arguments = pictures + MORE_ARGUMENTS.get(name, [])
    command = [sys.executable, EXAMPLES / f"{name}.py", *arguments]
    if name == "ranks":
        command, environment = ["mpirun", "-n", "2", *command], {**os.environ, **mpi.ENVIRONMENT}
    else:
        environment = None
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, env=environment)
    assert done.returncode == 0, done.stderr
    assert re.search(SAYS[name], done.stdout), done.stdout
    for picture in pictures:
        assert (tmp_path / picture).stat().st_size > 5_000
