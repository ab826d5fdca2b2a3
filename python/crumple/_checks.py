"""Verdicts on parts and assemblies: crumple.check."""

from __future__ import annotations

import json
import os
import warnings
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Literal

from . import _core
from ._detector import Detector
from ._errors import FileWarning, InvalidInput, InvalidType, suggesting
from ._mesh import Mesh, as_mesh, is_mesh
from ._world import World

Place = tuple[float, float, float]


@dataclass(frozen=True)
class CheckItem:
    """Defect of a body, or relation of two bodies or of two shells of one body. docs/check.md defines the kinds.

    Numbers that do not apply, or were not computed, are None.

    Attributes
    ----------
    kind : str
        Such as "hole", "self_intersection", "overlapping", "piercing", "near".
    finding : bool
        True if it counts as a finding.
    ignored : bool
        True for an overlap that is not deeper than `ignore_below`.
    first, second : str or None
        Names of the bodies; `second` is None for items about one body.
    first_shell, second_shell : int or None
        Numbers of the shells; None: the whole body.
    centre : (x, y, z) or None
        Place of the item.
    box : dict or None
        Its box: "low" and "high".
    count : int
        Number of triangles, or of edges, that it is about.
    volume, mean_depth, depth_reached, depth_bound, contact_area, length, clearance : float or None
        Numbers, in the unit of the bodies.
    closest_points : list or None
        Closest points of both bodies, with a clearance.
    places : list of dict
        Places of a pair: each connected region of an overlap.
    triangles : list of int
        Triangles of items about triangles.
    text : str
        The item as a sentence.
    """

    kind: str
    finding: bool
    ignored: bool
    first: str
    first_shell: int | None
    second: str | None
    second_shell: int | None
    centre: Place | None
    box: dict[str, Place] | None
    count: int
    text: str
    volume: float | None = None
    mean_depth: float | None = None
    depth_reached: float | None = None
    depth_bound: float | None = None
    contact_area: float | None = None
    length: float | None = None
    clearance: float | None = None
    closest_points: tuple[Place, Place] | None = None
    places: Sequence[dict[str, Any]] = ()
    triangles: Sequence[int] = ()

    def __str__(self) -> str:
        return self.text


class CheckReport:
    """Report of crumple.check. `str(report)` is the text that the command line prints."""

    def __init__(self, report: _core.Check) -> None:
        self._report = report

    @cached_property
    def _dict(self) -> dict[str, Any]:
        return json.loads(self._report.json())

    @property
    def findings(self) -> int:
        """Number of findings; 0: the bodies are sound."""
        return self._dict["findings"]

    @property
    def unit(self) -> str | None:
        """Unit of all numbers, such as "mm"; None: that of the meshes, which state none."""
        return self._dict["unit"]

    @property
    def bodies(self) -> list[dict[str, Any]]:
        """Properties of each body, with the keys of `crumple check --json`."""
        return self._dict["bodies"]

    @cached_property
    def items(self) -> list[CheckItem]:
        """All items, also those that are no findings: first those of one body, then those of pairs."""
        return [CheckItem(**item) for item in self._dict["items"]]

    def to_dict(self) -> dict[str, Any]:
        """Returns the report as the dict that `crumple check --json` prints.

        Returns
        -------
        dict
        """
        return json.loads(self._report.json())

    def save(self, path: str | os.PathLike[str]) -> None:
        """Writes the report by extension: all items as .json or .csv, the text as .txt, or a page as .html.

        The page shows the bodies and moves to each place; it works offline.

        Parameters
        ----------
        path : str or os.PathLike
            File.

        Raises
        ------
        FileError
            If the file cannot be written; an existing file is unchanged then.
        InvalidInput
            If the extension is another one.
        """
        self._report.save(path)

    def __str__(self) -> str:
        return self._report.text().rstrip("\n")

    def __repr__(self) -> str:
        return f"<crumple.CheckReport: {len(self.bodies)} bodies, {self.findings} findings>"


