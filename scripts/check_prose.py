#!/usr/bin/env python3
"""Checks words: how comments begin, terms in names and prose, names with two meanings, and spelling.

    scripts/check_prose.py               prints each failed check; exit status 1 if there is any
    scripts/check_prose.py --counts      prints the hits of each check that has some, as lines of REMAINING
    scripts/check_prose.py --hits NAME   prints where these hits are
    scripts/check_prose.py --lower       lowers the numbers of REMAINING to the current numbers of hits
    scripts/check_prose.py --self-test   shows that every check can fail

A check fails if it has more hits than REMAINING allows (none, if it is not listed there). REMAINING counts names and words that are
still to be replaced; its numbers may only fall.
"""

import re
import shutil
import subprocess
import sys
import tempfile
from collections import defaultdict
from functools import cached_property
from pathlib import Path

REMAINING = {
    "names: query, request": 2,
    "words: query, request": 4,
    "names: result, report, return": 5,
    "words: result, report, return": 9,
    "names: on_host, on_device": 2,
    "names: upload, download, bind, refresh": 5,
    "words: upload, download, bind, refresh": 1,
    "names: cached": 6,
    "names: deliver, consume": 2,
    "names: local mesh": 1,
    "names: message batches": 1,
    "names: collective error check": 2,
    "words: collective error check": 6,
    "names: capacity, reserve, grow": 1,
    "names: arena layout": 2,
    "names: in flight, complete, synchronize": 3,
    "names: representative vertex": 3,
    "names: codimensional": 2,
    "names: trajectory, swept volume": 1,
    "names: time samples, t0 and t1": 3,
    "words: time samples, t0 and t1": 4,
    "names: static, discrete, rest shape, unposed": 3,
    "names: minimum distance, separating direction": 3,
    "names: inflated box": 1,
    "words: inflated box": 1,
    "names: pair filter": 5,
    "names: unresolved": 2,
    "names: float32 filter, double-double filter, exact": 10,
    "names: extent": 3,
    "files with one name": 1,
}

# Words with which comments should not begin, and the share of all comments that may do so.
BAD_HEADS = set("what of those who whether which that".split())
BAD_HEADS_SHARE = 0.003

# (term to write, forbidden parts of names, forbidden words of comments and documentation), the last two as regular expressions or
# None. A name is matched in lower case, its parts between underscores: `_make_room_` for makeRoom, make_room_ and MAKE_ROOM.
TERMS = [
    ("query, request", "questions?|asks?|asked", "questions?|asks?|asked|asking"),
    ("result, report, return", "answers?|answered|tells?|told|says?|said", "answers?|answered|answering|tells?|told"),
    ("on_host, on_device", "here|there", None),
    ("upload, download, bind, refresh", "brings?|brought|adopts?|adopted|looks?|seen|knows?", "brings?|brought|adopts?"),
    ("cached", "known|kept|remembers?|remembered|held", "remembers?|remembered"),
    ("deliver, consume", "takes?|taken|hand_over", "hands? over|handed over"),
    ("local mesh", "(?:mesh|world|borrowed|add|bind)_share|share_(?:of|out|scene)", "ranks?'s? shares?|its share of"),
    ("distributed directory", "books?", "book keepers?|(?:the|owner's) books?"),
    ("message batches", "rounds|(?:begin|in)_rounds?|round_(?:bytes|count)", None),
    ("collective error check", "agree|agreements?", "agreements?"),
    ("capacity, reserve, grow", "rooms?|roomy", "roomy|makes? room|no room|room for"),
    ("arena layout", "lay_out|laid_out|cutter|cut_lists", "lays? out"),
    ("warm start", "guides?|guided", "guides?|guided"),
    ("in flight, complete, synchronize", "flights|lands?|landed|settles?|settled|turns?",
     "flights|lands?|landed|settles?|settled|take turns|its turn"),
    ("low_memory", "frugal", "frugal"),
    ("proxy triangle", "carriers?", "carriers?"),
    ("representative vertex", "renames?|renamed", None),
    ("codimensional", "listed_(?:features|kinds|tests|view|points|count)|(?:is|filter|of)_listed", "listed (?:edges|points|features)"),
    ("trajectory, swept volume", "ways?", "whole ways?|(?:its|their) ways?|on the way"),
    ("time samples, t0 and t1", "moments?", "moments?"),
    ("static, discrete, rest shape, unposed", "at_rest|resting|step_or_rest|everywhere", "at rest|resting"),
    ("minimum distance, separating direction", "separations?", "separations?"),
    ("inflated box", "grown", "grown"),
    ("pair filter", "wants?|wanted|rules?", "wants?|wanted"),
    ("adjacent triangles", "(?:are|drop|find|knows|skip)_neighbours", None),
    ("unresolved", "beyond", None),
    ("float32 filter, double-double filter, exact", "quick|close_separation|rational_.*", None),
    ("reference, counterpart", "yardsticks?|twins?", "yardsticks?|twins?"),
    ("batched clear", "clearing", "clearing"),
    ("extent", "reach|reaches", None),
    ("a subject, a verb and an object", None,
     "has it done|whoever|of one that|of those that|for those who|for who|to who|who asks|lets? be|let be|will do|be there none|"
     "nobody's business|none but|over and over|speaks?"),
    ("British spelling", None,
     r"(?:behavior|favor|honor|neighbor)\w*|gray|center(?:s|ed)?|(?:initial|normal|optim|recogn|serial)iz(?:e|es|ed|ing|ation)"),
]
# Names that may contain a word that TERMS forbids, since they use it in another meaning or are known to users.
FINE = set("""EdgeMoment HWY_WANT_AVX3_DL Held expansion_rule held integer_turn plane_turn rational_contacts rational_tests take_result turn_at
    turn_between turn_error turn_sign turn_slack turn_to_coordinates turn_to_edges turns_back""".split())

