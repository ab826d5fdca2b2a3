"""Tests an installed wheel, by the interpreter of its environment: runs the program of docs/python.md, whose path is
the argument, and the command line, and checks that errors of C++ become Python exceptions.
"""

import re
import subprocess
import sys
import tempfile
from pathlib import Path

page = Path(sys.argv[1]).read_text()
program = re.search(r"^```python\n(.*?)^```", page, flags=re.M | re.S)[1]

with tempfile.TemporaryDirectory() as folder:
    subprocess.run([sys.executable, "-c", program], check=True, cwd=folder)
    assert (Path(folder) / "collisions.html").read_text().startswith("<!DOCTYPE html>")

    import crumple

    mesh = Path(folder) / "cloth.ply"
    command = [Path(sys.executable).with_name("crumple")]
    version = subprocess.run([*command, "--version"], check=True, capture_output=True, text=True).stdout
    assert version == f"crumple {crumple.__version__}\n", version
    subprocess.run([*command, "make", "cloth", "--triangles", "2000", "-o", mesh], check=True)
    found = subprocess.run([*command, "detect", mesh], check=True, capture_output=True, text=True).stdout
    expected = crumple.intersections(crumple.read_mesh(mesh)).pairs
    assert found == "".join(f"{a} {b}\n" for a, b in expected) and len(expected), "both find the same"
    assert "\n" not in crumple.Detector().fallback, "without a device, one line says why"
    for call, error in (
        (lambda: crumple.read_mesh("no such file.ply"), crumple.FileError),
        (lambda: crumple.intersections([[0, 0, 0]], [[0, 0, 1]]), crumple.InvalidInput),
        (lambda: crumple.Detector(memory_limit=1).intersections(crumple.read_mesh(mesh)), crumple.MemoryLimit),
    ):
        try:
            call()
            sys.exit(f"{error.__name__} was not raised")
        except error:
            pass
print(
    f"crumple {crumple.__version__} works in Python {sys.version.split()[0]}: {len(expected)} pairs; "
    f"{crumple.list_devices().reason or crumple.Detector().backend}"
)
