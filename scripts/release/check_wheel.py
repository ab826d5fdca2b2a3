"""Checks that finished wheels fulfil the promises of a release, and prints the size and libraries of each.

    python check_wheel.py VERSION WHEEL...

A wheel with the cuda backend may have any size, but must be marked as not to be uploaded.
"""

import re
import sys
import zipfile
from pathlib import Path

LARGEST = 9_000_000  # bytes; the extension module and the command line each contain the library
NEWEST = (2, 34)  # version of glibc that a wheel may need
# Cryptographic libraries, which other libraries may pull in. A wheel that contains one would need security updates.
UNWANTED = ("libcrypto", "libssl", "libgnutls", "libmbedcrypto")


def faults(path: Path, version: str) -> list[str]:
    found = []
    parts = path.stem.split("-")
    if path.suffix != ".whl" or len(parts) != 5 or not path.is_file():
        return [f"{path} is not a wheel"]
    _, of, _, abi, platform = parts
    cuda = "cuda" in path.name
    with zipfile.ZipFile(path) as wheel:
        files = {info.filename: info for info in wheel.infolist()}
        metadata = next(wheel.read(name).decode() for name in files if name.endswith(".dist-info/METADATA"))
        licences = {name.split("/")[-1]: wheel.read(name).decode() for name in files if "/licenses/" in name}

    def hold(condition: bool, fault: str) -> None:
        if not condition:
            found.append(f"{path.name}: {fault}")

    hold(of == version, f"its version is {of}, not {version}")
    tag = re.search(r"manylinux_(\d+)_(\d+)_", platform)
    hold(bool(tag) and tuple(map(int, tag.groups())) <= NEWEST, f"its platform is {platform}, beyond manylinux_2_34")
    hold(
        cuda or path.stat().st_size < LARGEST,
        f"it has {path.stat().st_size:,} bytes, but at most {LARGEST:,} are allowed",
    )
    libraries = sorted(name.split("/")[-1] for name in files if ".libs/" in name and not name.endswith("/"))
    hold(any(name.startswith("libtbb-") for name in libraries), "oneTBB is not in it")
    for name in libraries:
        hold(not name.startswith(UNWANTED), f"{name} is in it")
        hold(not name.startswith("libcu"), f"{name} is in it, a library of CUDA")
    for name in ("crumple/_core.pyi", "crumple/py.typed", "crumple/crumple", "crumple/__init__.py"):
        hold(name in files, f"{name} is missing")
    program = files.get("crumple/crumple")
    hold(program is not None and bool(program.external_attr >> 16 & 0o111), "the command line cannot be executed")
    hold(not abi.startswith("abi3") or "crumple/_core.abi3.so" in files, "_core is not of the stable ABI")
    hold("Apache License" in licences.get("LICENSE", ""), "the Apache licence is missing")
    hold("libtbb" in licences.get("THIRD_PARTY_LICENSES.txt", ""), "third-party licences are missing")
    hold(cuda == ("Classifier: Private :: Do Not Upload" in metadata), "only wheels with cuda are marked as private")
    print(f"{path.name}: {path.stat().st_size:,} bytes; {', '.join(libraries)}")
    return found


if __name__ == "__main__":
    wrong = [fault for name in sys.argv[2:] for fault in faults(Path(name), sys.argv[1])]
    for fault in wrong:
        print(f"check_wheel.py: {fault}", file=sys.stderr)
    sys.exit(bool(wrong))
