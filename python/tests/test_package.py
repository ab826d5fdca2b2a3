"""Tests of the installed package: its command line, types, documentation and imports."""

import inspect
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

import crumple
from conftest import peer, soup

pytestmark = pytest.mark.installed

PACKAGE = Path(crumple.__file__).parent
TOP = Path(__file__).parents[2]


def run(*arguments, **options):
    return subprocess.run([sys.executable, *arguments], capture_output=True, text=True, **options)


def test_command_line_gives_the_pairs_of_the_library(tmp_path):
    assert run("-m", "crumple", "--version").stdout == f"crumple {crumple.__version__}\n"
    mesh = soup(50, size=0.5)
    crumple.write_mesh(tmp_path / "mesh.ply", mesh)
    assert run("-m", "crumple", "detect", "mesh.ply", "--check", cwd=tmp_path).returncode == 1
    found = run("-m", "crumple", "detect", "mesh.ply", cwd=tmp_path)
    assert found.stdout == "".join(f"{a} {b}\n" for a, b in crumple.intersections(mesh).pairs)
    assert run("-m", "crumple", "detect", "none.ply", cwd=tmp_path).returncode == 2


def test_the_version_is_that_of_the_distribution():
    from importlib.metadata import version

    assert version("crumple") == crumple.__version__


def test_header_citation_and_readme_have_the_version_of_the_package():
    header = (TOP / "include" / "crumple" / "version.h").read_text()
    numbers = re.findall(r"^#define CRUMPLE_VERSION_(?:MAJOR|MINOR|PATCH) (\d+)$", header, flags=re.M)
    suffix = re.search(r'^#define CRUMPLE_VERSION_SUFFIX "(.*)"$', header, flags=re.M).group(1)
    assert crumple.__version__ == ".".join(numbers) + suffix
    citation = re.findall(r"^version: (.*)$", (TOP / "CITATION.cff").read_text(), flags=re.M)
    assert citation == [crumple.__version__], "CITATION.cff repeats it, for it cannot read it elsewhere"
    named = set(re.findall(r"crumple[-_](\d+\.\d+\.\d+[.~\w]*?)[-_]", (TOP / "README.md").read_text()))
    deb = ".".join(numbers) + suffix.replace(".", "~")
    assert named == {crumple.__version__, deb}, "README.md names the files of the release"
    for name in ("CMakeLists.txt", "pyproject.toml", "cmake/package.cmake"):
        assert crumple.__version__ not in (TOP / name).read_text(), f"{name} reads include/crumple/version.h"


def test_two_installed_distributions_are_refused(tmp_path):
    """The distributions with and without the cuda backend install the same files."""
    (tmp_path / "crumple").symlink_to(PACKAGE)
    environment = os.environ | {"PYTHONPATH": str(tmp_path)}
    for name in ("crumple-0.2.0", "numpy_cuda13-1.0", "crumple_tools-1.0"):
        (tmp_path / f"{name}.dist-info").mkdir()
    assert run("-c", "import crumple", env=environment).returncode == 0
    (tmp_path / "crumple_cuda13-0.2.0.dist-info").mkdir()
    refused = run("-c", "import crumple", env=environment)
    assert refused.returncode == 1
    last = refused.stderr.splitlines()[-1]
    assert last.startswith("ImportError: crumple and crumple-cuda13 are both installed in ")
    assert "pip uninstall crumple crumple-cuda13" in last


def test_device_list_is_empty_exactly_if_a_reason_is_given():
    """Either the list of devices or the reason is empty, depending on the machine."""
    devices, reason = crumple.list_devices()
    assert bool(devices) != bool(reason) and "\n" not in reason
    assert isinstance(crumple.Detector().fallback, str) and crumple.Detector(backend="cpu").fallback == ""


def test_package_contains_a_type_stub_and_py_typed():
    assert (PACKAGE / "py.typed").exists()
    stub = (PACKAGE / "_core.pyi").read_text()
    assert "class Detector" in stub and "class Statistics" in stub


