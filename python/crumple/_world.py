"""Worlds as input: bodies, and where they are."""

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
    """One body, for worlds that are put together one by one; World takes arrays for all bodies at once as well.

    Attributes:
        shape: index into the world's shapes, or one of these shapes itself.
        pose: (3, 4) or (4, 4), the latter ending in 0 0 0 1; None: as given.
        group: of its triangles, where the shape has no groups of its own.
        world: which world it is in; -1: in all.
        self_collisions: whether pairs within the body are wanted.
        name: for exclusions and messages; "": none.
        end_pose: as `pose`, at the end of a step; None: as at its start.
    """

    shape: Any
    pose: Any = None
    group: int = 0
    world: int = 0
    self_collisions: bool = False
    name: str = ""
    end_pose: Any = None


class World(_core.World):
    """Bodies, each a shape under a pose; any number of them may share one shape.

    Args:
        shapes: of Shape, or of meshes that as_mesh knows.
        bodies: (n,) integers, the index of each body's shape; None: one body a shape. Or n of Body, and then none of
            the arguments below.
        poses: (n, 3, 4) or (n, 4, 4) of float64 or float32: affine maps, the latter ending in 0 0 0 1. None: all as
            given. Read by each search where they lie (float64 without gaps, of three rows) or copied by it, so that
            they may be written to between searches. Detector.find with the cuda backend also takes those in CUDA
            memory, (n, 3, 4) without gaps, by DLPack: bodies and shapes then stay on the device from call to call of
            Detector.find and launch, and other queries copy the poses.
        groups: (n,) integers that fit int32, or one for all: of the triangles of shapes without groups of their own.
        worlds: (n,) integers, ascending: which world each body is in. Bodies of different worlds never meet; -1: in all
            worlds; such bodies come last. None: all in world 0.
        self_collisions: True or False, or (n,) of bool: whether pairs within each body are wanted.
        names: n of str, each once unless empty: for exclusions and messages.
        end_poses: as `poses`, at the end of a step, for queries about a step: each vertex goes straight from where it
            is posed at the start to where it is posed at the end. None: as `poses`.

    `world.poses = poses` and `world.end_poses = poses` cost next to nothing; all else stays as it is.
    `len(world)` is the number of bodies. Raises InvalidInput, which names the argument; what is wrong with arrays
    of shapes, which are only read by a search, that search refuses.

    What is answered, and what a posed vertex is to the bit: docs/worlds.md.

    Attributes:
        unit: of the coordinates, "um", "mm", "cm", "in", "ft" or "m", as read_world found it; None: unknown. Pictures
            and files that Intersections.save writes keep it.
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
                raise InvalidInput("poses, groups, worlds, self_collisions and names are those of each crumple.Body")
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
        """The world of a trimesh.Scene: each node that has a mesh is a body, with its name and its transform.

        Geometry that several nodes share is one shape. Paths and points are left out. Vertices and faces are copied,
        so that detectors can remember them: make a world once, and set its poses. Raises InvalidInput, InvalidType.
        """
        import numpy as np

        if not all(hasattr(scene, name) for name in ("graph", "geometry")):
            kind = type(scene)
            raise InvalidType(f"a scene of trimesh is wanted, not {kind.__module__}.{kind.__qualname__}")
        shapes: list[Shape] = []
        places: dict[str, int] = {}
        names, of, poses = [], [], []
        for node in scene.graph.nodes_geometry:
            transform, geometry = scene.graph[node]
            mesh = scene.geometry[geometry]
            if not hasattr(mesh, "faces"):  # paths and points, which bound nothing
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
        """A world of many configurations of this one's bodies, each in a world of its own, against those at rest.

        Args:
            poses: (k, m, 3, 4) or (k, m, 4, 4): k configurations of the m bodies that are in world 0 here. Bodies that
                are in all worlds (-1) stay where they are now.
            end_poses: the same at the end of a step, for queries about a step; None: as `poses`.

        Body b of configuration c has index c * m + b; those at rest follow. Names and indices in `excluded` are those
        of this world, and hold in each configuration. `world.poses = poses` gives others, as many. Raises
        InvalidInput.

        Cost: some nanoseconds a body; a search copies 96 bytes a body if there are bodies at rest.
        """
        if self._base is not None:
            raise InvalidInput("configurations are made of a world that is none of configurations itself")
        import numpy as np

        from ._arrays import host_array

        worlds = self.worlds
        if not np.isin(worlds, (0, -1)).all():
            body = int(np.flatnonzero(~np.isin(worlds, (0, -1)))[0])
            raise InvalidInput(
                f"body {body}: its world is {worlds[body]}; configurations are made of bodies in world 0, which "
                "move, and in all worlds (-1), which do not",
                element="body",
                index=body,
            )
        if (np.diff(worlds) > 0).any():
            raise InvalidInput("bodies that are in all worlds (-1) come last")
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
        """The same bodies under other poses, given as World and `world.poses` take them; it shares all else.

        Cost: next to nothing. Raises InvalidInput.
        """
        made = World.__new__(World)
        made._pose(self, poses, end_poses)
        made.__dict__.update(self.__dict__)
        return made

    @property
    def shapes(self) -> tuple[Shape, ...]:
        """The shapes, as World was given them or as it made them of meshes."""
        return self._shapes

    def _column(self, name: str) -> Any:
        """A column of the world; of configurations, that of the bodies that move repeated, and the rest of it."""
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
        """(n,) int32: for each body, which one of the world that the configurations are made of; else itself."""
        return self._column("originals")

    @property
    def distinct(self) -> int:
        """How many bodies one configuration has, those at rest included; otherwise len(world)."""
        return len(self) if self._base is None else len(self._base)

    @property
    def bodies(self) -> NDArray[np.int32]:
        """(n,) int32: the index of each body's shape."""
        return self._column("bodies")

    @property
    def groups(self) -> NDArray[np.int32]:
        """(n,) int32: the group of each body's triangles, where its shape has none of its own."""
        return self._column("groups")

    @property
    def worlds(self) -> NDArray[np.int32]:
        """(n,) int32: which world each body is in; -1: in all."""
        return self._column("worlds")

    @property
    def self_collisions(self) -> NDArray[np.bool_]:
        """(n,) bool: whether pairs within each body are wanted."""
        return self._column("self_collisions")

    @property
    def names(self) -> tuple[str, ...]:
        """The names of the bodies; "" for one without. Of configurations, those of the world they are made of."""
        return self._names if self._base is None else self._base._names

    @property
    def mesh(self) -> Mesh:
        """All bodies as one mesh, one after the other, each vertex where a search has it; groups are the bodies.

        A copy of the whole, for pictures and files.
        """
        return self._mesh_at(self.poses)

    def _mesh_at(self, poses: Any) -> Mesh:
        return Mesh(*_core.posed_mesh(self, poses, self._all_names())[:3])

    def _all_names(self) -> list[str]:
        """A name for each body, for files."""
        if self._base is None:
            return [name or f"body {body}" for body, name in enumerate(self._names)]
        own = self._base._all_names()
        moving = [f"{name} {c}" for c in range(self._count) for name in own[: self._moving]]
        return moving + own[self._moving :]

    @cached_property
    def _index(self) -> dict[str, int]:
        return {name: body for body, name in enumerate(self.names) if name}

    def index(self, name: str) -> int:
        """The body of this name. Raises InvalidInput, which suggests the nearest name. Of configurations as `names`."""
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

            # Those at rest stay where they were when the configurations were made.
            base, moving = self._base.__reduce__(), np.tile(np.eye(3, 4), (self._moving, 1, 1))
            base_world = restore_world(*base[1][:-2], np.concatenate([moving, self._poses_at_rest]))
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
    """The world of a pickle."""
    columns = {"groups": groups, "worlds": worlds, "self_collisions": self_collisions, "names": names}
    return World(shapes, bodies, poses=poses, end_poses=end_poses, **columns)


def restore_configurations(base: Any, poses: Any, end_poses: Any = None) -> World:
    """The world of configurations of a pickle."""
    if not isinstance(base, World):
        raise InvalidType("the state of a world of configurations needs a World")
    return base.configurations(poses, end_poses)
