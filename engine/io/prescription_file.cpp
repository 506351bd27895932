#include "engine/io/prescription_file.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "engine/io/file.h"
#include "engine/io/input_error.h"
#include "engine/io/prescription_forms.h"

namespace lensproof {

namespace {

/// A form of prescriptions, by the extension of its files.
struct Form {
    std::string_view extension;
    Prescription (*parse)(const std::string&, const std::filesystem::path&);
};

constexpr Form kForms[] = {{".toml", parse_toml_prescription}, {".csv", parse_csv_prescription}};

const Form& find_form(const std::filesystem::path& file) {
    std::string extension = file.extension().string();
    std::ranges::transform(extension, extension.begin(), [](unsigned char letter) { return std::tolower(letter); });
    const auto* form = std::ranges::find(kForms, extension, &Form::extension);
    if (form == std::end(kForms)) {
        std::vector<std::string_view> known;
        std::ranges::transform(kForms, std::back_inserter(known), &Form::extension);
        throw InputError(fmt::format("{}: a prescription of an unknown kind, expected one of {}", file.string(),
                                     fmt::join(known, ", ")));
    }
    return *form;
}

}  // namespace

Prescription read_prescription(const std::filesystem::path& file) {
    return find_form(file).parse(read_file(file), file);
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
    if (is_name && !lens.empty() && std::filesystem::exists(shipped)) {
        return shipped;
    }
    if (!std::filesystem::exists(lens)) {
        throw InputError(fmt::format("{}: neither a file nor a lens that ships; those are: {}", lens,
                                     fmt::join(shipped_lens_names(), ", ")));
    }
    const std::filesystem::path path(lens);
    find_form(path);
    return path;
}

}  // namespace lensproof
