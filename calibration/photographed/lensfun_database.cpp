#include "calibration/photographed/lensfun_database.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <glib.h>
#include <lensfun/lensfun.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <string_view>
#include <vector>

#include "calibration/photographed/lensfun_entries.h"
#include "engine/base/file.h"
#include "engine/base/input_error.h"
#include "engine/base/nearest_name.h"
#include "engine/base/text.h"

namespace lensproof::calibration {

namespace {

constexpr double kSameCrop = 0.005;  // databases write 1.53, 1.534 and 1.5 of one format, and mean different ones
constexpr std::size_t kNamesOffered = 4;

/// Every language's text: they stand one behind the other, each but the first after its language, up to an empty one.
std::vector<std::string> texts_of(const char* multi) {
    std::vector<std::string> texts;
    if (multi == nullptr) {
        return texts;
    }
    texts.emplace_back(multi);
    const char* at = multi + texts.back().size() + 1;
    while (*at != '\0') {
        const std::string language(at);
        at += language.size() + 1;
        texts.emplace_back(at);
        at += texts.back().size() + 1;
    }
    return texts;
}

std::string lens_name(const lfLens& lens) {
    return lens.Model == nullptr ? std::string() : std::string(lens.Model);
}

std::string maker_of(const lfLens& lens) {
    return lens.Maker == nullptr ? std::string() : std::string(lens.Maker);
}

template <class Calibration>
std::vector<const Calibration*> list_of(const Calibration* const* list) {
    std::vector<const Calibration*> all;
    for (; list != nullptr && *list != nullptr; ++list) {
        all.push_back(*list);
    }
    return all;
}

std::optional<optics::Projection> projection_of(lfLensType type) {
    switch (type) {
        case LF_UNKNOWN:
        case LF_RECTILINEAR:
            return optics::Projection::rectilinear;
        case LF_FISHEYE:
            return optics::Projection::equidistant;
        case LF_FISHEYE_EQUISOLID:
            return optics::Projection::equisolid;
        case LF_FISHEYE_STEREOGRAPHIC:
            return optics::Projection::stereographic;
        case LF_FISHEYE_ORTHOGRAPHIC:
            return optics::Projection::orthographic;
        case LF_PANORAMIC:
        case LF_EQUIRECTANGULAR:
        case LF_FISHEYE_THOBY:
            break;
    }
    return std::nullopt;
}

/// The focal length of those calibrated that stands for `focal_length_mm`: itself where it lies between them, else the
/// nearest.
template <class Calibration>
double calibrated_focal(const std::vector<const Calibration*>& calibrations, double focal_length_mm) {
    double least = INFINITY;
    double largest = 0.0;
    for (const Calibration* calibration : calibrations) {
        least = std::min<double>(least, calibration->Focal);
        largest = std::max<double>(largest, calibration->Focal);
    }
    return std::clamp(focal_length_mm, least, largest);
}

void take_distortion(const lfLens& entry, double focal_length_mm, PhotographedLens& lens) {
    const auto calibrations = list_of(entry.CalibDistortion);
    if (calibrations.empty()) {
        return;
    }
    lens.focal_length_mm = calibrated_focal(calibrations, focal_length_mm);
    lfLensCalibDistortion found{};
    if (!entry.InterpolateDistortion(static_cast<float>(lens.focal_length_mm), found)) {
        return;
    }
    const double t0 = found.Terms[0];
    const double t1 = found.Terms[1];
    const double t2 = found.Terms[2];
    switch (found.Model) {
        case LF_DIST_MODEL_POLY3:
            lens.distortion_model = "poly3";
            lens.distortion = {1.0 - t0, 0.0, t0};
            break;
        case LF_DIST_MODEL_POLY5:
            lens.distortion_model = "poly5";
            lens.distortion = {1.0, 0.0, t0, 0.0, t1};
            break;
        case LF_DIST_MODEL_PTLENS:
            lens.distortion_model = "ptlens";
            lens.distortion = {1.0 - t0 - t1 - t2, t2, t1, t0};
            break;
        case LF_DIST_MODEL_NONE:
            break;
    }
}

void take_lateral_colour(const lfLens& entry, double focal_length_mm, PhotographedLens& lens) {
    const auto calibrations = list_of(entry.CalibTCA);
    lfLensCalibTCA found{};
    if (calibrations.empty() ||
        !entry.InterpolateTCA(static_cast<float>(calibrated_focal(calibrations, focal_length_mm)), found)) {
        return;
    }
    if (found.Model == LF_TCA_MODEL_LINEAR) {
        lens.lateral_colour =
            LateralColour{.red = ChannelScale{.v = found.Terms[0]}, .blue = ChannelScale{.v = found.Terms[1]}};
    } else if (found.Model == LF_TCA_MODEL_POLY3) {
        lens.lateral_colour =
            LateralColour{.red = ChannelScale{.v = found.Terms[0], .c = found.Terms[2], .b = found.Terms[4]},
                          .blue = ChannelScale{.v = found.Terms[1], .c = found.Terms[3], .b = found.Terms[5]}};
    }
}

void take_vignetting(const lfLens& entry, double focal_length_mm, PhotographedLens& lens) {
    const auto calibrations = list_of(entry.CalibVignetting);
    if (calibrations.empty()) {
        return;
    }
    const double focal = calibrated_focal(calibrations, focal_length_mm);
    std::set<std::pair<float, float>> settings;  // aperture, distance
    for (const lfLensCalibVignetting* calibration : calibrations) {
        settings.emplace(calibration->Aperture, calibration->Distance);
    }
    for (const auto& [aperture, distance] : settings) {
        lfLensCalibVignetting found{};
        if (!entry.InterpolateVignetting(static_cast<float>(focal), aperture, distance, found) ||
            found.Model != LF_VIGNETTING_MODEL_PA) {
            continue;
        }
        const MeasuredVignetting measured{
            .f_number = aperture, .distance_m = distance, .k = {found.Terms[0], found.Terms[1], found.Terms[2]}};
        if (!lens.vignetting.empty() && lens.vignetting.back().f_number == measured.f_number) {
            lens.vignetting.back() = measured;  // farther than the one before
        } else {
            lens.vignetting.push_back(measured);
        }
    }
}

PhotographedLens lens_of(const lfLens& entry, double focal_length_mm) {
    PhotographedLens lens{.maker = maker_of(entry), .model = lens_name(entry)};
    lens.crop_factor = entry.CropFactor;
    lens.aspect_ratio = entry.AspectRatio > 0.0F ? entry.AspectRatio : 1.5F;
    const auto projection = projection_of(entry.Type);
    if (!projection) {
        throw InputError(
            fmt::format("lensfun's \"{}\" is of the type {}, which no lens is compared with: expected "
                        "rectilinear or a fisheye that is equidistant, equisolid, stereographic or "
                        "orthographic",
                        lens.model, lfLens::GetLensTypeDesc(entry.Type, nullptr)));
    }
    lens.projection = *projection;
    take_distortion(entry, focal_length_mm, lens);
    take_lateral_colour(entry, focal_length_mm, lens);
    take_vignetting(entry, focal_length_mm, lens);
    return lens;
}

/// "Canon: Canon FDn 50mm 1:1.4, crop factor 2, rectilinear".
std::string described(const lfLens& entry) {
    const auto projection = projection_of(entry.Type);
    return fmt::format("\"{}\" of {}, crop factor {:.4g}, {}", lens_name(entry), maker_of(entry), entry.CropFactor,
                       projection ? optics::projection_name(*projection) : "of another projection");
}

/// The model in every language, with and without the maker before it.
std::vector<std::string> names_of_entry(const lfLens& entry) {
    std::vector<std::string> names = texts_of(entry.Model);
    const std::size_t plain = names.size();
    for (const std::string& maker : texts_of(entry.Maker)) {
        for (std::size_t i = 0; i < plain; ++i) {
            names.push_back(maker + " " + names[i]);
        }
    }
    return names;
}

std::vector<const lfLens*> entries_named(const std::vector<const lfLens*>& all, const std::string& model) {
    std::vector<const lfLens*> exact;
    std::vector<const lfLens*> alike;
    const std::string wanted = lower_case(trimmed(model));
    for (const lfLens* entry : all) {
        const std::vector<std::string> names = names_of_entry(*entry);
        if (std::ranges::find(names, model) != names.end()) {
            exact.push_back(entry);
        } else if (std::ranges::any_of(names, [&](const std::string& name) { return lower_case(name) == wanted; })) {
            alike.push_back(entry);
        }
    }
    return exact.empty() ? alike : exact;
}

/// The names most like `model`: those that hold it first, then by spelling.
std::vector<std::string> nearest_names(const std::vector<const lfLens*>& all, const std::string& model) {
    const std::string wanted = lower_case(trimmed(model));
    std::set<std::tuple<bool, int, std::string>> ranked;
    for (const lfLens* entry : all) {
        const std::string name = lens_name(*entry);
        const std::string small = lower_case(name);
        const bool holds = !wanted.empty() && small.find(wanted) != std::string::npos;
        ranked.emplace(!holds, spelling_distance(wanted, small), name);
    }
    std::vector<std::string> names;
    for (const auto& [lacks, distance, name] : ranked) {
        if (names.size() == kNamesOffered) {
            break;
        }
        names.push_back('"' + name + '"');
    }
    return names;
}

bool is_same_calibration(const PhotographedLens& a, const PhotographedLens& b) {
    return a.crop_factor == b.crop_factor && a.projection == b.projection && a.distortion == b.distortion &&
           a.aspect_ratio == b.aspect_ratio && a.lateral_colour.has_value() == b.lateral_colour.has_value() &&
           a.vignetting.size() == b.vignetting.size();
}

[[noreturn]] void refuse_several(const std::string& database, const std::string& model,
                                 const std::vector<const lfLens*>& found) {
    std::vector<std::string> lines;
    std::ranges::transform(found, std::back_inserter(lines), [](const lfLens* entry) { return described(*entry); });
    const bool crops_differ = std::ranges::any_of(found, [&](const lfLens* entry) {
        return std::abs(entry->CropFactor / found.front()->CropFactor - 1.0F) > kSameCrop;
    });
    throw InputError(
        fmt::format("{} has {} entries of \"{}\": {}; {}", database, found.size(), model, fmt::join(lines, "; "),
                    crops_differ ? "expected --crop-factor to say which"
                                 : "expected a name that only one has, as with the maker before the model"));
}

/// Files of a folder that can hold entries, sorted.
std::vector<std::filesystem::path> database_files(const std::filesystem::path& data) {
    if (!is_folder(data)) {
        return {data};
    }
    std::vector<std::filesystem::path> files;
    for (const auto& item : std::filesystem::directory_iterator(data)) {
        const std::string extension = lower_extension(item.path());
        if (extension == ".xml" || extension == ".json") {
            files.push_back(item.path());
        }
    }
    std::ranges::sort(files);
    if (files.empty()) {
        throw InputError(fmt::format("{}: holds no file of lensfun's database, expected .xml", data.string()));
    }
    return files;
}

/// What the library would write to standard error is kept for messages, while one of these lives.
class QuietLibrary {
  public:
    QuietLibrary() : before_(g_log_set_default_handler(keep, nullptr)) { said().clear(); }
    ~QuietLibrary() { g_log_set_default_handler(before_, nullptr); }
    QuietLibrary(const QuietLibrary&) = delete;
    QuietLibrary& operator=(const QuietLibrary&) = delete;

