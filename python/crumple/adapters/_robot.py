"""Robots: which configurations collide, how far apart bodies are, and which motions are free.

A robot is a tree of joints with a mesh for each link. All methods take many configurations at once, and make a world of
each.
"""

from __future__ import annotations

import copy
from collections.abc import Callable, Iterable, Iterator, Mapping
from typing import TYPE_CHECKING, Any, NamedTuple
from weakref import WeakKeyDictionary

import numpy as np

from .._detector import Detector
from .._errors import InvalidInput, InvalidType
from .._mesh import Mesh, Shape, as_mesh
from .._queries import DistanceQuery, ImpactQuery, IntersectionQuery, PairFilter
from .._world import World
from ._batches import excluded_groups, finite_rows, rigid_pose_of, slices, suggestion
from ._kinematics import Joint, Tree
from ._obstacles import Obstacles, allowed_pairs, copied_shape

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["LinkPairs", "Robot"]

_WORLDS = 1 << 14  # worlds in one call of the detector: poses of a robot of ten links then take 16 MB
_COARSE = 1 / 400  # share of the robot's reach by which the first pieces of a motion may deviate from it


class LinkPairs(NamedTuple):
    """Pairs of bodies that collide.

    Attributes
    ----------
    configurations : (k,) ndarray of int64
        Configuration of each pair, ascending.
    bodies : (k, 2) ndarray of int32
        Indices into `names`, the lower one first.
    names : tuple of str
        Names of all bodies: links, attached objects, then obstacles.
    """

    configurations: NDArray[np.int64]
    bodies: NDArray[np.int32]
    names: tuple[str, ...]

    def of(self, configuration: int) -> list[tuple[str, str]]:
        """Returns the names of the pairs that collide in a configuration, given its index."""
        first, last = np.searchsorted(self.configurations, [configuration, configuration + 1])
        return [(self.names[a], self.names[b]) for a, b in self.bodies[first:last].tolist()]


