"""Shortens a Debian package's copyright file to the paragraphs about given files. Boost's file has 2 MB.

https://www.debian.org/doc/packaging-manuals/copyright-format/1.0/
"""

import re
from collections.abc import Iterable
from fnmatch import translate


def field(paragraph: str, name: str) -> str:
    """Returns the value of a field, including continuation lines; empty if the field is missing."""
    found = re.search(rf"^{name}:(.*(?:\n[ \t].*)*)", paragraph, re.M)
    return found[1].strip() if found else ""


def concerning(text: str, files: Iterable[str]) -> str:
    """Returns the head, the paragraphs about `files` (paths in the source package), and the licences that they name."""
    head, *paragraphs = re.split(r"\n\s*\n(?=\S)", text.strip())
    head = re.sub(r"^Files-Excluded:.*(?:\n[ \t].*)*\n?", "", head, flags=re.M)
    groups = [(paragraph, field(paragraph, "Files").split()) for paragraph in paragraphs]
    # If several patterns match a file, the last one applies. Most patterns have no wildcards: a dictionary finds them.
    last = {pattern: i for i, (_, patterns) in enumerate(groups) for pattern in patterns}
    wild = [(re.compile(translate(pattern)), i) for pattern, i in last.items() if re.search(r"[*?]", pattern)]
    kept = set()
    for file in files:
        about = [last[file]] if file in last else []
        about += [i for pattern, i in wild if pattern.match(file)]
        if not about:
            raise ValueError(f"nothing is said of {file}")
        kept.add(max(about))
    words = set()
    for i in kept:
        words |= set(re.split(r"[\s,()]+", field(groups[i][0], "License").split("\n")[0]))
    for i, (paragraph, patterns) in enumerate(groups):
        if not patterns and field(paragraph, "License").split("\n")[0].strip() in words:
            kept.add(i)
    return "\n\n".join([head.strip(), *(groups[i][0] for i in sorted(kept))])
