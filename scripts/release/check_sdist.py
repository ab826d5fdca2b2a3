"""Checks that an sdist contains everything that builds the package, and nothing else.

python check_sdist.py SDIST VERSION CHECKOUT
"""

import subprocess
import sys
import tarfile
from pathlib import Path

NEEDED = ("CMakeLists.txt", "LICENSE", "README.md", "pyproject.toml", "PKG-INFO", "include/crumple/version.h")
FOLDERS = {"cli", "cmake", "include", "python", "scenes", "src"}
LEFT_OUT = ("python/benchmarks/", "python/tests/")
LARGEST = 2_000_000  # bytes


def tracked(checkout: Path) -> list[str]:
    """Returns the files in FOLDERS that git tracks, except those in LEFT_OUT."""
    command = ["git", "-C", str(checkout), "ls-files", *sorted(FOLDERS)]
    names = subprocess.run(command, check=True, capture_output=True, text=True).stdout.splitlines()
    return [name for name in names if not name.startswith(LEFT_OUT) and (checkout / name).exists()]


def faults(path: Path, version: str, checkout: Path) -> list[str]:
    root = f"crumple-{version}"
    with tarfile.open(path) as sdist:
        names = sdist.getnames()
        about = sdist.extractfile(f"{root}/PKG-INFO").read().decode() if f"{root}/PKG-INFO" in names else ""
    found = [f"{name} is not below {root}" for name in names if name.split("/")[0] != root]
    inside = {name.removeprefix(root + "/") for name in names}
    found += [f"{name} is missing" for name in (*NEEDED, *tracked(checkout)) if name not in inside]
    folders = {name.split("/")[0] for name in inside if "/" in name}
    found += [f"{name} is in it" for name in sorted(folders - FOLDERS)]
    found += [f"{name} is in it" for name in inside if name.startswith(LEFT_OUT)]
    if f"\nVersion: {version}\n" not in about:
        found.append(f"its metadata does not have the version {version}")
    if path.stat().st_size > LARGEST:
        found.append(f"it has {path.stat().st_size:,} bytes, but at most {LARGEST:,} are allowed")
    print(f"{path.name}: {path.stat().st_size:,} bytes, {len(inside)} files")
    return found


if __name__ == "__main__":
    wrong = faults(Path(sys.argv[1]), sys.argv[2], Path(sys.argv[3]))
    for fault in wrong:
        print(f"check_sdist.py: {fault}", file=sys.stderr)
    sys.exit(bool(wrong))
