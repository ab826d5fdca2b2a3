"""The result of an IntersectionQuery: NumPy views, and files and pictures of them."""

from __future__ import annotations

import io
import os
from functools import cached_property
from typing import TYPE_CHECKING, Any

from . import _core
from ._errors import InvalidInput, InvalidType
from ._mesh import Mesh
from ._results import Contacts, Result, bools, extension_of, file_name, float64, int32, int64, uint8
from ._world import World

if TYPE_CHECKING:
    from ._drawing import Painted

_PICTURES = {".png": "PNG", ".jpg": "JPEG", ".jpeg": "JPEG", ".bmp": "BMP", ".tif": "TIFF", ".tiff": "TIFF"}
_PAIR_FILES = {".txt", ".csv", ".json", ".npz"}
_MESH_FILES = {".ply", ".obj", ".glb", ".3mf", ".html"}
OUTPUTS = ("any", "any_by_world", "body_pairs", "count", "pairs", "contacts")
# The least of OUTPUTS that an array or a count is made for.
_FROM = {
    "skipped": "any",
    "world_hit": "any_by_world",
    "bodies": "body_pairs",
    "inside": "body_pairs",
    "count": "count",
    "world_counts": "count",
    "pairs": "pairs",
}
_OF_MESHES = ("offsets", "hit_second")
_OF_WORLDS = ("world_hit", "world_counts", "world_offsets", "body_offsets", "first_triangle")
_OF_CONTAINMENT = ("inside", "skipped")
_INDEX = ("world_offsets", "body_offsets", "first_triangle", "hit")


