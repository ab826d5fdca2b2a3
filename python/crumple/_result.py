"""The answer to a call: NumPy views, and files and pictures of them."""

from __future__ import annotations

import io
import os
from collections.abc import Iterator
from copy import deepcopy
from enum import IntEnum
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

from . import _core
from ._core import Answer, Statistics
from ._errors import InvalidInput, InvalidType
from ._mesh import Mesh

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

_PAIR_FILES = {".txt", ".csv", ".json", ".npz"}
_MESH_FILES = {".ply", ".obj", ".glb", ".3mf", ".html"}
PICTURES = {".png": "PNG", ".jpg": "JPEG", ".jpeg": "JPEG", ".bmp": "BMP", ".tif": "TIFF", ".tiff": "TIFF"}


def file_name(path: Any) -> str:
    try:
        name = os.fsdecode(path)
        if b"\0" not in os.fsencode(name):
            return name
    except TypeError:
        kind = "None" if path is None else type(path).__name__
        raise InvalidType(f"path must be a str, bytes or os.PathLike, not {kind}") from None
    except UnicodeError:
        pass
    raise InvalidInput("path cannot be the name of a file")


def extension_of(name: str) -> str:
    """In lower case; .csv for pairs.csv.gz, whose contents are compressed."""
    path = Path(name)
    return (path.with_suffix("") if path.suffix.lower() == ".gz" else path).suffix.lower()


class ContactKind(IntEnum):
    """What two triangles have in common: 1, 2 or 3 to 6 extreme points."""

    POINT = 1
    SEGMENT = 2
    AREA = 3


class Contacts:
    """Where the pairs of a result meet: the whole intersection of each pair by its extreme points.

    Each coordinate is the exact one, rounded to the nearest float64. The lexicographically smallest exact point comes
    first; areas run counter-clockwise about the first triangle's normal.

    Attributes:
        kinds: (pairs,) uint8, a ContactKind each.
        offsets: (pairs + 1,) int64; the points of pair i are points[offsets[i]:offsets[i + 1]], or contacts[i].
        points: (k, 3) float64; 1, 2 or 3 to 6 a pair.
    """

    kinds: NDArray[np.uint8]
    offsets: NDArray[np.int64]
    points: NDArray[np.float64]

    def __init__(self, kinds: NDArray[np.uint8], offsets: NDArray[np.int64], points: NDArray[np.float64]) -> None:
        self.kinds = kinds
        self.offsets = offsets
        self.points = points

    def __len__(self) -> int:
        """How many pairs."""
        return len(self.kinds)

    def __getitem__(self, pair: int) -> NDArray[np.float64]:
        """(1 to 6, 3) float64: the points of a pair, a view. Raises IndexError."""
        if not -len(self) <= pair < len(self):
            raise IndexError(f"there are {len(self)} contacts, none of number {pair}")
        pair %= len(self)
        return self.points[self.offsets[pair] : self.offsets[pair + 1]]

    def __iter__(self) -> Iterator[NDArray[np.float64]]:
        """The points of one pair after the other, as contacts[i]."""
        return (self[pair] for pair in range(len(self)))

    def __repr__(self) -> str:
        return f"<crumple.Contacts: {len(self)} pairs, {len(self.points)} points>"


class Block:
    """Some of the pairs of an answer that comes in blocks (Detector.stream_self). It keeps its arrays as a Result does.

    `len(block)` is the number of pairs.
    """

    def __init__(self, answer: Answer) -> None:
        self._answer = answer

    @cached_property
    def pairs(self) -> NDArray[np.int32]:
        """(k, 2) int32: colliding pairs; sorted, if blocks come in order. Indices as in Result.pairs."""
        return self._answer.pairs

    @cached_property
    def contacts(self) -> Contacts | None:
        """Where the pairs meet, or None if `contacts=True` was not asked for."""
        a = self._answer
        return Contacts(a.contact_kinds, a.contact_offsets, a.contact_points) if a.has_contacts else None

    def __len__(self) -> int:
        """How many pairs."""
        return len(self._answer)

    def __repr__(self) -> str:
        return f"<crumple.Block: {len(self)} colliding pairs>"


