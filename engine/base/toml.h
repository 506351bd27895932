// engine/base/toml.h — TOML tables read key by key, so that every complaint names the file, the line and the key.
#pragma once
#include <filesystem>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "engine/base/bounds.h"

// The library's include is kept to toml.cpp.
namespace toml {
inline namespace v3 {
class table;
class node;
}  // namespace v3
}  // namespace toml

namespace lensproof {

/// One table of a TOML file. Keys are taken one by one; `finish` then refuses those that nobody asked for, since a
/// misspelt key that is silently ignored is worse than an error. All members throw InputError naming file, line and
/// key.
class TomlTable {
  public:
    /// Reads and parses a whole file.
    static TomlTable read(const std::filesystem::path& file);
    /// Parses a text; `name` stands for the file in messages.
    static TomlTable parse(const std::string& text, const std::filesystem::path& name);

    /// The table with what `over` states put over it: of a key that both have, over's value counts, and where both
    /// values are tables they are joined in the same way. Complaints name the file that states what they are about;
    /// `file` remains this table's.
    [[nodiscard]] TomlTable overlaid(const TomlTable& over) const;

    /// Whether the key is there, which is no taking of it.
    [[nodiscard]] bool has(const std::string& key) const;
    /// Every key of the table, for a table whose keys are names.
    [[nodiscard]] std::vector<std::string> keys() const;

    double number(const std::string& key, const Bounds& bounds = kAnyNumber);
    double number_or(const std::string& key, double fallback, const Bounds& bounds = kAnyNumber);
    std::optional<double> optional_number(const std::string& key, const Bounds& bounds = kAnyNumber);
    /// Whatever number stands there, nan and inf included.
    double any_number(const std::string& key);
    [[nodiscard]] bool is_number(const std::string& key) const;
    [[nodiscard]] bool is_text(const std::string& key) const;
    [[nodiscard]] bool is_text_list(const std::string& key) const;
    [[nodiscard]] bool is_table(const std::string& key) const;
    /// 1 where the key's value is inf, -1 where it is -inf, else 0.
    int infinity(const std::string& key);
    int integer(const std::string& key, int min, int max);
    int integer_or(const std::string& key, int fallback, int min, int max);
    bool boolean_or(const std::string& key, bool fallback);
    std::string text(const std::string& key);
    std::string text_or(const std::string& key, const std::string& fallback);
    /// A text that has to be one of `choices`.
    std::string choice(const std::string& key, const std::vector<std::string>& choices);
    /// `count` numbers (0: any count).
    std::vector<double> numbers(const std::string& key, std::size_t count, const Bounds& bounds = kAnyNumber);
    /// Whatever numbers stand there, nan and inf included.
    std::vector<double> any_numbers(const std::string& key);
    /// Lists of numbers in a list: [[1, 2], [3, 4]].
    std::vector<std::vector<double>> number_lists(const std::string& key);
    std::vector<std::string> texts(const std::string& key);
    TomlTable table(const std::string& key);
    std::optional<TomlTable> optional_table(const std::string& key);
    /// An array of tables; empty where the key is absent.
    std::vector<TomlTable> tables(const std::string& key);

    /// All that stands in the table, read or not, as a text: two tables have the same only where they state the same
    /// values, in whatever order and notation.
    [[nodiscard]] std::string stated() const;

    /// Refuses keys that were not read.
    void finish() const;

    /// Of a key, of the table itself where it is absent; from 1.
    [[nodiscard]] int line(const std::string& key) const;
    /// "file:line: path.key" of a key (of the table itself where the key is empty or absent).
    [[nodiscard]] std::string where(const std::string& key = "") const;
    /// Throws InputError "where(key): message".
    [[noreturn]] void fail(const std::string& key, const std::string& message) const;

    [[nodiscard]] const std::filesystem::path& file() const { return layers_.back().file; }

  private:
    /// A table as one file states it.
    struct Layer {
        std::shared_ptr<const toml::table> root;  // keeps the nodes alive
        const toml::table* table;
        std::filesystem::path file;
        std::string path;  // "surfaces[3]", empty at the top

        [[nodiscard]] std::string qualified(const std::string& key) const;
        [[nodiscard]] Layer below(const std::string& key, const toml::table* inner) const;
    };

    explicit TomlTable(std::vector<Layer> layers) : layers_(std::move(layers)) {}
    const toml::node& require(const std::string& key);
    const toml::node* find(const std::string& key);
    [[nodiscard]] std::vector<std::string> keys_not_taken() const;
    double checked_number(const toml::node& node, const std::string& key, const Bounds& bounds) const;
    /// The layer whose value of the key counts; the lowest where none has it.
    [[nodiscard]] const Layer& layer_of(const std::string& key) const;
    [[nodiscard]] const toml::node* get(const std::string& key) const;

    std::vector<Layer> layers_;  // the one that counts most first
    std::set<std::string> taken_;
    mutable std::set<std::string> asked_after_;  // known names too, for whoever misspells one
};

}  // namespace lensproof
