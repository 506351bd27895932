#include "engine/scene/geometry/ply_check.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "engine/base/input_error.h"
#include "engine/base/text.h"
#include "engine/scene/geometry/plain_number.h"

namespace lensproof::scene {

namespace {

enum class PlyForm { ascii, little_endian, big_endian };

struct PlyProperty {
    int bytes = 0;        // of a value
    int count_bytes = 0;  // of the number before a list's values; 0 where there is one value
    bool is_count_signed = false;
    bool is_whole = false;  // a value
};

struct PlyElement {
    std::string name;
    double count = 0.0;
    std::vector<PlyProperty> properties;
    std::string header;  // of it and its properties, a line each
};

/// Of which Assimp knows the name, and there is something to read.
bool is_of_meshes(const PlyElement& element) {
    constexpr std::array kNames = {"vertex", "face", "tristrips", "edge", "material"};
    return std::ranges::find(kNames, element.name) != kNames.end() && !element.properties.empty();
}

/// A property's name as Assimp may have it: it reads the first of a list's values where it expects one, also of none.
std::string name_of(std::string_view name, bool is_list) {
    constexpr std::array<std::string_view, 3> kLists = {"vertex_indices", "vertex_index", "texcoord"};
    const bool is_lists = std::ranges::find(kLists, name) != kLists.end();
    return is_list == is_lists ? printable(name) : std::string("other");
}

struct PlyHeader {
    PlyForm form = PlyForm::ascii;
    std::string format;  // its line
    std::vector<PlyElement> elements;
    std::size_t size = 0;  // of the header, up to the first byte of the first element
};

class PlyCheck {
  public:
    PlyCheck(std::string_view content, const std::filesystem::path& file) : content_(content), file_(file.string()) {}

    std::string run() {
        const PlyHeader header = read_header();
        rest_ = content_.substr(header.size);
        std::string head = "ply\n" + header.format;
        std::string body;
        for (const PlyElement& element : header.elements) {
            const std::string values =
                header.form == PlyForm::ascii ? take_lines(element) : std::string(take_bytes(element, header.form));
            if (is_of_meshes(element)) {
                head += element.header;
                body += values;
            }
        }
        // Assimp takes a line's end off binary values, too, in case the header's was "\r\n".
        const bool is_hidden = header.form != PlyForm::ascii && body.starts_with('\n');
        return head + "end_header\n" + (is_hidden ? "\n" : "") + body;
    }

  private:
    [[noreturn]] void refuse(const std::string& reason) const {
        throw InputError(fmt::format("{}: cannot be read as ply: {}", file_, reason));
    }

    /// The next line of the header or of an ASCII file, without its end; nothing at the end of the file.
    static std::optional<std::string_view> take_line(std::string_view& rest) {
        const std::size_t end = rest.find_first_of("\r\n");
        if (rest.empty()) {
            return std::nullopt;
        }
        const std::string_view line = rest.substr(0, end);
        const bool is_crlf = end != std::string_view::npos && rest.substr(end, 2) == "\r\n";
        rest.remove_prefix(end == std::string_view::npos ? rest.size() : end + (is_crlf ? 2 : 1));
        return line;
    }

    int size_of(std::string_view type) const {
        static const std::map<std::string_view, int> kBytes = {
            {"char", 1},  {"uchar", 1},   {"int8", 1},   {"uint8", 1},  {"short", 2}, {"ushort", 2},
            {"int16", 2}, {"uint16", 2},  {"int", 4},    {"uint", 4},   {"int32", 4}, {"uint32", 4},
            {"float", 4}, {"float32", 4}, {"double", 8}, {"float64", 8}};
        const auto found = kBytes.find(type);
        if (found == kBytes.end()) {
            refuse(fmt::format("its header has a property of type '{}'", printable(type)));
        }
        return found->second;
    }

    static bool is_float(std::string_view type) { return type.starts_with("float") || type.starts_with("double"); }

    PlyForm form_of(std::string_view word) const {
        if (word == "ascii") {
            return PlyForm::ascii;
        }
        if (word != "binary_little_endian" && word != "binary_big_endian") {
            refuse(fmt::format("its format is '{}'", printable(word)));
        }
        return word == "binary_little_endian" ? PlyForm::little_endian : PlyForm::big_endian;
    }

    PlyElement element_of(const std::vector<std::string_view>& words) const {
        const std::optional<double> count = parse_number(words[2]);
        if (!count || !(*count >= 0.0) || *count != std::floor(*count)) {
            refuse(fmt::format("its header promises '{}' of {}", printable(words[2]), printable(words[1])));
        }
        const std::string name = printable(words[1]);
        return {
            .name = name, .count = *count, .properties = {}, .header = fmt::format("element {} {}\n", name, *count)};
    }

    static void add_property(PlyElement& element, const PlyProperty& property,
                             const std::vector<std::string_view>& words) {
        const bool is_list = property.count_bytes > 0;
        element.properties.push_back(property);
        element.header +=
            fmt::format("{} {}\n", fmt::join(words.begin(), words.end() - 1, " "), name_of(words.back(), is_list));
    }

