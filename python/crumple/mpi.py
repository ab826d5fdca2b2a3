"""One scene on many processes of MPI, with mpi4py's communicators.

    from mpi4py import MPI
    import crumple.mpi

    with crumple.mpi.Detector(MPI.COMM_WORLD) as detector:
        result = detector.intersections(vertices, faces)  # this rank's share of the scene
        print(result.pairs, result.count)                 # its rows of the result; pairs over all ranks

Each rank brings triangles of its own, with all vertices that they name, and gets the pairs whose first triangle it has
brought. The rows of all ranks, merged, are the bytes of crumple.Detector.intersections of the whole scene. impacts and
proximities do the same for motion and nearness. Ranks may bring bodies, too (crumple.World). As in crumple.Detector,
detector.find(share, query) is the one call.

The package has this module where it was built with MPI: `pip install .
--config-settings=cmake.define.CRUMPLE_MPI=ON`. mpi4py must use the same MPI; importing this module checks that, and
initialises MPI as mpi4py does. Raises ImportError.
"""

from __future__ import annotations

import functools
import importlib.util
import inspect
from collections.abc import Callable
from typing import Any, TypeVar

from ._detector import Backend, Simd
from ._errors import Error, InvalidInput, InvalidType, name_of_type, suggesting
from ._queries import (
    FuzzyCMeans,
    ImpactQuery,
    IntersectionQuery,
    ProximityQuery,
    Query,
    check_fuzzy_c_means,
    keywords_of,
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

from . import _mpi  # after mpi4py, which chooses how MPI is loaded
from ._ranks import Impacts, Intersections, MeshShare, Proximities, WorldShare, excluded_of_ranks, share_of, show

Statistics = _mpi.Statistics
Answered = TypeVar("Answered")
Method = TypeVar("Method", bound=Callable[..., Any])

__all__ = ["Detector", "Impacts", "Intersections", "MeshShare", "Proximities", "Statistics", "WorldShare"]


def _check_library() -> None:
    """Handles of one MPI mean nothing to another, nor to another copy of the same."""
    libraries = [library.strip("\0\n ") for library in (_mpi.library(), MPI.Get_library_version())]
    ours, theirs = (" ".join(library.partition("\n")[0].partition(",")[0].split()) for library in libraries)
    if ours != theirs:
        raise ImportError(f"crumple.mpi uses {ours}, but mpi4py {theirs}: build both with the same MPI")
    same = MPI._sizeof(MPI.Comm) == _mpi.handle_size() and MPI._handleof(MPI.COMM_WORLD) == _mpi.world()
    if libraries[0] != libraries[1] or not same:
        raise ImportError(f"crumple.mpi and mpi4py use two libraries that are {ours}: build both with the same")


_check_library()


def _collective(fail: Callable[..., None]) -> Callable[[Method], Method]:
    """For methods that all ranks call: where the arguments of one are none of the method, fail(error, self, *arguments,
    **named) tells the others, who would wait for it."""

    def decorate(method: Method) -> Method:
        suggested = suggesting(method)
        signature = inspect.signature(method)

        @functools.wraps(method)
        def call(self: Any, *arguments: Any, **named: Any) -> Any:
            try:
                signature.bind(self, *arguments, **named)
            except TypeError:
                try:
                    return suggested(self, *arguments, **named)  # which says what is wrong
                except TypeError as error:
                    fail(error, self, *arguments, **named)
                    raise
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
    """Searches a scene of which each rank brings a share, exactly and completely: intersections, impacts, proximities.

    The result depends neither on the number of ranks nor on how triangles are shared out. A detector keeps parts of the
    scene and their centres between calls: where only vertices have moved, little more than their coordinates travels.

    All calls, making and closing a detector included, are collective: all ranks of the communicator make the same, in
    the same order, with the same query; properties and `statistics` are not. A detector takes one call at a time.
    Calls release the GIL.

    If a call fails on one rank it fails on all: each raises the same Error, whose `rank` is the one that failed; where
    an element is to blame, `index` is its number over all ranks. What is no crumple.Error, such as KeyboardInterrupt,
    is raised where it happened, and an Error of code "cancelled" on the others. All detectors stay usable. Ctrl-C is
    seen within about 50 ms while a rank searches, otherwise when the ranks next agree. A process that dies ends the
    job, as with MPI it does.

    Args:
        comm: an intracommunicator of mpi4py, of which the detector uses a duplicate.
        parts: that the scene is cut into over all ranks, 1 to 262144; 0: chosen from the number of ranks. More parts
            are shared out more evenly, but overlap more.
        round_bytes: bytes that a rank may have on their way at a time, out and in each; at least 1024.
        threads: 0: the cores that the rank may use, divided by the ranks that share them.
        memory_limit: bytes that this rank's detector may own, 0: no limit.

    Other options are those of crumple.Detector; parts and round_bytes are the same on all ranks. No option changes a
    result. MPI must be initialised with MPI.THREAD_FUNNELED at least for calls from the main thread, with
    MPI.THREAD_SERIALIZED for others; mpi4py asks for MPI.THREAD_MULTIPLE. Raises InvalidInput for options out of range,
    BackendUnavailable for what a machine or build lacks, Error of code "communication" where MPI fails.

    As a context manager it is closed at the end, unless an exception ends the block: others may not be there then, and
    memory is freed alone.

    Cost: as that of crumple.Detector, shared by the ranks, and the way of triangles to the ranks that search them.
    """

    @_collective(_fail_making)
    def __init__(
        self,
        comm: MPI.Intracomm,
        *,
        parts: int = 0,
        round_bytes: int = 1 << 26,
        backend: Backend = "automatic",
        threads: int = 0,
        memory_limit: int = 0,
        clusters: int = 0,
        leaf_size: int = 3000,
        fuzzy_c_means: FuzzyCMeans = FuzzyCMeans(),
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
            raise Error("MPI is not initialised: call MPI.Init() before", code="communication")
        options = _together(comm, lambda: _mpi.Options(of_each, parts, round_bytes))
        self._ranks: _mpi.Detector | None = _mpi.Detector(MPI._handleof(comm), options)
        of_each["threads"], of_each["device"] = self._ranks.threads, self._ranks.device
        self._options = {"parts": parts, "round_bytes": round_bytes, **of_each}

    @property
    def options(self) -> dict[str, Any]:
        """What the detector was made with on this rank; threads: how many it has come to; device: which."""
        return dict(self._options)

    @property
    def rank(self) -> int:
        """This rank, from 0. Raises Error, as `ranks` and `statistics`, after close()."""
        return self._open().rank

    @property
    def ranks(self) -> int:
        """How many ranks there are."""
        return self._open().ranks

    @property
    def statistics(self) -> Statistics:
        """What the last call did on this rank."""
        return self._open().statistics

    @_in_call
    def find(self, share: MeshShare | WorldShare, query: Query = _ALL) -> Any:
        """Finds everything that a query describes: on each rank the rows whose first triangle, or first feature, or
        first body, it has brought. Collective.

        Args:
            share: what this rank brings: a MeshShare or a WorldShare.
            query: an IntersectionQuery, an ImpactQuery or a ProximityQuery, the same on all ranks. For less output than
                pairs no rows travel; "any_by_world" is as "any", for ranks share one world. Filters speak of bodies
                (World's self_collisions, too) or of groups, not of both; excluded bodies are (n, 2) integers, numbers
                over all ranks. Listed edges and points, radii, rest shapes, rings, least distances, pairs of triangles
                and offsets are for one process.

        Arrays lie on the host, or, but for ids and worlds, all on the rank's device (options["device"]) where the cuda
        backend works, which copies them to the host first. They must not change until the call returns. There may be
        2^31 - 1 triangles, and as many vertices, over all ranks. Parts of the scene are made for one query: another
        minimum distance, or a query of another type, begins them anew. Raises InvalidInput, which names the argument
        and the place, and MemoryLimit, on all ranks; see Detector.

        Cost: see Detector. result.statistics tells what travelled, and how evenly the work was shared out. Source:
        Mainzer and Zachmann, sec. 1.1, for parts on several machines.
        """
        return self._find(lambda: share, lambda: query)

    @_in_call
    def any(self, share: MeshShare | WorldShare, query: Query = _ALL) -> bool:
        """True if there is anything to find, on any rank. Each rank stops at its first. Collective. As find."""
        return self._call("any", lambda: share, lambda: query)[0]

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
        """Pairs of triangles that intersect: find with an IntersectionQuery. Collective.

        Args:
            vertices, faces, groups: as of crumple.Detector.intersections, of this rank; or a mesh or a World alone.
            triangle_ids, vertex_ids: as of MeshShare; body_ids: as of WorldShare.
        """
        ids = (triangle_ids, vertex_ids, body_ids)
        return self._find(
            lambda: share_of(scene_of(vertices, faces, groups=groups), *ids), lambda: IntersectionQuery(**options)
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
        """Features that touch on the way from `start` to `end`, and when: find with an ImpactQuery. Collective.

        Each impact is on the rank whose triangle owns its first feature. Copies of a vertex are equal at the end, too.
        Arguments as of intersections.
        """
        ids = (triangle_ids, vertex_ids, body_ids)
        return self._find(lambda: share_of(step_of(start, end, faces, groups), *ids), lambda: ImpactQuery(**options))

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
        """Features whose distance is at most a radius: find with a ProximityQuery. Collective.

        Each pair is on the rank whose triangle owns its first feature. Arguments as of intersections.
        """
        ids = (triangle_ids, vertex_ids, body_ids)
        return self._find(
            lambda: share_of(scene_of(vertices, faces, groups=groups), *ids), lambda: ProximityQuery(**options)
        )

    def set_progress(self, show: Callable[[str, int, int], Any] | None) -> None:
        """Has show(phase, parts_done, parts) called on this rank as calls go on. Not collective.

        Args:
            show: called as each phase begins (statistics.phase_milliseconds names them, in their order; what a call
                does not need is left out), and as each part has been searched: phase "search", how many of this rank's
                parts are done, and how many there are. Otherwise these two are 0. What it raises ends the call, as
                KeyboardInterrupt does. It must not call this detector. None: nothing is called.

        Raises InvalidType, and Error after close().
        """
        if show is not None and not callable(show):
            raise InvalidType(f"show must be callable or None, not {type(show).__name__}", element="option")
        self._open().set_progress(show)

    def close(self) -> None:
        """Frees the duplicate of the communicator and all memory. Collective. No call may follow but another close.

        A detector that is not closed leaves the duplicate to the end of MPI.
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

    def _find(self, share: Callable[[], Any], query: Callable[[], Any]) -> Any:
        found, request, of_world = self._call("find", share, query)
        return show(found, request, of_world)

    def _call(self, call: str, share: Callable[[], Any], query: Callable[[], Any]) -> tuple[Any, Query, bool]:
        """What the call finds, and of what. `share` and `query` make what this rank brings: where that fails it tells
        the others, who wait for it."""
        ranks = self._open()
        try:
            brought, request = share(), query()
            if not isinstance(brought, (MeshShare, WorldShare)):
                kind = name_of_type(type(brought))
                raise InvalidType(f"share must be a MeshShare or a WorldShare, not {kind}", element="option")
            scene: Any = brought._scene()
            request = checked_query(scene, request)
            if not isinstance(request, (IntersectionQuery, ImpactQuery, ProximityQuery)):
                raise InvalidInput(
                    f"{type(request).__name__} is not supported on ranks: docs/supported.md has the table"
                )
            excluded = excluded_of_ranks(request.filter.excluded_bodies)
            arguments = brought._borrow(ranks, scene), getattr(_mpi, type(request).__name__)(request, excluded)
        except BaseException as error:
            ranks.fail(error)  # which raises what is crumple's on all ranks, for they wait for this one
            raise
        return getattr(ranks, call)(*arguments), request, isinstance(brought, WorldShare)


def _together(comm: MPI.Intracomm, work: Callable[[], Answered]) -> Answered:
    """What `work` gives, or on all ranks the error of the least rank where it fails."""
    result: Answered | None = None
    failed: Error | None = None
    own: BaseException | None = None
    try:
        result = work()
    except Error as error:
        failed = type(error)(
            f"rank {comm.rank}: {error}", code=error.code, element=error.element, index=error.index, rank=comm.rank
        )
    except BaseException as error:  # the others wait for this rank: they hear of it, and it is raised here as it is
        own = error
        failed = Error(f"rank {comm.rank}: the call was interrupted: {error!r}", code="cancelled", rank=comm.rank)
    all_failed = comm.allgather(failed)
    if own is not None:
        raise own
    for error in all_failed:
        if error is not None:
            raise error
    return result  # type: ignore[return-value]