NAMED = "include src cli scenes python/crumple python/src".split()  # folders whose names are checked
COMMENTED = "include src cli scenes python cuda_on_cpu benchmarks examples scripts tests".split()
HEADED = "include src cli python cuda_on_cpu benchmarks examples scripts".split()  # folders whose comments' heads are checked
CPP = {".h", ".cpp", ".cu", ".cuh"}
CHECKED_CPP = "include src cli scenes".split()  # folders whose files and types are checked

# Match comments, as group 1, and strings, because text inside a string may look like a comment.
QUOTED = r'"(?:\\.|[^"\\\n])*"'
CHARACTERS = r"'(?:\\.|[^'\\\n])*'"
IN_CPP = re.compile(rf'(//[^\n]*|/\*.*?\*/)|R"(\w*)\(.*?\)\2"|{QUOTED}|(?<![0-9A-Fa-f]){CHARACTERS}', re.DOTALL)
IN_PYTHON = re.compile(rf'(#[^\n]*|^[ \t]*r?""".*?""")|""".*?"""|{QUOTED}|{CHARACTERS}', re.DOTALL | re.MULTILINE)
IN_SHELL = re.compile(rf"((?<!\S)#[^\n]*)|{QUOTED}|{CHARACTERS}", re.DOTALL)
CODE_IN_PAGES = re.compile(r"^```.*?^```|`[^`\n]*`", re.DOTALL | re.MULTILINE)
MARKS = re.compile(r'^\s*(?://[/!]?<?|#!?|/?\*+/?|r?""")|"""$|\*/$', re.MULTILINE)

# Matches definitions of types at namespace level, which start in the first column in this project.
TYPE = re.compile(r"^(?:template ?<[^;{]*>\s*)?(?:struct|class|enum class) (?:alignas\(\w+\) )?(?:CRUMPLE_API )?(\w+)(?: final)?"
                  r"(?:\s*:(?!:)[^;{]*)?\s*\{", re.MULTILINE)

root = Path(__file__).resolve().parent.parent


