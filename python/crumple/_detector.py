"""Detector: the calls that take a scene and a query."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, Literal, overload

from . import _core
from ._core import Statistics
from ._device import Launch, stream_of
from ._errors import InvalidInput, InvalidType, suggesting
from ._feature_pairs import Candidates
from ._features import FirstImpact, FreeStep, Impacts, Proximities
from ._intersections import Intersections
from ._overlaps import Overlaps
from ._queries import (
    CandidateQuery,
    DistanceQuery,
    FirstImpactQuery,
    FreeStepQuery,
    FuzzyCMeans,
    ImpactQuery,
    IntersectionQuery,
    OverlapQuery,
    ProximityQuery,
    Query,
    check_fuzzy_c_means,
    keywords_of,
    query_of,
)
from ._results import Distances
from ._scene import checked_copy, checked_query, excluded_in, scene_of, show, step_of, with_names

Backend = Literal["automatic", "cpu", "cuda", "reference"]
Simd = Literal["automatic", "scalar", "sse4", "avx2", "avx512", "neon"]
_ALL = IntersectionQuery()


class Detector(_core.Detector):
    """Searches scenes, exactly and completely.

    detector.find(scene, query) is the one call; each query has a method beside it that takes arrays and keywords:
    detector.impacts(start, end, faces, min_distance=0.1) is
    detector.find(Mesh(start, faces).moving_to(end), ImpactQuery(min_distance=0.1)).

    Keeps buffers and cluster centres between calls, so one detector for all frames of a simulation is faster than a new
    one for each; the topology may change freely. Any triangle soup will do.

    A scene is a mesh, given as one object that as_mesh knows (crumple.Mesh, a tuple, a mesh of trimesh, meshio, Open3D
    or PyVista); two meshes, [a, b], of which pairs across are found; a crumple.World of bodies; or a crumple.Part. A
    mesh moves that says where to (Mesh.moving_to), a world whose bodies or shapes do. Arrays are read in place: NumPy
    or anything on the host that speaks DLPack or the buffer protocol, float32 or float64, int32, uint32 or int64, in
    any order and with any strides. Other integers and Python lists are converted, at the cost of a copy. Inputs are not
    written to, and must not change until the call returns. The cuda backend also reads arrays in CUDA memory, after the
    work of their package's current stream.

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
        devices: instead, the numbers of several, which share queries about one mesh on the host; arrays on a device
            are on the first, which does alone what the others cannot share (docs/distributed.md).

    No option changes a result, only its cost. A detector keeps its options: a second __init__ is refused. Raises
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
        """The backend in use, "cpu", "cuda" or "reference": the requested one, or the one that "automatic" chose."""
        return super().backend

    @property
    def fallback(self) -> str:
        """Why "automatic" took the cpu backend although this build has the cuda backend, in one line; else ""."""
        return super().fallback

    def cancel(self) -> None:
        """Asks the call that runs at this moment to end: it raises Error, code "cancelled", within some milliseconds.

        To be called from another thread. A call that is nearly done may still return its result. Does nothing while
        no call runs; one that waits for its turn goes on waiting. `partition` is not cut short while it clusters.
        """
        super().cancel()

    def __repr__(self) -> str:
        try:
            options = self._options
        except AttributeError:
            return "<crumple.Detector whose __init__ has not been called>"
        return "crumple.Detector(" + ", ".join(f"{name}={value!r}" for name, value in options.items()) + ")"

    @overload
    def find(self, scene: Any, query: IntersectionQuery = ..., *, copy: bool = False) -> Intersections: ...
    @overload
    def find(self, scene: Any, query: ImpactQuery, *, copy: bool = False) -> Impacts: ...
    @overload
    def find(self, scene: Any, query: FirstImpactQuery, *, copy: bool = False) -> FirstImpact | None: ...
    @overload
    def find(self, scene: Any, query: FreeStepQuery, *, copy: bool = False) -> FreeStep: ...
    @overload
    def find(self, scene: Any, query: ProximityQuery, *, copy: bool = False) -> Proximities: ...
    @overload
    def find(self, scene: Any, query: CandidateQuery, *, copy: bool = False) -> Candidates: ...
    @overload
    def find(self, scene: Any, query: DistanceQuery, *, copy: bool = False) -> Distances: ...
    @overload
    def find(self, scene: Any, query: OverlapQuery, *, copy: bool = False) -> Overlaps: ...
    @suggesting
    def find(self, scene: Any, query: Query = _ALL, *, copy: bool = False) -> Any:
        """Finds everything in a scene that a query describes.

        Args:
            scene: a mesh, [a, b] of two meshes, a World or a Part; see Detector. For queries about features and
                distances two meshes are two bodies.
            query: the type says what is searched for, and gives the type of the result.
            copy: the result gets writable arrays of its own instead of read-only views.

        Of a part the result has the rows that the part owns, with the ids of the mesh; offsets, hit flags and least
        distances count by position in the part.

        Raises InvalidInput, which names the argument, the mesh, the body or the shape, also where the query is not
        supported for such a scene (`supports`); MemoryLimit.

        Cost: a warm call on two threads takes about 0.1 microseconds a triangle on ordinary scenes, more with the
        number of pairs of boxes that overlap; contacts take about a microsecond a pair. A world takes some microseconds
        a call, and less than one a body of a named shape that is clear of all others.
        """
        return self._find(scene_of(scene), query, copy)

    def _find(self, scene: Any, query: Any, copy: Any = False) -> Any:
        query = checked_query(scene, query)
        found = self._call("find", scene, query)
        return show(found, scene, query, copy if copy is False else checked_copy(copy))

    def _call(self, delivery: str, scene: Any, query: Query, *more: Any) -> Any:
        """Has the extension module do it, unless queries of this type are not delivered so."""
        method = query._methods.get(delivery)
        if method is None:
            raise InvalidInput(f"{delivery} is not for {type(query).__name__}: docs/supported.md has the table")
        excluded = query.filter.excluded_bodies
        if excluded is not None:
            excluded = excluded_in(scene, query.filter)
        try:
            return getattr(self, method)(scene, query, excluded, *more)
        except InvalidInput as error:
            raise with_names(scene, error) from error.__cause__

    @suggesting
    def supports(self, scene: Any, query: Query = _ALL) -> bool:
        """True if find takes queries of this type about such a scene: by what it is, where it lies, and the backend.

        docs/supported.md has the table. Of options only `containment` of intersections matters; says nothing of sizes.
        """
        scene = scene_of(scene)
        return self._call("supports", scene, checked_query(scene, query))

    @suggesting
    def any(self, scene: Any, query: Query = _ALL) -> bool:
        """True if there is anything to find: of intersections, impacts, proximities and overlaps.

        Stops at the first pair. A step is free if there is no impact: not detector.any(mesh.moving_to(end),
        ImpactQuery()). `output` does not matter. Arguments and errors as of find.
        """
        scene = scene_of(scene)
        return self._call("any", scene, checked_query(scene, query))

    @suggesting
    def stream(self, scene: Any, query: Query, take: Callable[[Any], Any], *, block_rows: int = 1 << 18) -> Statistics:
        """Calls take(block) with one block of the result after another, for results that exceed memory.

        Of intersections, impacts, proximities and candidates, of meshes and worlds in host memory.

        Args:
            scene, query: as of find; not with `index`, `triangle_pairs`, `least`, or less output than pairs.
            take: a block is a result of the same type that has its rows and nothing else. What it raises ends the call.
                It may run in another thread, but never in two at a time, and cannot call this detector.
            block_rows: rows of a block, of all its lists together, 1 to 2^40; the last one has fewer.

        All blocks together have the rows of the whole result in another order: leaf by leaf, which does not depend on
        threads. Returns the statistics of the call. Cost: that of find. Memory: that of find without its lists, and of
        about three blocks.
        """
        scene = scene_of(scene)
        query = checked_query(scene, query)
        if not callable(take):
            raise InvalidType(f"take must be callable with a block, not {type(take).__name__}")
        return self._call(
            "stream", scene, query, lambda found: take(show(found, scene, query, False, block=True)), block_rows
        )

    @suggesting
    def partition(self, scene: Any, query: Query = _ALL, *, count: int) -> list[_core.Part]:
        """Cuts a scene of one mesh, or of two for intersections, into `count` (1 to 262144) independent parts.

        Each part owns rows of the result and is searched anywhere, without the mesh, by find(part, query); the results
        together are the whole result, and no row is in two of them. Parts can be pickled, and depend only on the
        arguments. Those for impacts and proximities serve what they were made for: no more distance than this query
        asks for, the same `weld`, radii, rest shape and rings; for intersections the members of the query do not
        matter.

        Raises InvalidInput. Cost: a look at each triangle, and its copies; 230 ms for a million triangles in 64 parts
        on one thread. Source: Mainzer and Zachmann, sec. 1.1, for parts on several machines, and sec. 4, eqs. 2-4, for
        their centres.
        """
        scene = scene_of(scene)
        return self._call("partition", scene, checked_query(scene, query), count)

    @suggesting
    def launch(self, scene: Any, query: Query = _ALL, *, stream: Any = None) -> Launch:
        """Starts a query on arrays in device memory and returns at once: launch(...).wait() gives the DeviceResult.

        Of intersections, of meshes and of worlds whose poses lie on the device; of impacts, proximities and candidates,
        of one mesh. Only with the cuda backend. Two launches may be in flight; they are waited for in their order.
        Arrays must stay as they are until then.

        Args:
            scene, query: as of find, with all arrays on the detector's device, through DLPack. What is not of a type
                that can be read in place is refused, for nothing is converted there. Shapes and bodies of a world lie
                on the host, and go to the device when they are not those of the call before; at most 65,535 worlds,
                and 2^24 triangles together.
            stream: CUDA stream that does the work: None, the legacy default stream; or the address of another one, or a
                stream of PyTorch, CuPy or Warp. The package that owns the arrays makes them ready on it (DLPack's
                __dlpack__(stream=...)): the stream waits for the package's current stream, such as
                torch.cuda.current_stream(), and for no other. A stream that is being captured makes the work a part of
                the caller's graph: each replay is a query, after two calls like it outside of the capture. It should be
                the package's current stream then, for a capture may not wait for streams outside of it.

        The first launch for a mesh about features, and one with other numbers of vertices, faces, edges or points,
        waits for the stream: the host has to see which edges there are. Raises InvalidInput; bad contents of arrays are
        reported by wait().
        """
        scene = scene_of(scene)
        query = checked_query(scene, query)
        return Launch(self, self._call("launch", scene, query, stream_of(stream)))

    @keywords_of(IntersectionQuery)
    def intersections(
        self, vertices: Any, faces: Any = None, *, groups: Any = None, copy: bool = False, **options: Any
    ) -> Intersections:
        """Pairs of triangles that intersect: find with an IntersectionQuery, whose members are keywords.

        Args:
            vertices, faces: (n, 3) float32 or float64 and (m, 3) integers, or flat; or a scene alone; or two meshes.
            groups: (m,) integers that fit int32, one a triangle.
            copy: as of find.
        """
        return self._find(scene_of(vertices, faces, groups), query_of(IntersectionQuery, options), copy)

    @keywords_of(ImpactQuery)
    def impacts(
        self,
        start: Any,
        end: Any = None,
        faces: Any = None,
        *,
        groups: Any = None,
        edges: Any = None,
        points: Any = None,
        copy: bool = False,
        **options: Any,
    ) -> Impacts:
        """Features that touch on the way from `start` to `end`, and when: find with an ImpactQuery.

        Args:
            start, end, faces: (n, 3), (n, 3) and (m, 3); or a mesh and `end`; or a scene that moves, alone.
            groups, edges, points: as crumple.Mesh has them.
            copy: as of find.
        """
        return self._find(step_of(start, end, faces, groups, edges, points), query_of(ImpactQuery, options), copy)

    @keywords_of(FirstImpactQuery)
    def first_impact(
        self,
        start: Any,
        end: Any = None,
        faces: Any = None,
        *,
        groups: Any = None,
        edges: Any = None,
        points: Any = None,
        **options: Any,
    ) -> FirstImpact | None:
        """The first impact of a step; None: the step is free. Find with a FirstImpactQuery; arguments as of impacts."""
        return self._find(step_of(start, end, faces, groups, edges, points), query_of(FirstImpactQuery, options))

    @keywords_of(FreeStepQuery)
    def free_step(
        self,
        start: Any,
        end: Any = None,
        faces: Any = None,
        *,
        groups: Any = None,
        edges: Any = None,
        points: Any = None,
        **options: Any,
    ) -> FreeStep:
        """A share of a step, with positions, that nothing touches on the way to. Find with a FreeStepQuery.

        Arguments as of impacts.
        """
        return self._find(step_of(start, end, faces, groups, edges, points), query_of(FreeStepQuery, options))

    @keywords_of(ProximityQuery)
    def proximities(
        self,
        vertices: Any,
        faces: Any = None,
        *,
        groups: Any = None,
        edges: Any = None,
        points: Any = None,
        copy: bool = False,
        **options: Any,
    ) -> Proximities:
        """Features whose distance is at most a radius: find with a ProximityQuery.

        Args:
            vertices, faces: (n, 3) and (m, 3); or a scene alone; or two meshes.
            groups, edges, points: as crumple.Mesh has them.
            copy: as of find.
        """
        scene = scene_of(vertices, faces, groups=groups, edges=edges, points=points)
        return self._find(scene, query_of(ProximityQuery, options), copy)

    @keywords_of(CandidateQuery)
    def candidates(
        self,
        vertices: Any,
        faces: Any = None,
        *,
        end: Any = None,
        groups: Any = None,
        edges: Any = None,
        points: Any = None,
        copy: bool = False,
        **options: Any,
    ) -> Candidates:
        """Features whose boxes overlap: find with a CandidateQuery.

        Args:
            vertices, faces: (n, 3) and (m, 3); or a scene alone; or two meshes.
            end: (n, 3): where the vertices are at the end; None: they stay.
            groups, edges, points: as crumple.Mesh has them.
            copy: as of find.
        """
        scene = scene_of(vertices, faces, end=end, groups=groups, edges=edges, points=points)
        return self._find(scene, query_of(CandidateQuery, options), copy)

    @keywords_of(DistanceQuery)
    def distances(self, world: Any, second: Any = None, *, copy: bool = False, **options: Any) -> Distances:
        """Distances of the bodies of a world, or of two meshes, each pair of them: find with a DistanceQuery.

        Args:
            world, second: a World; or two meshes.
            copy: as of find.
        """
        return self._find(scene_of(world, second), query_of(DistanceQuery, options), copy)

    @keywords_of(OverlapQuery)
    def overlaps(self, world: Any, second: Any = None, *, copy: bool = False, **options: Any) -> Overlaps:
        """Overlaps of the closed bodies of a world, or of two meshes, each pair of them: find with an OverlapQuery.

        Args:
            world, second: a World; or two meshes.
            copy: as of find.
        """
        return self._find(scene_of(world, second), query_of(OverlapQuery, options), copy)
