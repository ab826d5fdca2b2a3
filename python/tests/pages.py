"""Programs in README.md and docs/start_*.md that readers can copy, and the output that the pages show below each."""

from __future__ import annotations

import os
import re
import subprocess
import sys
import sysconfig
from pathlib import Path
from typing import NamedTuple

TOP = Path(__file__).parents[2]
PAGES = [TOP / "README.md", *sorted((TOP / "docs").glob("start_*.md"))]

#: A fenced block: its language, and its text.
FENCED = re.compile(r"^```(\w+)\n(.*?)^```$", flags=re.M | re.S)


class Program(NamedTuple):
    """Attributes:
    language: cpp, python or sh.
    prints: the output that the page shows for it, or None.
    """

    page: Path
    language: str
    text: str
    prints: str | None


def programs(page: Path) -> list[Program]:
    """Returns all programs of a page, in order. A program's output is the next fenced block, if that is `text`."""
    blocks = FENCED.findall(page.read_text())
    following = [*blocks[1:], ("", "")]
    return [
        Program(page, language, text, output if kind == "text" else None)
        for (language, text), (kind, output) in zip(blocks, following)
        if language in ("cpp", "python", "sh")
    ]


def run(program: Program, folder: Path) -> subprocess.CompletedProcess[str]:
    """Runs a Python or shell program in a folder, with this package's `crumple` command. Output includes errors."""
    start = {"python": [sys.executable, "-c"], "sh": ["bash", "-euo", "pipefail", "-c"]}[program.language]
    path = sysconfig.get_path("scripts") + os.pathsep + os.environ["PATH"]
    return subprocess.run(
        [*start, program.text],
        cwd=folder,
        env={**os.environ, "PATH": path},
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
    )


def without_times(text: str) -> str:
    """Returns the text with every time replaced by "? ms"."""
    return re.sub(r"\d[\d.,]* ms\b", "? ms", text)
