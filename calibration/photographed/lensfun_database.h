// calibration/photographed/lensfun_database.h — lensfun's database of lenses that were calibrated from photographs.
#pragma once
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "calibration/photographed/photographed_lens.h"

struct lfDatabase;

namespace lensproof::calibration {

/// Which entry of a database is meant.
struct LensfunQuery {
    std::string model;                    // in any of the entry's languages, with or without the maker before
    std::optional<double> crop_factor{};  // needed where a model was calibrated on several sensors
    /// In its place: of several the one that was calibrated on the smallest sensor that holds one of this crop factor,
    /// else on the largest of all.
    std::optional<double> sensor_crop_factor{};
    std::optional<optics::Projection> projection{};  // needed where it was calibrated as several
    double focal_length_mm = 0.0;                    // for a zoom: lensfun interpolates its calibrations
};

/// A database as the library lensfun reads it.
class LensfunDatabase {
  public:
    /// The system's: a user's newer copy, or what Debian's liblensfun-data-v1 installs. Throws InputError where there
    /// is none.
    static LensfunDatabase of_system();

    /// A file or all files of a folder: lensfun's own XML, or its entries as JSON (an object with "entries", each with
    /// maker, models, mounts, crop, aspect, type, dist, tca, vig). Throws InputError naming the file that the library
    /// refuses.
    static LensfunDatabase read(const std::filesystem::path& data);

    /// The entry whose model is `query.model`: exactly, else but for capital letters. Throws InputError where there is
    /// none (naming the nearest), several (listing them), and for a projection that no lens has.
    [[nodiscard]] PhotographedLens find(const LensfunQuery& query) const;

  private:
    LensfunDatabase(std::vector<std::shared_ptr<const lfDatabase>> parts, std::string name)
        : parts_(std::move(parts)), name_(std::move(name)) {}

    std::vector<std::shared_ptr<const lfDatabase>> parts_;
    std::string name_;  // for messages
};

}  // namespace lensproof::calibration
