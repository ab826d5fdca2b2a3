"""Renames the distribution of a pyproject.toml, and marks it as not to be uploaded, so that PyPI refuses it.

python rename.py PYPROJECT NAME
"""

import sys
from pathlib import Path

path, name = Path(sys.argv[1]), sys.argv[2]
text = path.read_text()
for before, after in (
    ('name = "crumple"\n', f'name = "{name}"\n'),
    ("classifiers = [\n", 'classifiers = [\n    "Private :: Do Not Upload",\n'),
):
    if text.count(before) != 1:
        sys.exit(f"rename.py: {path} must have the line {before!r} exactly once")
    text = text.replace(before, after)
path.write_text(text)
