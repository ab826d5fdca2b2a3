"""A result as a piece of HTML with a small WebGL viewer (viewer.html) in it: no package, no network."""

from __future__ import annotations

import base64
import json
import uuid
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from ._drawing import CONTACT, drawing_of

if TYPE_CHECKING:
    from ._result import Result


def _encoded(array: np.ndarray, dtype: str) -> str:
    return base64.b64encode(np.ascontiguousarray(array, dtype).tobytes()).decode()


def page(result: Result, height: int) -> str:
    """Corners, not indices: each face has its own colour, and old WebGL has no 32-bit indices."""
    drawing = drawing_of(result)
    corners = drawing.vertices[drawing.faces].reshape(-1, 3)
    used = corners if len(corners) else np.zeros((1, 3))
    low, high = used.min(axis=0), used.max(axis=0)
    # Nothing here overflows or underflows, wherever the coordinates lie: halves are added, quotients are squared.
    centre, half = low / 2 + high / 2, high / 2 - low / 2
    extent = float(half.max()) or 1.0
    radius = float(np.linalg.norm(half / extent)) or 1.0

    def normalised(points: np.ndarray) -> str:
        return _encoded((points.reshape(-1, 3) - centre) / extent / radius, "<f4")

    data = {
        "corners": normalised(corners),
        "colours": _encoded(np.repeat(drawing.colours, 3, axis=0), "u1"),
        "lines": normalised(drawing.lines),
        "points": normalised(drawing.points),
        "contact": [c / 255 for c in CONTACT],
    }
    text = Path(__file__).with_name("viewer.html").read_text(encoding="utf-8")
    caption = f"{len(result):,} colliding pairs of {len(drawing.faces):,} triangles"
    for name, value in {
        "ID": f"crumple-{uuid.uuid4().hex}",
        "HEIGHT": str(int(height)),
        "CAPTION": caption,
        "DATA": json.dumps(data),
    }.items():
        text = text.replace(f"@{name}@", value)
    return text
