"""Prints the licences of third-party code in a build, as one text: of the headers that its files include and of the
shared libraries that its programs load, taken from Debian's and PyPI's packages.

    python3 licences.py BUILD ELF...

BUILD is a CMake build folder, built by Ninja, that contains each ELF.
"""

import functools
import re
import subprocess
import sys
from pathlib import Path

from debian_copyright import concerning

INCLUDE = Path("/usr/include")
LONG = 100_000  # characters; if only headers of a package are used, a longer text is shortened to paragraphs about them

# Packages whose licences are not printed: libraries and headers of glibc, GCC and Linux, which every system has and
# which programs may use freely by exceptions in their licences.
SYSTEM = ("libc6", "libgcc", "libstdc++", "gcc-", "linux-libc-dev", "libcrypt-dev")


def output(*command) -> str:
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout


def headers(build: Path) -> set[Path]:
    """Returns the files outside of the project that compilers have read, by Ninja's record, but not Python's headers."""
    source = next(
        Path(line.split("=", 1)[1])
        for line in (build / "CMakeCache.txt").read_text().splitlines()
        if line.startswith("CMAKE_HOME_DIRECTORY:")
    )
    lines = output("ninja", "-C", str(build), "-t", "deps").splitlines()
    read = {(build / line.strip()).resolve() for line in lines if line[:1] == " "}  # unindented lines name targets
    read = {path for path in read if not re.search(r"/include/python3\.\d+/", str(path))}  # Python's own headers
    sites = {path for path in read if "site-packages" in path.parts}  # may lie within the project's folder
    return sites | {path for path in read if not path.is_relative_to(source.resolve())}


def libraries(elf: Path) -> set[Path]:
    lines = [line.split() for line in output("ldd", str(elf)).splitlines() if "=>" in line]
    missing = [line[0] for line in lines if line[2] == "not"]
    if missing:
        sys.exit(f"licences.py: {elf} needs libraries that are missing: {', '.join(missing)}")
    return {Path(line[2]) for line in lines}


@functools.cache
def owners() -> dict[str, str]:
    """Returns the Debian package of each installed file; paths omit /usr, since a merged /usr gives files two paths."""
    found = {}
    for listing in Path("/var/lib/dpkg/info").glob("*.list"):
        package = listing.stem.split(":")[0]
        for line in listing.read_text().splitlines():
            found[line.removeprefix("/usr")] = package
    return found


def debian_package(path: Path) -> str | None:
    for name in (path, path.resolve()):
        if package := owners().get(str(name).removeprefix("/usr")):
            return package
    return None


def distribution(path: Path) -> Path | None:
    """Returns the metadata folder of the PyPI package that a file in site-packages belongs to."""
    if "site-packages" not in path.parts:
        return None
    site = Path(*path.parts[: path.parts.index("site-packages") + 1])
    name = path.relative_to(site).parts[0]
    return next(iter(sorted(site.glob(f"{name}-*.dist-info"))), None)


def embedded(path: Path) -> tuple[str, str] | None:
    """Returns (NAME, first comment) of a header in ext/NAME, where a PyPI package bundles another project; else None.

    The first comment of such a header contains its licence.
    """
    if "site-packages" not in path.parts or "ext" not in path.parts:
        return None
    comment = re.match(r"\s*/\*(.*?)\*/", path.read_text(), re.S)
    text = re.sub(r"^ ?\*+ ?", "", comment[1], flags=re.M) if comment else ""
    return path.parts[path.parts.index("ext") + 1], text


def toolkit(path: Path) -> Path | None:
    """Returns the folder of the CUDA toolkit that contains a header, however it was installed."""
    return next((folder for folder in path.parents if (folder / "bin" / "nvcc").exists()), None)


def toolkit_licence(folder: Path) -> str:
    """Returns the toolkit's licence. NVIDIA's installer has one text for everything; its PyPI packages have one each,
    of which those of the CUDA runtime and of CCCL (headers) apply."""
    files = [folder / "EULA.txt"]
    for part in ("cuda_runtime", "cuda_cccl"):
        files += sorted(folder.glob(f"dist-info/nvidia_{part}-*/licenses/*"))
    return "\n\n".join(file.read_text() for file in files if file.is_file())


def is_licence(path: Path) -> bool:
    return path.is_file() and path.name.upper().startswith(("LICENSE", "LICENCE", "COPYING"))


def texts(paths: set[Path]) -> dict[str, str]:
    """Maps the name of each package that one of the files belongs to, to its licence. Exits if a licence is unknown."""
    found, strangers = {}, []
    of_package: dict[str, list[Path]] = {}
    for path in sorted(paths):
        package = debian_package(path)
        if carried := embedded(path):
            found.setdefault(*carried)
        elif metadata := distribution(path):
            name = metadata.name.removesuffix(".dist-info")
            if name not in found:
                files = [*filter(is_licence, sorted(metadata.rglob("*")))]
                found[name] = "\n\n".join(file.read_text() for file in files)
        elif package is None and (folder := toolkit(path)):
            if "CUDA toolkit" not in found:
                found["CUDA toolkit"] = toolkit_licence(folder)
        elif package is None:
            strangers.append(str(path))
        elif not package.startswith(SYSTEM):
            of_package.setdefault(package, []).append(path)
    for package, files in of_package.items():
        text = (Path("/usr/share/doc") / package / "copyright").read_text()
        if len(text) > LONG and all(file.is_relative_to(INCLUDE) for file in files):
            text = concerning(text, [str(file.relative_to(INCLUDE)) for file in files])
        found[package] = text
    empty = [name for name, text in found.items() if not text.strip()]
    if strangers or empty:
        sys.exit("licences.py: no licence is known for " + ", ".join(strangers[:5] + empty))
    return found


def third_party_licences(build: Path, elves: list[Path]) -> str:
    paths = headers(build).union(*map(libraries, elves))
    # Prints equal texts once: packages made from one source, such as libfmt9 and libfmt-dev, share one text.
    names: dict[str, list[str]] = {}
    for name, text in texts(paths).items():
        names.setdefault(text.strip(), []).append(name)
    rule = "=" * 78
    parts = [f"{rule}\n{', '.join(who)}\n{rule}\n\n{text}\n" for text, who in sorted(names.items(), key=lambda x: x[1])]
    return "Crumple contains or uses code of these packages, under their licences:\n\n" + "\n".join(parts)


if __name__ == "__main__":
    print(third_party_licences(Path(sys.argv[1]), [Path(name) for name in sys.argv[2:]]), end="")
