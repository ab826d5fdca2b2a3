"""Questions about meshes in device memory whose answers stay there: Detector.launch_self and its like."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

from . import _core
from ._candidates import candidate_question
from ._core import Statistics
from ._errors import InvalidInput, InvalidType
from ._impacts import FirstImpact
from ._mesh import as_mesh, listing_of, soup_of
from ._names import suggesting
from ._near import radius_of
from ._world_search import excluded_in, with_names

if TYPE_CHECKING:
    from ._candidates import CandidateKind
    from ._detector import Detector, GroupPairs, Intersections, Neighbours, Wanted
    from ._motion import MotionWants
    from ._near import NearWants
    from ._world import World
    from ._world_search import Wants

_AGAIN = "a call outside of the capture makes longer lists, or other features; capture it again"


class DeviceArray:
    """An array in CUDA memory that a detector owns.

    What reads arrays of a device takes it, without a copy: torch.from_dlpack(array), cupy.from_dlpack(array),
    jax.dlpack.from_dlpack(array), wp.from_dlpack(array), and by __cuda_array_interface__ cupy.asarray(array),
    numba.cuda.as_cuda_array(array). It is ready on every stream. Valid as the answer that it belongs to; copy what has
    to last (torch.from_dlpack(array).clone()). Flags are uint8.

    Attributes:
        shape: numbers of elements.
        dtype: "<i4", "<i8", "<f8" or "|u1", as NumPy writes types.
        address: of the first element, in device memory.
    """

    __slots__ = ("_detector", "address", "dtype", "shape")

    def __init__(self, detector: Detector, address: int, shape: tuple[int, ...], dtype: str) -> None:
        self._detector, self.address, self.shape, self.dtype = detector, address, shape, dtype

    def __len__(self) -> int:
        return self.shape[0]

    @property
    def __cuda_array_interface__(self) -> dict[str, Any]:
        return {
            "shape": self.shape,
            "typestr": self.dtype,
            "data": (self.address, False),
            "version": 3,
            "strides": None,
            "stream": None,
        }

    def __dlpack__(self, **_: Any) -> Any:
        return self._detector._dlpack_capsule(self.address, self.shape, self.dtype)

    def __dlpack_device__(self) -> tuple[int, int]:
        return 2, self._detector.options["device"]  # CUDA

    def __repr__(self) -> str:
        return f"<crumple.DeviceArray {self.shape} {self.dtype} at {self.address:#x}>"


class DeviceAnswer:
    """An answer in device memory.

    Valid until the second launch after the one that it answers, or the detector's next call that is no launch and no
    wait. Its arrays (DeviceArray) have the names of those of the answer on the host, and their bytes; flags are uint8.

    Attributes:
        complete: False if the answer did not fit in a launch that was captured: then there are no arrays.
        needed: rows that there are; where it is not complete, those that were found, and there may be more.
        count: rows of all lists.
        statistics: what the call did.
    """

    _members: tuple[str, ...] = ()

    def __init__(self, detector: Detector, told: Any, arrays: dict[str, Any], statistics: Statistics) -> None:
        self.complete, self.needed, self.count = told[:3]
        self.statistics = statistics
        self._arrays = {name: DeviceArray(detector, *array) for name, array in arrays.items()}

    def __getattr__(self, name: str) -> DeviceArray:
        if name.startswith("_") or name not in self.__dict__.get("_arrays", {}):
            if not name.startswith("_") and not self.__dict__.get("complete", True):
                raise InvalidInput(f"{name}: the answer is not complete; {_AGAIN}")
            raise AttributeError(f"{type(self).__name__} has no {name}; it has {', '.join(self._names())}")
        return self._arrays[name]

    def _names(self) -> list[str]:
        return [*self._members, "complete", "needed", "count", "statistics", *self.__dict__.get("_arrays", {})]

    def __dir__(self) -> list[str]:
        return sorted({*super().__dir__(), *self._names()})

    def __repr__(self) -> str:
        told = f"{self.count} rows" if self.complete else "not complete"
        return f"<crumple.{type(self).__name__}: {told}>"


class DeviceResult(DeviceAnswer):
    """What Detector.launch_self and launch_between find: `pairs`, `offsets`, `hit`, between two meshes `hit_second`,
    and with contacts `contact_kinds`, `contact_offsets` (pairs + 1) and `contact_points` (k, 3)."""


class DeviceWorldResult(DeviceAnswer):
    """What Detector.launch finds: `world_hit` and `world_counts` (worlds,), `world_offsets` (worlds + 1); from
    wants="pairs" on `pairs` and `bodies`, and with "contacts" `contact_kinds`, `contact_offsets` (pairs + 1) and
    `contact_points` (k, 3), as crumple.WorldResult has them.

    Attributes:
        any: whether anything collides.
    """

    _members = ("any",)

    def __init__(self, detector: Detector, told: Any, arrays: dict[str, Any], statistics: Statistics) -> None:
        super().__init__(detector, told, arrays, statistics)
        self.any: bool = told[3]


class DeviceImpacts(DeviceAnswer):
    """What Detector.launch_impacts finds: arrays as those of crumple.Impacts, and `edges`.

    Attributes:
        any: whether anything touches.
        first: the first impact (crumple.FirstImpact), or None. From wants="earliest" on.
    """

    _members = ("any", "first")

    def __init__(self, detector: Detector, told: Any, arrays: dict[str, Any], statistics: Statistics) -> None:
        super().__init__(detector, told, arrays, statistics)
        self.any: bool = told[3]
        self.first: FirstImpact | None = None if told[4] is None else FirstImpact(*told[4])


class DeviceNearby(DeviceAnswer):
    """What Detector.launch_near finds: arrays as those of crumple.Nearby, and `edges`.

    Attributes:
        any: whether anything is near.
    """

    _members = ("any",)

    def __init__(self, detector: Detector, told: Any, arrays: dict[str, Any], statistics: Statistics) -> None:
        super().__init__(detector, told, arrays, statistics)
        self.any: bool = told[3]


class DeviceCandidates(DeviceAnswer):
    """What Detector.launch_candidates finds: arrays as those of crumple.Candidates, and `edges`."""


def _stream(given: Any) -> int | None:
    """The address of a stream: an integer, or what PyTorch, Warp and CuPy have for streams."""
    for name in ("cuda_stream", "ptr", "handle"):
        given = getattr(given, name, given)
    if given is None or (isinstance(given, int) and not isinstance(given, bool)):
        return given
    kind = type(given).__name__
    raise InvalidType(f"stream must be None, an address, or a stream of PyTorch, CuPy or Warp, not {kind}")


@suggesting
def launch_self(
    self: Detector,
    vertices: Any,
    faces: Any = None,
    *,
    neighbours: Neighbours = "geometric",
    intersections: Intersections = "all",
    weld: bool = False,
    contacts: bool = False,
    groups: Any = None,
    wanted: Wanted = "both",
    excluded_groups: GroupPairs | None = None,
    stream: Any = None,
) -> None:
    """Starts find_self on arrays in device memory and returns at once; wait() tells where the answer lies there.

    Two launches may be in flight, of any kind, and each wait is for the oldest. Arrays must stay as they are until it
    returns. Only with the cuda backend.

    Args:
        vertices, faces, groups: as find_self takes them, on the detector's device, through DLPack. What is not of a
            type that can be read in place is refused, for nothing is converted there.
        stream: CUDA stream that does the work: None, the legacy default stream; or the address of another one, or a
            stream of PyTorch, CuPy or Warp. The package that owns the arrays makes them ready on it (DLPack's
            __dlpack__(stream=...)): the stream waits for the package's current stream, such as
            torch.cuda.current_stream(), and for no other. A stream that is being captured makes the work a part of the
            caller's graph: each replay is a query, after two calls like it outside of the capture. It should be the
            package's current stream then, for a capture may not wait for streams outside of it.
        neighbours, intersections, weld, contacts, wanted, excluded_groups: as find_self has them.

    Raises InvalidInput; bad contents of arrays are reported by wait().
    """
    query = _core.Query(neighbours, intersections, weld, contacts, wanted, excluded_groups)
    self._launch(soup_of(vertices, faces, groups), None, query, _stream(stream))


@suggesting
def launch_between(
    self: Detector,
    a: Any,
    b: Any,
    *,
    neighbours: Neighbours = "geometric",
    intersections: Intersections = "all",
    weld: bool = False,
    contacts: bool = False,
    wanted: Wanted = "both",
    excluded_groups: GroupPairs | None = None,
    stream: Any = None,
) -> None:
    """Starts find_between on meshes in device memory and returns at once; see launch_self, and wait()."""
    query = _core.Query(neighbours, intersections, weld, contacts, wanted, excluded_groups)
    self._launch(as_mesh(a), as_mesh(b), query, _stream(stream))


@suggesting
def launch(
    self: Detector,
    world: World,
    *,
    poses: Any = None,
    wants: Wants = "pairs",
    neighbours: Neighbours = "geometric",
    intersections: Intersections = "all",
    weld: bool = False,
    bodies: Wanted = "both",
    groups: Wanted = "both",
    excluded: Any = None,
    excluded_groups: GroupPairs | None = None,
    stream: Any = None,
) -> None:
    """Starts find on a world whose poses lie in device memory and returns at once; wait() returns its result.

    A step of thousands of worlds, say, whose poses a simulator has on the device: flags by world stay there.

    Args:
        world: shapes and bodies, on the host. They go to the device when they are not those of the call before.
        poses: (n, 3, 4) float32 or float64 in CUDA memory, without gaps; None: those of the world, which lie there
            and are made ready once more by each launch.
        wants: "any", "any_by_world" and "count" make flags and counts by world, "pairs" and "contacts" all.
        stream: see launch_self.
        neighbours, intersections, weld, bodies, groups, excluded, excluded_groups: as find has them.

    At most 65,535 worlds, and 2^24 triangles together. Raises InvalidInput, which names the body; MemoryLimit.
    """
    question = _core.Question(wants, neighbours, intersections, weld, bodies, groups, excluded_groups, False)
    poses = world.poses if poses is None else poses
    with_names(world, self._launch_world, world, poses, question, excluded_in(world, excluded), _stream(stream))


@suggesting
def launch_impacts(
    self: Detector,
    vertices: Any,
    end: Any,
    faces: Any = None,
    *,
    wants: MotionWants = "impacts",
    min_distance: float = 0.0,
    min_distance_share: float = 0.0,
    groups: Any = None,
    edges: Any = None,
    points: Any = None,
    wanted: Wanted = "both",
    excluded_groups: GroupPairs | None = None,
    stream: Any = None,
) -> None:
    """Starts find_impacts on arrays in device memory and returns at once; wait_impacts() tells of the answer.

    See launch_self for streams, and find_impacts for what is asked. `end`, `edges` and `points` lie on the device, too.
    The first launch for a mesh, and one with other numbers of vertices, faces, edges or points, waits for the stream:
    the host has to see which edges there are. Rules about groups beside `edges` or `points` are for find_impacts.
    """
    rules = _core.rules_of_mesh(wanted, excluded_groups)
    question = _core.Motion(wants, min_distance, min_distance_share, False, rules, False, False)
    mesh = listing_of(vertices, faces, groups, edges, points)
    self._launch_impacts(mesh, end, question, (edges, points), _stream(stream))


@suggesting
def launch_near(
    self: Detector,
    vertices: Any,
    faces: Any = None,
    *,
    radius: float | None = None,
    radii: Any = None,
    wants: NearWants = "pairs",
    strict: bool = False,
    rings: int = 0,
    rest: Any = None,
    rest_radius: float = 0,
    groups: Any = None,
    edges: Any = None,
    points: Any = None,
    wanted: Wanted = "both",
    excluded_groups: GroupPairs | None = None,
    stream: Any = None,
) -> None:
    """Starts find_near on arrays in device memory and returns at once; wait_near() tells where the answer lies.

    See launch_self for streams, launch_impacts for what waits, and find_near for what is asked. `radii`, `rest`,
    `edges` and `points` lie on the device, too. Closest points and least distances are for find_near.
    """
    rules = _core.rules_of_mesh(wanted, excluded_groups)
    radius = radius_of("launch_near", radius, radii is not None)
    question = _core.Near(wants, radius, strict, False, False, False, rings, rest_radius, rules, False)
    mesh = listing_of(vertices, faces, groups, edges, points)
    self._launch_near(mesh, question, radii, rest, (edges, points), _stream(stream))


@suggesting
def launch_candidates(
    self: Detector,
    vertices: Any,
    faces: Any = None,
    *,
    end: Any = None,
    kinds: CandidateKind | Iterable[CandidateKind] = ("vertex_face", "edge_edge"),
    inflation: float = 0.0,
    groups: Any = None,
    edges: Any = None,
    points: Any = None,
    wanted: Wanted = "both",
    excluded_groups: GroupPairs | None = None,
    stream: Any = None,
) -> None:
    """Starts find_candidates on arrays in device memory and returns at once; wait_candidates() tells where they lie.

    See launch_self for streams, launch_impacts for what waits, and find_candidates for what is asked.
    """
    question = candidate_question(kinds, inflation, False, _core.rules_of_mesh(wanted, excluded_groups))
    mesh = listing_of(vertices, faces, groups, edges, points)
    self._launch_candidates(mesh, end, question, (edges, points), _stream(stream))


@suggesting
def wait(self: Detector) -> DeviceResult | DeviceWorldResult:
    """Waits for the oldest launch, of launch_self, launch_between or launch, and returns where its result lies on the
    device: a DeviceWorldResult of a launch of worlds.

    The answer is complete: lists that were too short are made longer and the work is done again, and what only the host
    can decide is decided. After a launch that was captured it tells of the last replay, whose stream the caller has
    waited for, and does not do it again: see DeviceAnswer.complete.

    Raises InvalidInput if the arrays are not what a mesh can be, or there is nothing to wait for; MemoryLimit.
    """
    told, arrays, statistics = self._wait()
    kind = DeviceResult if len(told) == 3 else DeviceWorldResult
    return kind(self, told, arrays, statistics)


@suggesting
def wait_impacts(self: Detector) -> DeviceImpacts:
    """Waits for the oldest launch, of launch_impacts, as wait() does. Where faces, edges or points turn out to be
    others than in the launch before, the host looks at them and the work is done again."""
    return DeviceImpacts(self, *self._wait_impacts())


@suggesting
def wait_near(self: Detector) -> DeviceNearby:
    """Waits for the oldest launch, of launch_near, as wait_impacts() does."""
    return DeviceNearby(self, *self._wait_near())


@suggesting
def wait_candidates(self: Detector) -> DeviceCandidates:
    """Waits for the oldest launch, of launch_candidates, as wait_impacts() does."""
    return DeviceCandidates(self, *self._wait_candidates())


for _method in (
    launch,
    launch_self,
    launch_between,
    launch_impacts,
    launch_near,
    launch_candidates,
    wait,
    wait_impacts,
    wait_near,
    wait_candidates,
):
    _method.__qualname__ = f"Detector.{_method.__name__}"
