"""The answer for a world: NumPy views, and files and pictures of them."""

from __future__ import annotations

import io
import os
from copy import deepcopy
from functools import cached_property
from typing import TYPE_CHECKING, Any

from . import _core
from ._errors import InvalidInput, InvalidType
from ._result import Contacts

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from ._core import Statistics, WorldAnswer
    from ._mesh import Mesh
    from ._world import World
    from ._world_pickling import StoredAnswer

WANTS = ("any", "any_by_world", "body_pairs", "count", "pairs", "contacts")
# What each array is made for, from which of WANTS on.
_FROM = {"world_hit": 1, "count": 3, "world_counts": 3, "pairs": 4}
_INDEX = ("world_offsets", "body_offsets", "first_triangle", "hit")


class Painted:
    """What a picture needs of a result: of a world, its mesh and the triangles that collide."""

    _second = None

    def __init__(self, mesh: Mesh, hit: NDArray[np.bool_], contacts: Contacts | None) -> None:
        self._first, self.hit, self.contacts = mesh, hit, contacts


class WorldResult:
    """What collides in a world, as much as `wants` asked for: the same bytes from every backend and thread count.

    Rows are in the order of first body, its triangle, second body, its triangle, each pair once. So worlds follow each
    other, and pairs among bodies that are in all worlds, which come once and count for none, are last. Triangles count
    within their bodies.

    A result is true if anything collides; `len(result)` is the number of its rows. What was not asked for is an
    InvalidInput that says how to ask. A result outlives its detector, and no later call changes it. Its arrays are
    read-only views of the library's memory that keep that memory alive, or with `copy=True` writable arrays of their
    own. It keeps the world and its poses as they were given, for files and pictures.

    Results and worlds can be copied and pickled. A pickle carries the world, its shapes and poses as NumPy arrays;
    copy.copy shares the answer and the world, copy.deepcopy neither. What was written into the arrays of `copy=True` is
    not carried. Unpickling checks that all of it fits together, or raises InvalidInput.
    """

    def __init__(self, answer: WorldAnswer | StoredAnswer, world: World, poses: Any) -> None:
        self._answer = answer
        self._world = world
        self._poses = poses

    def _array(self, name: str) -> Any:
        answer = self._answer
        if name in _INDEX and not answer.has_index:
            raise InvalidInput(f'{name} was not asked for: find(..., wants="pairs", index=True)')
        if WANTS.index(answer.wants) < _FROM.get(name, 0):
            raise InvalidInput(f'{name} was not asked for: find(..., wants="{WANTS[_FROM[name]]}")')
        array = getattr(answer, name)
        return array.copy() if answer.copy else array

    @property
    def any(self) -> bool:
        """Whether anything collides."""
        return self._answer.any

    @property
    def count(self) -> int:
        """How many pairs of triangles collide. From wants="count" on."""
        if WANTS.index(self._answer.wants) < _FROM["count"]:
            raise InvalidInput('count was not asked for: find(..., wants="count")')
        return self._answer.count

    @cached_property
    def world_hit(self) -> NDArray[np.bool_]:
        """(worlds,) bool: in which worlds, or configurations, something collides. From wants="any_by_world" on."""
        return self._array("world_hit")

    @cached_property
    def world_counts(self) -> NDArray[np.int64]:
        """(worlds,) int64: how many pairs of triangles each world has. From wants="count" on."""
        return self._array("world_counts")

    @cached_property
    def bodies(self) -> NDArray[np.int32]:
        """(k, 2) int32: the bodies of each pair of triangles; of wants="body_pairs" the colliding ones, each once."""
        if self._answer.wants not in ("body_pairs", "pairs", "contacts"):
            raise InvalidInput('bodies was not asked for: find(..., wants="body_pairs")')
        return self._array("bodies")

    @cached_property
    def pairs(self) -> NDArray[np.int32]:
        """(k, 2) int32: the colliding triangles, as they count within their bodies. From wants="pairs" on."""
        return self._array("pairs")

    @cached_property
    def contacts(self) -> Contacts | None:
        """Where the pairs meet, or None if wants="contacts" was not asked for."""
        if self._answer.wants != "contacts":
            return None
        return Contacts(self._array("contact_kinds"), self._array("contact_offsets"), self._array("contact_points"))

    @cached_property
    def world_offsets(self) -> NDArray[np.int64]:
        """(worlds + 1,) int64, with `index`: the rows of world w are [world_offsets[w]:world_offsets[w + 1]].

        The rows after these are of bodies that are in all worlds.
        """
        return self._array("world_offsets")

    @cached_property
    def body_offsets(self) -> NDArray[np.int64]:
        """(n + 1,) int64, with `index`: the rows whose first body is b are [body_offsets[b]:body_offsets[b + 1]]."""
        return self._array("body_offsets")

    @cached_property
    def first_triangle(self) -> NDArray[np.int64]:
        """(n + 1,) int64, with `index`: where each body's triangles begin in `hit`."""
        return self._array("first_triangle")

    @cached_property
    def hit(self) -> NDArray[np.bool_]:
        """(triangles of all bodies,) bool, with `index`: which triangles of which body collide."""
        return self._array("hit")

    @property
    def names(self) -> list[tuple[str, str]]:
        """The names of `bodies`, row by row; of configurations, those of the world they are made of."""
        names, originals = self._world.names, self._world.originals
        return [(names[a], names[b]) for a, b in originals[self.bodies].tolist()]

    @property
    def world(self) -> World:
        """The world that was searched."""
        return self._world

    @property
    def statistics(self) -> Statistics:
        """Counts and times of the stages."""
        return self._answer.statistics

    def __bool__(self) -> bool:
        """Whether anything collides."""
        return self._answer.any

    def __len__(self) -> int:
        """How many rows `bodies` has; 0 where they were not asked for."""
        return len(self._answer.bodies)

    def save(self, path: str | os.PathLike[str], **options: Any) -> None:
        """Writes the world with what collides coloured; the extension names the kind.

        Of wants="pairs" and "contacts" triangles are coloured, of wants="body_pairs" whole bodies.

        - .glb, .3mf: bodies with names and poses, over shapes that they share
        - .ply, .obj: all bodies as one mesh, as world.mesh makes it
        - .html: a page to turn and zoom, with contacts if there are any
        - .png, .jpg, .jpeg, .bmp, .tif, .tiff: a picture; needs PyVista. `options` as of Result.save

        Paints what shapes and poses hold by now; what does not fit the result any more is an InvalidInput. A file
        appears when it is complete. Otherwise as Result.save, errors included.
        """
        from ._result import PICTURES, extension_of, file_name

        name = file_name(path)
        extension = extension_of(name)
        if extension in PICTURES:
            from ._pictures import image

            picture = io.BytesIO()
            image(self._painted(), **options).save(picture, format=PICTURES[extension])
            _core.write_bytes(path, picture.getvalue())
            return
        if extension not in (".ply", ".obj", ".glb", ".3mf", ".html"):
            raise InvalidInput(
                f"{name}: a result of a world is saved as .ply, .obj, .glb, .3mf (coloured meshes), .html, or .png, "
                ".jpg, .bmp, .tif (pictures)"
            )
        for option in options:
            raise InvalidType(f"{option} is no option of {extension} files")
        contacts = [getattr(self._answer, name) for name in ("contact_kinds", "contact_offsets", "contact_points")]
        _core.write_coloured_world(
            path, self._world, self._poses, self._world._all_names(), self.bodies, self._answer.pairs, *contacts
        )

    def show(self, **options: Any) -> Any:
        """Opens a window, or a picture in a notebook: colliding triangles coloured, contacts drawn. Needs PyVista.

        `options` go to pyvista.Plotter.show, whose answer is returned. Raises ModuleNotFoundError without PyVista.
        """
        from ._pictures import plotter

        return plotter(self._painted(), off_screen=None).show(**options)

    def _painted(self) -> Any:
        import numpy as np

        world = self._world
        sizes = np.array([shape.triangles for shape in world.shapes], np.int64)[world.bodies]
        first = np.concatenate([[0], np.cumsum(sizes)])
        hit = np.zeros(first[-1], np.bool_)
        if self._answer.wants == "body_pairs":
            collides = np.zeros(len(world), np.bool_)
            collides[self.bodies.ravel()] = True
            hit = np.repeat(collides, sizes)
        else:
            hit[(first[self.bodies] + self._answer.pairs).ravel()] = True
        return Painted(world._mesh_at(self._poses), hit, self.contacts)

    def __reduce__(self) -> Any:
        from ._world_pickling import poses_of, restore_result, stored

        return restore_result, (tuple(stored(self._answer)), self._world, poses_of(self._poses))

    def __copy__(self) -> WorldResult:
        return WorldResult(self._answer, self._world, self._poses)

    def __deepcopy__(self, memo: dict[int, Any]) -> WorldResult:
        from ._world_pickling import stored

        return WorldResult(stored(self._answer), deepcopy(self._world, memo), deepcopy(self._poses, memo))

    def __repr__(self) -> str:
        answer = self._answer
        wants, time = answer.wants, f"{self.statistics.milliseconds:.3g} ms"
        if wants in ("any", "any_by_world"):
            found = "something collides" if answer.any else "nothing collides"
        elif wants == "body_pairs":
            found = f"{len(self)} colliding pairs of bodies"
        else:
            found = f"{answer.count} colliding pairs of triangles"
        return f"<crumple.WorldResult: {found} of {len(self._world)} bodies, {time}>"
