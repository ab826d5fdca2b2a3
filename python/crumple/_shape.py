"""Shapes: what bodies of a world are made of."""

from __future__ import annotations

import itertools
from typing import Any

from . import _core
from ._errors import Error, InvalidInput, InvalidType, suggesting
from ._mesh import Mesh, as_mesh, mesh_of

_FIRST_OWN = 2**63  # numbers of names; those below are for names that are numbers
_own_numbers = itertools.count(_FIRST_OWN)
_numbers: dict[str, int] = {}


class OwnName:
    """The name of a shape that nobody else names, and whose arrays nobody changes."""


def _number_of(name: Any) -> int:
    if name is None:
        return 0
    if isinstance(name, OwnName):
        return next(_own_numbers)
    if isinstance(name, str):
        if not name:
            raise InvalidInput("name must not be empty; None: the shape has no name")
        return _numbers.get(name) or _numbers.setdefault(name, next(_own_numbers))
    if isinstance(name, bool) or not hasattr(name, "__index__"):
        raise InvalidType(f"name must be a str, an int or None, not {type(name).__name__}")
    number = name.__index__()
    if not 0 < number < _FIRST_OWN:
        raise InvalidInput(f"name must be a str or from 1 to {_FIRST_OWN - 1}, not {number}")
    return number


def name_of_number(number: int) -> str | int | None:
    """The name that a number stands for; None: a shape's own, which has no other."""
    if number < _FIRST_OWN:
        return number
    return next((name for name, known in _numbers.items() if known == number), None)


class Shape(_core.Shape):
    """Triangles, and edges and points, that bodies are made of. Nothing is copied.

    Args:
        vertices: (n, 3) float32 or float64; or a mesh that as_mesh knows, and then no `faces`. On the host.
        faces: (m, 3) integers, or flat: three a triangle.
        groups: (m,) integers that fit int32, one a triangle; None: the mesh's, or each body's own.
        name: a str, or an int from 1 to 2**63 - 1. What it names has the same contents now and in later calls. A
            detector checks it in the first call only and keeps what it has computed, for all bodies of that shape: one
            that is clear of all others costs less than a microsecond. Pairs within a body are searched anew. Names
            count for a whole process; another size or precision under a known name is an InvalidInput. A shape whose
            vertices move gets no name, or a new one with each change.
        end: (n, 3) float32 or float64: where they are at the end of a step, for queries about a step; None: they stay.
            What a name promises says nothing of it, nor of what follows.
        edges, points: as crumple.Mesh has them, for queries about features. What no face names is of
            the body's group where the shape has no groups, else of none.
        radii: (n,) float64 or float32, one a vertex, for a ProximityQuery, which tells what they are; None: 0, where
            another shape has some. In the units of the world, whatever the pose.
        rest: (n, 3) float32 or float64: where the vertices are at rest, before poses, for `rest_radius` of
            a ProximityQuery; None: there is no such shape.

    Raises InvalidInput, which names the argument. Whether coordinates are finite and indices in range is looked at when
    a search first reads the shape.
    """

    __slots__ = ("__weakref__", "_end", "_lists", "_mesh", "_name", "_radii", "_rest")

    @suggesting
    def __init__(
        self,
        vertices: Any,
        faces: Any = None,
        groups: Any = None,
        name: int | str | None = None,
        end: Any = None,
        edges: Any = None,
        points: Any = None,
        radii: Any = None,
        rest: Any = None,
    ) -> None:
        mesh = mesh_of(vertices, faces, groups=groups, end=end, edges=edges, points=points)
        self._make(mesh, name, "", mesh.end, (mesh.edges, mesh.points), radii, rest)

    def _make(
        self,
        mesh: Mesh,
        name: Any,
        which: str,
        end: Any = None,
        lists: tuple[Any, Any] = (None, None),
        radii: Any = None,
        rest: Any = None,
    ) -> None:
        super().__init__(mesh, which, _number_of(name), end, lists, radii, rest)
        self._lists = lists
        self._mesh = mesh
        self._name = name
        self._end = end
        self._radii = radii
        self._rest = rest

    @property
    def mesh(self) -> Mesh:
        """What the shape was made of."""
        return self._mesh

    @property
    def name(self) -> int | str | None:
        """What the shape is remembered by, if anything; None also for one that a file gave, whose name is its own."""
        return None if isinstance(self._name, OwnName) else self._name

    @property
    def end(self) -> Any:
        """Where the vertices are at the end of a step, as given; None: they stay."""
        return self._end

    @property
    def edges(self) -> Any:
        """The edges that are meant, as given; None: those of the faces."""
        return self._lists[0]

    @property
    def points(self) -> Any:
        """The vertices that are meant as points, as given; None: those that a face or an edge names."""
        return self._lists[1]

    @property
    def radii(self) -> Any:
        """The radii of the vertices, as given, or None."""
        return self._radii

    @property
    def rest(self) -> Any:
        """Where the vertices are at rest, as given, or None."""
        return self._rest

    def __reduce__(self) -> Any:
        from ._world_pickling import restore_shape, state_of_shape

        return restore_shape, state_of_shape(self, self._name)

    def __repr__(self) -> str:
        named = f" {self.name!r}" if self.name else ""
        return f"<crumple.Shape{named}: {self.triangles} triangles>"


def shape_of(given: Any, which: str, name: Any = None) -> Shape:
    """A Shape as it is, or one of a mesh. `which` leads every message."""
    if isinstance(given, Shape):
        return given
    try:
        mesh = as_mesh(given)
    except Error as error:
        raise type(error)(f"{which}{error}", code=error.code) from None
    shape = Shape.__new__(Shape)
    shape._make(mesh, name, which, mesh.end, (mesh.edges, mesh.points))
    return shape
