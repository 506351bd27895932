#include "experiments/cli/device_option.h"

#include <fmt/format.h>

#include <optional>

#include "engine/base/input_error.h"
#include "experiments/cli/terminal.h"

namespace lensproof::cli {

namespace {

std::optional<device::Device> device_of(const std::string& wish) {
    if (wish == "cpu") {
        return std::nullopt;
    }
    if (wish == "stand-in") {
        return device::Device::stand_in();
    }
    device::Device::Found found = device::Device::find();
    if (!found.device && wish == "cuda") {
        throw InputError(fmt::format("--device is \"cuda\", but {}", found.why_not));
    }
    if (!found.device) {
        print_message("lensproof: no GPU, so the processors do it: {}\n", found.why_not);
    }
    return found.device;
}

}  // namespace

void add_device_option(Command& command, std::string& wish) {
    command
        .add_option("--device", wish,
                    "Who traces: the processors; cuda, an NVIDIA GPU; auto, a GPU where there is one; stand-in, what a "
                    "GPU would run, on the processors, to try it. Results are the same")
        .check(one_of({"cpu", "cuda", "auto", "stand-in"}))
        .shows_default();
}

std::shared_ptr<device::SharedDevice> shared_device(const std::string& wish, OnRefusal on_refusal) {
    const std::optional<device::Device> device = device_of(wish);
    if (!device) {
        return nullptr;
    }
    const bool ends = wish == "cuda" && on_refusal == OnRefusal::end;
    return std::make_shared<device::SharedDevice>(
        *device,
        [ends](const std::string& why) {
            if (ends) {
                throw InputError(fmt::format("--device is \"cuda\", but {}", why));
            }
            print_message("lensproof: not on the device: {}\n", why);
        },
        [](const std::string& why) {
            print_message("lensproof: the device failed, and the processors go on in its place: {}\n", why);
        });
}

}  // namespace lensproof::cli
