"""Detector, and functions for a single call."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from typing import Any, Literal, overload

from . import _core
from ._blocks import taker
from ._candidates import find_candidates
from ._core import Statistics
from ._errors import InvalidInput, InvalidType
from ._feature_streams import stream_candidates, stream_impacts, stream_near
from ._fuzzy_c_means import FuzzyCMeans, check_fuzzy_c_means
from ._launches import (
    launch,
    launch_between,
    launch_candidates,
    launch_impacts,
    launch_near,
    launch_self,
    wait,
    wait_candidates,
    wait_impacts,
    wait_near,
)
from ._mesh import Mesh, as_mesh, soup_of
from ._motion import find_free_step, find_impacts, is_free, time_of_first_impact
from ._names import suggesting
from ._near import find_near
from ._nearest import find_nearest
from ._parts import partition_motion, partition_near
from ._result import Block, Result
from ._world import World
from ._world_result import WorldResult
from ._world_search import Wants, find_in_world

Neighbours = Literal["geometric", "skip"]
Intersections = Literal["all", "proper"]
Wanted = Literal["both", "between", "within"]
Backend = Literal["automatic", "cpu", "cuda", "reference"]
Simd = Literal["automatic", "scalar", "sse4", "avx2", "avx512", "neon"]
GroupPairs = Iterable[tuple[int, int]]


class Detector(_core.Detector):
    """Finds all pairs of triangles that intersect, exactly: in a mesh, between two, or in a world of bodies.

    Keeps buffers and cluster centres between calls, so one detector for all frames of a simulation is faster than a new
    one for each; the topology may change freely. Any triangle soup will do.

    find_impacts and its like tell what touches on its way from one frame to the next, and when; find_near what is near;
    find_candidates lists what a narrow phase of your own would look at.

    Meshes are given as (vertices, faces), or as one object that as_mesh knows: crumple.Mesh, a tuple, a mesh of
    trimesh, meshio, Open3D or PyVista. Arrays are read in place: NumPy or anything on the host that speaks DLPack or
    the buffer protocol, float32 or float64, int32, uint32 or int64, in any order and with any strides. Other integers
    and Python lists are converted, at the cost of a copy. Inputs are not written to, and must not change until the
    call returns. The cuda backend also reads arrays in CUDA memory, after the work of their package's current stream.

    Calls release the GIL. Different detectors work at the same time; calls of one detector from several threads take
    turns. In the main thread Ctrl-C ends a call within about 50 ms, KeyboardInterrupt is raised, and the detector
    stays usable; partition is not cut short while it clusters.

    Args:
        backend: "automatic", "cpu", "cuda", or "reference", brute force in rational arithmetic to compare with.
            "automatic" is "cuda" where it was built and a device is there, else "cpu".
        threads: 0: as many as the machine has, which are the most that are used; they start when the detector is made.
        memory_limit: bytes that the detector may own, 0: no limit. Results that Python holds are not counted.
            Work that exceeds the limit is cut into chunks, on one thread; what still does not fit raises MemoryLimit,
            which names a lower bound.
        clusters: parts of the first level of subdivision, 1 to 64; 0: chosen from the number of triangles.
        leaf_size: triangles that a leaf should have; larger clusters are subdivided again.
        fuzzy_c_means: how the centres of clusters are placed, a crumple.FuzzyCMeans.
        simd: instruction set: "automatic" takes the best that the machine has.
        device: number of the device that the cuda backend works on.
        devices: instead, the numbers of several, which share questions about one mesh on the host; arrays on a device
            are on the first, which does alone what the others cannot share (docs/distributed.md).

    No option changes an answer, only its cost. A detector keeps its options: a second __init__ is refused. Raises
    InvalidInput for options out of range, BackendUnavailable for what this machine or build lacks.

    Source: D. Mainzer, G. Zachmann, "Collision Detection Based on Fuzzy Scene Subdivision", Algorithm 1: clusters by
    fuzzy C-means (sec. 4, eqs. 2-4), each swept along its principal axis (sec. 3, eq. 1), then a test of each pair of
    boxes that overlap; here that test is exact. docs/README.md names the page of each stage.
    """

    __slots__ = ("__weakref__", "_options")

    @suggesting
    def __init__(
        self,
        *,
        backend: Backend = "automatic",
        threads: int = 0,
        memory_limit: int = 0,
        clusters: int = 0,
        leaf_size: int = 3000,
        fuzzy_c_means: FuzzyCMeans = FuzzyCMeans(),
        simd: Simd = "automatic",
        device: int = 0,
        devices: Sequence[int] = (),
    ) -> None:
        options = {
            "backend": backend,
            "threads": threads,
            "memory_limit": memory_limit,
            "clusters": clusters,
            "leaf_size": leaf_size,
            "fuzzy_c_means": check_fuzzy_c_means(fuzzy_c_means),
            "simd": simd,
            "device": device,
            "devices": devices,
        }
        super().__init__(options)
        self._options = options

    @property
    def options(self) -> dict[str, Any]:
        """What the detector was made with."""
        try:
            return dict(self._options)
        except AttributeError:
            raise InvalidInput("crumple.Detector.__init__ has not been called", element="option") from None

    @property
    def backend(self) -> str:
        """The backend in use, "cpu", "cuda" or "reference": the one asked for, or the one that "automatic" chose."""
        return super().backend

    @property
    def fallback(self) -> str:
        """Why "automatic" took the cpu backend although this build has the cuda backend, in one line; else ""."""
        return super().fallback

    def cancel(self) -> None:
        """Asks the call that runs at this moment to end: it raises Error, code "cancelled", within some milliseconds.

        To be called from another thread. A call that is nearly done may still return its answer. Does nothing while
        no call runs; one that waits for its turn goes on waiting. `partition` is not cut short while it clusters.
        """
        super().cancel()

    def __repr__(self) -> str:
        try:
            options = self._options
        except AttributeError:
            return "<crumple.Detector whose __init__ has not been called>"
        return "crumple.Detector(" + ", ".join(f"{name}={value!r}" for name, value in options.items()) + ")"

    @suggesting
    def find_self(
        self,
        vertices: Any,
        faces: Any = None,
        *,
        groups: Any = None,
        neighbours: Neighbours = "geometric",
        intersections: Intersections = "all",
        weld: bool = False,
        contacts: bool = False,
        wanted: Wanted = "both",
        excluded_groups: GroupPairs | None = None,
        copy: bool = False,
    ) -> Result:
        """All colliding pairs within one soup.

        Args:
            vertices: (n, 3) float32 or float64; or a mesh, and then no `faces`.
            faces: (m, 3) integers, or flat: three a triangle.
            groups: (m,) integers that fit int32, one a triangle; None: the mesh's, or all in group 0.
            neighbours: pairs that share a vertex. "geometric": they collide only if they meet outside the hull of what
                they share (a fold counts, a hinge does not); "skip": never reported.
            intersections: "all": touching counts; "proper": only if an edge strictly crosses an interior.
            weld: vertices at equal positions count as one.
            contacts: also compute where each pair meets.
            wanted: which pairs, by their groups: "both", "between" different groups, "within" one.
            excluded_groups: pairs of groups that are not tested against each other: an array or any iterable.
            copy: the result gets writable arrays of its own instead of read-only views.

        Raises InvalidInput, which names the argument and the place; MemoryLimit.

        Cost: a warm call on two threads takes about 0.1 microseconds a triangle on ordinary scenes, more with the
        number of pairs of boxes that overlap; contacts take about a microsecond a pair. Source: Mainzer and Zachmann,
        Algorithm 1; see Detector. What a collision is: docs/contract.md.
        """
        query = _core.Query(neighbours, intersections, weld, contacts, wanted, excluded_groups)
        mesh = soup_of(vertices, faces, groups)
        return Result(self._find(mesh, None, query, copy), mesh, None)

    @suggesting
    def find_between(
        self,
        a: Any,
        b: Any,
        *,
        neighbours: Neighbours = "geometric",
        intersections: Intersections = "all",
        weld: bool = False,
        contacts: bool = False,
        wanted: Wanted = "both",
        excluded_groups: GroupPairs | None = None,
        copy: bool = False,
    ) -> Result:
        """All colliding pairs of a triangle of mesh `a` with one of mesh `b`: (index in a, index in b).

        Meshes are what as_mesh takes, for instance a tuple (vertices, faces). Groups, which compare across both, come
        with crumple.Mesh or a tuple of three. Equal indices share nothing here; with `weld` equal positions do. If one
        mesh is float64, both are computed in float64. Otherwise as find_self, errors, cost and source included.
        """
        query = _core.Query(neighbours, intersections, weld, contacts, wanted, excluded_groups)
        first, second = as_mesh(a), as_mesh(b)
        return Result(self._find(first, second, query, copy), first, second)

    @suggesting
    def stream_self(
        self,
        take: Callable[[Block], Any],
        vertices: Any,
        faces: Any = None,
        *,
        block_rows: int = 1 << 18,
        groups: Any = None,
        neighbours: Neighbours = "geometric",
        intersections: Intersections = "all",
        weld: bool = False,
        contacts: bool = False,
        wanted: Wanted = "both",
        excluded_groups: GroupPairs | None = None,
    ) -> Statistics:
        """Hands all colliding pairs of one soup over in blocks, for answers that exceed memory.

        Args:
            take: called with one crumple.Block after the other. What it raises ends the call. It may run in another
                thread, but never in two at a time, and cannot call this detector.
            block_rows: most pairs of a block, 1 to 2^40.

        Other arguments, errors and source as of find_self. Returns the statistics of the call.

        The order of pairs does not depend on threads; find_self sorts, blocks do not. Cost: that of find_self. Memory:
        that of a search without its pairs, and some 32 bytes for each pair of a block.
        """
        query = _core.Query(neighbours, intersections, weld, contacts, wanted, excluded_groups)
        return self._stream(taker(take, Block), soup_of(vertices, faces, groups), None, query, block_rows)

    @suggesting
    def stream_between(
        self,
        take: Callable[[Block], Any],
        a: Any,
        b: Any,
        *,
        block_rows: int = 1 << 18,
        neighbours: Neighbours = "geometric",
        intersections: Intersections = "all",
        weld: bool = False,
        contacts: bool = False,
        wanted: Wanted = "both",
        excluded_groups: GroupPairs | None = None,
    ) -> Statistics:
        """Hands all colliding pairs of two meshes over in blocks: find_between as stream_self is find_self.

        Arguments, errors, cost and source as of these two.
        """
        query = _core.Query(neighbours, intersections, weld, contacts, wanted, excluded_groups)
        return self._stream(taker(take, Block), as_mesh(a), as_mesh(b), query, block_rows)

    @suggesting
    def has_intersections(
        self,
        vertices: Any,
        faces: Any = None,
        *,
        groups: Any = None,
        neighbours: Neighbours = "geometric",
        intersections: Intersections = "all",
        weld: bool = False,
        wanted: Wanted = "both",
        excluded_groups: GroupPairs | None = None,
    ) -> bool:
        """Whether any two triangles of a soup collide; stops at the first pair. Otherwise as find_self.

        Cost: as find_self if nothing collides, usually less if something does. Source: Mainzer and Zachmann,
        Algorithm 1, cut short.
        """
        query = _core.Query(neighbours, intersections, weld, False, wanted, excluded_groups)
        return self._any(soup_of(vertices, faces, groups), None, query)

    @suggesting
    def has_intersections_between(
        self,
        a: Any,
        b: Any,
        *,
        neighbours: Neighbours = "geometric",
        intersections: Intersections = "all",
        weld: bool = False,
        wanted: Wanted = "both",
        excluded_groups: GroupPairs | None = None,
    ) -> bool:
        """Whether two meshes collide; stops at the first pair. Otherwise as find_between.

        Cost and source: as of has_intersections, for the triangles of both.
        """
        query = _core.Query(neighbours, intersections, weld, False, wanted, excluded_groups)
        return self._any(as_mesh(a), as_mesh(b), query)

    @suggesting
    def partition(self, mesh: Any, second: Any = None, *, count: int) -> list[_core.Part]:
        """Cuts a scene of one mesh or two into `count` (1 to 262144) overlapping, independent parts.

        Each part owns its triangles and can be answered anywhere, without the meshes, by `find`; the answers together
        are the whole answer, and no pair is in two of them. Parts can be pickled, and depend only on the arguments.
        For motion and nearness: partition_motion, partition_near. Raises InvalidInput.

        Cost: a look at each triangle, and its copies; 230 ms for a million triangles in 64 parts on one thread. Source:
        Mainzer and Zachmann, sec. 1.1, for parts on several machines, and sec. 4, eqs. 2-4, for their centres.
        """
        return self._partition(as_mesh(mesh), None if second is None else as_mesh(second), count)

    @overload
    def find(
        self,
        part: _core.Part,
        /,
        *,
        neighbours: Neighbours = "geometric",
        intersections: Intersections = "all",
        weld: bool = False,
        contacts: bool = False,
        wanted: Wanted = "both",
        excluded_groups: GroupPairs | None = None,
        copy: bool = False,
    ) -> Result: ...

    @overload
    def find(
        self,
        world: World,
        /,
        *,
        wants: Wants = "pairs",
        neighbours: Neighbours = "geometric",
        intersections: Intersections = "all",
        weld: bool = False,
        bodies: Wanted = "both",
        groups: Wanted = "both",
        excluded: Any = None,
        excluded_groups: GroupPairs | None = None,
        index: bool = False,
        poses: Any = None,
        copy: bool = False,
    ) -> WorldResult: ...

    def find(self, part_or_world: Any, /, **question: Any) -> Any:
        """What collides in a world of bodies; or the pairs that a part owns (see partition).

        Of a world (crumple.World) it returns a WorldResult. Args:
            wants: how much is made; the first three end at the first hit where they can. "any": whether anything
                collides; "any_by_world": in which worlds; "body_pairs": which bodies; "count": how many pairs of
                triangles; "pairs": all of them; "contacts": and where each pair meets.
            neighbours, intersections, weld: as find_self. Bodies share no vertices, also where they share a shape;
                `weld` makes one of vertices at equal posed positions, across bodies too.
            bodies: "both", pairs "between" bodies, "within" one.
            groups: the same for groups, which compare across bodies.
            excluded: pairs of bodies that are not tested against each other, by name or index: an iterable of sets
                ({"arm", "hand"}; {"arm"}: the arm and itself) or pairs, or an array (k, 2) of integers.
            excluded_groups: the same for groups.
            index: also make offsets by world and by body, and hit flags, where pairs are wanted.
            poses: instead of world.poses, for this call.
            copy: the result gets writable arrays of its own instead of read-only views.

        Of a part (crumple.Part) it returns a Result with the ids of the meshes that it was cut from; offsets and hits
        count in the part's own lists, part.triangles and part.triangles_second. Arguments as of find_self.

        Raises InvalidInput, which names body, shape or argument; MemoryLimit.

        Cost: some microseconds a call, and less than one a body of a named shape that is clear of all others. What
        must be looked at costs what find_self does for these triangles. A part costs as a mesh of its size. Source:
        Mainzer and Zachmann, Algorithm 1, for each world; docs/worlds.md tells what is left out before.
        """
        if isinstance(part_or_world, World):
            return find_in_world(self, part_or_world, **question)
        if not isinstance(part_or_world, _core.Part):
            kind = type(part_or_world)
            name = f"{kind.__module__}.{kind.__qualname__}".removeprefix("builtins.")
            raise InvalidType(f"find takes a crumple.World or a crumple.Part, not {name}")
        return _find_in_part(self, part_or_world, **question)

    partition_motion = partition_motion
    partition_near = partition_near
    find_impacts = find_impacts
    time_of_first_impact = time_of_first_impact
    is_free = is_free
    find_free_step = find_free_step
    find_near = find_near
    find_candidates = find_candidates
    stream_impacts = stream_impacts
    stream_near = stream_near
    stream_candidates = stream_candidates
    find_nearest = find_nearest
    launch = launch
    launch_self = launch_self
    launch_between = launch_between
    launch_impacts = launch_impacts
    launch_near = launch_near
    launch_candidates = launch_candidates
    wait = wait
    wait_impacts = wait_impacts
    wait_near = wait_near
    wait_candidates = wait_candidates


def _find_in_part(
    self: Detector,
    part: _core.Part,
    *,
    neighbours: Neighbours = "geometric",
    intersections: Intersections = "all",
    weld: bool = False,
    contacts: bool = False,
    wanted: Wanted = "both",
    excluded_groups: GroupPairs | None = None,
    copy: bool = False,
) -> Result:
    query = _core.Query(neighbours, intersections, weld, contacts, wanted, excluded_groups)
    answer = self._find_part(part, query, copy)
    if part.second is None:
        return Result(answer, Mesh(*part.mesh), None, (part.triangles, None))
    return Result(answer, Mesh(*part.mesh), Mesh(*part.second), (part.triangles, part.triangles_second))


_find_in_part.__name__, _find_in_part.__qualname__ = "find", "Detector.find"
_find_in_part = suggesting(_find_in_part)
