"""Refuses to be imported where two distributions of this package are installed, with and without the cuda backend: both
have the same files, of which the last one's are there, or some of each.
"""

import os
import re


def refuse_two(folder: str) -> None:
    """Raises ImportError if `folder`, where packages are installed, has metadata of more than one of them."""
    try:
        entries = os.listdir(folder)
    except OSError:  # imported from elsewhere than a folder
        return
    found = {match[1] for entry in entries if (match := re.match(r"(crumple(?:_cuda\d+)?)-[^-]+\.dist-info$", entry))}
    if len(found) > 1:
        names = [name.replace("_", "-") for name in sorted(found)]
        raise ImportError(
            f"{' and '.join(names)} are both installed in {folder}, and overwrite each other's files: "
            f"pip uninstall {' '.join(names)}, then install the one that you want"
        )


refuse_two(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