class Result:
    """Every colliding pair, once, in lexicographic order: the same bytes from every backend and thread count.

    Detectors make results. A result outlives its detector, and no later call changes it. Its arrays are read-only views
    of the library's memory that keep that memory alive; once the last of them is gone, the detector's next call uses
    the memory again. With `copy=True` they are writable arrays of their own.

    Of a part (Detector.find) pairs have the ids of the whole meshes; offsets and hits, and what is shown and saved as a
    mesh, are of the part's own triangles, in the order of part.triangles.

    `len(result)` is the number of pairs, and a result without pairs is false. A result keeps the input arrays too, for
    show, save and to_html, but does not copy them: pictures show what the arrays hold by then.

    copy.copy shares all of that memory, copy.deepcopy none of it, the input arrays included. A pickled result is the
    answer and its meshes as NumPy arrays, which have to lie on the host: 8 bytes a pair and 9 a triangle, 1 more for
    each of the second mesh, with contacts 9 a pair and 24 a point, and what the meshes take. Neither carries what was
    written into the arrays of copy=True. Unpickling checks that all of it fits together, or raises InvalidInput.
    """

    def __init__(self, answer: Answer, first: Mesh, second: Mesh | None, ids: tuple[Any, Any] = (None, None)) -> None:
        self._answer = answer
        self._first = first
        self._second = second
        self._ids = ids  # of a part's triangles; None: pairs count in the meshes themselves

    def _array(self, name: str) -> Any:
        array = getattr(self._answer, name)
        return array.copy() if self._answer.copy else array

    @cached_property
    def pairs(self) -> NDArray[np.int32]:
        """(k, 2) int32: the colliding pairs, sorted. One soup: first < second; two meshes: index in each."""
        return self._array("pairs")

    @cached_property
    def offsets(self) -> NDArray[np.int64]:
        """(m + 1,) int64: the pairs of which triangle i is the first are pairs[offsets[i]:offsets[i + 1]]."""
        return self._array("offsets")

    @cached_property
    def hit(self) -> NDArray[np.bool_]:
        """(m,) bool: which triangles (of the first mesh) collide."""
        return self._array("hit")

    @cached_property
    def hit_second(self) -> NDArray[np.bool_]:
        """(m of the second mesh,) bool: the same for the second mesh; empty for one soup."""
        return self._array("hit_second")

    @cached_property
    def contacts(self) -> Contacts | None:
        """Where the pairs meet, or None if `contacts=True` was not asked for."""
        if not self._answer.has_contacts:
            return None
        return Contacts(self._array("contact_kinds"), self._array("contact_offsets"), self._array("contact_points"))

    @property
    def statistics(self) -> Statistics:
        """Counts and times of the stages."""
        return self._answer.statistics

    def __len__(self) -> int:
        """How many pairs."""
        return len(self._answer)

    def __reduce__(self) -> Any:
        from ._pickling import restore, state_of

        return restore, (state_of(self),)

    def __copy__(self) -> Result:
        return Result(self._answer, self._first, self._second, self._ids)

    def __deepcopy__(self, memo: dict[int, Any]) -> Result:
        first, second = deepcopy(self._first, memo), deepcopy(self._second, memo)
        return Result(self._answer.deep_copy(), first, second, deepcopy(self._ids, memo))

    def __repr__(self) -> str:
        s = self.statistics
        return f"<crumple.Result: {s.pairs} colliding pairs of {s.triangles} triangles, {s.milliseconds:.3g} ms>"

    def show(self, **options: Any) -> Any:
        """Opens a window, or a picture in a notebook: colliding triangles coloured, contacts drawn. Needs PyVista.

        `options` go to pyvista.Plotter.show, whose answer is returned. Raises ModuleNotFoundError without PyVista.
        """
        from ._pictures import plotter

        return plotter(self, off_screen=None).show(**options)

    def save(self, path: str | os.PathLike[str], **options: Any) -> None:
        """Writes a file of the kind that its extension names.

        - .txt, .csv, .json, .npz: the pairs, and contacts if there are any
        - .ply, .obj, .glb, .3mf: the meshes with colliding triangles coloured
        - .png, .jpg, .jpeg, .bmp, .tif, .tiff: a picture, as show paints it; needs PyVista. `options`, for instance
          window_size=(1600, 1200), go to pyvista.Plotter.screenshot
        - .html: a page to turn and zoom, which fills the window; with the option `height`, the piece of one that
          to_html makes

        A file appears when it is complete; the old one stays until then. Files that show a mesh need its arrays on the
        host. Ctrl-C waits until the file is written. Raises InvalidInput for other extensions and for options that do
        not belong to the extension, FileError, and ModuleNotFoundError without PyVista.
        """
        name = file_name(path)
        extension = extension_of(name)
        for option in options:
            if extension in _PAIR_FILES | _MESH_FILES and (extension, option) != (".html", "height"):
                raise InvalidType(f"{option} is no option of {extension} files")
        if extension in _PAIR_FILES:
            _core.write_pairs(path, self._answer)
        elif extension == ".html" and options:
            _core.write_bytes(path, self.to_html(**options).encode())
        elif extension in _MESH_FILES:
            _core.write_coloured(path, self._first, self._second, self._answer)
        elif extension in PICTURES:
            from ._pictures import image

            picture = io.BytesIO()
            image(self, **options).save(picture, format=PICTURES[extension])
            _core.write_bytes(path, picture.getvalue())
        else:
            raise InvalidInput(
                f"{name}: a result is saved as .txt, .csv, .json, .npz (pairs), .ply, .obj, .glb, .3mf (coloured "
                "meshes), .png, .jpg, .bmp, .tif (pictures) or .html"
            )

    def to_html(self, height: int = 480) -> str:
        """A self-contained piece of HTML that shows the meshes and contacts in WebGL, to turn, zoom and move.

        For a notebook: IPython.display.HTML(result.to_html()). It needs no package and no network. About 100 bytes a
        triangle. `height` is in pixels. Raises InvalidInput.
        """
        return _core.to_html(self._first, self._second, self._answer, height)