class Robot:
    """Tree of joints, with a mesh for each link that can collide. `urdf.load` makes one from files.

    Parameters
    ----------
    joints : sequence of Joint
        Joints in any order.
    meshes : mapping of str to mesh
        Mesh of each link that can collide, in the link's frame. Copied.
    allowed : iterable of (str, str)
        Pairs of links that are not tested (allowed collision matrix), in addition to adjacent ones.
    limits : mapping of str to (float, float)
        Lowest and highest values of joints, by name. Joints without an entry have no limits.
    solid : bool, default True
        True: a closed body inside another one collides with it; False: only surfaces collide.
    tessellation_error : float, default 0
        Value of the attribute `tessellation_error`, for meshes that replace round primitives.
    base : str, optional
        Link whose frame is that of poses and obstacles; None: the link that is not the child of a joint.
    **options
        Options of crumple.Detector.

    Attributes
    ----------
    variables : tuple of str
        Names of the joints whose values make a configuration: those that move and mimic no other.
    links : tuple of str
        Names of the links with a mesh, then of attached objects.
    allowed : frozenset of frozenset of str
        Allowed pairs, which are not tested; adjacent links included. Links are adjacent if a joint connects them, or a
        chain of joints between links without meshes.
    limits : (2, variables) ndarray of float64
        Lowest and highest values; infinite for joints without limits.
    tessellation_error : float
        Upper bound on how far meshes extend beyond the round primitives that they replace; 0 without such primitives.
    detector : Detector

    Raises
    ------
    InvalidInput
        If joints do not make a tree, no link has a mesh, or an argument is invalid.

    Notes
    -----
    Poses are computed in float64, and so are rounded by some 1e-16 times the size of the robot. Everything after that
    is exact for these poses, as docs/worlds.md states. Methods ignore limits.

    In all methods, configurations have shape (..., variables), and results have the leading part of that shape.
    Obstacles are given as Obstacles, or as a mapping as for Obstacles, which is then read in each call.
    """

    def __init__(
        self,
        joints: Iterable[Joint],
        meshes: Mapping[str, Any],
        allowed: Iterable[tuple[str, str]] = (),
        *,
        limits: Mapping[str, tuple[float, float]] | None = None,
        solid: bool = True,
        tessellation_error: float = 0.0,
        base: str | None = None,
        **options: Any,
    ) -> None:
        tree = Tree(list(joints), base)
        unknown = [link for link in meshes if link != tree.base and link not in tree.parents]
        if unknown:
            raise InvalidInput(f"{unknown[0]!r} has a mesh but is no link of the robot")
        if not meshes:
            raise InvalidInput("no link of the robot has a mesh, so it cannot collide")
        self.limits = _limits(tree, limits or {})
        self.solid, self.tessellation_error = solid, tessellation_error
        self.detector = Detector(**options)
        copies = {link: as_mesh(mesh) for link, mesh in meshes.items()}
        shapes = {link: copied_shape(mesh, f"link {link!r}: ") for link, mesh in copies.items()}
        radii = {link: _radius(mesh) for link, mesh in copies.items()}
        self._set(tree, shapes, radii, _adjacent(tree, meshes) | allowed_pairs(allowed))

    def _set(self, tree: Tree, shapes: dict[str, Shape], radii: dict[str, float], allowed: frozenset[Any]) -> None:
        _check_names(allowed, shapes, "no link with a mesh")
        self._tree, self._shapes, self._radii, self.allowed = tree, shapes, radii, allowed
        self.variables, self.links = tuple(tree.variables), tuple(shapes)
        self._worlds: WeakKeyDictionary[Obstacles, tuple[World, PairFilter]] = WeakKeyDictionary()
        self._alone = Obstacles({})

    def attach(self, name: str, mesh: Any, link: str, pose: Any = None, touching: Iterable[str] = ()) -> Robot:
        """Returns this robot with an object that is fixed to a link, for instance in a gripper.

        Parameters
        ----------
        name : str
            Name of the object.
        mesh : mesh
            Anything that as_mesh takes. Copied.
        link : str
            Link to which the object is fixed. The two are an allowed pair.
        pose : (3, 4) or (4, 4) array_like, optional
            Rotation and translation of the object in the frame of the link; None: identity.
        touching : iterable of str
            Other links that make allowed pairs with the object, such as fingers.

        Returns
        -------
        Robot
            Uses the detector of this robot, which does not change.

        Raises
        ------
        InvalidInput
            If there is no such link, the name is taken, or the pose is not a rotation with a translation.
        """
        if name in self._tree.parents or name == self._tree.base:
            raise InvalidInput(f"{name!r} is already the name of a link")
        if link not in self._tree.parents and link != self._tree.base:
            raise InvalidInput(f"the robot has no link {link!r}")
        origin = rigid_pose_of(np.eye(4) if pose is None else pose, f"attached object {name!r}")
        joint = Joint(f"{name} is attached", link, name, "fixed", origin)
        tree, mesh = Tree([*self._tree.joints, joint], self._tree.base), as_mesh(mesh)
        shapes = {**self._shapes, name: copied_shape(mesh, f"attached object {name!r}: ")}
        allowed = self.allowed | _adjacent(tree, shapes) | allowed_pairs((name, other) for other in touching)
        made = copy.copy(self)
        made._set(tree, shapes, {**self._radii, name: _radius(mesh)}, allowed)
        return made

    def poses(self, configurations: Any) -> NDArray[np.float64]:
        """Returns the poses of `links` in the frame of the base.

        Parameters
        ----------
        configurations : (..., variables) array_like of float
            Values of the joints, in radians and units of length.

        Returns
        -------
        (..., links, 4, 4) ndarray of float64

        Raises
        ------
        InvalidInput
            If the shape is wrong, or a value is not finite.
        """
        rows, leading = self._rows(configurations, "configurations")
        made = np.zeros((len(rows), len(self.links), 4, 4))
        made[:, :, :3] = self._tree.poses(rows, self.links)
        made[:, :, 3, 3] = 1
        return made.reshape(*leading, len(self.links), 4, 4)

    @property
    def shapes(self) -> dict[str, Shape]:
        """Shape of each of `links`, in the frame of the link."""
        return dict(self._shapes)

    def world(self, configurations: Any, obstacles: Any = None) -> tuple[World, PairFilter]:
        """Returns a world in which each configuration has a world index of its own, for any query of a detector.

        Parameters
        ----------
        configurations, obstacles
            As for `collides`.

        Returns
        -------
        world : World
            Link l of configuration c is body c * links + l. Obstacles are in all worlds, and come last.
        filter : PairFilter
            Selects the tested pairs: all but the allowed ones, and those of two obstacles.
        """
        rows, _ = self._rows(configurations, "configurations")
        world, allowed = self._world(obstacles)
        return world.configurations(self._tree.poses(rows, self.links)), allowed

    def collides(self, configurations: Any, obstacles: Any = None) -> NDArray[np.bool_]:
        """Returns whether the robot collides with itself or with obstacles, exactly for meshes under rounded poses.

        Parameters
        ----------
        configurations : (..., variables) array_like of float
            Values of the joints.
        obstacles : Obstacles or mapping, optional
            None: only the robot with itself.

        Returns
        -------
        (...) ndarray of bool

        Raises
        ------
        InvalidInput, MemoryLimit
            As Detector.find.

        Notes
        -----
        Cost: some 10 to 30 microseconds per configuration and thread, for a robot of ten links.
        """
        rows, leading = self._rows(configurations, "configurations")
        world, allowed = self._world(obstacles)
        return self._collide(rows, world, allowed).reshape(leading)

    def colliding_links(self, configurations: Any, obstacles: Any = None) -> LinkPairs:
        """Returns all pairs of bodies that collide.

        Parameters
        ----------
        configurations, obstacles
            As for `collides`. A configuration's index counts rows of the array flattened to (n, variables).

        Returns
        -------
        LinkPairs

        Raises
        ------
        InvalidInput, MemoryLimit
            As Detector.find.
        """
        rows, _ = self._rows(configurations, "configurations")
        world, allowed = self._world(obstacles)
        query = self._intersections("body_pairs", allowed)
        configuration, bodies, moving = [], [], len(self.links)
        for first, many in self._configurations(rows, world):
            found = self.detector.find(many, query).bodies
            configuration.append(first + found[:, 0].astype(np.int64) // moving)  # the first body is a link
            bodies.append(many.originals[found])
        return LinkPairs(
            np.concatenate([np.empty(0, np.int64), *configuration]),
            np.concatenate([np.empty((0, 2), np.int32), *bodies]),
            self.links + world.names[moving:],
        )

    def clearances(self, configurations: Any, obstacles: Any = None, *, radius: float = np.inf) -> NDArray[np.float64]:
        """Returns the least distance of any tested pair of bodies.

        Parameters
        ----------
        configurations, obstacles
            As for `collides`.
        radius : float
            Distances above this need not be known, which saves time.

        Returns
        -------
        (...) ndarray of float64
            0 for configurations that collide; infinite if no distance is at most `radius`. Distances of the meshes are
            correctly rounded squared ones, and their roots.

        Raises
        ------
        InvalidInput, MemoryLimit
            As Detector.find.

        Notes
        -----
        Cost: some 100 microseconds per configuration and thread, far less with a small radius.
        """
        rows, leading = self._rows(configurations, "configurations")
        world, allowed = self._world(obstacles)
        query = DistanceQuery(output="nearest", radius=radius, filter=allowed)
        parts = []
        for _, many in self._configurations(rows, world):
            found = self.detector.find(many, query)
            distance = np.append(found.distance, np.inf)  # the row -1 means: none
            parts.append(distance[found.world_rows])
        made = np.concatenate([np.empty(0), *parts])
        apart = np.flatnonzero(made > 0) if self.solid else np.empty(0, np.int64)
        made[apart[self._collide(rows[apart], world, allowed)]] = 0  # a body lies inside another one
        return made.reshape(leading)

    def collides_between(
        self, starts: Any, ends: Any, obstacles: Any = None, *, tolerance: float = 1e-3
    ) -> NDArray[np.bool_]:
        """Returns whether motions collide, in which all joint values change at constant rates. No collision is missed.

        Parameters
        ----------
        starts, ends : (..., variables) array_like of float
            Configurations at the start and at the end of each motion.
        obstacles : Obstacles or mapping, optional
            As for `collides`.
        tolerance : float, default 0.001
            Distance, in the units of the meshes, below which a motion may count as colliding without doing so. Above 0.

        Returns
        -------
        (...) ndarray of bool
            False: no tested pair collides at any time of the motion, up to the rounding of poses. True: a tested pair
            collides, or comes closer than `tolerance`.

        Raises
        ------
        InvalidInput, MemoryLimit
            As Detector.find.

        Notes
        -----
        A motion is cut into pieces. In each, vertices are moved straight, which takes each point of a link at most a
        known distance off its true trajectory (Tree.bends). That distance, for the two links for which it is largest,
        is the minimum distance of the search. Pieces that are not free are halved, until the distance is half the
        tolerance. docs/robots.md has the argument. Cost: proportional to the square root of 1 / tolerance near
        obstacles.
        """
        first, leading = self._rows(starts, "starts")
        last, other = self._rows(ends, "ends")
        if leading != other:
            raise InvalidInput(f"starts and ends must have the same shape, not {leading} and {other} configurations")
        if not (np.isfinite(tolerance) and tolerance > 0):
            raise InvalidInput(f"tolerance must be finite and above 0, not {tolerance}")
        world, allowed = self._world(obstacles)
        hit = self._collide(first, world, allowed) | self._collide(last, world, allowed)
        radii = [self._radii[link] for link in self.links]
        bends = np.sort(self._tree.bends(first, last, self.links, radii), axis=1)
        bend = bends[:, -2:].sum(axis=1)  # of the two links that deviate most
        edge, distance = np.flatnonzero(~hit), tolerance / 2
        while 4 * distance <= _COARSE * self._tree.reach(self.links, radii):
            distance *= 4
        count = np.maximum(1, np.ceil(np.sqrt(bend[edge] / (8 * distance)))).astype(np.int64)
        edge, low, high = _cut(edge, count)
        while True:
            near = self._sweep(first, last, edge, low, high, world, allowed, distance)
            edge, low, high = edge[near], low[near], high[near]
            if distance == tolerance / 2:
                hit[edge] = True
                return hit.reshape(leading)
            middle = (low + high) / 2
            at = first[edge] + middle[:, None] * (last - first)[edge]
            hit[edge[self._collide(at, world, allowed)]] = True
            kept = ~hit[edge]
            edge, low, middle, high = edge[kept], low[kept], middle[kept], high[kept]
            edge, low, high = np.tile(edge, 2), np.append(low, middle), np.append(middle, high)
            distance /= 4  # a piece of half the length deviates a quarter as far

    def _sweep(
        self, first: Any, last: Any, edge: Any, low: Any, high: Any, world: World, allowed: PairFilter, distance: float
    ) -> NDArray[np.bool_]:
        """Returns whether bodies come within a distance in pieces of motions, in which vertices move straight."""
        parts, size = [np.empty(0, bool)], max(self._radii.values(), default=0.0)
        for rows in slices(len(edge), _WORLDS):
            of = edge[rows]
            step = (last - first)[of]
            poses = [self._tree.poses(first[of] + t[rows, None] * step, self.links) for t in (low, high)]
            farthest = max(np.abs(ends[..., 3]).max() for ends in poses)
            rounding = 2.0**-40 * (size + farthest + distance)  # of poses and of the distance
            query = ImpactQuery(output="any_by_world", min_distance=distance + rounding, filter=allowed)
            parts.append(self.detector.find(world.configurations(*poses), query).world_hit.copy())
        return np.concatenate(parts)

    def _collide(self, rows: NDArray[np.float64], world: World, allowed: PairFilter) -> NDArray[np.bool_]:
        query = self._intersections("any_by_world", allowed)
        found = [self.detector.find(many, query).world_hit.copy() for _, many in self._configurations(rows, world)]
        return np.concatenate([np.empty(0, bool), *found])

    def _intersections(self, output: Any, allowed: PairFilter) -> IntersectionQuery:
        return IntersectionQuery(output=output, filter=allowed, containment=self.solid, open="skip")

    def _configurations(self, rows: NDArray[np.float64], world: World) -> Iterator[tuple[int, World]]:
        for part in slices(len(rows), _WORLDS):
            yield part.start, world.configurations(self._tree.poses(rows[part], self.links))

    def _rows(self, configurations: Any, name: str) -> tuple[NDArray[np.float64], tuple[int, ...]]:
        columns = len(self.variables)
        of = f", one value for each of {', '.join(self.variables)}" if columns else ""
        return finite_rows(configurations, name, columns, f"have shape (..., {columns}){of}")

    def _world(self, obstacles: Any) -> tuple[World, PairFilter]:
        """Returns the world of one configuration with obstacles, and the pairs to test in it."""
        if obstacles is None:
            obstacles = self._alone
        elif isinstance(obstacles, Mapping):
            return self._make_world(Obstacles(obstacles), lambda shape: Shape(*shape.mesh))
        elif not isinstance(obstacles, Obstacles):
            raise InvalidType(f"obstacles must be Obstacles or a mapping, not {type(obstacles).__name__}")
        made = self._worlds.get(obstacles)
        if made is None:
            made = self._worlds[obstacles] = self._make_world(obstacles, lambda shape: shape)
        return made

    def _make_world(self, obstacles: Obstacles, shape: Callable[[Shape], Shape]) -> tuple[World, PairFilter]:
        # Each link is a group, and so is each obstacle with allowed pairs; all other obstacles are one group.
        taken = [name for name in obstacles.names if name in self._shapes]
        if taken:
            raise InvalidInput(f"obstacle {taken[0]!r} has the name of a link; rename it")
        _check_names(obstacles.allowed, self.links + obstacles.names, "no link or obstacle")
        special = [name for name in obstacles.names if any(name in pair for pair in obstacles.allowed)]
        group = {name: i for i, name in enumerate((*self.links, *special))}
        common, links = len(group), len(self.links)
        world = World(
            [*self._shapes.values(), *map(shape, obstacles.shapes)],
            poses=np.concatenate([np.tile(np.eye(3, 4), (links, 1, 1)), obstacles.poses]),
            groups=[group.get(name, common) for name in self.links + obstacles.names],
            worlds=[0] * links + [-1] * len(obstacles),
            names=self.links + obstacles.names,
        )
        tested = np.ones((common + 1, common + 1), bool)
        tested[links:, links:] = False  # pairs of obstacles
        for pair in self.allowed | obstacles.allowed:
            a, b = (group[name] for name in pair)
            tested[a, b] = tested[b, a] = False
        return world, PairFilter(excluded_groups=excluded_groups(tested))


def _cut(edge: NDArray[Any], count: NDArray[np.int64]) -> tuple[Any, Any, Any]:
    """Cuts each motion into `count` pieces. Returns their motion, and their share of it from low to high."""
    repeated = np.repeat(count, count)
    place = np.arange(len(repeated)) - np.repeat(np.cumsum(count) - count, count)
    return np.repeat(edge, count), place / repeated, (place + 1) / repeated


def _limits(tree: Tree, given: Mapping[str, tuple[float, float]]) -> NDArray[np.float64]:
    """Returns the lowest and highest values of the variables, (2, variables), from limits of joints by name."""
    names = [joint.name for joint in tree.joints]
    for name, bounds in given.items():
        if name not in names:
            raise InvalidInput(f"limits: no joint is called {name!r}{suggestion(name, names)}")
        if np.shape(bounds) != (2,) or np.isnan(bounds).any():
            raise InvalidInput(f"limits of joint {name!r} must be its lowest and its highest value, not {bounds}")
    bounds_of = [given.get(name, (-np.inf, np.inf)) for name in tree.variables]
    return np.array(bounds_of, np.float64).reshape(-1, 2).T


def _check_names(allowed: frozenset[frozenset[str]], names: Iterable[str], nothing: str) -> None:
    """Raises InvalidInput if an allowed pair has a name that is not among `names`: `nothing` is called so."""
    known = set(names)
    for pair in allowed:
        for name in pair:
            if name not in known:
                both = tuple(sorted(pair))
                raise InvalidInput(f"allowed pair {both}: {nothing} is called {name!r}{suggestion(name, known)}")


def _adjacent(tree: Tree, meshes: Mapping[str, Any]) -> frozenset[frozenset[str]]:
    made = set()
    for link in meshes:
        above = link
        while above != tree.base:
            above = tree.parents[above].parent
            if above in meshes:
                made.add(frozenset((link, above)))
                break
    return frozenset(made)


def _radius(mesh: Mesh) -> float:
    """Returns the largest distance of a vertex from the origin, rounded up."""
    vertices = np.asarray(mesh.vertices, np.float64)
    return float(np.linalg.norm(vertices, axis=1).max(initial=0.0)) * (1 + 2.0**-40)
