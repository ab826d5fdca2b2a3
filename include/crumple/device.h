#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "crumple/export.h"

namespace crumple {

/// A device that the cuda backend can work on.
struct DeviceInfo {
    int number = 0;  ///< Options::device
    std::string name;
    int major = 0, minor = 0;       ///< compute capability
    std::int64_t memory_bytes = 0;  ///< of the device, in use or not
};

struct DeviceList {
    std::vector<DeviceInfo> devices;
    std::string reason;  ///< why there are none, in one line; empty if there are any
};

/// The devices that CUDA lists. Without a device, a driver or the backend the list is empty and says why: no Error is
/// thrown. The first call in a process starts the driver, which takes some tenths of a second.
CRUMPLE_API DeviceList list_devices();

}  // namespace crumple
