"""Result of an IntersectionQuery: NumPy views, and files and pictures of them."""

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
    from ._drawing import PictureContents

_PICTURES = {".png": "PNG", ".jpg": "JPEG", ".jpeg": "JPEG", ".bmp": "BMP", ".tif": "TIFF", ".tiff": "TIFF"}
_PAIR_FILES = {".txt", ".csv", ".json", ".npz"}
_MESH_FILES = {".ply", ".obj", ".glb", ".3mf", ".html"}
OUTPUTS = ("any", "any_by_world", "body_pairs", "count", "pairs", "contacts")
# For each attribute, the first of OUTPUTS from which on it exists.
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
    """Result of an IntersectionQuery: pairs of triangles that intersect, each once.

    `bool(result)` is True if anything intersects, and `len(result)` is the number of rows.

    Notes
    -----
    Every backend and thread count gives the same bytes. Order and ids:

    - one mesh: in lexicographic order, first < second;
    - two meshes: in lexicographic order; the first id is a triangle of the first mesh, the second one of the second;
    - a world: sorted by first body, its triangle, second body, its triangle; triangles have indices within their
      bodies. So the rows of each world follow those of the world before. Pairs of bodies that are both in all worlds
      occur once, come last, and count for no world;
    - a part: pairs have the ids of the whole meshes. Offsets, hit flags, pictures and mesh files have the part's own
      triangles, in the order of Part.triangles.

    The result refers to the meshes, or to the world and its poses, for `show`, `save` and `to_html`. These are the
    caller's arrays: pictures show their current contents. Deep copies and pickles contain copies of them.
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
        """Number of pairs of triangles that intersect. Requires output "count" or more."""
        self._check("count")
        return self._found.count

    pairs = int32('(k, 2) int32: triangles of each pair. Requires output="pairs" or more.', (2,))

    _contact_kinds = uint8("Contacts.kinds.")
    _contact_offsets = int64("Contacts.offsets.")
    _contact_points = float64("Contacts.points.", (3,))

    @cached_property
    def contacts(self) -> Contacts | None:
        """Contacts of the pairs, or None if output="contacts" was not requested."""
        if self._request.output != "contacts":
            return None
        return Contacts(self._contact_kinds, self._contact_offsets, self._contact_points)

    bodies = int32(
        '(k, 2) int32, for worlds: bodies of each pair; for output="body_pairs" each intersecting pair of bodies once.',
        (2,),
    )
    inside = bools(
        '(k,) bool, with `containment` and output="body_pairs": True for pairs of `bodies` whose surfaces do not '
        "meet, and of which one body has a component inside the other."
    )
    skipped = int32(
        '(s,) int32, with `containment` and open="skip": bodies whose surfaces are not closed, among selected pairs '
        "whose boxes overlap and whose surfaces do not meet."
    )
    offsets = int64("(m + 1,) int64, for meshes: pairs with first triangle i are pairs[offsets[i]:offsets[i + 1]].")
    hit = bools(
        "(m,) bool: True for triangles in some pair: of the first mesh; with `index`, of all bodies of a world."
    )
    hit_second = bools("(m,) bool: True for triangles of the second mesh in some pair; empty for one mesh.")
    world_hit = bools(
        '(worlds,) bool: True for worlds in which anything intersects. Requires output="any_by_world" or more.'
    )
    world_counts = int64(
        '(worlds,) int64: number of pairs of triangles of each world. Requires output="count" or more.'
    )
    world_offsets = int64(
        "(worlds + 1,) int64, with `index`: world w has the rows [world_offsets[w]:world_offsets[w + 1]]. Rows of "
        "bodies that are in all worlds follow."
    )
    body_offsets = int64(
        "(n + 1,) int64, with `index`: rows whose first body is b are [body_offsets[b]:body_offsets[b + 1]]."
    )
    first_triangle = int64("(n + 1,) int64, with `index`: start of each body's triangles in `hit`, and the end.")

    @property
    def names(self) -> list[tuple[str, str]]:
        """Names of `bodies`, row by row. For configurations, the names in the world that they are made from."""
        world = self.world
        return [(world.names[a], world.names[b]) for a, b in world.originals[self.bodies].tolist()]

    @property
    def world(self) -> World:
        """World that was searched. Raises InvalidInput for meshes."""
        if not self._of_world:
            raise InvalidInput("the scene is a mesh or two, not a world")
        return self._scene[0]

    def __len__(self) -> int:
        """Number of rows; 0 if they were not requested."""
        return len(self._found.bodies if self._of_world else self._found.pairs)

    def show(self, **options: Any) -> Any:
        """Shows the meshes in a window or a notebook, with colliding triangles coloured and contacts drawn.

        Parameters
        ----------
        **options
            Passed to `pyvista.Plotter.show`.

        Returns
        -------
        object
            Result of `pyvista.Plotter.show`.

        Raises
        ------
        ModuleNotFoundError
            If PyVista is not installed.
        """
        from ._drawing import plotter

        return plotter(self._painted(), off_screen=None).show(**options)

    def save(self, path: str | os.PathLike[str], **options: Any) -> None:
        """Writes a file of the kind that its extension selects.

        Parameters
        ----------
        path : str or os.PathLike
            File. By extension:

            - .txt, .csv, .json, .npz: pairs of meshes, and contacts if there are any;
            - .ply, .obj, .glb, .3mf: the meshes with colliding triangles coloured. For worlds, .glb and .3mf have
              bodies with names and poses, which share shapes; .ply and .obj have one mesh. For output="body_pairs",
              whole bodies are coloured;
            - .png, .jpg, .jpeg, .bmp, .tif, .tiff: the picture that `show` shows; needs PyVista;
            - .html: an interactive page that fills the window.
        **options
            For pictures, passed to `pyvista.Plotter.screenshot`, for instance `window_size=(1600, 1200)`. For .html of
            meshes, `height`: writes the HTML of `to_html` instead.

        Raises
        ------
        InvalidInput
            If the extension is another one, an option does not apply to the extension, or the meshes have changed and
            no longer fit the result.
        FileError
            If the file cannot be written.
        ModuleNotFoundError
            If PyVista is needed and not installed.

        Notes
        -----
        The file appears when it is complete; an existing file stays until then. Files that show a mesh need its arrays
        in host memory. Ctrl-C waits until the file is written.
        """
        name = file_name(path)
        extension = extension_of(name)
        lists = set() if self._of_world else _PAIR_FILES
        for option in options:
            if extension in lists | _MESH_FILES and (self._of_world or (extension, option) != (".html", "height")):
                raise InvalidType(f"{option} is not an option of {extension} files")
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
        """Returns self-contained HTML that shows the meshes and contacts in WebGL, to turn, zoom and pan.

        For meshes only. In a notebook: `IPython.display.HTML(result.to_html())`. Needs no package and no network.

        Parameters
        ----------
        height : int, default 480
            Height in pixels.

        Returns
        -------
        str
            About 100 bytes per triangle.

        Raises
        ------
        InvalidInput
            If the scene is a world, or pairs were not requested.
        """
        if self._of_world:
            raise InvalidInput('to_html supports only meshes; use save("page.html") for a world')
        self._check("pairs")
        return _core.to_html(*self._meshes(), self._held(), height)

    def _meshes(self) -> tuple[Mesh, Mesh | None]:
        if self._request.block:
            raise InvalidInput("only a whole result can be shown with its meshes, but this is one of its blocks")
        return self._scene[0], self._scene[1]

    def _held(self) -> Any:
        """Returns the result of the extension module. Unpickled objects have one, too."""
        return self._found

    def _painted(self) -> PictureContents:
        from ._drawing import PictureContents

        if not self._of_world:
            self._check("pairs")
            first, second = self._meshes()
            return PictureContents(first, self.hit, self.contacts, second, self.hit_second)
        import numpy as np

        world, poses = self._scene
        sizes = np.array([shape.triangles for shape in world.shapes], np.int64)[world.bodies]
        first = np.concatenate([[0], np.cumsum(sizes)])
        if self._request.output == "body_pairs":
            collides = np.zeros(len(world), np.bool_)
            collides[self.bodies.ravel()] = True
            return PictureContents(world._mesh_at(poses), np.repeat(collides, sizes), None)
        hit = np.zeros(first[-1], np.bool_)
        hit[(first[self.bodies] + self._found.pairs).ravel()] = True
        return PictureContents(world._mesh_at(poses), hit, self.contacts)

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
