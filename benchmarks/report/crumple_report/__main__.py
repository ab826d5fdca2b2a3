"""crumple-report: plots, and the tables of README.md and docs/, from benchmarks/results/*.json.

Plots have the same bytes only with the pinned version of matplotlib. With other versions they are not compared.
"""

import argparse
import importlib.metadata
import sys
import tempfile
import tomllib
from pathlib import Path

from . import appendix, blocks, device_tables, tables  # noqa: F401: their blocks register themselves
from .results import COMMITTED, TOP, Results

IMAGES = TOP / "docs/images/benchmarks"
# Page whose findings are written by hand. It names the commit of the figures that it is about.
FINDINGS = TOP / "docs/benchmarks.md"


def pinned():
    """Maps each package that plots need to its pinned version."""
    project = tomllib.loads((Path(__file__).parents[1] / "pyproject.toml").read_text())["project"]
    return dict(requirement.split("==") for requirement in project["optional-dependencies"]["plots"])


def missing_for_plots():
    """Returns why plots cannot be reproduced, or None."""
    for package, version in pinned().items():
        try:
            here = importlib.metadata.version(package)
        except importlib.metadata.PackageNotFoundError:
            return f"{package} is not installed"
        if here != version:
            return f"{package} is {here}, plots are made with {version}"
    return None


def draw(results, folder):
    """Draws every plot for which there are figures, for light and for dark pages."""
    from . import bars, drawings, plots, style  # noqa: F401: their plots register themselves

    for name, function in style.PLOTS.items():
        for theme in style.THEMES:
            style.apply(theme)
            figure = function(results, theme)
            if figure is not None:
                style.save(figure, folder / f"{name}-{theme.name}.svg")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--results", type=Path, default=COMMITTED, help="figures (default: the committed ones)")
    parser.add_argument("--check", action="store_true", help="change nothing; fail if something would change")
    only = parser.add_mutually_exclusive_group()
    only.add_argument("--tables", action="store_true", help="tables alone: needs no packages")
    only.add_argument("--plots", action="store_true", help="plots alone")
    only.add_argument("--pictures", metavar="BENCHMARK", help="rendered pictures alone, by this crumple_benchmark")
    arguments = parser.parse_args()
    results = Results(arguments.results)
    if arguments.pictures:
        from .pictures import draw_pictures

        return draw_pictures(IMAGES, arguments.pictures)

    stale = [] if arguments.plots else tables_anew(results, arguments.check)
    if not arguments.tables:
        reason = missing_for_plots()
        if not reason:
            stale += plots_anew(results, arguments.check)
        elif arguments.check:
            print(f"SKIPPED: plots are not compared: {reason}")
        else:
            sys.exit(f"{reason}; scripts/report.sh installs what is needed")
    if stale and arguments.check:
        names = ", ".join(str(path.relative_to(TOP)) for path in stale)
        sys.exit(f"these files do not match the committed figures: {names}; run scripts/report.sh")
    for path in stale:
        print(path.relative_to(TOP))
    commit = results.data["commit"][:12]
    if not arguments.plots and f"`{commit}`" not in FINDINGS.read_text():
        sys.exit(f"{FINDINGS.relative_to(TOP)} does not name {commit}, the commit of the figures: compare its findings with them, then name that commit")


def tables_anew(results, check):
    """Returns the pages whose tables are out of date, and rewrites them unless `check`."""
    stale = []
    for path, text in blocks.pages(results):
        if path.read_text() != text:
            stale.append(path)
            if not check:
                path.write_text(text)
    return stale


def plots_anew(results, check):
    """Draws all plots; returns those that differ from the existing files, and replaces these unless `check`."""
    with tempfile.TemporaryDirectory() as folder:
        draw(results, Path(folder))
        fresh = {path.name: path.read_bytes() for path in Path(folder).iterdir()}
    stale = []
    IMAGES.mkdir(parents=True, exist_ok=True)
    for old in IMAGES.glob("*.svg"):
        if old.name not in fresh:
            stale.append(old)
            if not check:
                old.unlink()
    for name, content in sorted(fresh.items()):
        path = IMAGES / name
        if not path.exists() or path.read_bytes() != content:
            stale.append(path)
            if not check:
                path.write_bytes(content)
    return stale


if __name__ == "__main__":
    main()
