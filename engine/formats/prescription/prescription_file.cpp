#include "engine/formats/prescription/prescription_file.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "engine/base/data_root.h"
#include "engine/base/file.h"
#include "engine/base/input_error.h"
#include "engine/base/nearest_name.h"
#include "engine/base/write_file.h"
#include "engine/formats/prescription/prescription_forms.h"

namespace lensproof::formats {

namespace {

/// A form of prescriptions, by the extension of its files.
struct Form {
    std::string_view extension;
    optics::Prescription (*parse)(const std::string&, const std::filesystem::path&);
    WrittenPrescription (*write)(const optics::Prescription&);  // null: read only
};

constexpr Form kForms[] = {
    {".toml", parse_toml_prescription, to_toml},
    {".csv", parse_csv_prescription, to_csv},
    {".zmx", parse_zmx, to_zmx},
    {".zar", parse_zar, nullptr},
    {".seq", parse_seq, nullptr},
    {".dat", parse_pbrt_lens, to_pbrt_lens},
    {".json", parse_optiland, nullptr},
    {".roa", parse_rayoptics, nullptr},
    {".fx", parse_fx, nullptr},
};

/// The form of that extension, letter case aside, or the end.
const Form* form_of(const std::filesystem::path& file) {
    return std::ranges::find(kForms, lower_extension(file), &Form::extension);
}

const Form& find_form(const std::filesystem::path& file) {
    const Form* form = form_of(file);
    if (form == std::end(kForms)) {
        std::vector<std::string_view> known;
        std::ranges::transform(kForms, std::back_inserter(known), &Form::extension);
        throw InputError(fmt::format("{}: a prescription of an unknown kind, expected one of {}", file.string(),
                                     fmt::join(known, ", ")));
    }
    return *form;
}

}  // namespace

optics::Prescription read_prescription(const std::filesystem::path& file) {
    return find_form(file).parse(read_file(file), file);
}

void check_prescription_name(const std::filesystem::path& file) {
    const Form* form = form_of(file);
    if (form == std::end(kForms) || form->write == nullptr) {
        std::vector<std::string_view> known;
        for (const Form& each : kForms) {
            if (each.write != nullptr) {
                known.push_back(each.extension);
            }
        }
        throw InputError(fmt::format("{}: prescriptions are not written as \"{}\", expected one of {}", file.string(),
                                     file.extension().string(), fmt::join(known, ", ")));
    }
    check_output_name(file);
}

std::vector<optics::Finding> write_prescription(const optics::Prescription& prescription,
                                                const std::filesystem::path& file) {
    check_prescription_name(file);
    optics::Prescription moved = prescription;
    const std::filesystem::path folder = std::filesystem::absolute(file).parent_path();
    moved.file = folder / file.filename();
    for (std::filesystem::path& catalogue : moved.catalogues) {
        catalogue = std::filesystem::absolute(catalogue);
    }
    if (auto* texture = std::get_if<optics::TexturedStop>(&moved.stop_shape)) {
        const auto image = std::filesystem::absolute(prescription.file).parent_path() / texture->image;
        texture->image = image.lexically_proximate(folder).generic_string();
    }
    WrittenPrescription written = form_of(file)->write(moved);
    write_file(file, written.text);
    return std::move(written.lost);
}

std::vector<std::string> shipped_lens_names() {
    std::vector<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(data_root() / "lenses")) {
        if (entry.path().extension() == ".toml" && entry.path().stem() != "glasses") {
            names.push_back(entry.path().stem().string());
        }
    }
    std::ranges::sort(names);
    return names;
}

std::filesystem::path find_lens_file(const std::string& lens) {
    std::filesystem::path shipped = data_root() / "lenses" / (lens + ".toml");
    const bool is_name = lens.find('/') == std::string::npos && lens.find('.') == std::string::npos;
    if (is_name && !lens.empty() && is_there(shipped)) {
        return shipped;
    }
    if (!is_there(lens)) {
        throw InputError(fmt::format("{}: neither a file nor a lens that ships{}", lens,
                                     complete_name_hint(lens, shipped_lens_names())));
    }
    std::filesystem::path path(lens);
    find_form(path);
    return path;
}

std::vector<std::filesystem::path> files_of_lens(const std::string& lens) {
    std::vector<std::filesystem::path> files = {find_lens_file(lens)};
    const optics::Prescription prescription = read_prescription(files.front());
    files.insert(files.end(), prescription.catalogues.begin(), prescription.catalogues.end());
    if (const auto* texture = std::get_if<optics::TexturedStop>(&prescription.stop_shape)) {
        files.push_back(files.front().parent_path() / texture->image);
    }
    return files;
}

}  // namespace lensproof::formats
