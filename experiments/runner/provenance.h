// experiments/runner/provenance.h — what a result was made from, so that it can be made again.
#pragma once
#include <filesystem>
#include <string>

namespace lensproof::runner {

/// Lower-case hexadecimal SHA-256 of the file's bytes.
std::string sha256(const std::filesystem::path& file);

/// The commit that the source tree stands at, or "unknown" outside a git checkout.
std::string source_commit();

/// `file` relative to the source tree where it lies inside, else as given: reports hold no path of a machine's own.
std::string portable_path(const std::filesystem::path& file);

}  // namespace lensproof::runner
