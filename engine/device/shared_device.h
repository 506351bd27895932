// engine/device/shared_device.h — a device that much of a command may use, and who hears where it cannot.
#pragma once
#include <atomic>
#include <functional>
#include <mutex>
#include <set>
#include <string>
#include <utility>

#include "engine/device/device.h"

namespace lensproof::device {

/// Whoever is given one asks it for what it can do, does the rest on the processors, and does there, too, what it
/// failed at: results are the same. For any number of threads.
class SharedDevice {
  public:
    using Hear = std::function<void(const std::string& why)>;

    /// `on_refusal` hears once of each thing that a device cannot do or has no memory for, before that is begun, and
    /// may throw where it has to; `on_failure` of the first call that fails in the midst of it.
    SharedDevice(Device device, Hear on_refusal, Hear on_failure)
        : device_(std::move(device)), on_refusal_(std::move(on_refusal)), on_failure_(std::move(on_failure)) {}

    [[nodiscard]] const Device& device() const { return device_; }
    /// Then it is not to be asked any more.
    [[nodiscard]] bool has_failed() const { return has_failed_; }

    void refuse(const std::string& why);
    void fail(const std::string& why);

  private:
    Device device_;
    Hear on_refusal_;
    Hear on_failure_;
    std::atomic<bool> has_failed_ = false;
    std::mutex mutex_;
    std::set<std::string> refused_;
};

}  // namespace lensproof::device
