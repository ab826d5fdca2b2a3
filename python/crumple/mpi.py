"""Searches one scene with many MPI processes (ranks), through communicators of mpi4py.

Each rank provides some of the triangles, with all of their vertices, and gets the pairs whose first triangle it has
provided. The rows of all ranks, merged, are the same bytes as the rows of crumple.Detector.intersections for the whole
scene. `impacts` and `proximities` do the same for motion and nearness. Instead of triangles, ranks may provide bodies
(World), whose overlaps `overlaps` finds. As in crumple.Detector, `find(local, query)` is the basic call.

Raises
------
ImportError
    If the package was built without MPI, mpi4py is missing, or mpi4py uses another MPI library.

Notes
-----
The package has this module if it was built with MPI: `pip install . --config-settings=cmake.define.CRUMPLE_MPI=ON`.
Importing this module initialises MPI, as mpi4py does.

Examples
--------
    from mpi4py import MPI
    import crumple.mpi

    with crumple.mpi.Detector(MPI.COMM_WORLD) as detector:
        result = detector.intersections(vertices, faces)  # local mesh of this rank
        print(result.pairs, result.count)                 # local rows; number of pairs of all ranks
"""

from __future__ import annotations

import functools
import importlib.util
import inspect
from collections.abc import Callable
from typing import Any, TypeVar

