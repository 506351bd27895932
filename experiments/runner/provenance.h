// experiments/runner/provenance.h — what a result was made from, so that it can be made again.
#pragma once
#include <filesystem>
#include <string>

namespace lensproof::runner {

/// The project's version, "0.1.0".
std::string program_version();

/// The libraries that the program was built against, with their versions: "OpenCV 4.6.0, Ceres 2.1.0, …".
std::string library_versions();

/// Lower-case hexadecimal SHA-256 of the file's bytes.
std::string sha256(const std::filesystem::path& file);

/// The commit that the source tree stands at, or "unknown" outside a git checkout.
std::string source_commit();

/// `file` relative to the source tree where it lies inside, else as given: reports hold no path of a machine's own.
std::string portable_path(const std::filesystem::path& file);

}  // namespace lensproof::runner
