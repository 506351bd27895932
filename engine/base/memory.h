// engine/base/memory.h — how much memory there is to plan with.
#pragma once

namespace lensproof {

/// Bytes that this process may come to use: the machine's memory, or less where the process or its control group
/// (a container, say) is given less. What others use at the moment is not taken off.
double memory_bytes();

}  // namespace lensproof
