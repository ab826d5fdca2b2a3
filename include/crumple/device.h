#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "crumple/export.h"

namespace crumple {

/// Device that the cuda backend can use.
struct DeviceInfo {
    int number = 0;  ///< number of the device for Options::device
    std::string name;
    int major = 0, minor = 0;       ///< compute capability
    std::int64_t memory_bytes = 0;  ///< total memory of the device
};

/// Result of list_devices().
struct DeviceList {
    std::vector<DeviceInfo> devices;
    std::string reason;  ///< reason in one line why there are none; empty if there are any
};

/// Returns the devices that CUDA lists. Throws no Error: without a device, a driver or the backend, the list is empty
/// and has the reason. The first call in a process starts the driver, which takes some tenths of a second.
CRUMPLE_API DeviceList list_devices();

}  // namespace crumple
