#include "engine/scene/geometry/obj_check.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "engine/base/input_error.h"
#include "engine/base/text.h"
#include "engine/base/visible.h"
#include "engine/scene/geometry/plain_number.h"

namespace lensproof::scene {

namespace {

using Words = std::span<const std::string_view>;

class ObjCheck {
  public:
    explicit ObjCheck(const std::filesystem::path& file) : file_(file.string()) {}

    CheckedObj run(std::string_view content) {
        std::string joined;
        for (const std::string_view line : lines_of(content)) {
            ++line_number_;
            // A line that ends in a backslash goes on in the next.
            if (line.ends_with('\\')) {
                joined.append(line, 0, line.size() - 1).append(" ");
            } else if (!joined.empty()) {
                take(joined.append(line));
                joined.clear();
            } else {
                take(line);
            }
        }
        take(joined);
        for (std::size_t kind = 0; kind < kKinds; ++kind) {
            if (largest_[kind].index > count_[kind]) {
                refuse(largest_[kind].line_number,
                       fmt::format("a face goes to the {} {} of {}", kNames[kind], largest_[kind].index, count_[kind]));
            }
        }
        return std::move(checked_);
    }

  private:
    enum Kind : std::uint8_t { position, texture, normal, kKinds };
    static constexpr std::array kNames = {"vertex", "texture coordinate", "normal"};
    using Corner = std::array<std::int64_t, kKinds>;  // which of each kind, from 1; 0: none

    [[noreturn]] void refuse(std::size_t line_number, const std::string& reason) const {
        throw InputError(fmt::format("{}: cannot be read as obj: line {}: {}", file_, line_number, reason));
    }

    void take(std::string_view line) {
        line_ = line;
        const std::vector<std::string_view> words = words_of(line);
        if (words.empty()) {
            return;
        }
        const Words values = Words(words).subspan(1);
        if (words[0] == "v") {
            // Of four the last divides the others; what follows three or four are colours.
            take_numbers("v", values, 3, values.size() == 4 ? 4 : 3, position);
            if (values.size() == 4 && parse_number(values[3]) == 0.0) {
                refuse_line();
            }
        } else if (words[0] == "vt") {
            take_numbers("vt", values, 1, 2, texture);
        } else if (words[0] == "vn") {
            take_numbers("vn", values, 3, 3, normal);
        } else if (words[0] == "f" && values.size() > 2) {
            take_face(values);
        } else if (words[0] == "f" || words[0] == "l" || words[0] == "p") {
            ++checked_.lines_and_points;
        } else if (words[0] == "o" || words[0] == "g" || words[0] == "usemtl") {
            const std::string_view name = trimmed(trimmed(line).substr(words[0].size()));
            add_line(words[0], visible_in_line(name));
        }
    }

    [[noreturn]] void refuse_line() const { refuse(line_number_, fmt::format("'{}'", printable(line_))); }

    void add_line(std::string_view keyword, std::string_view rest) {
        checked_.text.append(keyword).append(" ").append(rest).append("\n");
    }

    /// At least `least` of them, of which `written` are written, 0 for what is not there.
    void take_numbers(std::string_view keyword, Words values, std::size_t least, std::size_t written, Kind kind) {
        if (values.size() < least) {
            refuse_line();
        }
        std::string numbers;
        for (std::size_t i = 0; i < written; ++i) {
            const std::string_view word = i < values.size() ? values[i] : "0";
            const std::optional<double> number = parse_number(word);
            if (!number) {
                refuse_line();
            }
            numbers.append(i > 0 ? " " : "").append(plain_number(word, *number));
        }
        add_line(keyword, numbers);
        ++count_[kind];
    }

    /// `position`, `position/texture`, `position//normal` or `position/texture/normal`.
    Corner corner_of(std::string_view word) {
        Corner corner{};
        for (std::size_t kind = 0; kind < kKinds; ++kind) {
            const std::string_view number = word.substr(0, word.find('/'));
            if (!number.empty()) {
                corner[kind] = index_of(number, kind);
            }
            word.remove_prefix(std::min(word.size(), number.size() + 1));
        }
        if (!word.empty() || corner[position] == 0) {
            refuse_line();
        }
        return corner;
    }

    /// Counted from 1, of those so far back from −1.
    std::int64_t index_of(std::string_view number, std::size_t kind) {
        const std::optional<std::int64_t> stated = parse_exact<std::int64_t>(number);
        if (!stated || *stated == 0 || *stated < -count_[kind]) {
            refuse_line();
        }
        const std::int64_t index = *stated < 0 ? count_[kind] + 1 + *stated : *stated;
        if (index > largest_[kind].index) {
            largest_[kind] = {index, line_number_};
        }
        return index;
    }

    void take_face(Words words) {
        std::vector<Corner> corners;
        corners.reserve(words.size());
        for (const std::string_view word : words) {
            corners.push_back(corner_of(word));
        }
        const auto all_have = [&](Kind kind) {
            return std::ranges::all_of(corners, [&](const Corner& corner) { return corner[kind] > 0; });
        };
        const bool with_texture = all_have(texture);
        const bool with_normal = all_have(normal);
        std::string face;
        for (const Corner& corner : corners) {
            face += fmt::format("{}{}", face.empty() ? "" : " ", corner[position]);
            if (with_texture || with_normal) {
                face += with_texture ? fmt::format("/{}", corner[texture]) : "/";
            }
            if (with_normal) {
                face += fmt::format("/{}", corner[normal]);
            }
        }
        add_line("f", face);
    }

    struct Largest {
        std::int64_t index = 0;
        std::size_t line_number = 0;
    };
    std::string file_;
    std::size_t line_number_ = 0;
    std::string_view line_;
    std::array<std::int64_t, kKinds> count_{};
    std::array<Largest, kKinds> largest_;
    CheckedObj checked_;
};

}  // namespace

CheckedObj checked_obj(std::string_view content, const std::filesystem::path& file) {
    return ObjCheck(file).run(content);
}

}  // namespace lensproof::scene
