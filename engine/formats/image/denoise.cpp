#include "engine/formats/image/denoise.h"

#include <fmt/format.h>

#include <stdexcept>

#ifdef LENSPROOF_OIDN
#include <OpenImageDenoise/oidn.h>

#include <memory>
#endif

namespace lensproof::formats {

#ifdef LENSPROOF_OIDN

namespace {

struct Release {
    void operator()(OIDNDevice device) const { oidnReleaseDevice(device); }
    void operator()(OIDNFilter filter) const { oidnReleaseFilter(filter); }
};
template <class Handle>
using Owned = std::unique_ptr<std::remove_pointer_t<Handle>, Release>;

void check(OIDNDevice device) {
    const char* message = nullptr;
    if (oidnGetDeviceError(device, &message) != OIDN_ERROR_NONE) {
        throw std::runtime_error(
            fmt::format("Open Image Denoise failed: {}", message != nullptr ? message : "it does not say why"));
    }
}

}  // namespace

std::optional<std::string> denoiser() {
    return fmt::format("Open Image Denoise {}.{}", OIDN_VERSION_MAJOR, OIDN_VERSION_MINOR);
}

Image denoised(const Image& rgb, std::vector<float> albedo, std::vector<float> normal, int threads) {
    Image input = rgb;
    Image output = make_image(rgb.width, rgb.height, rgb.channels);
    output.metadata = rgb.metadata;
    const Owned<OIDNDevice> device(oidnNewDevice(OIDN_DEVICE_TYPE_CPU));
    if (threads > 0) {
        oidnSetDeviceInt(device.get(), "numThreads", threads);
    }
    oidnCommitDevice(device.get());
    check(device.get());
    const Owned<OIDNFilter> filter(oidnNewFilter(device.get(), "RT"));
    const auto set = [&](const char* name, float* values) {
        oidnSetSharedFilterImage(filter.get(), name, values, OIDN_FORMAT_FLOAT3, static_cast<std::size_t>(rgb.width),
                                 static_cast<std::size_t>(rgb.height), 0, 0, 0);
    };
    set("color", input.pixels.data());
    if (!albedo.empty()) {
        set("albedo", albedo.data());
        if (!normal.empty()) {
            set("normal", normal.data());
        }
    }
    set("output", output.pixels.data());
    oidnSetFilterBool(filter.get(), "hdr", true);
    oidnCommitFilter(filter.get());
    oidnExecuteFilter(filter.get());
    check(device.get());
    return output;
}

#else

std::optional<std::string> denoiser() {
    return {};
}

Image denoised(const Image& /*rgb*/, std::vector<float> /*albedo*/, std::vector<float> /*normal*/, int /*threads*/) {
    throw std::logic_error("built without Open Image Denoise");
}

#endif

}  // namespace lensproof::formats
