// tests/engine/every_device.h — what a device's job is tried on.
#pragma once
#include <vector>

#include "engine/device/device.h"

namespace lensproof {

/// The stand-in, and this machine's GPU where it has one.
inline std::vector<device::Device> every_device() {
    std::vector<device::Device> devices = {device::Device::stand_in()};
    if (const device::Device::Found found = device::Device::find(); found.device) {
        devices.push_back(*found.device);
    }
    return devices;
}

}  // namespace lensproof
