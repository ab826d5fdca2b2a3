#!/usr/bin/env python3
"""Checks the layers of src/ (ARCHITECTURE.md, Folders), the order of the Python package's modules, and the size of folders.

LAYERS lists the layers from bottom to top. A file may include files of its own layer and of lower ones; backends must not
include each other. A Python module may import only modules that precede it in MODULES, even inside functions and for type
annotations; UPWARDS has the exceptions. Folders contain at most 40 files. Prints each breach; exit status 1 if there are any.
"""

import ast

import re
import sys
from pathlib import Path

LAYERS = "base geometry exact scene partition queries filters results backends search detector distributed io checks".split()
BACKENDS = "reference cpu cuda".split()
MOST_FILES = 40  # per folder below TOPS
TOPS = "include src cli scenes".split()
MODULES = """__main__ _core _mpi _errors _versions _arrays _queries _rigid_motion _mesh _world_arrays _world _results _drawing _overlaps _intersections
    _features _feature_pairs _clustering _scene _stencils _pickle_checks _pickles _device _detector _files _checks _ranks mpi __init__""".split()
UPWARDS = {
    ("_results", "_pickles"),  # imported inside functions that pickle and copy call, after all modules
    ("_device", "_detector"),  # imported for type annotations only
}
SUFFIXES = {".h", ".cpp", ".cu"}

root = Path(__file__).resolve().parent.parent


def sources(folder):
    return sorted(path for path in (root / folder).rglob("*") if path.suffix in SUFFIXES)


def includes():
    """Yields (file, included file) of src/, as paths relative to src/."""
    for path in sources("src"):
        file = path.relative_to(root / "src")
        for name in re.findall(r'^#include "([^"]+)"', path.read_text(), re.MULTILINE):
            if (root / "src" / name).exists():
                yield file, Path(name)


def breach_of_layers(file, included):
    if LAYERS.index(included.parts[0]) > LAYERS.index(file.parts[0]):
        return f"src/{file} includes {included}, of a higher layer"
    both = [path.parts[1] for path in (file, included) if path.parts[0] == "backends" and path.parts[1] in BACKENDS]
    if len(set(both)) == 2:
        return f"src/{file} includes {included}, of another backend"
    return None


def breaches_of_modules():
    """Yields imports in python/crumple/*.py of modules that do not precede the importing module in MODULES."""
    package = root / "python" / "crumple"
    for path in sorted(package.glob("*.py")):
        if path.stem not in MODULES:
            yield f"python/crumple/{path.name} is not in the order of modules in scripts/check_layers.py"
            continue
        before = MODULES[: MODULES.index(path.stem)]
        for node in ast.walk(ast.parse(path.read_text())):
            if not isinstance(node, ast.ImportFrom) or not node.level:
                continue
            for module in [node.module] if node.module else [alias.name for alias in node.names]:
                if module not in before and (path.stem, module) not in UPWARDS:
                    yield f"python/crumple/{path.name}:{node.lineno} imports {module}, which does not come before"


def breaches_of_size():
    for folder in sorted({path.parent for top in TOPS for path in sources(top)}):
        count = sum(path.is_file() for path in folder.iterdir())
        if count > MOST_FILES:
            yield f"{folder.relative_to(root)} has {count} files, more than {MOST_FILES}"


def main():
    breaches = [breach for file, included in includes() if (breach := breach_of_layers(file, included))]
    breaches += [*breaches_of_modules(), *breaches_of_size()]
    print("\n".join(breaches), end="\n" if breaches else "")
    return 1 if breaches else 0


if __name__ == "__main__":
    sys.exit(main())
