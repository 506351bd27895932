#include "engine/formats/prescription/design_command.h"

#include <fmt/format.h>

#include <cmath>

#include "engine/base/input_error.h"
#include "engine/base/text.h"

namespace lensproof::formats {

std::string_view Command::word(std::size_t index) const {
    return index < words.size() ? words[index] : std::string_view();
}

double Command::number(std::size_t index, std::string_view expected) const {
    const std::optional<double> value = parse_number(word(index));
    if (!value) {
        fail(word(index), expected);
    }
    return *value;
}

double Command::number_or_zero(std::size_t index) const {
    return index < words.size() ? number(index, "a number") : 0.0;
}

int Command::integer(std::size_t index, int min, int max, std::string_view expected) const {
    const double value = number(index, expected);
    if (!(value >= min && value <= max) || value != std::floor(value)) {
        fail(word(index), fmt::format("{} from {} to {}", expected, min, max));
    }
    return static_cast<int>(value);
}

std::vector<double> Command::numbers_from(std::size_t first) const {
    std::vector<double> values;
    for (std::size_t i = first; i < words.size(); ++i) {
        values.push_back(number(i, "numbers"));
    }
    return values;
}

void Command::fail(std::string_view found, std::string_view expected) const {
    throw InputError(fmt::format("{}:{}: {}{} is \"{}\", expected {}", file->string(), line, context,
                                 printable(keyword), printable(found), expected));
}

}  // namespace lensproof::formats
