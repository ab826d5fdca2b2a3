"""Tests that the programs in the documentation run, section by section, and that their assertions hold."""

import re
import subprocess
from pathlib import Path

import pytest

from conftest import peer

DOCS = Path(__file__).parents[2] / "docs"


def sections(page):
    """Yields (page, heading, programs) for each section with programs. A page's first one runs before all others."""
    text = (DOCS / page).read_text()
    for part in re.split(r"^## ", text, flags=re.M):
        programs = re.findall(r"^```python\n(.*?)^```", part, flags=re.M | re.S)
        if programs:
            yield page, part.splitlines()[0], programs


PAGES = (
    "python.md",
    "python_coming_from.md",
    "worlds.md",
    "nearness.md",
    "given_pairs.md",
    "coming_from_ipc_toolkit.md",
    "robots.md",
)
SECTIONS = [section for page in PAGES for section in sections(page)]


def test_comparison_tables_show_both_programs_side_by_side():
    """The program for another package is on the left, ours on the right, in one row of a table that GitHub can show."""
    text = (DOCS / "python_coming_from.md").read_text()
    row = r"<tr><td>\n\n```python\n(.*?)```\n\n</td><td>\n\n```python\n(.*?)```\n\n</td></tr>"
    rows = re.findall(row, text, flags=re.S)
    assert len(rows) == text.count("<table>") == text.count("</table>") >= 9
    for theirs, ours in rows:
        assert "theirs" in theirs and "detector." not in theirs and "ours = detector." in ours and "assert" in ours
        assert max(map(len, (theirs + ours).splitlines())) <= 60, "two columns fit the page"
    for package in ("IPC Toolkit", "libigl", "trimesh", "MeshLib", "trueform", "FCL"):
        assert f"<th>{package}</th><th>crumple</th>" in text


def test_main_sections_of_the_documentation_have_programs():
    headings = {heading for _, heading, _ in SECTIONS}
    assert headings >= {
        "Five minutes",
        "Meshes",
        "Results",
        "Worlds",
        "Motion and nearness",
        "libigl",
        "trimesh",
        "MeshLib",
        "FCL",
    }


@pytest.mark.parametrize(
    "page, heading, programs", SECTIONS, ids=[f"{page}: {heading}" for page, heading, _ in SECTIONS]
)
def test_programs_of_main_documentation_pages_run(page, heading, programs, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    start = next(programs for other, _, programs in SECTIONS if other == page)
    for package in re.findall(r"^import (\w+)", "\n".join([*start, *programs]), flags=re.M):
        peer(package)
    names = {}
    for program in [*start, *programs]:
        exec(compile(program, f"{page}, {heading}", "exec"), names)


def test_error_message_in_python_md_is_printed_by_its_programs(capsys, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    names = {}
    promised = re.search(r"# (triangle \d+ names .*)", (DOCS / "python.md").read_text()).group(1)
    for page, heading, programs in SECTIONS:
        if page == "python.md" and heading in ("Five minutes", "Results"):
            for program in programs:
                exec(program, names)
    assert promised in capsys.readouterr().out


COMMANDS = r"(?:[A-Z_]+=\S+ )*(?:crumple|cmake|ctest|pip|apt|mpirun|srun|scripts/\S+|build\S*/\S+|nice|python3?)\b"
PAGES_OF_COMMANDS = [*sorted(DOCS.glob("*.md")), *(DOCS.parent / name for name in ("README.md", "CONTRIBUTING.md"))]


@pytest.mark.parametrize("page", PAGES_OF_COMMANDS, ids=lambda page: page.name)
def test_documented_commands_parse_in_bash_with_remarks_as_comments(page):
    """Remarks after commands begin with #, because a shell would pass anything else as an argument."""
    text = re.sub(r"^```(?!sh|bash|$).*?^```$", "", page.read_text(), flags=re.M | re.S)  # drops other languages
    for line in re.findall(rf"^(?: {{4}})?({COMMANDS}.*)$", text, flags=re.M):
        command, *remark = re.split(r" {2,}(?=\S)", line, maxsplit=1)
        assert not remark or remark[0].startswith("#"), f"{page.name}: {line}"
        assert subprocess.run(["bash", "-n", "-c", command]).returncode == 0, f"{page.name}: {line}"
