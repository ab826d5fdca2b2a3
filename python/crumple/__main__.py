"""Entry point of `python -m crumple` and of the script `crumple`: runs the C++ command line in the package."""

from __future__ import annotations

import os
import sys
from pathlib import Path


def main() -> None:
    """Replaces this process with the command line program, so that exit status, signals and pipes are the program's."""
    program = str(Path(__file__).with_name("crumple"))
    if not os.access(program, os.X_OK):
        sys.exit(f"crumple: the command line is missing from this installation: {program}")
    os.execv(program, ["crumple", *sys.argv[1:]])


if __name__ == "__main__":
    main()