class Tree:
    """Sources and documentation below a folder."""

    def __init__(self, root):
        self.root = root

    def files(self, folders, suffixes):
        return sorted(path for folder in folders for path in (self.root / folder).rglob("*") if path.suffix in suffixes)

    def place(self, path):
        return path.relative_to(self.root).as_posix()

    def folder(self, path):
        """Returns the folder of a file, with `*` for the name of the backend in folders of backends."""
        return re.sub("^src/backends/(?:reference|cpu|cuda)/", "src/backends/*/", f"{self.place(path.parent)}/")

    @cached_property
    def sources(self):
        """Maps each file to (its code without comments and strings, its comments as a list of (line, text))."""
        sources = {}
        for path in self.files(COMMENTED, CPP | {".py", ".sh", ".txt"}):
            if path.suffix == ".txt" and path.name != "CMakeLists.txt":
                continue
            text = path.read_text()
            pattern = IN_CPP if path.suffix in CPP else IN_PYTHON if path.suffix == ".py" else IN_SHELL
            lines = []
            for found in pattern.finditer(text):
                if found[1]:
                    start = text.rfind("\n", 0, found.start()) + 1
                    alone = not text[start : found.start()].strip()
                    lines.append((text.count("\n", 0, found.start()) + 1, found.start() - start, alone, found[1]))
            sources[self.place(path)] = pattern.sub(lambda found: "\n" * found[0].count("\n") + " ", text), joined(lines)
        return sources

    @cached_property
    def prose(self):
        """Comments, and pages of documentation without their code, as (file, line, text)."""
        prose = [(file, line, text) for file, (_, comments) in self.sources.items() for line, text in comments]
        for path in [*self.root.glob("*.md"), *self.files(["docs", *COMMENTED], {".md"})]:
            prose.append((self.place(path), 1, CODE_IN_PAGES.sub(lambda code: "\n" * code[0].count("\n"), path.read_text())))
        return prose

    @cached_property
    def names(self):
        """Maps each name in code or of a file, written in the form that TERMS matches, to one place that has it."""
        names = defaultdict(set)
        for file, (code, _) in self.sources.items():
            if file.startswith(tuple(f"{folder}/" for folder in NAMED)):
                for name in {Path(file).stem, *re.findall(r"\b[A-Za-z_]\w*", code)} - FINE:
                    parts = re.sub("([a-z0-9])([A-Z])", r"\1_\2", re.sub("([A-Z]+)([A-Z][a-z])", r"\1_\2", name))
                    names[f"_{parts.lower().strip('_')}_"].add(f"{file}: {name}")
        return {parts: min(places) for parts, places in names.items()}


def joined(lines):
    """Returns comments as (line, text): comments on lines of their own that follow each other are one."""
    comments, last = [], None
    for line, column, alone, text in lines:
        text = MARKS.sub("", text).strip()
        if alone and last == (line - 1, column):
            comments[-1][1] += "\n" + text
        else:
            comments.append([line, text])
        last = (line, column) if alone else None
    return [(line, text) for line, text in comments if text]


def check_heads(tree):
    """Yields the name of this check and the comments that begin with a word of BAD_HEADS, if BAD_HEADS_SHARE is exceeded."""
    comments = [(f"{file}:{line}", text) for file, (_, comments) in tree.sources.items()
                if file.split("/")[0] in HEADED for line, text in comments]
    bad = [f"{place}: {text.splitlines()[0]}" for place, text in comments
           if (head := re.match("[A-Za-z]+", text)) and head[0].lower() in BAD_HEADS]
    if len(bad) > BAD_HEADS_SHARE * len(comments):
        yield "heads of comments", bad


def place_of(file, line, text, found):
    around = " ".join(text[max(0, found.start() - 30) : found.end() + 30].split())
    return f"{file}:{line + text.count(chr(10), 0, found.start())}: {around}"


def check_terms(tree):
    for write, in_names, in_words in TERMS:
        if in_names:
            pattern = re.compile(f"_(?:{in_names})_")
            yield f"names: {write}", [place for parts, place in tree.names.items() if pattern.search(parts)]
        if in_words:
            pattern = re.compile(rf"\b(?:{in_words})\b".replace(" ", r"\s+"), re.IGNORECASE)
            yield f"words: {write}", [place_of(file, line, text, found) for file, line, text in tree.prose
                                      if file != "CHANGELOG.md" for found in pattern.finditer(text)]


