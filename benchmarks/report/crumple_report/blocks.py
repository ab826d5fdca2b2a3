"""Blocks of README.md and docs/ that show figures, each between `<!-- figures: NAME -->` and `<!-- end -->`. They are
generated, so that no figure of a table is typed; the text about them is written by hand. NAME may have arguments."""

import re
from statistics import median

from .results import TOP, digits

PAGES = [TOP / "README.md", *sorted((TOP / "docs").glob("*.md"))]

# Maps names to (function that makes Markdown from results and arguments, query of the contests that it shows or None,
# names of the studies that it shows).
BLOCKS = {}


def block(name, question=None, studies=()):
    """Registers a function that makes a block. The second argument is the query of the contests that the block shows.
    Without `studies`, the arguments of the block are the names of the studies that it shows."""
    def register(function):
        BLOCKS[name] = function, question, studies
        return function
    return register


def show(results, name):
    """Returns the block, with a note if other load disturbed its measurement."""
    arguments = ()
    if name not in BLOCKS:
        name, *arguments = name.split()
    function, question, studies = BLOCKS[name]
    body = function(results, *arguments)
    if not body:
        return "*Not measured in this run.*"
    busy = results.busy(question, studies or arguments)
    return body + (f"\n\n{busy}" if busy else "")


def pages(results):
    """Yields the path and the updated text of every page that shows figures."""
    pattern = re.compile(r"(<!-- figures: ([\w ]+) -->\n).*?(<!-- end -->)", re.DOTALL)
    for path in PAGES:
        text = path.read_text()
        fresh = pattern.sub(lambda match: match[1] + show(results, match[2]) + "\n" + match[3], text)
        if pattern.search(text):
            yield path, fresh


def table(header, rows):
    """Returns a Markdown table; an empty string without rows."""
    if not rows:
        return ""
    lines = ["| " + " | ".join(header) + " |", "|" + "---|" * len(header)]
    return "\n".join(lines + ["| " + " | ".join(map(str, row)) + " |" for row in rows])


def ms(summary):
    return f"{digits(summary['median'])} ms"


def spread(summary):
    return f"{digits(summary['median'])} ({digits(summary['lower_quartile'])} to {digits(summary['upper_quartile'])})"


def percent(share):
    return f"{digits(100 * share)} %"


def span(counts):
    """Formats the least and the greatest count, or one number if they are equal."""
    low, high = f"{min(counts):,}", f"{max(counts):,}"
    return low if low == high else f"{low} to {high}"


def mebibytes(count):
    return f"{count / 2**20:.1f}"


def beside_median(values, index):
    """Formats values[index] divided by the median of all values; empty if the median is 0."""
    return f"{values[index] / median(values):.2f}" if median(values) else ""