    static std::string& said() {
        static thread_local std::string text;
        return text;
    }

  private:
    static void keep(const char* /*domain*/, GLogLevelFlags /*level*/, const char* message, void* /*data*/) {
        said() = message;
    }
    GLogFunc before_;
};

/// Throws InputError where the library refuses `text`, or would take it for whole though its end is missing.
void load(lfDatabase& library, const std::string& text, const std::filesystem::path& file) {
    if (library.Load(file.c_str(), text.c_str(), text.size()) != LF_NO_ERROR) {
        throw InputError(
            fmt::format("{}: lensfun {}.{}.{} cannot read it, expected its XML of version {} or before{}{}",
                        file.string(), LF_VERSION_MAJOR, LF_VERSION_MINOR, LF_VERSION_MICRO, LF_MAX_DATABASE_VERSION,
                        QuietLibrary::said().empty() ? "" : "; it says: ", trimmed(QuietLibrary::said())));
    }
    if (!trimmed(text).ends_with("</lensdatabase>")) {
        throw InputError(
            fmt::format("{}: ends before </lensdatabase>, expected a whole file of lensfun's database", file.string()));
    }
}

}  // namespace

LensfunDatabase LensfunDatabase::of_system() {
    const QuietLibrary quiet;
    auto library = std::make_shared<lfDatabase>();
    if (library->Load() != LF_NO_ERROR) {
        throw InputError(
            "lensfun finds no database on this system: expected Debian's package liblensfun-data-v1, or "
            "--lensfun-data");
    }
    return {{std::move(library)}, "lensfun's database"};
}

LensfunDatabase LensfunDatabase::read(const std::filesystem::path& data) {
    const QuietLibrary quiet;
    auto of_xml = std::make_shared<lfDatabase>();
    std::vector<std::shared_ptr<const lfDatabase>> parts{of_xml};
    for (const std::filesystem::path& file : database_files(data)) {
        const std::string text = read_file(file);
        if (lower_extension(file) != ".json") {
            load(*of_xml, text, file);
            continue;
        }
        for (const std::string& xml : lensfun_xml(text, file)) {
            auto of_entry = std::make_shared<lfDatabase>();
            load(*of_entry, xml, file);
            parts.push_back(std::move(of_entry));
        }
    }
    return {std::move(parts), data.string()};
}

PhotographedLens LensfunDatabase::find(const LensfunQuery& query) const {
    std::vector<const lfLens*> all;
    for (const auto& part : parts_) {
        std::ranges::copy(list_of(part->GetLenses()), std::back_inserter(all));
    }
    if (all.empty()) {
        throw InputError(fmt::format("{}: holds no lens", name_));
    }
    std::vector<const lfLens*> found = entries_named(all, query.model);
    if (found.empty()) {
        throw InputError(fmt::format("{} has no lens \"{}\"; the nearest names are {}", name_, query.model,
                                     fmt::join(nearest_names(all, query.model), ", ")));
    }
    const std::vector<const lfLens*> named = found;
    std::erase_if(found, [&](const lfLens* entry) {
        return (query.crop_factor && std::abs(entry->CropFactor / *query.crop_factor - 1.0) > kSameCrop) ||
               (query.projection && projection_of(entry->Type) != query.projection);
    });
    if (found.empty()) {
        std::vector<std::string> lines;
        std::ranges::transform(named, std::back_inserter(lines), [](const lfLens* entry) { return described(*entry); });
        throw InputError(
            fmt::format("{} has no \"{}\"{}{}; it has {}", name_, query.model,
                        query.crop_factor ? fmt::format(" of crop factor {:g}", *query.crop_factor) : "",
                        query.projection ? fmt::format(" as {}", optics::projection_name(*query.projection)) : "",
                        fmt::join(lines, "; ")));
    }
    if (query.sensor_crop_factor) {
        const auto fit = [&](const lfLens* entry) {
            const double crop = entry->CropFactor;
            return crop < *query.sensor_crop_factor * (1.0 + kSameCrop) ? crop
                                                                        : -crop;  // sensors that are too small last
        };
        const double best = fit(*std::ranges::max_element(found, {}, fit));
        std::erase_if(found, [&](const lfLens* entry) { return std::abs(fit(entry) / best - 1.0) > kSameCrop; });
    }
    PhotographedLens lens = lens_of(*found.front(), query.focal_length_mm);
    for (const lfLens* other : found) {
        if (!is_same_calibration(lens_of(*other, query.focal_length_mm), lens)) {
            refuse_several(name_, query.model, found);
        }
    }
    return lens;
}

}  // namespace lensproof::calibration