    PlyHeader read_header() const {
        PlyHeader header;
        std::string_view rest = content_;
        if (take_line(rest) != "ply") {
            refuse("it does not begin with 'ply'");
        }
        while (const auto line = take_line(rest)) {
            const std::vector<std::string_view> words = words_of(*line);
            if (words.empty() || words[0] == "comment" || words[0] == "obj_info") {
                continue;
            }
            if (words[0] == "end_header" && !header.format.empty()) {
                header.size = content_.size() - rest.size();
                return header;
            }
            if (words[0] == "format" && words.size() == 3) {
                header.form = form_of(words[1]);
                header.format = fmt::format("format {} 1.0\n", words[1]);
            } else if (words[0] == "element" && words.size() == 3) {
                PlyElement element = element_of(words);
                if (std::ranges::find(header.elements, element.name, &PlyElement::name) != header.elements.end()) {
                    // Assimp writes the second where there is room for as many as the first has.
                    refuse(fmt::format("its header promises {} twice", element.name));
                }
                header.elements.push_back(std::move(element));
            } else if (words[0] == "property" && words.size() == 3 && !header.elements.empty()) {
                add_property(header.elements.back(), {.bytes = size_of(words[1]), .is_whole = !is_float(words[1])},
                             words);
            } else if (words[0] == "property" && words.size() == 5 && words[1] == "list" && !header.elements.empty()) {
                if (is_float(words[2])) {
                    refuse(fmt::format("its header says '{}'", printable(*line)));
                }
                add_property(header.elements.back(),
                             {.bytes = size_of(words[3]),
                              .count_bytes = size_of(words[2]),
                              .is_count_signed = !words[2].starts_with('u'),
                              .is_whole = !is_float(words[3])},
                             words);
            } else {
                refuse(fmt::format("its header says '{}'", printable(*line)));
            }
        }
        refuse("its header does not end");
    }

    [[noreturn]] void refuse_end(const PlyElement& element, double at) const {
        refuse(fmt::format("it ends within the {} {} of {}", element.name, at, element.count));
    }

    /// The values of an ASCII file, a line for each of the element.
    std::string take_lines(const PlyElement& element) {
        std::string lines;
        for (double i = 0; i < element.count; ++i) {
            const auto line = take_line(rest_);
            if (!line) {
                refuse_end(element, i);
            }
            const std::vector<std::string_view> words = words_of(*line);
            const auto refuse_line = [&] {
                refuse(fmt::format("the {} {} is '{}'", element.name, i, printable(*line)));
            };
            std::size_t at = 0;
            const auto take_number = [&](bool is_whole) {
                const std::string_view word = at < words.size() ? words[at] : "";
                const std::optional<double> number = parse_number(word);
                if (!number || (is_whole && (*number != std::floor(*number) || std::abs(*number) > kLargestWhole))) {
                    refuse_line();
                }
                lines += at++ > 0 ? " " : "";
                lines += is_whole ? fmt::format("{:.0f}", *number) : plain_number(word, *number);
                return *number;
            };
            for (const PlyProperty& property : element.properties) {
                const double count = property.count_bytes > 0 ? take_number(true) : 1.0;
                if (count < 0.0) {
                    refuse_line();
                }
                for (double k = 0; k < count; ++k) {
                    take_number(property.is_whole);
                }
            }
            lines += '\n';
        }
        return lines;
    }

    /// The same of a binary file.
    std::string_view take_bytes(const PlyElement& element, PlyForm form) {
        const std::string_view before = rest_;
        for (double i = 0; i < element.count; ++i) {
            std::size_t taken = 0;
            for (const PlyProperty& property : element.properties) {
                std::size_t values = 1;
                if (property.count_bytes > 0) {
                    if (taken + property.count_bytes > rest_.size()) {
                        refuse_end(element, i);
                    }
                    values = whole_number(rest_.substr(taken, property.count_bytes), form);
                    if (property.is_count_signed && values >> (8 * property.count_bytes - 1) != 0) {
                        refuse(fmt::format("the {} {} has a list of less than nothing", element.name, i));
                    }
                    taken += property.count_bytes;
                }
                if (values > (rest_.size() - std::min(taken, rest_.size())) / property.bytes) {
                    refuse_end(element, i);
                }
                taken += values * property.bytes;
            }
            if (taken == 0) {
                break;  // an element without properties, of which any number is there
            }
            rest_.remove_prefix(taken);
        }
        return before.substr(0, before.size() - rest_.size());
    }

    static constexpr double kLargestWhole = 4294967295.0;  // of 32 bits

    static std::size_t whole_number(std::string_view bytes, PlyForm form) {
        std::size_t value = 0;
        for (std::size_t i = 0; i < bytes.size(); ++i) {
            const std::size_t at = form == PlyForm::big_endian ? i : bytes.size() - 1 - i;
            value = value << 8 | static_cast<unsigned char>(bytes[at]);
        }
        return value;
    }

    std::string_view content_;
    std::string file_;
    std::string_view rest_;
};

}  // namespace

std::string checked_ply(std::string_view content, const std::filesystem::path& file) {
    return PlyCheck(content, file).run();
}

}  // namespace lensproof::scene
