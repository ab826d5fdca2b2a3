"""Devices: those that the cuda backend can work on, launches, and results in their memory."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

from . import _core
from ._core import Statistics
from ._errors import InvalidInput, InvalidType
from ._features import FirstImpact

if TYPE_CHECKING:
    from ._detector import Detector

_AGAIN = "a call outside of the capture makes longer lists, or other features; capture it again"


class DeviceArray:
    """An array in CUDA memory that a detector owns.

    What reads arrays of a device takes it, without a copy: torch.from_dlpack(array), cupy.from_dlpack(array),
    jax.dlpack.from_dlpack(array), wp.from_dlpack(array), and by __cuda_array_interface__ cupy.asarray(array),
    numba.cuda.as_cuda_array(array). It is ready on every stream. Valid as the result that it belongs to; copy what has
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


class DeviceResult:
    """A result in device memory.

    Valid until the second launch after the one that it is for, or the detector's next call that is no launch and no
    wait. Its arrays (DeviceArray) have the names of those of the result on the host, and their bytes; flags are uint8.
    Of intersections of meshes `pairs`, `offsets`, `hit`, `hit_second`; of worlds `world_hit`, `world_counts`,
    `world_offsets`, and where pairs were requested `pairs` and `bodies`; with contacts `contact_kinds`,
    `contact_offsets` and `contact_points`. Of features the lists, and `edges`.

    Attributes:
        any: whether there is anything.
        complete: False if the result did not fit in a launch that was captured: then there are no arrays.
        needed: rows that there are; where it is not complete, those that were found, and there may be more.
        count: rows of all lists.
        first: of impacts, the first one (crumple.FirstImpact), or None. From output="first" on.
        statistics: what the call did.
    """

    def __init__(self, detector: Detector, values: Any, arrays: dict[str, Any], statistics: Statistics) -> None:
        self.complete, self.needed, self.count, self.any, first = values
        self.first: FirstImpact | None = None if first is None else FirstImpact(*first)._replace(bodies=None)
        self.statistics = statistics
        self._arrays = {name: DeviceArray(detector, *array) for name, array in arrays.items()}

    def __getattr__(self, name: str) -> DeviceArray:
        arrays = self.__dict__.get("_arrays", {})
        if not name.startswith("_") and name in arrays:
            return arrays[name]
        if not name.startswith("_") and not self.__dict__.get("complete", True):
            raise InvalidInput(f"{name}: the result is not complete; {_AGAIN}")
        raise AttributeError(f"DeviceResult has no {name}; it has {', '.join(self._names())}")

    def _names(self) -> list[str]:
        values = [name for name in self.__dict__ if not name.startswith("_")]
        return [*values, *self.__dict__.get("_arrays", {})]

    def __dir__(self) -> list[str]:
        return sorted({*super().__dir__(), *self._names()})

    def __repr__(self) -> str:
        return f"<crumple.DeviceResult: {f'{self.count} rows' if self.complete else 'not complete'}>"


class Launch:
    """A query that Detector.launch has started."""

    def __init__(self, detector: Detector, ticket: Any) -> None:
        self._detector, self._ticket = detector, ticket

    def wait(self) -> DeviceResult:
        """Waits, and returns where the result lies on the device. The oldest launch comes first.

        The result is complete: lists that were too short are made longer and the work is done again, and what only the
        host can decide is decided. After a launch that was captured it is that of the last replay, whose stream the
        caller has waited for, and is not made again: see DeviceResult.complete; each replay may be waited for.

        Raises InvalidInput if the arrays are not what a scene can be, or there is nothing to wait for; MemoryLimit.
        """
        return DeviceResult(self._detector, *self._ticket.wait(self._detector))


def stream_of(given: Any) -> int | None:
    """The address of a stream: an integer, or what PyTorch, Warp and CuPy have for streams."""
    for name in ("cuda_stream", "ptr", "handle"):
        given = getattr(given, name, given)
    if given is None or (isinstance(given, int) and not isinstance(given, bool)):
        return given
    kind = type(given).__name__
    raise InvalidType(f"stream must be None, an address, or a stream of PyTorch, CuPy or Warp, not {kind}")


class DeviceInfo(NamedTuple):
    """A device that the cuda backend can work on.

    Attributes:
        number: selects it, as the option `device` of a Detector.
        name: from its driver.
        major, minor: its compute capability.
        memory_bytes: all of its memory, in use or not.
    """

    number: int
    name: str
    major: int
    minor: int
    memory_bytes: int


class DeviceList(NamedTuple):
    """The devices; and if there are none, the reason in one line, otherwise ""."""

    devices: list[DeviceInfo]
    reason: str


def list_devices() -> DeviceList:
    """The devices that CUDA lists. Without a device, a driver or the backend, the list is empty and says why.

    Cost: the first call in a process starts the driver, which takes some tenths of a second.
    """
    devices, reason = _core.list_devices()
    return DeviceList([DeviceInfo(*device) for device in devices], reason)
