// experiments/runner/provenance.h — what a result was made from, so that it can be made again.
#pragma once
#include <filesystem>
#include <string>

namespace lensproof::runner {

/// The project's version, "0.1.0".
std::string program_version();

/// The libraries that the program was built against, with their versions: "OpenCV 4.6.0, Ceres 2.1.0, …".
std::string library_versions();

/// What compiled the program: "GCC 12.2.0".
std::string compiler_version();

/// Lower-case hexadecimal SHA-256 of the file's bytes.
std::string sha256(const std::filesystem::path& file);

/// The commit that the source tree stands at, or that an installation was made from (the file `commit` among its data);
/// "unknown" where neither is there.
std::string source_commit();

/// `file` relative to the project's own data where it lies among them, else as given: reports hold no path of a
/// machine's own.
std::string portable_path(const std::filesystem::path& file);

}  // namespace lensproof::runner