def check_files(tree):
    """Yields the name of this check and the base names that files of several folders share.

    A public header and its source may share a name, and so may files for the same step in several backends.
    """
    folders = defaultdict(set)
    for path in tree.files(CHECKED_CPP, CPP):
        folders[path.stem].add(tree.folder(path))
    for name, places in folders.items():
        if all(place.startswith("src/") for place in places - {"include/crumple/"}) and len(places) == 2:
            places.discard("include/crumple/")
    yield "files with one name", [f"{name}: {', '.join(sorted(places))}" for name, places in folders.items() if len(places) > 1]


def check_types(tree):
    """Yields the name of this check and the names of types that are defined in several folders.

    Types for the same step in several backends may share a name.
    """
    folders = defaultdict(set)
    for path in tree.files(CHECKED_CPP, CPP):
        for name in TYPE.findall(path.read_text()):
            folders[name].add(tree.folder(path))
    yield "types with one name", [f"{name}: {', '.join(sorted(places))}" for name, places in folders.items() if len(places) > 1]


def check_spelling(tree):
    """Yields the name of this check and misspelt words of comments and documentation, by codespell and .codespellrc."""
    if not shutil.which("codespell"):
        sys.exit("check_prose.py: codespell is missing; scripts/install_dependencies.sh --tests installs it")
    with tempfile.NamedTemporaryFile("w", suffix=".txt") as file:
        lines = [(f"{source}:{first + i}", line) for source, first, text in tree.prose for i, line in enumerate(text.split("\n"))]
        file.writelines(f"{line}\n" for _, line in lines)
        file.flush()
        found = subprocess.run(["codespell", file.name], cwd=root, capture_output=True, text=True).stdout
    hits = [line.removeprefix(f"{file.name}:").split(": ", 1) for line in found.splitlines()]
    yield "spelling", [f"{lines[int(number) - 1][0]}: {words}" for number, words in hits]


def hits_in(tree):
    """Returns the hits of each check, by its name."""
    checks = check_heads, check_terms, check_files, check_types, check_spelling
    return {name: hits for check in checks for name, hits in check(tree)}


def table(counts):
    """Returns counts as the lines of REMAINING's definition."""
    return "".join(f'    "{name}": {count},\n' for name, count in counts.items())


def self_test():
    """Runs the checks on small files with known mistakes. Returns the hits of checks whose number of hits is not as expected."""
    with tempfile.TemporaryDirectory() as folder:
        for file, text in {
            "src/scene/leaves.h": "// Of one that has not.\nstruct Leaf {\n    bool make_room();\n};\n",
            "src/search/leaves.cpp": '// The carrier\'s colour.\nenum class Leaf { a, b };\nauto s = "// What";\n',
            "docs/page.md": "Whoever sees teh neighbor has\nit done `of one that`.\n",
        }.items():
            path = Path(folder, file)
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text)
        hits = hits_in(Tree(Path(folder)))
    expected = {"heads of comments": 1, "files with one name": 1, "types with one name": 1, "spelling": 1,
                "names: capacity, reserve, grow": 1, "words: proxy triangle": 1, "words: British spelling": 1,
                "words: a subject, a verb and an object": 3}
    return {name: hits[name] for name in hits if len(hits[name]) != expected.get(name, 0)}


def main(option="", name=""):
    if option == "--self-test":
        wrong = self_test()
        print("\n".join(f"{name}: {hits}" for name, hits in wrong.items()), end="\n" if wrong else "")
        return 1 if wrong else 0
    hits = hits_in(Tree(root))
    if option == "--hits":
        print("\n".join(hits[name]))
        return 0
    counts = {name: len(places) for name, places in hits.items() if places}
    if option == "--counts":
        print(table(counts), end="")
        return 0
    if option == "--lower":
        lowered = {name: min(count, REMAINING[name]) for name, count in counts.items() if name in REMAINING}
        script = Path(__file__)
        script.write_text(script.read_text().replace(table(REMAINING), table(lowered)))
    failed = {name: places for name, places in hits.items() if len(places) > REMAINING.get(name, 0)}
    for name, places in failed.items():
        print(f"{name}: {len(places)} hits, at most {REMAINING.get(name, 0)} may remain (check_prose.py --hits '{name}')")
        if name not in REMAINING:
            print("\n".join(f"    {place}" for place in places))
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
