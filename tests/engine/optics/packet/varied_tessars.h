// tests/engine/optics/packet/varied_tessars.h — lenses whose surfaces have more than a sphere and a rim.
#pragma once
#include <string>
#include <vector>

#include "engine/base/file.h"
#include "engine/base/write_file.h"
#include "engine/formats/prescription/load_lens.h"
#include "engine/formats/prescription/prescription_file.h"
#include "tests/test_folder.h"

namespace lensproof::optics {

/// A file with the Tessar and more in it.
inline Lens tessar_with(const std::string& more) {
    const TestFolder folder;
    const std::filesystem::path file = folder.path() / "tessar_with.toml";
    write_file(file, read_file(formats::find_lens_file("tessar")) + more);
    return formats::load_lens(file.string());
}

/// With blades, with turned and displaced groups, with coatings.
inline std::vector<Lens> varied_tessars() {
    return {tessar_with("[stop]\nblades = 6\nrotation_deg = 10\n"),
            tessar_with("[[groups]]\nsurfaces = [3, 6]\ntilt_deg = [1, -2, 0]\ndecentre_mm = [0.3, 0.2]\n"),
            formats::load_lens("tessar", {.coatings = {"broadband,1=v-coat"}})};
}

}  // namespace lensproof::optics
