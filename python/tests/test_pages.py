"""Tests that the programs in README.md and docs/start_*.md run unchanged and print the output shown on the page."""

import re

import pytest

from pages import PAGES, TOP, Program, programs, run, without_times

pytestmark = pytest.mark.installed

STARTS = ("cloth", "cpp", "printing", "research", "robots")
PROGRAMS = [program for page in PAGES for program in programs(page)]
# C++ is built and compared by tests/docs, with CMake.
HERE = [program for program in PROGRAMS if program.language != "cpp"]


def name_of(program):
    return f"{program.page.name}: {program.text.splitlines()[0]}"


def heading_anchors(page):
    """Returns the anchors of all headings of a page, in the form in which GitHub makes them."""
    headings = re.findall(r"^#+ (.*)$", page.read_text(), flags=re.M)
    return {re.sub(r"[^\w -]", "", heading.lower()).replace(" ", "-") for heading in headings}


def test_readme_and_start_pages_have_programs_with_their_output():
    assert [page.stem for page in PAGES] == ["README", *(f"start_{name}" for name in STARTS)]
    assert {program.page for program in PROGRAMS} == set(PAGES)
    for program in PROGRAMS:
        assert program.prints, f"{name_of(program)}: no output below it"
    in_cpp = [name_of(program) for program in PROGRAMS if program.language == "cpp"]
    assert in_cpp == ["README.md: #include <cstdio>", "start_cpp.md: #include <cstdio>"]


def test_commands_of_the_figures_of_the_paper_run(tmp_path):
    """Runs them on fewer triangles, because simulated scenes of the usual size take minutes."""
    page = TOP / "docs" / "start_research.md"
    rows = re.findall(r"^\| (\d) \| [^|]*\| `([^`]*)` \|", page.read_text(), flags=re.M)
    assert [int(number) for number, _ in rows] == list(range(1, 9))
    commands = ["export XDG_CACHE_HOME=$PWD", "crumple make cloth --triangles 2000 -o cloth.ply"]
    commands += [re.sub(r"--scene \w+", r"\g<0> --triangles 300", command) for _, command in rows]
    done = run(Program(page, "sh", "\n".join(commands), None), tmp_path)
    assert done.returncode == 0, done.stdout
    assert "pairs may be missing" in done.stdout
    for _, command in rows:
        (output,) = re.findall(r"-o (\S+)", command)
        assert (tmp_path / output).stat().st_size > 0, command


def test_readme_links_to_each_start_page():
    text = (TOP / "README.md").read_text()
    for page in PAGES[1:]:
        assert f"(docs/{page.name})" in text


@pytest.mark.parametrize("program", HERE, ids=name_of)
def test_python_or_shell_program_prints_the_output_on_its_page(program, tmp_path):
    done = run(program, tmp_path)
    assert done.returncode == 0, done.stdout
    assert without_times(done.stdout) == without_times(program.prints)


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_targets_of_local_links_and_pictures_exist(page):
    links = re.findall(r"\]\(([^)#:]*)(?:#([^):]*))?\)", page.read_text())
    assert links
    for target, anchor in links:
        path = page.parent / target if target else page
        assert path.exists(), f"{page.name} leads to {path}, which is not there"
        assert not anchor or anchor in heading_anchors(path), f"{page.name}: {target} has no #{anchor}"
