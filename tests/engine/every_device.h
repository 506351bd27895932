// tests/engine/every_device.h — what a device's job is tried on.
#pragma once
#include <vector>

#include "engine/device/device.h"

namespace lensproof {

/// The stand-in, and this machine's GPU where it has one.
inline std::vector<Device> every_device() {
    std::vector<Device> devices = {Device::stand_in()};
    if (const Device::Found found = Device::find(); found.device) {
        devices.push_back(*found.device);
    }
    return devices;
}

}  // namespace lensproof
