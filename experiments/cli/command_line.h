// experiments/cli/command_line.h — the program's commands, and what each takes on the command line.
//
// The parser library's header costs each file that includes it some eight seconds; it is kept to command_line.cpp.
#pragma once
#include <functional>
#include <iosfwd>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "engine/base/input_error.h"

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace lensproof::cli {

/// A command line that cannot be used, with a line that says where to read how it can.
class UsageError : public InputError {
  public:
    UsageError(const std::string& complaint, std::string hint) : InputError(complaint), hint_(std::move(hint)) {}
    [[nodiscard]] const std::string& hint() const { return hint_; }

  private:
    std::string hint_;
};

/// What the text given to an option has to be.
struct OptionCheck {
    std::function<std::string(const std::string& text)> complaint;  // empty where the text will do
    std::string name;                                               // that stands for the value in the help
};

OptionCheck one_of(const std::vector<std::string>& texts);
OptionCheck in_range(int from, int to);
OptionCheck in_range(double from, double to);
OptionCheck either(const OptionCheck& one, const OptionCheck& other);
extern const OptionCheck kNumberOption;       // a finite number. (The library takes an empty text for 0.)
extern const OptionCheck kPositiveOption;     // a finite number above 0. (The library's own lets nan pass.)
extern const OptionCheck kNotNegativeOption;  // a number that is not below 0
extern const OptionCheck kSeedOption;         // digits alone. (The library turns -1 and 1e30 into some other seed.)

/// An option as it was declared, for what is written from that: manual page and completions.
struct OptionDescription {
    std::vector<std::string> names;  // "-o", "--output"; of what stands without one, "LENS"
    bool stands_alone = false;       // without a name
    bool is_required = false;
    bool repeats = false;              // takes more than one value
    std::string value;                 // what stands for it in the help, "FILE"; empty: a flag
    std::vector<std::string> choices;  // where only these will do
    std::string default_value;         // empty: none that is told
    std::string help;

    bool operator==(const OptionDescription& other) const = default;
};

struct CommandDescription {
    std::string name;
    std::string help;
    std::string footer;
    std::vector<OptionDescription> options;
};

/// An option of a command, while it is declared.
class Option {
  public:
    explicit Option(CLI::Option* option) : option_(option) {}
    Option& required();
    Option& type_name(const std::string& name);  // "FILE": what stands for the value in the help
    Option& check(const OptionCheck& check);     // each check that is asked for has to hold
    Option& shows_default();
    Option& separated_by(char separator);  // values of a list in one argument
    Option& takes_one_argument();          // of a list: an option's further values repeat its name
    Option& takes(int values);
    Option& needs(const Option& other);
    Option& excludes(const Option& other);

  private:
    CLI::Option* option_;
};

/// A command, while it is declared.
class Command {
  public:
    /// `status`: where what it returns goes.
    Command(CLI::App* app, int* status, std::ostream* result) : app_(app), status_(status), result_(result) {}

    /// `names`: "-o,--output", or a bare name for what stands without one. The value is set where the option is given;
    /// it outlives the program. T: std::string, double and int, these as std::optional, lists of the first two;
    /// unsigned and std::uint64_t.
    template <class T>
    Option add_option(const std::string& names, T& value, const std::string& help);
    Option add_flag(const std::string& names, bool& value, const std::string& help);
    Option add_flag(const std::string& names, const std::function<void()>& given, const std::string& help);

    /// What stands below the options in the help: an example.
    void footer(const std::string& text);

    /// What the command does; returns the exit status.
    void runs(const std::function<int()>& run);

    /// Where `--json -` goes.
    [[nodiscard]] std::ostream& result() const { return *result_; }

  private:
    CLI::App* app_;
    int* status_;
    std::ostream* result_;
};

class Program {
  public:
    /// `version` is asked for --version alone. `result`, which outlives it, is where `--json -` goes.
    Program(const std::string& name, const std::string& description, const std::function<std::string()>& version,
            const std::string& footer, std::ostream& result);
    ~Program();
    Program(const Program&) = delete;
    Program& operator=(const Program&) = delete;

    Command add_command(const std::string& name, const std::string& description);

    /// The commands that were added, in their order, without the --help of each.
    [[nodiscard]] std::vector<CommandDescription> describe() const;

    /// Runs the command that the arguments name (the program's own name is not among them), and returns its exit
    /// status; 0 after --help and --version. Throws InputError for arguments that are unusable.
    int run(const std::vector<std::string>& arguments);

  private:
    std::unique_ptr<CLI::App> app_;
    std::string name_;
    std::ostream* result_;
    int status_ = 0;
};

}  // namespace lensproof::cli
