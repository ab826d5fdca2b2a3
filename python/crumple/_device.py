"""CUDA devices, launches, and results in device memory."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

from . import _core
from ._core import Statistics
from ._errors import InvalidInput, InvalidType
from ._features import FirstImpact

if TYPE_CHECKING:
    from ._detector import Detector

_AGAIN = "call launch outside of the capture, which updates its lists, and capture it again"


class DeviceArray:
    """Array in CUDA memory that a detector owns.

    Attributes
    ----------
    shape : tuple of int
        Number of elements along each axis.
    dtype : {"<i4", "<i8", "<f8", "|u1"}
        Type as NumPy writes it. Flags are uint8, "|u1".
    address : int
        Address of the first element in device memory.

    Notes
    -----
    Packages read it without a copy: `torch.from_dlpack(array)`, `cupy.from_dlpack(array)`,
    `jax.dlpack.from_dlpack(array)`, `wp.from_dlpack(array)`, and through `__cuda_array_interface__`
    `cupy.asarray(array)` and `numba.cuda.as_cuda_array(array)`. The array is ready on every stream. It is valid as long
    as its DeviceResult; copy what you need for longer (`torch.from_dlpack(array).clone()`).
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
    """Result in device memory.

    Attributes
    ----------
    any : bool
        True if anything was found.
    complete : bool
        False if the result of a captured launch did not fit in the lists that were allocated. There are no arrays then.
    needed : int
        Number of rows that the lists need. For an incomplete result: the number found so far, which is a lower bound.
    count : int
        Number of rows of all lists.
    first : FirstImpact or None
        First impact, for impacts with output "first" or "pairs".
    statistics : Statistics
        Counts and times of the call.

    Notes
    -----
    Other attributes are arrays (DeviceArray) with the names and contents of those of the result in host memory; flags
    are uint8:

    - intersections of meshes: `pairs`, `offsets`, `hit`, `hit_second`;
    - intersections of worlds: `world_hit`, `world_counts`, `world_offsets`, and `pairs` and `bodies` if pairs were
      requested;
    - contacts: `contact_kinds`, `contact_offsets`, `contact_points`;
    - features: the lists, and `edges`.

    Valid until the second launch after its own, or until the detector's next call that is neither a launch nor a wait.
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
    """Query in flight, which Detector.launch has started."""

    def __init__(self, detector: Detector, ticket: Any) -> None:
        self._detector, self._ticket = detector, ticket

    def wait(self) -> DeviceResult:
        """Waits for the launch and returns its result in device memory.

        Wait for launches in their order, the oldest first. The result is complete: if lists were too short, `wait`
        grows them and runs the query again. It also does the steps that only the host can do.

        After a launch in a capture: returns the result of the last replay of the graph. The caller must have
        synchronized its stream. A replayed query does not run again if lists were too short (DeviceResult.complete).
        `wait` may be called after each replay.

        Returns
        -------
        DeviceResult

        Raises
        ------
        InvalidInput
            If the contents of the arrays are invalid, or there is nothing to wait for.
        MemoryLimit
            If the lists exceed the memory limit.
        """
        return DeviceResult(self._detector, *self._ticket.wait(self._detector))


def stream_of(given: Any) -> int | None:
    """Returns the address of a stream, given as an integer or as a stream of PyTorch, Warp or CuPy; None for None."""
    for name in ("cuda_stream", "ptr", "handle"):
        given = getattr(given, name, given)
    if given is None or (isinstance(given, int) and not isinstance(given, bool)):
        return given
    kind = type(given).__name__
    raise InvalidType(f"stream must be None, an address, or a stream of PyTorch, CuPy or Warp, not {kind}")


class DeviceInfo(NamedTuple):
    """Device that the cuda backend can use.

    Attributes
    ----------
    number : int
        Value of the option `device` of a Detector that selects this device.
    name : str
        Name that the driver reports.
    major, minor : int
        Compute capability.
    memory_bytes : int
        Total memory of the device.
    """

    number: int
    name: str
    major: int
    minor: int
    memory_bytes: int


class DeviceList(NamedTuple):
    """Result of list_devices.

    Attributes
    ----------
    devices : list of DeviceInfo
        Devices; empty if there are none.
    reason : str
        Reason, in one line, why there are no devices; "" if there are any.
    """

    devices: list[DeviceInfo]
    reason: str


def list_devices() -> DeviceList:
    """Returns the devices that CUDA lists.

    If there is no device, no driver or no cuda backend, the list is empty and has the reason; no error is raised.

    Returns
    -------
    DeviceList

    Notes
    -----
    Cost: the first call in a process starts the driver, which takes some tenths of a second.
    """
    devices, reason = _core.list_devices()
    return DeviceList([DeviceInfo(*device) for device in devices], reason)
