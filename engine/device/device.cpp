#include "engine/device/device.h"

#include <fmt/format.h>

#include <atomic>
#include <cstring>
#include <new>

#ifdef LENSPROOF_CUDA
#include <cuda_runtime_api.h>
#endif

namespace lensproof::device {

struct Device::State {
    std::string name;
    bool is_gpu = false;
    std::optional<int> fails_after;  // a stand-in's calls
    std::atomic<int> calls = 0;

    /// A stand-in's, each of which may be the one that fails.
    void count_call() {
        const int before = calls.fetch_add(1);
        if (fails_after && before >= *fails_after) {
            throw Error(fmt::format("{}: failed as it was asked to", name));
        }
    }
};

namespace {

#ifdef LENSPROOF_CUDA
void check(cudaError_t status, const char* what) {
    if (status != cudaSuccess) {
        throw Error(fmt::format("{}: {}", what, cudaGetErrorString(status)));
    }
}
#endif

}  // namespace

struct Device::Queue::Stream {
    explicit Stream(const std::shared_ptr<State>& device) : state(device) {
#ifdef LENSPROOF_CUDA
        if (state->is_gpu) {
            cudaStream_t made = nullptr;
            check(cudaStreamCreateWithFlags(&made, cudaStreamNonBlocking), "a GPU's queue");
            stream = made;
        }
#endif
    }
    Stream(const Stream&) = delete;
    Stream& operator=(const Stream&) = delete;
    ~Stream() {
#ifdef LENSPROOF_CUDA
        if (stream != nullptr) {
            cudaStreamDestroy(static_cast<cudaStream_t>(stream));
        }
#endif
    }

    std::shared_ptr<State> state;
    void* stream = nullptr;
};

Device::Found Device::find() {
#ifdef LENSPROOF_CUDA
    int count = 0;
    if (const cudaError_t status = cudaGetDeviceCount(&count); status != cudaSuccess || count == 0) {
        return {.device = {}, .why_not = status != cudaSuccess ? cudaGetErrorString(status) : "no device is there"};
    }
    cudaDeviceProp properties{};
    if (const cudaError_t status = cudaGetDeviceProperties(&properties, 0); status != cudaSuccess) {
        return {.device = {}, .why_not = cudaGetErrorString(status)};
    }
    // Who waits leaves its core to others. Fails where the context is there already, which does no harm.
    (void)cudaSetDeviceFlags(cudaDeviceScheduleBlockingSync);
    if (const cudaError_t status = cudaFree(nullptr); status != cudaSuccess) {  // makes the context
        return {.device = {}, .why_not = fmt::format("{}: {}", properties.name, cudaGetErrorString(status))};
    }
    // Paths ahead take 6 MB a thread, two pieces of 32768 paths of some 90 bytes: room for forty threads.
    constexpr std::size_t kLeastMiB = 256;
    std::size_t free = 0;
    std::size_t total = 0;
    if (cudaMemGetInfo(&free, &total) == cudaSuccess && free >> 20U < kLeastMiB) {
        return {.device = {},
                .why_not = fmt::format("{}: {} MiB of its memory are free, expected {}", properties.name, free >> 20U,
                                       kLeastMiB)};
    }
    const auto state = std::make_shared<State>();
    state->name = properties.name;
    state->is_gpu = true;
    return {.device = Device(state), .why_not = {}};
#else
    return {.device = {}, .why_not = "this build has no CUDA (LENSPROOF_CUDA)"};
#endif
}

Device Device::stand_in(std::optional<int> fails_after) {
    const auto state = std::make_shared<State>();
    state->name = "stand-in";
    state->fails_after = fails_after;
    return Device(state);
}

const std::string& Device::name() const {
    return state_->name;
}

bool Device::is_gpu() const {
    return state_->is_gpu;
}

Device::Queue::Queue(const Device& device) : stream_(std::make_shared<Stream>(device.state_)) {}

void* Device::Queue::stream_or_none() {
    if (stream_->stream == nullptr) {
        stream_->state->count_call();
    }
    return stream_->stream;
}

void Device::Queue::upload(void* to, const void* from, std::size_t bytes) {
#ifdef LENSPROOF_CUDA
    if (void* stream = stream_or_none()) {
        check(cudaMemcpyAsync(to, from, bytes, cudaMemcpyHostToDevice, static_cast<cudaStream_t>(stream)), "to a GPU");
        return;
    }
#else
    (void)stream_or_none();
#endif
    std::memcpy(to, from, bytes);
}

void Device::Queue::download(void* to, const void* from, std::size_t bytes) {
#ifdef LENSPROOF_CUDA
    if (void* stream = stream_or_none()) {
        check(cudaMemcpyAsync(to, from, bytes, cudaMemcpyDeviceToHost, static_cast<cudaStream_t>(stream)),
              "from a GPU");
        return;
    }
#else
    (void)stream_or_none();
#endif
    std::memcpy(to, from, bytes);
}

void Device::Queue::wait() {
#ifdef LENSPROOF_CUDA
    if (void* stream = stream_or_none()) {
        check(cudaStreamSynchronize(static_cast<cudaStream_t>(stream)), "a GPU's work");
        return;
    }
#else
    (void)stream_or_none();
#endif
}

Memory::Memory(const Device& device, Place place, std::size_t bytes) {
#ifdef LENSPROOF_CUDA
    if (device.is_gpu()) {
        void* made = nullptr;
        if (place == Place::device) {
            check(cudaMalloc(&made, bytes), "a GPU's memory");
            memory_ = {made, [](void* memory) { cudaFree(memory); }};
        } else {
            check(cudaMallocHost(&made, bytes), "memory for a GPU");
            memory_ = {made, [](void* memory) { cudaFreeHost(memory); }};
        }
        return;
    }
#else
    (void)place;
#endif
    device.state_->count_call();
    constexpr std::align_val_t kLine{256};  // as a GPU's
    memory_ = {::operator new(bytes, kLine), [](void* memory) { ::operator delete(memory, kLine); }};
}

}  // namespace lensproof::device
