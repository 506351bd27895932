// calibration/photographed/lensfun_entries.h — entries of lensfun's database as JSON, made into its own XML.
#pragma once
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace lensproof::calibration {

/// A database in XML for each of {"entries": [{"maker", "models": […], "mounts": […], "crop", "aspect", "type", "dist":
/// [{"model", "focal", …}], "tca", "vig"}]}, whose calibrations have the attributes of lensfun's elements. Throws
/// InputError naming `file` and key for what is missing. (In one database an entry would replace another of the same
/// model and crop factor.)
std::vector<std::string> lensfun_xml(std::string_view json, const std::filesystem::path& file);

}  // namespace lensproof::calibration
