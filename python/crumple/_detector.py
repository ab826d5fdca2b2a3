"""Detector: searches a scene for what a query describes."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from typing import Any, Literal, overload

from . import _core
from ._clustering import Clustering
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
    Method,
    OverlapQuery,
    ProximityQuery,
    Query,
    check_fuzzy_c_means,
    check_method,
    keywords_of,
    query_of,
)
from ._results import Distances
from ._scene import checked_copy, checked_query, excluded_in, scene_of, show, step_of, with_names

Backend = Literal["automatic", "cpu", "cuda", "reference"]
Simd = Literal["automatic", "scalar", "sse4", "avx2", "avx512", "neon"]
_ALL = IntersectionQuery()


def _part_of_overlaps(result: Any) -> tuple[Any, ...]:
    """Returns the result of an OverlapQuery about a part in the form of the extension module."""
    if not isinstance(result, Overlaps):
        raise InvalidType(f"parts must be results of crumple.OverlapQuery, not {type(result).__name__}")
    found = result._found
    return *found.part, found.part_pairs, found.part_bodies


class Detector(_core.Detector):
    """Searches scenes, exactly and completely.

    `find(scene, query)` is the basic call. Each query also has a method that takes arrays and keywords:
    `detector.impacts(start, end, faces, min_distance=0.1)` is short for `detector.find(Mesh(start,
    faces).moving_to(end), ImpactQuery(min_distance=0.1))`.

    Parameters
    ----------
    backend : {"automatic", "cpu", "cuda", "reference"}, default "automatic"
        "automatic" chooses "cuda" if the cuda backend was built and a device is available, else "cpu". "reference" is
        brute force in rational arithmetic, for comparisons.
    threads : int, default 0
        Number of threads of the cpu backend, which start when the detector is made. 0: as many as the machine has.
        Larger numbers use no more than that. With the cuda backend: of what the host computes (docs/cuda.md).
    memory_limit : int, default 0
        Number of bytes that the detector may own; 0: no limit. Results that Python still uses are not counted. A search
        that exceeds the limit is cut into chunks and runs on one thread. If that does not suffice, the call raises
        MemoryLimit with a lower bound on a sufficient limit.
    clusters : int, default 0
        Clusters of the first level of subdivision, 1 to 64; 0: chosen from the number of triangles.
    leaf_size : int, default 3000
        Target number of triangles per leaf; larger clusters are subdivided again.
    fuzzy_c_means : FuzzyCMeans, optional
        Parameters of the placement of cluster centres.
    method : Method, optional
        Sweep direction and membership rule, for researchers.
    simd : {"automatic", "scalar", "sse4", "avx2", "avx512", "neon"}, default "automatic"
        Instruction set; "automatic" chooses the best that the machine supports.
    device : int, default 0
        Number of the CUDA device that the cuda backend uses (list_devices).
    devices : sequence of int, optional
        Numbers of several CUDA devices, instead of `device`. Together they search one mesh in host memory. The first
        device alone runs all other queries, and arrays in device memory must be on it (docs/distributed.md).

    Raises
    ------
    InvalidInput
        If an option is out of range, or `__init__` is called a second time.
    BackendUnavailable
        If this machine or build does not have the requested backend or instruction set.

    Notes
    -----
    No option changes a result, only its cost, except `membership` of Method. A detector caches buffers and cluster
    centres between calls, so one detector for all frames of a simulation is faster than a new one per frame. The
    topology may change freely.

    A scene is one of:

    - a mesh, as one object that `as_mesh` takes: a Mesh, a tuple, or a mesh of trimesh, meshio, Open3D or PyVista;
    - two meshes `[a, b]`: only pairs across them are found;
    - a World of bodies;
    - a Part.

    A mesh moves if it has positions at the end of a step (Mesh.moving_to), a world if its bodies or shapes have. Works
    on any triangle soup.

    Arrays are read in place if they are NumPy arrays, or support DLPack or the buffer protocol in host memory, and are
    float32 or float64, int32, uint32 or int64, with any strides. Other integers and Python lists are copied. The cuda
    backend also reads arrays in CUDA memory, after the work that the package of the array has put on its current
    stream. Inputs are not written to, and must not change until the call returns.

    Calls release the GIL. Different detectors run in parallel; calls of one detector from several threads run one at a
    time. Ctrl-C in the main thread ends a call within about 50 ms: it raises KeyboardInterrupt, and the detector stays
    usable. While `partition` computes clusters, Ctrl-C does not end it.

    References
    ----------
    .. [1] D. Mainzer and G. Zachmann, "Collision Detection Based on Fuzzy Scene Subdivision", Algorithm 1: clusters by
       fuzzy C-means (sec. 4, eqs. 2-4), a sweep of each along its principal axis (sec. 3, eq. 1), and a test of each
       pair of boxes that overlap. Crumple's test is exact. docs/README.md lists the page of each stage.
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
        method: Method = Method(),
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
            "method": check_method(method),
            "simd": simd,
            "device": device,
            "devices": devices,
        }
        super().__init__(options)
        self._options = options

    @property
    def options(self) -> dict[str, Any]:
        """Options that the detector was made with, by name."""
        try:
            return dict(self._options)
        except AttributeError:
            raise InvalidInput("crumple.Detector.__init__ has not been called", element="option") from None

    @property
    def backend(self) -> str:
        """Backend in use, "cpu", "cuda" or "reference": the requested one, or the choice of "automatic"."""
        return super().backend

    @property
    def fallback(self) -> str:
        """Reason in one line why "automatic" chose "cpu" although this build has the cuda backend; else ""."""
        return super().fallback

    def cancel(self) -> None:
        """Ends the call in progress: it raises Error with code "cancelled" within some milliseconds.

        Call it from another thread. A call that is nearly complete may still return its result. Calls that wait for the
        one in progress are not cancelled. While `partition` computes clusters, it does not end. Does nothing if no call
        is in progress.
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

        Parameters
        ----------
        scene : Mesh or mesh-like, [mesh, mesh], World, or Part
            Scene, as described in Detector. In queries about features and distances, two meshes are two bodies.
        query : Query, default IntersectionQuery()
            The type of the query selects what is searched for and the type of the result.
        copy : bool, default False
            If True, the arrays of the result are writable copies, otherwise read-only views.

        Returns
        -------
        Intersections, Impacts, FirstImpact or None, FreeStep, Proximities, Candidates, Distances, or Overlaps
            Result of the query. For a part: the rows that the part owns, with ids of the whole mesh. Offsets, hit flags
            and least distances are indexed by position in the part.

        Raises
        ------
        InvalidInput
            If an argument is invalid, or the query is not supported for this scene (see `supports`). Names the
            argument, the mesh, the body or the shape.
        MemoryLimit
            If the data of the search or the result exceed the memory limit.

        Notes
        -----
        Cost: on ordinary scenes and two threads, a warm call takes about 0.1 microseconds per triangle, and more for
        many overlapping boxes; contacts take about a microsecond per pair. A world takes some microseconds per call,
        and less than one per body if the body's shape is named and the body is clear of all others.
        """
        return self._find(scene_of(scene), query, copy)

    def _find(self, scene: Any, query: Any, copy: Any = False) -> Any:
        query = checked_query(scene, query)
        found = self._call("find", scene, query)
        return show(found, scene, query, copy if copy is False else checked_copy(copy))

    def _call(self, delivery: str, scene: Any, query: Query, *more: Any) -> Any:
        """Calls the extension module's method for a query and a delivery ("find", "any", ...).

        Raises InvalidInput if there is no such method.
        """
        method = query._methods.get(delivery)
        if method is None:
            raise InvalidInput(f"{delivery} does not support {type(query).__name__}: see docs/supported.md")
        excluded = query.filter.excluded_bodies
        if excluded is not None:
            excluded = excluded_in(scene, query.filter)
        try:
            call = getattr(self, method)
            return call(scene, query, excluded, *more) if more else call(scene, query, excluded)
        except InvalidInput as error:
            raise with_names(scene, error) from error.__cause__

    @suggesting
    def supports(self, scene: Any, query: Query = _ALL) -> bool:
        """True if `find` supports queries of this type about this scene.

        Depends on the kind of scene, the memory of its arrays and the backend; docs/supported.md has the table. Of the
        query's options only `containment` of an IntersectionQuery matters. Does not check sizes.

        Parameters
        ----------
        scene, query
            As for `find`.

        Returns
        -------
        bool

        Raises
        ------
        InvalidInput
            If the scene or the query is invalid.
        """
        scene = scene_of(scene)
        return self._call("supports", scene, checked_query(scene, query))

    @suggesting
    def any(self, scene: Any, query: Query = _ALL) -> bool:
        """True if `find` would find anything. Stops at the first pair.

        For intersections, impacts, proximities and overlaps. Ignores `output` of the query.

        Parameters
        ----------
        scene, query
            As for `find`.

        Returns
        -------
        bool

        Raises
        ------
        InvalidInput, MemoryLimit
            As `find`.

        Examples
        --------
        A step without an impact is free:

            is_free = not detector.any(mesh.moving_to(end), crumple.ImpactQuery())
        """
        scene = scene_of(scene)
        return self._call("any", scene, checked_query(scene, query))

    @suggesting
    def stream(self, scene: Any, query: Query, take: Callable[[Any], Any], *, block_rows: int = 1 << 18) -> Statistics:
        """Delivers the result in blocks: for results that exceed memory.

        For intersections, impacts, proximities, candidates and overlaps of meshes and worlds in host memory, with the
        cpu and the reference backend, for overlaps with all backends.

        Parameters
        ----------
        scene, query
            As for `find`. The query must not have `index`, `triangle_pairs` or `least`, and its `output` must be
            "pairs" or more, of overlaps "body_pairs" or more.
        take : callable
            Called as `take(block)`. A block is a result of the type that `find` returns, with rows only; of overlaps, it
            also has `skipped`, `body_volume` and `is_solid` of the whole result, and is the only one if there are no
            rows but one of these arrays. An exception
            from `take` ends the search. `take` may be called from different threads, but never from two at a time, and
            must not use this detector.
        block_rows : int, default 262144
            Number of rows per block, in all of its lists together, 1 to 2^40; the last block may have fewer.

        Returns
        -------
        Statistics
            Counts and times of the call.

        Raises
        ------
        InvalidInput, MemoryLimit
            As `find`.

        Notes
        -----
        All blocks together have the rows of the whole result, in the order of the leaves (groups of triangles that are
        searched together), overlaps in the order of the whole result. The order does not depend on the number of
        threads. Cost: that of `find`; overlaps of bodies with themselves are computed twice if they have a row. Memory:
        that of `find` without its lists, plus about three blocks.
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
        """Cuts a scene into independent parts, for instance for several machines.

        Each part owns some rows of the result. `find(part, query)` returns them; it needs no mesh, so it can run on any
        machine. Every row belongs to exactly one part, so that all parts together have the whole result. For overlaps,
        `find(part, query)` returns pairs of triangles, and `combine` makes rows of them. Parts can be pickled.

        Parameters
        ----------
        scene : Mesh or mesh-like, or [mesh, mesh]
            One mesh; two meshes for intersections and overlaps only.
        query : IntersectionQuery, ImpactQuery, ProximityQuery or OverlapQuery, default IntersectionQuery()
            Query that the parts are made for. Later queries about parts for impacts and proximities must have at most
            this distance, and the same `weld`, radii, rest shape and rings. Parts for intersections and for overlaps
            are the same, and the members of the query do not matter.
        count : int
            Number of parts, 1 to 262144.

        Returns
        -------
        list of Part

        Raises
        ------
        InvalidInput
            If an argument is invalid, or the scene or query does not support parts.

        Notes
        -----
        Parts depend only on the arguments. Cost: one pass over the triangles per level of subdivision, and a copy of
        them: 230 ms for a million triangles in 64 parts on one thread.

        References
        ----------
        .. [1] D. Mainzer and G. Zachmann, "Collision Detection Based on Fuzzy Scene Subdivision": sec. 1.1 for parts on
           several machines, sec. 4, eqs. 2-4 for their centres.
        """
        scene = scene_of(scene)
        return self._call("partition", scene, checked_query(scene, query), count)

    @suggesting
    def cluster(self, scene: Any) -> Clustering:
        """Returns the clusters and leaves into which the next search for intersections would divide a scene.

        Parameters
        ----------
        scene : Mesh or mesh-like, or [mesh, mesh]
            One mesh or two, in host memory.

        Returns
        -------
        Clustering
            Centres, members of clusters and leaves, and the frames in which leaves are swept.

        Raises
        ------
        InvalidInput
            If the scene is invalid or of another kind, or the backend is not "cpu".

        Notes
        -----
        Does not change the detector: the next call starts from the same cluster centres as without this call. A search
        that exceeds a memory limit uses other clusters. Cost: the stages `bounds` and `subdivide` of a search, and the
        arrays.

        References
        ----------
        .. [1] D. Mainzer and G. Zachmann, "Collision Detection Based on Fuzzy Scene Subdivision", secs. 3 and 4, fig.
           3.
        """
        return Clustering(**self._call("cluster", scene_of(scene), _ALL))

    @suggesting
    def combine(self, scene: Any, query: OverlapQuery, parts: Iterable[Overlaps], *, copy: bool = False) -> Overlaps:
        """Finds overlaps from the results of all parts of a scene: the same bytes as `find(scene, query)`.

        The parts share the search for triangles that intersect. This call computes the rest: winding numbers, sums and
        rows.

        Parameters
        ----------
        scene : Mesh or mesh-like, or [mesh, mesh]
            The same mesh, or two meshes, that were cut into parts.
        query : OverlapQuery
            Query about the whole scene.
        parts : iterable of Overlaps
            Results of `find(part, query)`, one for each part, in any order; results can be pickled. All must be found
            with the same `self_overlaps` as in `query`. Other members of the query may differ.
        copy : bool, default False
            As for `find`.

        Returns
        -------
        Overlaps

        Raises
        ------
        InvalidInput, MemoryLimit
            As `find`; also if a part is missing or occurs twice, or if a result has triangles that the scene lacks.

        Examples
        --------
            query = crumple.OverlapQuery(curves=True)
            found = [detector.find(part, query) for part in detector.partition(mesh, query, count=8)]
            overlaps = detector.combine(mesh, query, found)
        """
        scene = scene_of(scene)
        query = checked_query(scene, query)
        results = [_part_of_overlaps(part) for part in parts]
        combined = self._call("combine", scene, query, results)
        return show(combined, scene, query, copy if copy is False else checked_copy(copy))

    @suggesting
    def launch(self, scene: Any, query: Query = _ALL, *, stream: Any = None) -> Launch:
        """Starts a query on arrays in device memory and returns at once.

        For intersections of meshes, and of worlds whose poses are in device memory; for impacts, proximities and
        candidates of one mesh. Only with the cuda backend.

        Parameters
        ----------
        scene, query
            As for `find`, with all arrays on the detector's device, readable through DLPack. Arrays that cannot be read
            in place are refused. Only the poses of a world are on the device. Its shapes and bodies are in host memory,
            and are uploaded if they differ from those of the previous call. At most 65,535 worlds, with 2^24 triangles
            in total. Arrays must not change until `wait` returns.
        stream : None, int, or stream of PyTorch, CuPy or Warp, optional
            CUDA stream that does the work, by its address or as an object; None: the legacy default stream. The package
            that owns an array makes it ready on this stream (DLPack's `__dlpack__(stream=...)`): the stream waits for
            the package's current stream, such as `torch.cuda.current_stream()`, and for no other.

        Returns
        -------
        Launch
            Its `wait` returns the DeviceResult.

        Raises
        ------
        InvalidInput
            If an argument is invalid or not supported. `wait` reports invalid contents of arrays.

        Notes
        -----
        At most two launches may be in flight; wait for them in their order. The first launch about features of a mesh
        waits for the stream, because the host has to find the edges. So does a launch whose mesh has another number of
        vertices, faces, edges or points than the one before it.

        If the stream is being captured, the work becomes a part of the caller's CUDA graph, and each replay of the
        graph runs the query. Before the capture, make two calls of the same kind, which allocate the lists. For a
        capture, `stream` should be the current stream of the package, because a capture must not wait for streams
        outside of it.
        """
        scene = scene_of(scene)
        query = checked_query(scene, query)
        return Launch(self, self._call("launch", scene, query, stream_of(stream)))

    @keywords_of(IntersectionQuery)
    def intersections(
        self, vertices: Any, faces: Any = None, *, groups: Any = None, copy: bool = False, **options: Any
    ) -> Intersections:
        """Finds pairs of triangles that intersect.

        Short for `find` with an IntersectionQuery.

        Parameters
        ----------
        vertices : (n, 3) array_like of float32 or float64, or scene
            Vertices; or, without `faces`, a whole scene; or the first of two meshes.
        faces : (m, 3) or (3 m,) array_like of int, optional
            Indices of vertices; or the second mesh.
        groups : (m,) array_like of int, optional
            Group of each triangle, within the range of int32.
        copy : bool, default False
            As for `find`.
        **options
            Members of the IntersectionQuery.

        Returns
        -------
        Intersections

        Raises
        ------
        InvalidInput, MemoryLimit
            As `find`.
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
        """Finds features that touch while vertices move straight from `start` to `end`, and when.

        Short for `find` with an ImpactQuery.

        Parameters
        ----------
        start : (n, 3) array_like of float32 or float64, or mesh, or scene
            Positions at the start; or a mesh; or, as the only scene argument, a scene that has positions at the end.
        end : (n, 3) array_like of float32 or float64, optional
            Positions at the end of the step.
        faces : (m, 3) or (3 m,) array_like of int, optional
            Indices of vertices.
        groups, edges, points : array_like, optional
            Attributes of the Mesh.
        copy : bool, default False
            As for `find`.
        **options
            Members of the ImpactQuery.

        Returns
        -------
        Impacts

        Raises
        ------
        InvalidInput, MemoryLimit
            As `find`.
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
        """Finds the first impact of a step. Short for `find` with a FirstImpactQuery.

        Parameters
        ----------
        start, end, faces, groups, edges, points
            As for `impacts`.
        **options
            Members of the FirstImpactQuery.

        Returns
        -------
        FirstImpact or None
            None if the step is free of impacts.

        Raises
        ------
        InvalidInput, MemoryLimit
            As `find`.
        """
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
        """Finds a share of a step that is free of impacts, and the positions there.

        Short for `find` with a FreeStepQuery.

        Parameters
        ----------
        start, end, faces, groups, edges, points
            As for `impacts`.
        **options
            Members of the FreeStepQuery.

        Returns
        -------
        FreeStep

        Raises
        ------
        InvalidInput, MemoryLimit
            As `find`.
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
        """Finds features whose distance is at most a radius.

        Short for `find` with a ProximityQuery.

        Parameters
        ----------
        vertices : (n, 3) array_like of float32 or float64, or scene
            Vertices; or without `faces` a whole scene; or the first of two meshes.
        faces : (m, 3) or (3 m,) array_like of int, optional
            Indices of vertices; or the second mesh.
        groups, edges, points : array_like, optional
            Attributes of the Mesh.
        copy : bool, default False
            As for `find`.
        **options
            Members of the ProximityQuery.

        Returns
        -------
        Proximities

        Raises
        ------
        InvalidInput, MemoryLimit
            As `find`.
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
        """Finds features whose inflated boxes overlap.

        Short for `find` with a CandidateQuery.

        Parameters
        ----------
        vertices : (n, 3) array_like of float32 or float64, or scene
            Vertices; or without `faces` a whole scene; or the first of two meshes.
        faces : (m, 3) or (3 m,) array_like of int, optional
            Indices of vertices; or the second mesh.
        end : (n, 3) array_like of float32 or float64, optional
            Positions at the end of a step; None: the mesh does not move.
        groups, edges, points : array_like, optional
            Attributes of the Mesh.
        copy : bool, default False
            As for `find`.
        **options
            Members of the CandidateQuery.

        Returns
        -------
        Candidates

        Raises
        ------
        InvalidInput, MemoryLimit
            As `find`.
        """
        scene = scene_of(vertices, faces, end=end, groups=groups, edges=edges, points=points)
        return self._find(scene, query_of(CandidateQuery, options), copy)

    @keywords_of(DistanceQuery)
    def distances(self, world: Any, second: Any = None, *, copy: bool = False, **options: Any) -> Distances:
        """Finds the distance of each pair of bodies of a world, or of two meshes.

        Short for `find` with a DistanceQuery.

        Parameters
        ----------
        world : World or mesh
            World, or the first of two meshes.
        second : mesh, optional
            Second mesh.
        copy : bool, default False
            As for `find`.
        **options
            Members of the DistanceQuery.

        Returns
        -------
        Distances

        Raises
        ------
        InvalidInput, MemoryLimit
            As `find`.
        """
        return self._find(scene_of(world, second), query_of(DistanceQuery, options), copy)

    @keywords_of(OverlapQuery)
    def overlaps(self, world: Any, second: Any = None, *, copy: bool = False, **options: Any) -> Overlaps:
        """Finds the overlap of each pair of closed bodies of a world, or of two meshes.

        Short for `find` with an OverlapQuery.

        Parameters
        ----------
        world : World or mesh
            World, or the first of two meshes, or one mesh.
        second : mesh, optional
            Second mesh.
        copy : bool, default False
            As for `find`.
        **options
            Members of the OverlapQuery.

        Returns
        -------
        Overlaps

        Raises
        ------
        InvalidInput, MemoryLimit
            As `find`.
        """
        return self._find(scene_of(world, second), query_of(OverlapQuery, options), copy)
