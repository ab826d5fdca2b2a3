"""The devices that the cuda backend can work on."""

from __future__ import annotations

from typing import NamedTuple

from . import _core


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
