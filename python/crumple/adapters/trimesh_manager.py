"""CollisionManager with the methods of trimesh.collision.CollisionManager, but exact and without FCL.

Meshes are those of trimesh, or anything that as_mesh takes; neither trimesh nor python-fcl is needed. The differences
from trimesh 5 are:

- Results are exact for the meshes under their transforms. (trimesh rounds the transform of add_object to float32, and
  FCL decides in floating point.)
- Every closed mesh is a solid, so a mesh inside another one collides. In trimesh this holds for convex meshes only.
  `CollisionManager(solid=False)` makes all meshes surfaces.
- Distances of objects that collide are 0, never negative.
- Contacts are the pairs of triangles that intersect, all of them, also of convex meshes. A point is the middle of their
  intersection. Normal and depth are those of the overlap of both objects (docs/overlap.md): the normal points from the
  first object to the second one, the depth is the mean depth, and both are NaN if an object is not closed or the
  overlap has no volume. A mesh that lies inside another one without touching its surface has no contacts.

Examples
--------
    from crumple.adapters.trimesh_manager import CollisionManager

    manager = CollisionManager()
    manager.add_object("table", table)
    manager.add_object("cup", cup, transform)
    hit, names = manager.in_collision_internal(return_names=True)
"""

from __future__ import annotations

from collections.abc import Hashable
from typing import TYPE_CHECKING, Any

import numpy as np

from .._arrays import host_array
from .._detector import Detector
from .._errors import InvalidInput
from .._mesh import Mesh, Shape, as_mesh, constant_shape
from .._queries import DistanceQuery, IntersectionQuery, OverlapQuery, PairFilter
from .._world import World
from ._batches import pose_of

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["CollisionManager", "ContactData", "DistanceData"]

EXTERNAL = "__external"  # name of the mesh of in_collision_single and min_distance_single, as in trimesh
_BETWEEN = PairFilter(groups="between")


class ContactData:
    """Contact of two objects: a pair of triangles that intersect.

    Attributes
    ----------
    names : set
        Names of the objects.
    point : (3,) ndarray of float64
        Middle of the intersection of the triangles.
    normal : (3,) ndarray of float64
        Contact normal of the objects, from the first to the second; NaN if there is none.
    depth : float
        Mean depth of the objects' overlap; NaN if there is none.
    """

    def __init__(self, names: tuple[Any, Any], triangles: Any, point: Any, normal: Any, depth: float) -> None:
        self.names, self.point, self.normal, self.depth = set(names), point, normal, depth
        self._triangles: dict[Any, int] = dict(zip(names, triangles))

    def index(self, name: Hashable) -> int:
        """Returns the triangle of the object with this name."""
        return self._triangles[name]


class DistanceData:
    """Distance of two objects.

    Attributes
    ----------
    names : set
        Names of the objects.
    distance : float
        Distance; 0 if they collide.
    """

    def __init__(self, names: tuple[Any, Any], triangles: Any, points: Any, distance: float) -> None:
        self.names, self.distance = set(names), distance
        self._triangles: dict[Any, int] = dict(zip(names, triangles))
        self._points: dict[Any, NDArray[np.float64]] = dict(zip(names, points))

    def index(self, name: Hashable) -> int:
        """Returns the closest triangle of the object with this name."""
        return self._triangles[name]

    def point(self, name: Hashable) -> NDArray[np.float64]:
        """Returns the closest point of the surface of the object with this name: (3,) ndarray of float64."""
        return self._points[name]


