// engine/device/launch.cuh — a job's loop on a GPU. Included by the jobs' .cu files alone.
#pragma once
#include <string>

#include "engine/device/device.h"

namespace lensproof::device {

namespace launch_detail {

template <class Job>
__global__ void __launch_bounds__(Job::kThreadsPerBlock) run_items(const __grid_constant__ Job job, int count) {
    const int item = static_cast<int>(blockIdx.x * Job::kThreadsPerBlock + threadIdx.x);
    if (item < count) {
        job(item);
    }
}

}  // namespace launch_detail

template <class Job>
void launch_on_gpu(const Job& job, int count, void* stream) {
    if (count == 0) {
        return;
    }
    const int blocks = (count + Job::kThreadsPerBlock - 1) / Job::kThreadsPerBlock;
    launch_detail::run_items<Job><<<blocks, Job::kThreadsPerBlock, 0, static_cast<cudaStream_t>(stream)>>>(job, count);
    if (const cudaError_t status = cudaGetLastError(); status != cudaSuccess) {
        throw Error(std::string("a GPU's loop: ") + cudaGetErrorString(status));
    }
}

}  // namespace lensproof::device

/// Compiles the loop of one job.
#define LENSPROOF_DEVICE_JOB(...) template void lensproof::device::launch_on_gpu(const __VA_ARGS__&, int, void*)