def test_mypy_accepts_a_typed_program_and_rejects_wrong_options(tmp_path):
    peer("mypy")
    program = tmp_path / "typed.py"
    program.write_text(
        "import numpy as np\n"
        "import crumple\n"
        "v, f = np.zeros((3, 3)), np.zeros((1, 3), np.int32)\n"
        "r: crumple.Intersections = crumple.Detector(threads=2).intersections(v, f, neighbours='skip', output='contacts')\n"
        "n: int = r.statistics.pairs\n"
        "ok: bool = crumple.Detector().any((v, f))\n"
        "seconds: float = r.statistics.stage_milliseconds['sweep'] / 1000\n"
        "rules = crumple.PairFilter(groups='both', excluded_groups=zip([0], [1]))\n"
        "crumple.intersections(v, f, filter=rules)\n"
        "assert r.contacts is not None\n"
        "x: list[float] = [points[0, 0] for points in r.contacts]\n"
        "base = crumple.World([crumple.Shape(v, f, name='arm'), (v, f)], worlds=[0, -1], names=['arm', 'wall'])\n"
        "found: crumple.Intersections = crumple.Detector().find(base, crumple.IntersectionQuery(output='any'))\n"
        "many = base.configurations(np.zeros((9, 1, 3, 4)))\n"
        "detector = crumple.Detector()\n"
        "hit: bool = detector.intersections(many, output='count').world_hit.dtype == np.bool_\n"
        "of_part: crumple.Intersections = detector.find(detector.partition((v, f), count=1)[0])\n"
        "impacts: crumple.Impacts = detector.impacts(v, v, f, min_distance=0.1, output='first')\n"
        "first = detector.find(base.at(None, np.zeros((2, 3, 4))), crumple.FirstImpactQuery())\n"
        "toi: float | None = None if first is None else first.toi\n"
        "free: bool = not detector.any(crumple.Mesh(v, f).moving_to(v), crumple.ImpactQuery())\n"
        "share: float = detector.free_step(v, v, f, min_distance=0.1).share\n"
        "near: crumple.Proximities = detector.find(many, crumple.ProximityQuery(radius=0.1))\n"
        "touching: bool = near.vertex_face_touching.dtype == np.bool_\n"
        "apart: bool = detector.distances(many, radius=1).distance.dtype == np.float64\n"
        "kind: str = 'none' if impacts.first is None else impacts.first.kind\n"
        "why: str = crumple.Detector().fallback or crumple.list_devices().reason\n"
    )
    checked = run("-m", "mypy", "--strict", str(program), cwd=tmp_path)
    assert checked.returncode == 0, checked.stdout
    for wrong in (
        "IntersectionQuery(neighbours='none')",
        "ImpactQuery(output='contacts')",
        "ProximityQuery(radius='1')",
        "PairFilter(bodies='some')",
        "Detector().find([], 'pairs')",
    ):
        program.write_text(f"import crumple\ncrumple.{wrong}\n")
        checked = run("-m", "mypy", "--strict", str(program), cwd=tmp_path)
        assert "arg-type" in checked.stdout or "call-overload" in checked.stdout


def test_names_in_all_and_their_own_methods_have_docstrings():
    for name in set(crumple.__all__) - {"__version__"}:
        thing = getattr(crumple, name)
        assert inspect.getdoc(thing), name
        if inspect.isclass(thing) and thing.__module__.startswith("crumple"):
            for member, value in vars(thing).items():
                if not member.startswith("_") and (callable(value) or isinstance(value, (property, classmethod))):
                    assert inspect.getdoc(getattr(thing, member)), f"{name}.{member}"


def test_first_use_without_numpy_raises_an_import_error_that_names_it():
    code = "import sys; sys.modules['numpy'] = None; import crumple; crumple.Detector().intersections([], [])"
    process = run("-c", code)
    assert process.returncode == 1 and "ImportError" in process.stderr and "numpy" in process.stderr


def test_import_does_not_import_numpy():
    """Not even NumPy is imported before it is needed. benchmarks/one_process.py measures the time of imports."""
    modules = run("-c", "import crumple, sys; print(*sys.modules)", check=True).stdout.split()
    assert "crumple" in modules
    assert not {"numpy", "pyvista", "trimesh", "meshio", "open3d", "torch"} & set(modules)