@suggesting
def check(
    *parts: Any,
    names: Iterable[str] | None = None,
    ignore_below: float | str = 0.0,
    clearance: float | str | None = None,
    excluded_bodies: Iterable[tuple[str, str]] = (),
    precision: Literal["automatic", "float32", "float64"] = "automatic",
    weld: Literal["automatic", "yes", "no"] = "automatic",
    triangulation: Literal["ears", "fan"] = "ears",
    strict: bool = False,
    unit: Literal["um", "mm", "cm", "in", "ft", "m"] | None = None,
    detector: Detector | None = None,
) -> CheckReport:
    """Checks parts before printing or assembly: holes, places that pass through themselves, clashes, clearances.

    Does the same as `crumple check` on the command line. docs/check.md defines every finding and number.

    Parameters
    ----------
    *parts : str, os.PathLike, mesh or World
        Bodies to check. A file is one body, except that each object of a 3MF file and each node of a glTF scene is one.
        A mesh is anything that as_mesh takes; vertices and faces of one mesh may also be given as two arrays.
    names : iterable of str, optional
        Names of the meshes among the parts, in their order; None: "mesh", "mesh_2", ...
    ignore_below : float or str, default 0
        Two bodies, or two shells, that touch or overlap, but nowhere deeper than this length, are no findings. A number
        is in the unit of the bodies; a str has a unit, such as "0.01mm".
    clearance : float or str, optional
        Pairs of bodies that are nearer to each other than this length are findings.
    excluded_bodies : iterable of (str, str)
        Pairs of names of bodies that are not checked; (a, a): body a with itself.
    precision, weld, triangulation, strict, unit
        As for read_mesh. For meshes, weld="yes" merges vertices at equal positions, and `unit` is that of meshes that
        have none; meshes with another one are converted.
    detector : Detector, optional
        Detector that searches, with its options; None: a new one.

    Returns
    -------
    CheckReport

    Raises
    ------
    FileError
        If a file cannot be read.
    InvalidInput
        If a file, a mesh or an option is invalid.

    Warns
    -----
    FileWarning
        If something in a file is odd, or if the parts have different units.

    Examples
    --------
        report = crumple.check("plate.stl", "pin.stl", unit="mm", ignore_below="0.01mm")
        print(report)
        if report.findings:
            report.save("report.html")
    """
    given = _given(parts, names)
    excluded = [_pair(pair) for pair in excluded_bodies]
    if detector is None:
        detector = Detector()
    elif not isinstance(detector, Detector):
        raise InvalidType(f"detector must be a crumple.Detector, not {type(detector).__name__}")
    report, messages = _core.check(
        detector, given, ignore_below, clearance, excluded, precision, weld, triangulation, strict, unit
    )
    for message in messages:
        warnings.warn(message, FileWarning, stacklevel=3)  # names the line of the caller; level 2 is in `suggesting`
    return CheckReport(report)


def _given(parts: tuple[Any, ...], names: Iterable[str] | None) -> list[tuple[Any, ...]]:
    """Returns the parts in the form of the extension module (python/src/checks.cpp)."""
    if not parts:
        raise InvalidType("check needs files, meshes or a crumple.World; none is given")
    if len(parts) == 2 and not any(_is_part(part) for part in parts):
        parts = (Mesh(*parts),)
    given: list[tuple[Any, ...]] = []
    remaining = None if names is None else list(names)
    for part in parts:
        if isinstance(part, (str, bytes, os.PathLike)):
            given.append((part,))
        elif isinstance(part, World):
            if (part.worlds > 0).any():
                raise InvalidInput("check is about one configuration, but the world has several")
            given.append((part, part.poses, part._all_names()))
        else:
            if remaining == []:
                raise InvalidInput("there are fewer names than meshes")
            given.append((as_mesh(part), "mesh" if remaining is None else remaining.pop(0)))
    if remaining:
        raise InvalidInput("there are more names than meshes")
    return given


def _is_part(part: Any) -> bool:
    return isinstance(part, (str, bytes, os.PathLike, World)) or is_mesh(part)


def _pair(pair: Any) -> tuple[str, str]:
    if isinstance(pair, (tuple, list)) and len(pair) == 2:
        return pair[0], pair[1]
    raise InvalidType("excluded_bodies must be pairs of names")
