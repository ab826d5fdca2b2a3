"""Measures which pairs of triangles other packages miss and invent, and writes the tables of docs/misses.md.

    python benchmarks/misses_python.py [--part cases|scenes|overlaps] [--cases N] [--quick] [--page FILE]

Needs crumple's Python package; peers that are not installed are left out:

    pip install libigl meshlib open3d libusb-package pymeshlab python-fcl coal ipctk trueform manifold3d

Scenes need the data in the folder that $CRUMPLE_DATA names; missing data is left out. The tables are written between the markers of
the page; text outside the markers is kept. With --part only some tables are made anew. Parts:

    cases     pairs of triangles on small integer grids, by kind of degeneracy (miss_kinds.py, miss_cases.py)
    scenes    whole scenes, with times: peers and crumple alternate, one thread each (miss_scenes.py)
    overlaps  whether volumes of overlaps are reproducible (overlap_bits.py)
"""

import argparse
import datetime
import os
import re
from pathlib import Path

import merge_results
import miss_cases
import miss_kinds
import miss_scenes
import overlap_bits

PAGE = Path(__file__).resolve().parent.parent / "docs" / "misses.md"
QUESTIONS = {
    "between": (miss_cases.BETWEEN, [*miss_kinds.PLAIN, *miss_kinds.SCALES]),
    "self": (miss_cases.ITSELF, [*miss_kinds.PLAIN, *miss_kinds.SCALES, *miss_kinds.INDEXED]),
}
HEADS = {"between": "One triangle against another", "self": "Two triangles of one mesh"}


def machine():
    here = merge_results.machine()
    load = f"load average {os.getloadavg()[0]:.1f} at the end"
    return f"{datetime.date.today()}, {here['cpus']} cores of a shared virtual machine, {here['cpu']}, {load}"


def table(rows):
    return ["| " + " | ".join(rows[0]) + " |", "|---" * len(rows[0]) + "|", *("| " + " | ".join(row) + " |" for row in rows[1:])]


def promises(columns):
    rows = [["peer", "version", "function", "promise"]]
    rows += [[c.title, c.version, f"`{c.kind}` of `peers/{c.module}.py`", c.promise] for c in columns]
    return table(rows)


def absent(left_out):
    return ["", *(f"{title} is left out: {reason}" for title, reason in left_out.items())] if left_out else []


def smallest(column, rows):
    """Returns lines with the smallest case of each kind of failure of a peer."""
    lines = []
    for kind, _, cells in rows:
        for what, case in sorted(cells[column].smallest.items()):
            if what != "unpromised":
                lines.append(f"{column.title:16} {what:9} {kind:29} {case}")
    return lines


def cases_part(arguments):
    tables, failures = [], []
    for question, (columns, kinds) in QUESTIONS.items():
        kept, left_out = miss_cases.installed(columns)
        rows = miss_cases.judge(kept, kinds, arguments.cases)
        heads = ["kind", "collide", *(column.title for column in kept)]
        body = [[kind, f"{hits} of {arguments.cases}", *(str(cells[c]) for c in kept)] for kind, hits, cells in rows]
        tables += [f"### {HEADS[question]}", "", *promises(kept), *absent(left_out), "", *table([heads, *body]), ""]
        failures += [f"# {HEADS[question]}", *(line for c in kept for line in smallest(c, rows)), ""]
    return {"cases": tables[:-1], "smallest": ["", "```text", *failures[:-1], "```", ""]}


def scenes_part(arguments):
    lines = [f"Measured on {{machine}}. Crumple {miss_cases.BETWEEN[0].version}.", ""]
    for question, (columns, _) in QUESTIONS.items():
        kept, _ = miss_cases.installed(columns)
        rows = miss_scenes.measure(kept, question, arguments.quick)
        shown = [c for c in kept if any(c in row for _, row in rows)]
        heads = ["scene", "triangles", "pairs", *(c.title for c in shown)]
        body = [
            [scene.name, f"{scene.triangles:,}", f"{len(scene.pairs):,}", *(miss_scenes.cell(row[c]) for c in shown)]
            for scene, row in rows
        ]
        lines += [*table([heads, *body]), ""]
    lines[0] = lines[0].format(machine=machine())
    return {"scenes": lines[:-1]}


def overlaps_part(arguments):
    lines, versions = overlap_bits.table()
    names = ", ".join(f"{name} {number}" for name, number in versions.items())
    return {"overlaps": [f"Measured on {machine()}. {names}.", "", *lines]}


def fill(page, name, lines):
    """Returns the page with these lines between its markers of this name."""
    begin, end = f"<!-- misses: {name} -->", "<!-- end -->"
    filled, count = re.subn(
        f"{re.escape(begin)}.*?{re.escape(end)}", lambda _: "\n".join([begin, *lines, end]), page, flags=re.DOTALL
    )
    if count != 1:
        raise SystemExit(f"misses_python.py: the page has {count} markers '{begin}', not 1")
    return filled


PARTS = {"cases": cases_part, "scenes": scenes_part, "overlaps": overlaps_part}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--part", choices=PARTS, action="append", help="may be repeated; else all")
    parser.add_argument("--cases", type=int, default=200, help="pairs of triangles of each kind")
    parser.add_argument("--quick", action="store_true", help="few rounds and small scenes, to check that everything works")
    parser.add_argument("--page", type=Path, default=PAGE)
    arguments = parser.parse_args()
    for part in arguments.part or PARTS:
        made = PARTS[part](arguments)
        page = arguments.page.read_text()
        for name, lines in made.items():
            page = fill(page, name, lines)
        arguments.page.write_text(page)


if __name__ == "__main__":
    main()