class Intersections(Result):
    """Pairs of triangles that intersect, each once: the same bytes from every backend and thread count.

    Of a mesh in lexicographic order, first < second; of two meshes the index in each. Of a world in the order of first
    body, its triangle, second body, its triangle. So worlds follow each other, and pairs among bodies that are in all
    worlds, which come once and count for none, are last; triangles count within their bodies. Of a part (crumple.Part)
    pairs have the ids of the whole meshes; offsets and hits, and what is shown and saved as a mesh, are of the part's
    own triangles, in the order of part.triangles.

    `len(result)` is the number of its rows; it is true if anything intersects. It keeps meshes, or the world and its
    poses, as they were given, for show, save and to_html: pictures show what the arrays hold by then. copy.deepcopy and
    pickles carry them.
    """

    _query = "IntersectionQuery"

    @property
    def _of_world(self) -> bool:
        return self._request.scene == "world"

    @property
    def _listed(self) -> bool:
        return self._request.output in ("pairs", "contacts")

    def _check(self, name: str) -> None:
        request = self._request
        least = _FROM.get(name, "pairs" if name not in _OF_WORLDS else "any")
        if request.block and name not in ("pairs", "bodies", "count") and not name.startswith("contact"):
            raise InvalidInput(f"{name} is part of a whole result, but this is one of its blocks")
        if name in _OF_CONTAINMENT and "containment" not in request.options:
            self._refuse(name, "containment=True")
        if name in _OF_MESHES and self._of_world:
            raise InvalidInput(f"{name} is for meshes, but the scene is a world")
        if name in _OF_WORLDS and not self._of_world:
            raise InvalidInput(f"{name} is for worlds, but the scene is a mesh or two")
        if name == "bodies" and (request.output == "count" or not (self._of_world or request.output == "body_pairs")):
            self._refuse(name, 'output="body_pairs"') if self._of_world else self._refuse_bodies()
        if self._of_world and name in _INDEX and "index" not in request.options:
            self._refuse(name, "index=True" if self._listed else 'output="pairs", index=True')
        if OUTPUTS.index(request.output) < OUTPUTS.index(least):
            self._refuse(name, f'output="{least}"')

    def _refuse_bodies(self) -> None:
        raise InvalidInput("bodies are for worlds, but the scene is a mesh or two")

    @property
    def count(self) -> int:
        """How many pairs of triangles intersect. From output="count" on."""
        self._check("count")
        return self._found.count

    pairs = int32('(k, 2) int32: the triangles of each pair. From output="pairs" on.', (2,))

    _contact_kinds = uint8("Contacts.kinds.")
    _contact_offsets = int64("Contacts.offsets.")
    _contact_points = float64("Contacts.points.", (3,))

    @cached_property
    def contacts(self) -> Contacts | None:
        """Where the pairs meet, or None if output="contacts" was not requested."""
        if self._request.output != "contacts":
            return None
        return Contacts(self._contact_kinds, self._contact_offsets, self._contact_points)

    bodies = int32(
        '(k, 2) int32, of a world: the bodies of each pair; of output="body_pairs" those that intersect, each once.',
        (2,),
    )
    inside = bools(
        '(k,) bool, with `containment` and output="body_pairs": of which of `bodies` the surfaces do not meet, and one '
        "has a component inside the other."
    )
    skipped = int32(
        '(s,) int32, with `containment`: for open="skip" the bodies whose surfaces are not closed, of the wanted pairs '
        "whose boxes overlap and whose surfaces do not meet."
    )
    offsets = int64("(m + 1,) int64, of meshes: pairs whose first triangle is i are pairs[offsets[i]:offsets[i + 1]].")
    hit = bools(
        "(m,) bool: which triangles (of the first mesh; with `index` of all bodies of a world) are in some pair."
    )
    hit_second = bools("(m of the second mesh,) bool: the same for the second mesh; empty for one mesh.")
    world_hit = bools(
        '(worlds,) bool: in which worlds, or configurations, something intersects. From output="any_by_world" on.'
    )
    world_counts = int64('(worlds,) int64: how many pairs of triangles each world has. From output="count" on.')
    world_offsets = int64(
        "(worlds + 1,) int64, with `index`: the rows of world w are [world_offsets[w]:world_offsets[w + 1]]. The "
        "rows after these are of bodies that are in all worlds."
    )
    body_offsets = int64(
        "(n + 1,) int64, with `index`: the rows whose first body is b are [body_offsets[b]:body_offsets[b + 1]]."
    )
    first_triangle = int64("(n + 1,) int64, with `index`: where each body's triangles begin in `hit`.")

    @property
    def names(self) -> list[tuple[str, str]]:
        """The names of `bodies`, row by row; of configurations, those of the world they are made of."""
        world = self.world
        return [(world.names[a], world.names[b]) for a, b in world.originals[self.bodies].tolist()]

    @property
    def world(self) -> World:
        """The world that was searched."""
        if not self._of_world:
            raise InvalidInput("the scene is a mesh or two, not a world")
        return self._scene[0]

    def __len__(self) -> int:
        """How many rows there are; 0 where they were not requested."""
        return len(self._found.bodies if self._of_world else self._found.pairs)

    def show(self, **options: Any) -> Any:
        """Opens a window, or a picture in a notebook: triangles that intersect coloured, contacts drawn. Needs PyVista.

        `options` go to pyvista.Plotter.show, whose result is returned. Raises ModuleNotFoundError without PyVista.
        """
        from ._drawing import plotter

        return plotter(self._painted(), off_screen=None).show(**options)

    def save(self, path: str | os.PathLike[str], **options: Any) -> None:
        """Writes a file of the kind that its extension names.

        - .txt, .csv, .json, .npz: the pairs of meshes, and contacts if there are any
        - .ply, .obj, .glb, .3mf: the meshes with triangles that intersect coloured. Of a world .glb and .3mf have
          bodies with names and poses, over shapes that they share, the others one mesh; of output="body_pairs" whole
          bodies are coloured
        - .png, .jpg, .jpeg, .bmp, .tif, .tiff: a picture, as show paints it; needs PyVista. `options`, for instance
          window_size=(1600, 1200), go to pyvista.Plotter.screenshot
        - .html: a page to turn and zoom, which fills the window; of meshes with the option `height`, the piece of one
          that to_html makes

        A file appears when it is complete; the old one stays until then. Files that show a mesh need its arrays on the
        host. Ctrl-C waits until the file is written. Raises InvalidInput for other extensions, for options that do not
        belong to the extension, and for meshes that do not fit the result any more, FileError, and ModuleNotFoundError
        without PyVista.
        """
        name = file_name(path)
        extension = extension_of(name)
        lists = set() if self._of_world else _PAIR_FILES
        for option in options:
            if extension in lists | _MESH_FILES and (self._of_world or (extension, option) != (".html", "height")):
                raise InvalidType(f"{option} is no option of {extension} files")
        if extension in _PICTURES:
            from ._drawing import image

            picture = io.BytesIO()
            image(self._painted(), **options).save(picture, format=_PICTURES[extension])
            _core.write_bytes(path, picture.getvalue())
        elif extension in lists:
            self._check("pairs")
            _core.write_pairs(path, self._held())
        elif extension == ".html" and options:
            _core.write_bytes(path, self.to_html(**options).encode())
        elif extension not in _MESH_FILES:
            of_meshes = "" if self._of_world else ".txt, .csv, .json, .npz (pairs), "
            raise InvalidInput(
                f"{name}: a result {'of a world ' if self._of_world else ''}is saved as {of_meshes}.ply, .obj, .glb, "
                ".3mf (coloured meshes), .png, .jpg, .bmp, .tif (pictures) or .html"
            )
        elif self._of_world:
            world, poses = self._scene
            found = self._found
            contacts = [getattr(found, name) for name in ("contact_kinds", "contact_offsets", "contact_points")]
            bodies = self.bodies
            _core.write_coloured_world(path, world, poses, world._all_names(), bodies, found.pairs, *contacts)
        else:
            self._check("pairs")
            _core.write_coloured(path, *self._meshes(), self._held())

    def to_html(self, height: int = 480) -> str:
        """A self-contained piece of HTML that shows the meshes and contacts in WebGL, to turn, zoom and move.

        Of meshes. For a notebook: IPython.display.HTML(result.to_html()). It needs no package and no network. About 100
        bytes a triangle. `height` is in pixels. Raises InvalidInput.
        """
        if self._of_world:
            raise InvalidInput('to_html shows meshes: save("page.html") shows a world')
        self._check("pairs")
        return _core.to_html(*self._meshes(), self._held(), height)

    def _meshes(self) -> tuple[Mesh, Mesh | None]:
        if self._request.block:
            raise InvalidInput("meshes are shown of a whole result, but this is one of its blocks")
        return self._scene[0], self._scene[1]

    def _held(self) -> Any:
        """The result as the extension module has it; one that came through pickle is put together once more."""
        return self._found

    def _painted(self) -> Painted:
        from ._drawing import Painted

        if not self._of_world:
            self._check("pairs")
            first, second = self._meshes()
            return Painted(first, self.hit, self.contacts, second, self.hit_second)
        import numpy as np

        world, poses = self._scene
        sizes = np.array([shape.triangles for shape in world.shapes], np.int64)[world.bodies]
        first = np.concatenate([[0], np.cumsum(sizes)])
        if self._request.output == "body_pairs":
            collides = np.zeros(len(world), np.bool_)
            collides[self.bodies.ravel()] = True
            return Painted(world._mesh_at(poses), np.repeat(collides, sizes), None)
        hit = np.zeros(first[-1], np.bool_)
        hit[(first[self.bodies] + self._found.pairs).ravel()] = True
        return Painted(world._mesh_at(poses), hit, self.contacts)

    def __repr__(self) -> str:
        output, s = self._request.output, self.statistics
        found = f"{self._found.count} colliding pairs"
        if output in ("any", "any_by_world"):
            found = "something collides" if self._found.any else "nothing collides"
        elif output == "body_pairs":
            found = f"{len(self._found.bodies)} colliding pairs of bodies"
        if self._request.block:
            return f"<crumple.Intersections: a block of {found}>"
        of = f"{len(self._scene[0])} bodies" if self._of_world else f"{s.triangles} triangles"
        return f"<crumple.Intersections: {found} of {of}, {s.milliseconds:.3g} ms>"
