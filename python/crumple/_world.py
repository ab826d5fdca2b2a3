"""Worlds as input: bodies and their poses."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from difflib import get_close_matches
from functools import cached_property
from typing import TYPE_CHECKING, Any, NamedTuple

from . import _core
from ._errors import InvalidInput, InvalidType, suggesting
from ._mesh import Mesh, OwnName, Shape, constant_shape, shape_of  # noqa: F401, pickles of 0.2 find OwnName here

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray


class Body(NamedTuple):
    """Body of a world, for worlds that are made body by body. World also takes arrays with values for all bodies.

    Attributes
    ----------
    shape : int or Shape
        Index into the shapes of the World, or one of these shapes.
    pose : (3, 4) or (4, 4) array_like, or None
        Affine map; the last row of (4, 4) is 0 0 0 1. None: identity.
    group : int
        Group of the body's triangles if the shape has no groups.
    world : int
        Index of the world that contains the body; -1: all worlds.
    self_collisions : bool
        True: queries also search for pairs within the body.
    name : str
        Name for excluded pairs and messages; "": no name.
    end_pose : (3, 4) or (4, 4) array_like, or None
        Pose at the end of a step; None: the same as `pose`.
    """

    shape: Any
    pose: Any = None
    group: int = 0
    world: int = 0
    self_collisions: bool = False
    name: str = ""
    end_pose: Any = None


class World(_core.World):
    """World of bodies. A body is a shape with a pose. Any number of bodies may use the same shape.

    Parameters
    ----------
    shapes : iterable of Shape or mesh
        Shapes, or meshes that as_mesh takes.
    bodies : (n,) array_like of int, or sequence of Body, optional
        Index of each body's shape; None: one body per shape. Or a sequence of Body; then the arguments below must not
        be given.
    poses : (n, 3, 4) or (n, 4, 4) array_like of float64 or float32, optional
        Affine maps; the last row of (4, 4) is 0 0 0 1. None: identity for all.
    groups : int or (n,) array_like of int, optional
        Group of each body, within the range of int32, for bodies whose shape has no groups.
    worlds : (n,) array_like of int, optional
        World index of each body, ascending. Bodies of different worlds are never paired. Bodies with index -1 are in
        all worlds, and come last. None: all bodies are in world 0.
    self_collisions : bool or (n,) array_like of bool, default False
        True: queries also search for pairs within the body.
    names : iterable of str, optional
        Names for excluded pairs and messages, unique unless empty.
    end_poses : array_like, optional
        Poses at the end of a step, as `poses`, for queries about motion: each posed vertex moves straight from start to
        end. None: the same as `poses`.

    Attributes
    ----------
    unit : {"um", "mm", "cm", "in", "ft", "m"} or None
        Unit of the coordinates that read_world found in the file; None: unknown. Files that Intersections.save writes
        have this unit.

    Raises
    ------
    InvalidInput
        If an argument is invalid. Names the argument. Searches validate the contents of shapes.

    Notes
    -----
    `len(world)` is the number of bodies. Poses may be replaced at any time (`world.poses = poses`, `world.end_poses =
    poses`), which costs next to nothing; nothing else can change.

    Each search reads the current contents of the pose arrays, so these may change between searches. Contiguous float64
    arrays of shape (n, 3, 4) are read in place, others are copied. With the cuda backend, Detector.find also accepts
    contiguous poses of shape (n, 3, 4) in CUDA memory, through DLPack. Bodies and shapes then stay cached on the device
    between calls of Detector.find and Detector.launch; other queries download the poses.

    docs/worlds.md defines the results, and posed vertices to the bit.
    """

    unit: str | None = None

    @suggesting
    def __init__(
        self,
        shapes: Iterable[Any],
        bodies: Any = None,
        *,
        poses: Any = None,
        groups: Any = None,
        worlds: Any = None,
        self_collisions: Any = False,
        names: Iterable[str] | None = None,
        end_poses: Any = None,
    ) -> None:
        import numpy as np

        from . import _world_arrays as columns

        if isinstance(shapes, (Shape, Mesh)) or not isinstance(shapes, Iterable):
            raise InvalidType(f"shapes must be a sequence of crumple.Shape or of meshes, not {type(shapes).__name__}")
        made = tuple(shape_of(shape, f"shape {i}: ") for i, shape in enumerate(shapes))
        if isinstance(bodies, Sequence) and len(bodies) and all(isinstance(body, Body) for body in bodies):
            given = (poses, groups, worlds, names, end_poses)
            if any(column is not None for column in given) or self_collisions is not False:
                raise InvalidInput(
                    "poses, groups, worlds, self_collisions and names must be given in each crumple.Body"
                )
            bodies, poses, groups, worlds, self_collisions, names, end_poses = zip(*bodies)
            poses, end_poses = columns.stacked(poses, end_poses)
            bodies = columns.shapes_of(made, bodies)
        of = columns.ids(np.arange(len(made)) if bodies is None else bodies, "bodies")
        n = len(of)
        groups = columns.ids(0 if groups is None else groups, "groups", n)
        worlds = columns.ids(0 if worlds is None else worlds, "worlds", n)
        self_collisions = columns.flags(self_collisions, "self_collisions", n)
        all_names = columns.names(names, n)
        columns.check_shapes(of, len(made), all_names)
        columns.check_worlds(worlds, all_names)
        super().__init__(list(made), of, groups, worlds, self_collisions, poses, end_poses)
        self._shapes, self._names = made, all_names
        self._base: World | None = None
        self._columns = {
            "bodies": of,
            "groups": groups,
            "worlds": worlds,
            "self_collisions": self_collisions,
            "originals": columns.ids(np.arange(n), "originals"),
        }

    @classmethod
    def from_trimesh(cls, scene: Any) -> World:
        """Makes the world of a trimesh.Scene: each node with a mesh is a body, with its name and transform.

        Several nodes that use one geometry share a shape. Paths and points are left out. Vertices and faces are copied,
        so that detectors can cache data about them: make a world once, then only replace its poses.

        Parameters
        ----------
        scene : trimesh.Scene

        Returns
        -------
        World

        Raises
        ------
        InvalidInput, InvalidType
            If the scene is invalid.
        """
        import numpy as np

        if not all(hasattr(scene, name) for name in ("graph", "geometry")):
            kind = type(scene)
            raise InvalidType(f"scene must be a trimesh.Scene, not {kind.__module__}.{kind.__qualname__}")
        shapes: list[Shape] = []
        places: dict[str, int] = {}
        names, of, poses = [], [], []
        for node in scene.graph.nodes_geometry:
            transform, geometry = scene.graph[node]
            mesh = scene.geometry[geometry]
            if not hasattr(mesh, "faces"):  # the geometry is a path or points
                continue
            if geometry not in places:
                places[geometry] = len(shapes)
                copied = Mesh(np.array(mesh.vertices), np.array(mesh.faces))
                shapes.append(constant_shape(copied, f"geometry {geometry!r}: "))
            names.append(str(node))
            of.append(places[geometry])
            poses.append(np.asarray(transform, np.float64))
        return World(shapes, of, poses=np.array(poses).reshape(-1, 4, 4), names=names)

    def configurations(self, poses: Any, end_poses: Any = None) -> World:
        """Makes a world of many configurations of this world's bodies. Each configuration has a world index of its own.

        Bodies in world 0 are repeated for each configuration. Bodies in all worlds (-1) are static: they keep their
        poses, and can collide with the bodies of each configuration.

        Parameters
        ----------
        poses : (k, m, 3, 4) or (k, m, 4, 4) array_like
            Poses of k configurations of the m bodies in world 0.
        end_poses : array_like, optional
            Poses at the end of a step, as `poses`, for queries about motion; None: the same as `poses`.

        Returns
        -------
        World
            Body b of configuration c has index c * m + b; static bodies follow. In `excluded_bodies`, use the names and
            indices of this world; they apply to each configuration. `world.poses = poses` sets other poses, in an array
            of the same shape.

        Raises
        ------
        InvalidInput
            If this world has world indices other than 0 and -1, is itself made of configurations, or the shape of
            `poses` is wrong.

        Notes
        -----
        Cost: some nanoseconds per body. If there are static bodies, each search copies the poses, 96 bytes per body.
        """
        if self._base is not None:
            raise InvalidInput("configurations need a world that does not consist of configurations itself")
        import numpy as np

        from ._arrays import host_array

        worlds = self.worlds
        if not np.isin(worlds, (0, -1)).all():
            body = int(np.flatnonzero(~np.isin(worlds, (0, -1)))[0])
            raise InvalidInput(
                f"body {body}: its world is {worlds[body]}; configurations need bodies in world 0, which "
                "move, and in all worlds (-1), which do not",
                element="body",
                index=body,
            )
        if (np.diff(worlds) > 0).any():
            raise InvalidInput("bodies that are in all worlds (-1) must come last")
        shape = getattr(poses, "shape", None) or host_array(poses, "poses").shape
        if len(shape) != 4:
            moving = int((worlds == 0).sum())
            raise InvalidInput(
                f"poses of configurations must have shape (configurations, {moving}, 3, 4) or (configurations, "
                f"{moving}, 4, 4), not {tuple(shape)}"
            )
        made = World.__new__(World)
        made._configure(self, int(shape[0]), poses, end_poses)
        made._shapes, made._columns, made._base, made.unit = self._shapes, {}, self, self.unit
        return made

    def at(self, poses: Any, end_poses: Any = None) -> World:
        """Returns a world of the same bodies with other poses. Everything else is shared with this world.

        Parameters
        ----------
        poses, end_poses : array_like
            Poses, in the form that World takes.

        Returns
        -------
        World

        Raises
        ------
        InvalidInput
            If the shape of the poses is wrong.

        Notes
        -----
        Cost: next to nothing.
        """
        made = World.__new__(World)
        made._pose(self, poses, end_poses)
        made.__dict__.update(self.__dict__)
        return made

    @property
    def shapes(self) -> tuple[Shape, ...]:
        """Shapes as given, or as made from the given meshes."""
        return self._shapes

    def _column(self, name: str) -> Any:
        """Returns a column: one entry per body. For configurations, entries of moving bodies are repeated."""
        if self._base is None:
            return self._columns[name]
        if name not in self._columns:
            import numpy as np

            column, moving = self._base._column(name), self._moving
            if name == "worlds":
                repeated = np.repeat(np.arange(self._count, dtype=np.int32), moving)
            else:
                repeated = np.tile(column[:moving], self._count)
            made = np.concatenate([repeated, column[moving:]])
            made.flags.writeable = False
            self._columns[name] = made
        return self._columns[name]

    @property
    def originals(self) -> NDArray[np.int32]:
        """Index of each body in the world that configurations are made from; else its own index: (n,) int32."""
        return self._column("originals")

    @property
    def distinct(self) -> int:
        """Number of bodies in one configuration, including static ones; without configurations, len(world)."""
        return len(self) if self._base is None else len(self._base)

    @property
    def bodies(self) -> NDArray[np.int32]:
        """Index of each body's shape: (n,) int32."""
        return self._column("bodies")

    @property
    def groups(self) -> NDArray[np.int32]:
        """Group of each body's triangles, if its shape has no groups: (n,) int32."""
        return self._column("groups")

    @property
    def worlds(self) -> NDArray[np.int32]:
        """World index of each body, or -1 for bodies in all worlds: (n,) int32."""
        return self._column("worlds")

    @property
    def self_collisions(self) -> NDArray[np.bool_]:
        """True for bodies within which queries also search for pairs: (n,) bool."""
        return self._column("self_collisions")

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the bodies, "" for none. For configurations, the names in the world that they are made from."""
        return self._names if self._base is None else self._base._names

    @property
    def mesh(self) -> Mesh:
        """All posed bodies as one mesh, body after body; the group of each triangle is the index of its body.

        Each access makes a new copy. Vertices have the positions that a search uses.
        """
        return self._mesh_at(self.poses)

    def _mesh_at(self, poses: Any) -> Mesh:
        return Mesh(*_core.posed_mesh(self, poses, self._all_names())[:3])

    def _all_names(self) -> list[str]:
        """Returns a name for each body, for files: "body 7" if a body has none."""
        if self._base is None:
            return [name or f"body {body}" for body, name in enumerate(self._names)]
        own = self._base._all_names()
        moving = [f"{name} {c}" for c in range(self._count) for name in own[: self._moving]]
        return moving + own[self._moving :]

    @cached_property
    def _index(self) -> dict[str, int]:
        return {name: body for body, name in enumerate(self.names) if name}

    def index(self, name: str) -> int:
        """Returns the index of the body with this name.

        For configurations, this is the index in the world that they are made from.

        Parameters
        ----------
        name : str

        Returns
        -------
        int

        Raises
        ------
        InvalidInput
            If there is no such body. Suggests the most similar name.
        """
        try:
            return self._index[name]
        except KeyError:
            close = get_close_matches(name, list(self._index), n=1)
            meant = f"; did you mean {close[0]!r}?" if close else ""
            raise InvalidInput(f"there is no body {name!r}{meant}", element="body") from None

    def __reduce__(self) -> Any:
        from ._arrays import if_given, poses

        own_poses, end_poses = (if_given(poses, given) for given in (self.poses, self.end_poses))
        if self._base is not None:
            import numpy as np

            # Static bodies keep the poses that they had when the configurations were made.
            base, moving = self._base.__reduce__(), np.tile(np.eye(3, 4), (self._moving, 1, 1))
            base_world = restore_world(*base[1][:-2], np.concatenate([moving, self._static_poses]))
            arguments = (base_world, own_poses, end_poses)
            return restore_configurations, arguments, {"unit": self.unit} if self.unit else None
        names = ("bodies", "groups", "worlds", "self_collisions")
        columns = (self._columns[name] for name in names)
        arguments = (self._shapes, *columns, self._names, own_poses, end_poses)
        return restore_world, arguments, {"unit": self.unit} if self.unit else None

    def __repr__(self) -> str:
        if self._base is None:
            return f"<crumple.World: {len(self)} bodies of {len(self._shapes)} shapes>"
        return f"<crumple.World: {self._count} configurations of {self._moving} bodies, {len(self)} in all>"


def restore_world(
    shapes: Any,
    bodies: Any,
    groups: Any,
    worlds: Any,
    self_collisions: Any,
    names: Any,
    poses: Any,
    end_poses: Any = None,
) -> World:
    """Makes a world from the contents of a pickle."""
    columns = {"groups": groups, "worlds": worlds, "self_collisions": self_collisions, "names": names}
    return World(shapes, bodies, poses=poses, end_poses=end_poses, **columns)


def restore_configurations(base: Any, poses: Any, end_poses: Any = None) -> World:
    """Makes a world of configurations from the contents of a pickle."""
    if not isinstance(base, World):
        raise InvalidType("the state of a world of configurations needs a World")
    return base.configurations(poses, end_poses)