from ._detector import Backend, Simd
from ._errors import Error, InvalidInput, InvalidType, name_of_type, suggesting, with_suggestions
from ._queries import (
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
from ._scene import checked_query, scene_of, step_of

if importlib.util.find_spec("crumple._mpi") is None:
    raise ImportError(
        "crumple was built without MPI: install it by "
        "`pip install . --config-settings=cmake.define.CRUMPLE_MPI=ON` where MPI's headers are"
    )
try:
    from mpi4py import MPI
except ModuleNotFoundError as error:
    raise ImportError(f"crumple.mpi needs mpi4py: {error}") from error

from . import _mpi  # imported after mpi4py, which decides how MPI is loaded
from ._ranks import (
    Impacts,
    Intersections,
    LocalMesh,
    LocalWorld,
    Overlaps,
    Proximities,
    excluded_of_ranks,
    local_of,
    show,
)

Statistics = _mpi.Statistics
Returned = TypeVar("Returned")
Collective = TypeVar("Collective", bound=Callable[..., Any])

__all__ = ["Detector", "Impacts", "Intersections", "LocalMesh", "LocalWorld", "Overlaps", "Proximities", "Statistics"]


def _check_library() -> None:
    """Raises ImportError if mpi4py uses another MPI library than this module: handles are valid in one library only."""
    libraries = [library.strip("\0\n ") for library in (_mpi.library(), MPI.Get_library_version())]
    ours, theirs = (" ".join(library.partition("\n")[0].partition(",")[0].split()) for library in libraries)
    if ours != theirs:
        raise ImportError(f"crumple.mpi uses {ours}, but mpi4py uses {theirs}: build both with the same MPI")
    same = MPI._sizeof(MPI.Comm) == _mpi.handle_size() and MPI._handleof(MPI.COMM_WORLD) == _mpi.world()
    if libraries[0] != libraries[1] or not same:
        raise ImportError(f"crumple.mpi and mpi4py use different libraries, both {ours}: build both with the same one")


_check_library()


def _collective(fail: Callable[..., None]) -> Callable[[Collective], Collective]:
    """Decorates methods that all ranks call, so that invalid arguments on one rank raise an error on all.

    If the arguments do not fit the signature, calls fail(error, self, *arguments, **named), which must notify the other
    ranks. They would otherwise wait for this rank.
    """

    def decorate(method: Collective) -> Collective:
        suggested = suggesting(method)
        signature = inspect.signature(method)

        @functools.wraps(method)
        def call(self: Any, *arguments: Any, **named: Any) -> Any:
            try:
                signature.bind(self, *arguments, **named)
            except TypeError as mismatch:
                error = TypeError(with_suggestions(f"{method.__qualname__}() {mismatch}", method, named))
                fail(error, self, *arguments, **named)
                raise error from None
            return suggested(self, *arguments, **named)

        return call  # type: ignore[return-value]

    return decorate


def _fail_call(error: BaseException, detector: Detector, *_: Any, **__: Any) -> None:
    detector._open().fail(error)


def _fail_making(error: BaseException, _: Detector, comm: Any = None, *__: Any, **___: Any) -> None:
    def failing() -> None:
        raise error

    if isinstance(comm, MPI.Intracomm) and comm != MPI.COMM_NULL and MPI.Is_initialized() and not MPI.Is_finalized():
        _together(comm, failing)


_in_call = _collective(_fail_call)


_ALL = IntersectionQuery()


class Detector:
    """Searches a scene that is distributed over ranks, exactly and completely: intersections, impacts, proximities.

    Parameters
    ----------
    comm : mpi4py.MPI.Intracomm
        Communicator; the detector uses a duplicate of it.
    parts : int, default 0
        Number of parts over all ranks, 1 to 262144; 0: chosen from the number of ranks. More parts balance the load
        better, but overlap more.
    batch_bytes : int, default 67108864
        Approximate number of bytes that a rank sends, and that it receives, in one batch of messages; at least 1024.
    threads : int, default 0
        Number of threads of this rank; 0: the cores that the rank may use, divided by the number of ranks that share
        them.
    memory_limit : int, default 0
        Number of bytes that this rank's detector may own; 0: no limit.
    backend, clusters, leaf_size, fuzzy_c_means, method, simd, device
        As for crumple.Detector, but `membership` of Method must be "ball".

    Raises
    ------
    InvalidInput
        If an option is out of range.
    BackendUnavailable
        If a machine or build does not have the requested backend or instruction set.
    Error
        With code "communication" if MPI fails.

    Notes
    -----
    The result depends neither on the number of ranks nor on the distribution of the triangles, and no option changes
    it. A detector caches parts and their centres between calls: if only vertices have moved, little more than their
    coordinates is sent.

    All calls are collective, including those that make and close a detector: all ranks of the communicator make the
    same calls, in the same order, with the same query, and with the same `parts` and `batch_bytes`. Properties are not
    collective. A detector runs one call at a time. Calls release the GIL.

    If a call fails on one rank, all ranks raise the same Error. Its `rank` is the rank that failed, and its `index`
    counts over all ranks. Other exceptions, such as KeyboardInterrupt, are raised on the rank where they occurred, and
    the other ranks raise an Error with code "cancelled". All detectors stay usable. Ctrl-C ends a call within about 50
    ms while the rank searches, otherwise when the ranks next check whether one of them has failed. A process that dies
    ends the job, as usual with MPI.

    MPI must be initialised with at least MPI.THREAD_FUNNELED for calls from the main thread, and with at least
    MPI.THREAD_SERIALIZED for calls from other threads; mpi4py requests MPI.THREAD_MULTIPLE.

    As a context manager, a detector calls close() at the end of the block. If an exception ends the block, it only
    frees memory, because close() is collective, and the other ranks may not call it.

    Cost: that of crumple.Detector, divided among the ranks, plus the transfer of triangles to the ranks that search
    them.
    """

    @_collective(_fail_making)
    def __init__(
        self,
        comm: MPI.Intracomm,
        *,
        parts: int = 0,
        batch_bytes: int = 1 << 26,
        backend: Backend = "automatic",
        threads: int = 0,
        memory_limit: int = 0,
        clusters: int = 0,
        leaf_size: int = 3000,
        fuzzy_c_means: FuzzyCMeans = FuzzyCMeans(),
        method: Method = Method(),
        simd: Simd = "automatic",
        device: int = 0,
    ) -> None:
        of_each = {
            "backend": backend,
            "threads": threads,
            "memory_limit": memory_limit,
            "clusters": clusters,
            "leaf_size": leaf_size,
            "fuzzy_c_means": check_fuzzy_c_means(fuzzy_c_means),
            "method": check_method(method),
            "simd": simd,
            "device": device,
        }
        if not isinstance(comm, MPI.Comm):
            kind = name_of_type(type(comm))
            raise InvalidType(f"comm must be an intracommunicator of mpi4py, not {kind}", element="option")
        if comm == MPI.COMM_NULL or not isinstance(comm, MPI.Intracomm):
            what = "MPI.COMM_NULL" if comm == MPI.COMM_NULL else "an intercommunicator"
            raise InvalidInput(f"comm must be an intracommunicator of mpi4py, not {what}", element="option")
        if not MPI.Is_initialized() or MPI.Is_finalized():
            raise Error("MPI is not initialised: call MPI.Init() first", code="communication")
        options = _together(comm, lambda: _mpi.Options(of_each, parts, batch_bytes))
        self._ranks: _mpi.Detector | None = _mpi.Detector(MPI._handleof(comm), options)
        of_each["threads"], of_each["device"] = self._ranks.threads, self._ranks.device
        self._options = {"parts": parts, "batch_bytes": batch_bytes, **of_each}

    @property
    def options(self) -> dict[str, Any]:
        """Options of this rank's detector, with the number of threads and the device that it uses."""
        return dict(self._options)

    @property
    def rank(self) -> int:
        """Number of this rank, from 0. Like `ranks` and `statistics`, raises Error after close()."""
        return self._open().rank

    @property
    def ranks(self) -> int:
        """Number of ranks."""
        return self._open().ranks

    @property
    def statistics(self) -> Statistics:
        """Counts and times of the last call on this rank."""
        return self._open().statistics

    @_in_call
    def find(self, local: LocalMesh | LocalWorld, query: Query = _ALL) -> Any:
        """Finds everything that a query describes. Collective.

        Parameters
        ----------
        local : LocalMesh or LocalWorld
            Local mesh or bodies of this rank.
        query : IntersectionQuery, ImpactQuery, ProximityQuery or OverlapQuery, default IntersectionQuery()
            The same on all ranks.

        Returns
        -------
        Intersections, Impacts, Proximities or Overlaps
            Rows whose first triangle, first feature or first body belongs to this rank. If `output` is less than
            "pairs", there are no rows. "any_by_world" is the same as "any", because all ranks share one world.

        Raises
        ------
        InvalidInput, MemoryLimit
            On all ranks, see Detector. The message names the argument, and the invalid element of an array.

        Notes
        -----
        The pair filter may select bodies (with World.self_collisions) or groups, not both, except for overlaps.
        Excluded bodies are ids over all ranks, as (n, 2) integers. Not supported: `edges` and `points`, radii, rest
        shapes, rings, least distances, pairs of triangles, and `index`.

        Arrays must be in host memory. If the cuda backend is used, the arrays of a mesh, except for ids, may all be on
        the rank's device (options["device"]); they are then downloaded first. They must not change until the call
        returns. There may be at most 2^31 - 1 triangles, and as many vertices, over all ranks. The scene is divided
        into parts for one query: a different minimum distance, or another type of query, makes new parts. For overlaps
        of bodies it is not divided: each pair of bodies is searched by one rank, and the bodies that it lacks are sent
        to it in each call. For the overlap of a mesh with itself, the rank of triangle 0 gets the whole mesh in each
        call, and computes the row; only the search for triangles that intersect is divided.

        Cost: see Detector. The statistics of the result show what was sent, and how well the load was balanced.

        References
        ----------
        .. [1] D. Mainzer and G. Zachmann, "Collision Detection Based on Fuzzy Scene Subdivision", sec. 1.1, for parts
           on several machines.
        """
        return self._find(lambda: local, lambda: query)

    @_in_call
    def any(self, local: LocalMesh | LocalWorld, query: Query = _ALL) -> bool:
        """True if `find` would find anything on any rank. Each rank stops at its first pair. Collective.

        Parameters
        ----------
        local, query
            As for `find`.

        Returns
        -------
        bool

        Raises
        ------
        InvalidInput, MemoryLimit
            As `find`.
        """
        return self._call("any", lambda: local, lambda: query)[0]

    @_in_call
    @keywords_of(IntersectionQuery)
    def intersections(
        self,
        vertices: Any,
        faces: Any = None,
        *,
        groups: Any = None,
        triangle_ids: Any = None,
        vertex_ids: Any = None,
        body_ids: Any = None,
        **options: Any,
    ) -> Intersections:
        """Finds pairs of triangles that intersect: `find` with an IntersectionQuery. Collective.

        Parameters
        ----------
        vertices, faces, groups : array_like, or mesh or World alone
            Local mesh or bodies of this rank, as for crumple.Detector.intersections.
        triangle_ids, vertex_ids : array_like of int64, optional
            As for LocalMesh.
        body_ids : array_like of int64, optional
            As for LocalWorld.
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
        ids = (triangle_ids, vertex_ids, body_ids)
        return self._find(
            lambda: local_of(scene_of(vertices, faces, groups=groups), *ids),
            lambda: query_of(IntersectionQuery, options),
        )

    @_in_call
    @keywords_of(ImpactQuery)
    def impacts(
        self,
        start: Any,
        end: Any = None,
        faces: Any = None,
        *,
        groups: Any = None,
        triangle_ids: Any = None,
        vertex_ids: Any = None,
        body_ids: Any = None,
        **options: Any,
    ) -> Impacts:
        """Finds features that touch during a step, and when: `find` with an ImpactQuery. Collective.

        Parameters
        ----------
        start, end, faces, groups : array_like, or mesh or World alone
            Local mesh or bodies of this rank, as for crumple.Detector.impacts. Ghost vertices must be equal at the end,
            too.
        triangle_ids, vertex_ids, body_ids : array_like of int64, optional
            As for `intersections`.
        **options
            Members of the ImpactQuery.

        Returns
        -------
        Impacts
            Each impact is on the rank that provided the lowest triangle of its first feature.

        Raises
        ------
        InvalidInput, MemoryLimit
            As `find`.
        """
        ids = (triangle_ids, vertex_ids, body_ids)
        return self._find(
            lambda: local_of(step_of(start, end, faces, groups), *ids), lambda: query_of(ImpactQuery, options)
        )

    @_in_call
    @keywords_of(ProximityQuery)
    def proximities(
        self,
        vertices: Any,
        faces: Any = None,
        *,
        groups: Any = None,
        triangle_ids: Any = None,
        vertex_ids: Any = None,
        body_ids: Any = None,
        **options: Any,
    ) -> Proximities:
        """Finds features whose distance is at most a radius: `find` with a ProximityQuery. Collective.

        Parameters
        ----------
        vertices, faces, groups : array_like, or mesh or World alone
            Local mesh or bodies of this rank, as for crumple.Detector.proximities.
        triangle_ids, vertex_ids, body_ids : array_like of int64, optional
            As for `intersections`.
        **options
            Members of the ProximityQuery.

        Returns
        -------
        Proximities
            Each pair is on the rank that provided the lowest triangle of its first feature.

        Raises
        ------
        InvalidInput, MemoryLimit
            As `find`.
        """
        ids = (triangle_ids, vertex_ids, body_ids)
        return self._find(
            lambda: local_of(scene_of(vertices, faces, groups=groups), *ids), lambda: query_of(ProximityQuery, options)
        )

    @_in_call
    @keywords_of(OverlapQuery)
    def overlaps(
        self, world: Any, *, triangle_ids: Any = None, vertex_ids: Any = None, body_ids: Any = None, **options: Any
    ) -> Overlaps:
        """Finds the overlap of each pair of closed bodies: `find` with an OverlapQuery. Collective.

        Parameters
        ----------
        world : World or mesh
            Bodies of this rank, or its triangles of a mesh, of which the overlap with itself is found.
        triangle_ids, vertex_ids, body_ids : array_like of int64, optional
            As for LocalMesh and LocalWorld.
        **options
            Members of the OverlapQuery.

        Returns
        -------
        Overlaps
            Each row is on the rank that provided its first body; that of a mesh is on the rank of triangle 0.

        Raises
        ------
        InvalidInput, MemoryLimit
            As `find`.
        """
        return self._find(
            lambda: local_of(scene_of(world), triangle_ids, vertex_ids, body_ids),
            lambda: query_of(OverlapQuery, options),
        )

    def set_progress(self, show: Callable[[str, int, int], Any] | None) -> None:
        """Sets a function that reports the progress of calls on this rank. Not collective.

        Parameters
        ----------
        show : callable or None
            Called as show(phase, parts_done, parts). It is called at the beginning of each phase that the search needs,
            in the order of statistics.phase_milliseconds, and in the phase "search" also after each part. `parts_done`
            is the number of this rank's parts that are done, and `parts` their total; in other phases both are 0. An
            exception from `show` ends the call, as KeyboardInterrupt does. `show` must not call this detector. None: no
            function.

        Raises
        ------
        InvalidType
            If `show` is neither callable nor None.
        Error
            After close().
        """
        if show is not None and not callable(show):
            raise InvalidType(f"show must be callable or None, not {type(show).__name__}", element="option")
        self._open().set_progress(show)

    def close(self) -> None:
        """Frees the duplicate of the communicator and all memory. Collective.

        After it, no function but `close` may be called. If `close` is not called, MPI frees the duplicate when it ends.
        """
        if self._ranks is not None:
            self._ranks.close()
            self._ranks = None

    def __enter__(self) -> Detector:
        return self

    def __exit__(self, kind: type[BaseException] | None, *_: Any) -> None:
        if kind is None:
            self.close()
        else:
            self._ranks = None

    def __repr__(self) -> str:
        return "crumple.mpi.Detector(" + ", ".join(f"{name}={value!r}" for name, value in self._options.items()) + ")"

    def _open(self) -> _mpi.Detector:
        if self._ranks is None:
            raise Error("the detector is closed", code="communication")
        return self._ranks

    def _find(self, local: Callable[[], Any], query: Callable[[], Any]) -> Any:
        found, request, of_world = self._call("find", local, query)
        return show(found, request, of_world)

    def _call(self, call: str, local: Callable[[], Any], query: Callable[[], Any]) -> tuple[Any, Query, bool]:
        """Calls the method `call` of the extension module. Returns its result, the query, and True for bodies.

        local() and query() make the arguments of this rank. If one of them raises an exception, notifies the other
        ranks, which would otherwise wait for this rank.
        """
        ranks = self._open()
        try:
            brought, request = local(), query()
            if not isinstance(brought, (LocalMesh, LocalWorld)):
                kind = name_of_type(type(brought))
                raise InvalidType(f"local must be a LocalMesh or a LocalWorld, not {kind}", element="option")
            scene: Any = brought._scene()
            request = checked_query(scene, request)
            if not isinstance(request, (IntersectionQuery, ImpactQuery, ProximityQuery, OverlapQuery)):
                raise InvalidInput(f"{type(request).__name__} is not supported on ranks: see docs/supported.md")
            excluded = excluded_of_ranks(request.filter.excluded_bodies)
            arguments = brought._borrow(ranks, scene), getattr(_mpi, type(request).__name__)(request, excluded)
        except BaseException as error:
            ranks.fail(error)  # notifies the other ranks; if `error` is a crumple.Error, all ranks raise it
            raise
        return getattr(ranks, call)(*arguments), request, isinstance(brought, LocalWorld)


def _together(comm: MPI.Intracomm, work: Callable[[], Returned]) -> Returned:
    """Returns work() or, if it fails on any rank, raises on all ranks the error of the lowest rank where it failed."""
    result: Returned | None = None
    failed: Error | None = None
    own: BaseException | None = None
    try:
        result = work()
    except Error as error:
        failed = type(error)(
            f"rank {comm.rank}: {error}", code=error.code, element=error.element, index=error.index, rank=comm.rank
        )
    except BaseException as error:  # notifies the other ranks, which wait for this one
        own = error
        failed = Error(f"rank {comm.rank}: the call was interrupted: {error!r}", code="cancelled", rank=comm.rank)
    all_failed = comm.allgather(failed)
    if own is not None:
        raise own
    for error in all_failed:
        if error is not None:
            raise error
    return result  # type: ignore[return-value]