class CollisionManager:
    """Set of objects with names and transforms. See the module for differences from trimesh.

    Parameters
    ----------
    solid : bool, default True
        True: closed meshes are solids; False: all meshes are surfaces.
    **options
        Options of crumple.Detector.

    Notes
    -----
    Meshes are copied. The detector caches data of each object that was added, some 150 bytes per triangle, until the
    manager is destroyed.
    """

    def __init__(self, *, solid: bool = True, **options: Any) -> None:
        self.detector = Detector(**options)
        self.solid = solid
        self._shapes: dict[Hashable, Shape] = {}
        self._poses: dict[Hashable, NDArray[np.float64]] = {}

    def add_object(self, name: Hashable, mesh: Any, transform: Any = None) -> None:
        """Adds an object, or replaces the one with this name.

        Parameters
        ----------
        name : hashable
            Name of the object.
        mesh : trimesh.Trimesh, or mesh
            Anything that as_mesh takes.
        transform : (4, 4) or (3, 4) array_like, optional
            Transform of the object; None: identity.

        Raises
        ------
        InvalidInput, InvalidType
            If mesh or transform are invalid.
        """
        pose = _pose(transform, name)
        self._shapes[name] = constant_shape(_copy(mesh), f"object {name!r}: ")
        self._poses[name] = pose

    def remove_object(self, name: Hashable) -> None:
        """Removes an object. Raises InvalidInput, a ValueError, if there is none with this name."""
        self._check(name)
        del self._shapes[name], self._poses[name]

    def set_transform(self, name: Hashable, transform: Any) -> None:
        """Replaces the transform of an object. Raises InvalidInput, a ValueError, if there is none with this name."""
        self._check(name)
        self._poses[name] = _pose(transform, name)

    def in_collision_single(
        self, mesh: Any, transform: Any = None, return_names: bool = False, return_data: bool = False
    ) -> Any:
        """Returns whether a mesh collides with objects.

        Parameters
        ----------
        mesh, transform
            As for add_object.
        return_names : bool
            True: also returns the names of all objects that collide with the mesh.
        return_data : bool
            True: also returns the contacts, in which the mesh has the name "__external" and is the second object.

        Returns
        -------
        is_collision : bool
        names : set
            If `return_names`.
        contacts : list of ContactData
            If `return_data`.
        """
        world, names = self._with_external(mesh, transform)
        found = self._collisions(world, names, _BETWEEN, return_names, return_data)
        if return_names:
            return found[0], {first for first, _ in found[1]}, *found[2:]
        return found

    def in_collision_internal(self, return_names: bool = False, return_data: bool = False) -> Any:
        """Returns whether any two objects collide.

        Parameters
        ----------
        return_names : bool
            True: also returns all pairs of names, each in ascending order.
        return_data : bool
            True: also returns the contacts.

        Returns
        -------
        is_collision : bool
        names : set of tuple
            If `return_names`.
        contacts : list of ContactData
            If `return_data`.
        """
        world, names = self._world([self])
        found = self._collisions(world, names, PairFilter(), return_names, return_data)
        if return_names:
            return found[0], {tuple(sorted(pair)) for pair in found[1]}, *found[2:]
        return found

    def in_collision_other(
        self, other_manager: CollisionManager, return_names: bool = False, return_data: bool = False
    ) -> Any:
        """Returns whether any object collides with one of another manager.

        Parameters
        ----------
        other_manager : CollisionManager
        return_names : bool
            True: also returns all pairs of names, of this manager and of the other one.
        return_data : bool
            True: also returns the contacts.

        Returns
        -------
        is_collision : bool
        names : set of tuple
            If `return_names`.
        contacts : list of ContactData
            If `return_data`.
        """
        world, names = self._world([self, other_manager])
        return self._collisions(world, names, _BETWEEN, return_names, return_data)

    def min_distance_single(
        self, mesh: Any, transform: Any = None, return_name: bool = False, return_data: bool = False
    ) -> Any:
        """Returns the least distance of a mesh from the objects.

        Parameters
        ----------
        mesh, transform
            As for add_object.
        return_name : bool
            True: also returns the name of the closest object.
        return_data : bool
            True: also returns a DistanceData, in which the mesh has the name "__external".

        Returns
        -------
        distance : float
            0 if the mesh collides with an object.
        name : hashable
            If `return_name`.
        data : DistanceData
            If `return_data`.

        Raises
        ------
        InvalidInput
            If there are no objects.
        """
        world, names = self._with_external(mesh, transform)
        found = self._nearest(world, names, _BETWEEN)
        return _chosen(found[0], found[1][0], found[2], return_name, return_data)

    def min_distance_internal(
        self, name: Hashable = None, return_names: bool = False, return_data: bool = False
    ) -> Any:
        """Returns the least distance of any two objects, or of one from the others.

        Parameters
        ----------
        name : hashable, optional
            Object whose distance from the others is returned; None: of any two.
        return_names : bool
            True: also returns the names of the closest objects, in ascending order.
        return_data : bool
            True: also returns a DistanceData.

        Returns
        -------
        distance : float
            0 if two objects collide.
        names : tuple
            If `return_names`.
        data : DistanceData
            If `return_data`.

        Raises
        ------
        InvalidInput
            If there is no object with this name, or there are no two objects.
        """
        if name is not None:
            self._check(name)
        world, names = self._world([self], alone=name)
        found = self._nearest(world, names, PairFilter() if name is None else _BETWEEN)
        pair = tuple(sorted(found[1])) if return_names else found[1]
        return _chosen(found[0], pair, found[2], return_names, return_data)

    def min_distance_other(
        self, other_manager: CollisionManager, return_names: bool = False, return_data: bool = False
    ) -> Any:
        """Returns the least distance of any object from one of another manager.

        Parameters
        ----------
        other_manager : CollisionManager
        return_names : bool
            True: also returns the names of the closest objects, of this manager and of the other one.
        return_data : bool
            True: also returns a DistanceData.

        Returns
        -------
        distance : float
            0 if two objects collide.
        names : tuple
            If `return_names`.
        data : DistanceData
            If `return_data`.

        Raises
        ------
        InvalidInput
            If one of the managers has no objects.
        """
        world, names = self._world([self, other_manager])
        return _chosen(*self._nearest(world, names, _BETWEEN), return_names, return_data)

    def _check(self, name: Hashable) -> None:
        if name not in self._shapes:
            raise InvalidInput(f"{name} not in collision manager!")  # the words of trimesh

    def _world(self, managers: list[CollisionManager], alone: Hashable = None) -> tuple[World, list[Any]]:
        """Returns a world of all objects, with a group for each manager or for the object `alone`, and their names."""
        rows = [(name, manager, i) for i, manager in enumerate(managers) for name in manager._shapes]
        return self._made(
            [manager._shapes[name] for name, manager, _ in rows],
            [manager._poses[name] for name, manager, _ in rows],
            [int(alone is not None and name == alone) or i for name, _, i in rows],
        ), [name for name, _, _ in rows]

    def _with_external(self, mesh: Any, transform: Any) -> tuple[World, list[Any]]:
        shapes = [*self._shapes.values(), Shape(_copy(mesh))]
        poses = [*self._poses.values(), _pose(transform, EXTERNAL)]
        return self._made(shapes, poses, [0] * len(self._shapes) + [1]), [*self._shapes, EXTERNAL]

    def _made(self, shapes: list[Shape], poses: list[Any], groups: list[int]) -> World:
        return World(shapes, poses=np.array(poses).reshape(-1, 3, 4), groups=groups)

    def _collisions(
        self, world: World, names: list[Any], selected: PairFilter, return_names: bool, return_data: bool
    ) -> Any:
        output: Any = "body_pairs" if return_names else "any"
        query = IntersectionQuery(output=output, filter=selected, containment=self.solid, open="skip")
        found = self.detector.find(world, query)
        made: list[Any] = [bool(found.any)]
        if return_names:
            made.append({(names[a], names[b]) for a, b in found.bodies.tolist()})
        if return_data:
            made.append(self._contacts(world, names, selected))
        return tuple(made) if len(made) > 1 else made[0]

    def _contacts(self, world: World, names: list[Any], selected: PairFilter) -> list[ContactData]:
        overlaps = self.detector.find(world, OverlapQuery(open="skip", filter=selected))
        rows = zip(overlaps.bodies.tolist(), overlaps.normal.copy(), overlaps.mean_depth.tolist())
        overlap = {(a, b): (normal, depth) for (a, b), normal, depth in rows}
        found = self.detector.find(world, IntersectionQuery(output="contacts", filter=selected))
        contacts: Any = found.contacts
        points, offsets = contacts.points, contacts.offsets.tolist()
        made = []
        for i, ((a, b), triangles) in enumerate(zip(found.bodies.tolist(), found.pairs.tolist())):
            own = points[offsets[i] : offsets[i + 1]]
            normal, depth = overlap.get((a, b), (np.full(3, np.nan), np.nan))
            made.append(ContactData((names[a], names[b]), triangles, own.mean(axis=0), normal, depth))
        return made

    def _nearest(
        self, world: World, names: list[Any], selected: PairFilter
    ) -> tuple[float, tuple[Any, Any], DistanceData]:
        """Returns the least distance, the names of the two objects, and data about them."""
        found = self.detector.find(world, DistanceQuery(output="nearest", filter=selected))
        if not len(found):
            raise InvalidInput("there are no two objects to measure a distance between")
        pair, distance = found.bodies[0].tolist(), float(found.distance[0])
        triangles, points = found.triangles[0].tolist(), found.points[0].copy()
        if distance > 0 and self.solid:
            query = IntersectionQuery(output="body_pairs", filter=selected, containment=True, open="skip")
            inside = self.detector.find(world, query).bodies
            if len(inside):  # the surfaces do not meet, but one object is inside another one
                pair, distance = inside[0].tolist(), 0.0
                two = World([world.shapes[i] for i in pair], poses=world.poses[pair])
                found = self.detector.find(two, DistanceQuery())
                triangles, points = found.triangles[0].tolist(), found.points[0].copy()
        both = names[pair[0]], names[pair[1]]
        return distance, both, DistanceData(both, triangles, points, distance)


def _chosen(distance: float, names: Any, data: DistanceData, return_names: bool, return_data: bool) -> Any:
    made = [distance, *[names] * return_names, *[data] * return_data]
    return tuple(made) if len(made) > 1 else distance


def _copy(mesh: Any) -> Mesh:
    given = as_mesh(mesh)
    vertices = np.array(host_array(given.vertices, "vertices"))
    return Mesh(vertices, np.array(host_array(given.faces, "faces")).reshape(-1, 3))


def _pose(transform: Any, name: Hashable) -> NDArray[np.float64]:
    return pose_of(np.eye(3, 4) if transform is None else transform, f"object {name!r}", "transform")
