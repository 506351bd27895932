#include "engine/device/shared_device.h"

namespace lensproof::device {

void SharedDevice::refuse(const std::string& why) {
    const std::scoped_lock lock(mutex_);
    if (refused_.insert(why).second) {
        on_refusal_(why);
    }
}

void SharedDevice::fail(const std::string& why) {
    if (!has_failed_.exchange(true)) {
        on_failure_(why);
    }
}

}  // namespace lensproof::device
