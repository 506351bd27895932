// engine/device/device.h — where loops over many independent items run: a GPU, or this machine's processors in its
// place.
//
// A loop's body is a job: a plain struct of numbers and pointers into a device's memory, with a constexpr
//
//     void operator()(int item) const
//
// Marked so, one text serves both: nvcc compiles it for the GPU (--expt-relaxed-constexpr), g++ for the stand-in, on
// which tests run what a GPU would run. A job's .cu file instantiates LENSPROOF_DEVICE_JOB (launch.cuh).
#pragma once
#include <cstddef>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>

namespace lensproof::device {

/// A call to the device that failed, or memory that it has not.
class Error : public std::runtime_error {
    using std::runtime_error::runtime_error;
};

/// Starts a job for `count` items on a GPU's stream. One definition a job, in its .cu file.
template <class Job>
void launch_on_gpu(const Job& job, int count, void* stream);

/// A device, or a copy of what refers to it.
class Device {
  public:
    /// The first GPU, or why there is none that this process can use.
    struct Found;
    static Found find();

    /// Whoever calls it, with memory of its own: for tests, and to try what a GPU would do. After `fails_after` calls
    /// each ends with Error; nothing: none does.
    static Device stand_in(std::optional<int> fails_after = std::nullopt);

    [[nodiscard]] const std::string& name() const;
    [[nodiscard]] bool is_gpu() const;

    /// Work that is done in its order; queues go side by side. For one thread at a time.
    class Queue {
      public:
        explicit Queue(const Device& device);

        /// `bytes` from this machine's memory to the device's, and back. Memory that is not pinned holds the caller
        /// up.
        void upload(void* to, const void* from, std::size_t bytes);
        void download(void* to, const void* from, std::size_t bytes);

        template <class Job>
        void run(const Job& job, int count) {
            static_assert(std::is_trivially_copyable_v<Job>);
            if (void* stream = stream_or_none()) {
                start_on_gpu(job, count, stream);
            } else {
                for (int item = 0; item < count; ++item) {
                    job(item);
                }
            }
        }

        /// Until all that was asked for is done. Throws Error where any of it failed.
        void wait();

      private:
        template <class Job>
        static void start_on_gpu([[maybe_unused]] const Job& job, [[maybe_unused]] int count,
                                 [[maybe_unused]] void* stream) {
#ifdef LENSPROOF_CUDA
            launch_on_gpu(job, count, stream);
#else
            throw std::logic_error("this build has no GPU");
#endif
        }
        /// The GPU's; none: a stand-in. Counts as a call.
        [[nodiscard]] void* stream_or_none();

        struct Stream;
        std::shared_ptr<Stream> stream_;
    };

  private:
    friend class Memory;
    struct State;
    explicit Device(std::shared_ptr<State> state) : state_(std::move(state)) {}

    std::shared_ptr<State> state_;
};

struct Device::Found {
    std::optional<Device> device;
    std::string why_not;  // "this build has no CUDA", "no CUDA-capable device is detected", too little memory
};

/// Bytes on a device, or of this machine that the device reaches at its full speed. Throws Error where there are
/// not so many.
class Memory {
  public:
    enum class Place { device, pinned };
    Memory(const Device& device, Place place, std::size_t bytes);

    [[nodiscard]] void* get() const { return memory_.get(); }

  private:
    std::shared_ptr<void> memory_;
};

}  // namespace lensproof::device
