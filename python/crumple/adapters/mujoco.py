"""Exact contacts between the meshes of a MuJoCo model. MuJoCo itself collides their convex hulls.

Needs mujoco (`pip install mujoco`). Pairs of geoms are selected as MuJoCo selects them.

Examples
--------
    from crumple.adapters.mujoco import Collisions

    collisions = Collisions(model)
    contacts = collisions.contacts(data)               # after mujoco.mj_forward or mj_kinematics
    contacts.geoms, contacts.normal, contacts.depth    # of each pair of geoms that touch
    free = ~collisions.collides(qpos)                  # (n,) bool, for (n, nq) positions
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from .._detector import Detector
from .._errors import InvalidInput
from .._mesh import Mesh, Shape, constant_shape
from .._queries import IntersectionQuery, OverlapQuery, PairFilter
from .._world import World
from ._batches import excluded_groups, finite_rows, slices
from ._primitives import box, capsule, cylinder, ellipsoid, sphere

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["Collisions", "Contacts", "selected_pairs"]

_WORLDS = 1 << 13  # positions searched in one call of the detector


class Contacts(NamedTuple):
    """Pairs of geoms that touch or overlap, each once.

    Attributes
    ----------
    geoms : (k, 2) ndarray of int32
        Ids of both geoms, the lower one first, in ascending order.
    normal : (k, 3) ndarray of float64
        Contact normal, pointing from the geom with the smaller id to the other one: the direction of the area vector of
        the overlap. NaN for pairs that only touch, of which one geom is inside the other, or of which one is a mesh
        that is not closed.
    depth : (k,) ndarray of float64
        Mean depth: volume of the overlap over the length of its area vector, at most the greatest depth; NaN where the
        normal is.
    position : (k, 3) ndarray of float64
        Centroid of the overlap; NaN if its volume is 0 or not defined.
    volume : (k,) ndarray of float64
        Volume of the overlap; NaN if a geom is a mesh that is not closed.
    """

    geoms: NDArray[np.int32]
    normal: NDArray[np.float64]
    depth: NDArray[np.float64]
    position: NDArray[np.float64]
    volume: NDArray[np.float64]


class Collisions:
    """Collisions between the geoms of a model.

    Meshes are searched as they are. Round primitives become polyhedra that contain them. A height field becomes a
    closed mesh, and a plane a box below it that reaches beyond all other geoms. Flexes are left out, and so are
    margins: geoms at a distance above 0 have no contact.

    Parameters
    ----------
    model : mujoco.MjModel
        Model. Its meshes, sizes and filters are read once.
    max_tessellation_error : float, default 0.001
        Upper bound on how far polyhedra extend beyond the round primitives that they replace.
    **options
        Options of crumple.Detector.

    Attributes
    ----------
    geoms : (m,) ndarray of int32
        Ids of the geoms that are in a selected pair.
    tessellation_error : float
        Bound on how far polyhedra extend beyond round primitives that was reached; 0 without such primitives.
    detector : Detector

    Raises
    ------
    ImportError
        If mujoco is not installed.
    InvalidInput
        If a geom has no shape that can be searched. Names the geom.
    """

    def __init__(self, model: Any, *, max_tessellation_error: float = 1e-3, **options: Any) -> None:
        mujoco = _mujoco()
        self._model, self._data = model, mujoco.MjData(model)
        selected = selected_pairs(model)
        # Geoms of the world come last, as bodies that are in all worlds.
        used = np.unique(selected).astype(np.int32)
        fixed = model.body_weldid[model.geom_bodyid[used]] == 0
        self._planes = model.geom_type[used] == mujoco.mjtGeom.mjGEOM_PLANE
        fixed &= ~self._planes  # the box of a plane depends on the positions of other geoms
        fixed &= not fixed.all()  # a world needs a body that is not in all worlds
        order = np.argsort(fixed, kind="stable")
        self.geoms, self._planes, self._moving = used[order], self._planes[order], int((~fixed).sum())
        self.detector, self.tessellation_error = Detector(**options), 0.0
        shapes: dict[Any, tuple[int, Shape]] = {}
        of = [self._shape(geom, shapes, max_tessellation_error) for geom in self.geoms.tolist()]
        groups, tested = _groups(self.geoms, selected)
        self._world = World(
            [shape for _, shape in shapes.values()],
            np.array(of, np.int32),
            poses=np.tile(np.eye(3, 4), (len(of), 1, 1)),
            groups=groups,
            worlds=[0] * self._moving + [-1] * (len(of) - self._moving),
        )
        self._filter = PairFilter(excluded_groups=excluded_groups(tested))

    def poses(self, positions: Any) -> NDArray[np.float64]:
        """Returns the poses of `geoms`; those of planes also scale the box that takes the place of the plane.

        Parameters
        ----------
        positions : mujoco.MjData, or (..., nq) array_like of float
            Data after mj_kinematics or mj_forward, or joint positions, for which mj_kinematics is called.

        Returns
        -------
        (m, 3, 4) or (..., m, 3, 4) ndarray of float64
        """
        if hasattr(positions, "geom_xpos"):
            alone: NDArray[np.float64] = self._placed(positions.geom_xpos[None], positions.geom_xmat[None])[0]
            return alone
        rows, leading = self._rows(positions)
        return self._kinematics(rows).reshape(*leading, len(self.geoms), 3, 4)

    def collides(self, positions: Any) -> NDArray[np.bool_]:
        """Returns whether any selected pair of geoms collides; one inside the other counts if the other is closed.

        Parameters
        ----------
        positions : mujoco.MjData, or (..., nq) array_like of float
            As for `poses`. Mocap bodies stay where they are at the start of a simulation.

        Returns
        -------
        (...) ndarray of bool

        Raises
        ------
        InvalidInput, MemoryLimit
            As Detector.find.
        """
        query = IntersectionQuery(output="any_by_world", filter=self._filter, containment=True, open="skip")
        leading: tuple[int, ...] = ()
        parts: Iterable[NDArray[np.float64]]
        if hasattr(positions, "geom_xpos"):
            parts = [self.poses(positions)[None]]
        else:
            joints, leading = self._rows(positions)
            parts = (self._kinematics(joints[rows]) for rows in slices(len(joints), _WORLDS))
        if not len(self.geoms):
            return np.zeros(leading, bool)
        found = [self.detector.find(self._many(poses), query).world_hit.copy() for poses in parts]
        return np.concatenate([np.empty(0, bool), *found]).reshape(leading)

    def contacts(self, data: Any) -> Contacts:
        """Returns the selected pairs of geoms that touch or overlap.

        Parameters
        ----------
        data : mujoco.MjData, or (nq,) array_like of float
            As for `poses`.

        Returns
        -------
        Contacts

        Raises
        ------
        InvalidInput, MemoryLimit
            As Detector.find.

        Notes
        -----
        MuJoCo's `dist` is minus the depth of the deepest point; the mean depth is at most the greatest depth. A geom
        that is wholly inside another one, or below a plane, has a volume but no normal. Cost: that of an OverlapQuery.
        """
        poses = self.poses(data)
        if poses.ndim != 3:
            raise InvalidInput(f"contacts takes MjData or positions of shape ({self._model.nq},), not {np.shape(data)}")
        world = self._world.at(poses)
        found = self.detector.find(world, OverlapQuery(open="curves", filter=self._filter))
        geoms = self.geoms[found.bodies]
        swapped = geoms[:, 0] > geoms[:, 1]
        order = np.lexsort((geoms.max(axis=1), geoms.min(axis=1)))
        normal = np.where(swapped[:, None], -found.normal, found.normal)
        parts: Any = np.sort(geoms, axis=1), normal, found.mean_depth, found.centroid, found.volume
        return Contacts(*(part[order] for part in parts))

    def _many(self, poses: NDArray[np.float64]) -> World:
        static = self._world.at(poses[0]) if len(poses) else self._world
        return static.configurations(np.ascontiguousarray(poses[:, : self._moving]))

    def _rows(self, positions: Any) -> tuple[NDArray[np.float64], tuple[int, ...]]:
        columns = int(self._model.nq)
        return finite_rows(positions, "positions", columns, f"be MjData or have shape (..., {columns})")

    def _kinematics(self, rows: NDArray[np.float64]) -> NDArray[np.float64]:
        mujoco, data = _mujoco(), self._data
        place = np.empty((len(rows), self._model.ngeom, 3))
        turn = np.empty((len(rows), self._model.ngeom, 9))
        for i, row in enumerate(rows):
            data.qpos[:] = row
            mujoco.mj_kinematics(self._model, data)
            place[i], turn[i] = data.geom_xpos, data.geom_xmat
        return self._placed(place, turn)

    def _placed(self, place: NDArray[np.float64], turn: NDArray[np.float64]) -> NDArray[np.float64]:
        """Returns poses, (n, m, 3, 4), from positions and rotations of all geoms of the model."""
        poses = np.empty((len(place), len(self.geoms), 3, 4))
        poses[..., 3] = place[:, self.geoms]
        poses[..., :3] = turn[:, self.geoms].reshape(len(place), -1, 3, 3)
        solid = ~self._planes
        if solid.any():
            radii = self._model.geom_rbound[self.geoms[solid]]
            for i in np.flatnonzero(self._planes):
                # The box is scaled about the plane's origin so that no geom reaches its other five sides.
                places = poses[..., 3]
                apart = np.linalg.norm(places[:, solid] - places[:, i, None], axis=2)
                poses[:, i, :, :3] *= 2 * (apart + radii).max(axis=1)[:, None, None]
        return poses

    def _shape(self, geom: int, shapes: dict[Any, tuple[int, Shape]], max_error: float) -> int:
        """Returns the index of the shape of a geom. Geoms that use the same mesh share a shape."""
        model, data = self._model, int(self._model.geom_dataid[geom])
        kind = _mujoco().mjtGeom(int(model.geom_type[geom])).name.removeprefix("mjGEOM_")
        key = (kind, data) if data >= 0 else (kind, *model.geom_size[geom].tolist())
        if key not in shapes:
            mesh = _mesh(model, kind, data, model.geom_size[geom], max_error)
            if mesh is None:
                raise InvalidInput(f"geom {geom} ({model.geom(geom).name!r}) is a {kind}, which has no mesh")
            shape = constant_shape(Mesh(np.array(mesh.vertices), np.array(mesh.faces)), f"geom {geom}: ")
            shapes[key] = len(shapes), shape
            self.tessellation_error = max(self.tessellation_error, getattr(mesh, "tessellation_error", 0.0))
        return shapes[key][0]


def selected_pairs(model: Any) -> NDArray[np.int32]:
    """Returns the pairs of geoms that MuJoCo tests: (k, 2) ids, the lower one first, in ascending order.

    A pair is selected if a <pair> lists it. It is also selected if contype of one geom and conaffinity of the other
    have a common bit, except for geoms of the same body or of bodies that are welded together, of a body and its parent
    (unless the parent is welded to the world, or the model disables this filter), and of bodies that an <exclude>
    lists.

    Parameters
    ----------
    model : mujoco.MjModel
    """
    mujoco = _mujoco()
    first, second = np.triu_indices(model.ngeom, 1)
    types, affinities, body = model.geom_contype, model.geom_conaffinity, model.geom_bodyid
    kept = ((types[first] & affinities[second]) | (types[second] & affinities[first])) != 0
    weld = model.body_weldid[body]
    above = model.body_weldid[model.body_parentid[weld]]
    a, b = weld[first], weld[second]
    kept &= a != b
    if not model.opt.disableflags & mujoco.mjtDisableBit.mjDSBL_FILTERPARENT:
        kept &= (a == 0) | (b == 0) | ((a != above[second]) & (b != above[first]))
    low, high = np.minimum(body[first], body[second]), np.maximum(body[first], body[second])
    kept &= ~np.isin((low.astype(np.int64) << 16) + high, model.exclude_signature)
    listed = np.sort(np.column_stack([model.pair_geom1, model.pair_geom2]).reshape(-1, 2), axis=1)
    pairs = np.concatenate([np.column_stack([first, second])[kept], listed[listed[:, 0] != listed[:, 1]]])
    return np.unique(pairs, axis=0).astype(np.int32).reshape(-1, 2)


def _mujoco() -> Any:
    try:
        import mujoco
    except ImportError as error:
        raise ImportError(f"crumple.adapters.mujoco needs mujoco ({error}): pip install mujoco") from None
    return mujoco


def _groups(geoms: NDArray[np.int32], selected: NDArray[np.int32]) -> tuple[NDArray[np.int32], NDArray[np.bool_]]:
    """Returns a group for each geom, and the pairs of groups that are tested, a symmetric matrix.

    Geoms that are tested with the same others, such as those of one body, share a group. No two of them are a selected
    pair, because no geom is tested with itself.
    """
    place = np.full(geoms.max(initial=-1) + 1, -1)
    place[geoms] = np.arange(len(geoms))
    tested = np.zeros((len(geoms), len(geoms)), bool)
    first, second = place[selected].T
    tested[first, second] = tested[second, first] = True
    if not len(geoms):
        return np.empty(0, np.int32), tested
    _, some, groups = np.unique(tested, axis=0, return_index=True, return_inverse=True)
    return groups.reshape(-1).astype(np.int32), tested[np.ix_(some, some)]


def _mesh(model: Any, kind: str, data: int, size: NDArray[np.float64], max_error: float) -> Mesh | None:
    """Returns the mesh of a geom in its own frame; None if it has none."""
    if kind in ("MESH", "SDF") and data >= 0:
        vertices = slice(model.mesh_vertadr[data], model.mesh_vertadr[data] + model.mesh_vertnum[data])
        faces = slice(model.mesh_faceadr[data], model.mesh_faceadr[data] + model.mesh_facenum[data])
        return Mesh(model.mesh_vert[vertices], model.mesh_face[faces])
    if kind == "HFIELD":
        return _height_field(model, data)
    if kind == "PLANE":  # the upper side of a box of size 1, which poses scale
        unit = box([1.0, 1.0, 1.0])
        return Mesh(unit.vertices * [2, 2, 1] - [0, 0, 0.5], unit.faces)
    if kind == "SPHERE":
        return sphere(size[0], max_error=max_error)
    if kind == "CAPSULE":
        return capsule(size[0], 2 * size[1], max_error=max_error)
    if kind == "CYLINDER":
        return cylinder(size[0], 2 * size[1], max_error=max_error)
    if kind == "ELLIPSOID":
        return ellipsoid(size, max_error=max_error)
    return box(2 * size) if kind == "BOX" else None


def _height_field(model: Any, field: int) -> Mesh:
    """Returns a height field as a closed mesh with a flat bottom, its cells cut as MuJoCo cuts them."""
    rows, columns = int(model.hfield_nrow[field]), int(model.hfield_ncol[field])
    wide, deep, top, bottom = model.hfield_size[field].tolist()
    begin = int(model.hfield_adr[field])
    heights = np.asarray(model.hfield_data[begin : begin + rows * columns], np.float64)
    x, y = np.meshgrid(np.linspace(-wide, wide, columns), np.linspace(-deep, deep, rows))
    upper = np.column_stack([x.ravel(), y.ravel(), heights * top])
    lower = np.column_stack([x.ravel(), y.ravel(), np.full(rows * columns, -bottom)])
    index = np.arange(rows * columns).reshape(rows, columns)
    a, b, c, d = (part.ravel() for part in (index[:-1, :-1], index[:-1, 1:], index[1:, 1:], index[1:, :-1]))
    faces = np.concatenate([np.column_stack([a, b, c]), np.column_stack([a, c, d])])
    count = rows * columns
    around = np.concatenate([index[0], index[1:, -1], index[-1, -2::-1], index[-2:0:-1, 0]])
    following = np.roll(around, -1)
    sides = [np.column_stack([around, around + count, following + count])]
    sides.append(np.column_stack([around, following + count, following]))
    return Mesh(
        np.concatenate([upper, lower]), np.concatenate([faces, faces[:, ::-1] + count, *sides]).astype(np.int32)
    )
