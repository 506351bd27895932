// experiments/findings/varied.h — one table of an experiment's file that stands for many.
#pragma once
#include <string>
#include <vector>

#include "experiments/findings/axis.h"

namespace lensproof::findings {

/// A table, with what sets it apart from the others that were made of the same.
struct Varied {
    TomlTable table;
    std::vector<Axis> at{};  // each with one value
};

/// "f/2.8, broadband"; of none: ""
std::string words_of(const std::vector<Axis>& at);

/// The array of tables under `key`. Of a table that has `vary`, one of each combination of the values that it lists,
///     [[simulations]]
///     name = "tessar"
///     vary.camera.f_number = [4.0, 8.0]
///     vary.model = ["brown-conrady", "kannala-brandt"]
/// which is the table with these values put over it and, where it has a name and a title, those that tell them:
/// "tessar-4-brown-conrady". Axes are in the order of their keys, the last running fastest. Throws InputError;
/// complaints of a value name the line of `vary`.
std::vector<Varied> varied_tables(TomlTable& owner, const std::string& key);

}  // namespace lensproof::findings
