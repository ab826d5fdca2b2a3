"""`python -m crumple`, and `crumple` on the path: the C++ command line, which is part of the package."""

from __future__ import annotations

import os
import sys
from pathlib import Path


def main() -> None:
    """Replaces this process by the command line, so that exit status, signals and pipes are its own."""
    program = str(Path(__file__).with_name("crumple"))
    if not os.access(program, os.X_OK):
        sys.exit(f"crumple: the command line is missing from this installation: {program}")
    os.execv(program, ["crumple", *sys.argv[1:]])


if __name__ == "__main__":
    main()
