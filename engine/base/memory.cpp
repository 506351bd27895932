#include "engine/base/memory.h"

#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>

namespace lensproof {

double memory_bytes() {
    double bytes = static_cast<double>(::sysconf(_SC_PHYS_PAGES)) * static_cast<double>(::sysconf(_SC_PAGE_SIZE));
    ::rlimit limit{};
    if (::getrlimit(RLIMIT_AS, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY) {
        bytes = std::min(bytes, static_cast<double>(limit.rlim_cur));
    }
    double of_group = 0.0;
    if (std::ifstream("/sys/fs/cgroup/memory.max") >> of_group) {  // "max" is no number
        bytes = std::min(bytes, of_group);
    }
    return bytes;
}

}  // namespace lensproof
