// Entries of lensfun's database, written by hand.
#pragma once
#include <fstream>
#include <string>

#include "tests/test_folder.h"

namespace lensproof::calibration::synthetic {

/// A lens element: `rest` is what stands between mount and calibration (cropfactor is needed), `calibration` in it.
inline std::string lens_entry(const std::string& model, const std::string& rest, const std::string& calibration) {
    return "<lens><maker>Maker</maker><model>" + model + "</model><mount>Generic</mount>" + rest + "<calibration>" +
           calibration + "</calibration></lens>\n";
}

inline std::string database_of(const std::string& entries) {
    return "<!DOCTYPE lensdatabase SYSTEM \"lensfun-database.dtd\">\n<lensdatabase version=\"1\">\n" + entries +
           "</lensdatabase>\n";
}

inline std::filesystem::path written(const TestFolder& folder, const std::string& name, const std::string& text) {
    std::filesystem::path file = folder.path() / name;
    std::ofstream(file) << text;
    return file;
}

}  // namespace lensproof::calibration::synthetic
