#include "engine/base/data_root.h"

#include <dlfcn.h>
#include <fmt/format.h>
#include <link.h>

#include <cstdlib>
#include <stdexcept>
#include <vector>

namespace lensproof {

namespace fs = std::filesystem;

namespace {

/// The file that this code was loaded from.
fs::path file_of_this_code() {
    Dl_info symbol{};
    void* map = nullptr;
    const auto* here = reinterpret_cast<const void*>(&file_of_this_code);
    const bool found = ::dladdr1(here, &symbol, &map, RTLD_DL_LINKMAP) != 0 && map != nullptr;
    const char* name = found ? static_cast<const link_map*>(map)->l_name : nullptr;
    return fs::canonical(name != nullptr && *name != '\0' ? name : "/proc/self/exe");  // the program itself has no name
}

fs::path installed_data() {
    const fs::path code = file_of_this_code();
    std::vector<fs::path> folders;
    for (fs::path folder = code; folder != folder.parent_path();) {
        folder = folder.parent_path();
        folders.push_back(folder);
    }
    folders.insert(folders.end(), {"/usr/local", "/usr"});  // for other programs that the engine is part of
    for (const fs::path& folder : folders) {
        const fs::path data = folder / "share" / "lensproof";
        if (fs::is_directory(data / "lenses")) {
            return fs::canonical(data);
        }
    }
    throw std::runtime_error(
        fmt::format("{}: no folder above it has share/lensproof, the data that ship with it; LENSPROOF_HOME may name "
                    "them",
                    code.string()));
}

}  // namespace

fs::path data_root() {
    const char* home = std::getenv("LENSPROOF_HOME");
    if (home != nullptr && *home != '\0') {
        return home;
    }
    static const fs::path kInstalled = installed_data();
    return kInstalled;
}

}  // namespace lensproof
