#include "experiments/cli/command_line.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <iterator>
#include <optional>
#include <sstream>

#include "engine/base/input_error.h"
#include "engine/base/nearest_name.h"
#include "engine/base/text.h"

namespace lensproof::cli {

namespace {

OptionCheck check_by(const CLI::Validator& validator) {
    return {[validator](std::string text) { return validator(text); }, validator.get_description()};
}

CLI::Validator validator_of(const OptionCheck& check) {
    return {[complaint = check.complaint](const std::string& text) { return complaint(text); }, check.name};
}

std::string complain_unless_seed(const std::string& text) {
    std::uint64_t seed = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), seed);
    const bool good = error == std::errc() && end == text.data() + text.size();
    return good ? "" : fmt::format("\"{}\", expected a whole number from 0 to 2^64 - 1", text);
}

std::string complain_unless_positive(const std::string& text) {
    char* end = nullptr;
    const double value = std::strtod(text.c_str(), &end);
    const bool good = !text.empty() && end == text.c_str() + text.size() && std::isfinite(value) && value > 0.0;
    return good ? "" : fmt::format("\"{}\", expected a finite number above 0", text);
}

std::string complain_unless_number(const std::string& text) {
    const std::optional<double> value = parse_number(text);
    const bool good = value && std::isfinite(*value);
    return good ? "" : fmt::format("\"{}\", expected a number", printable(text));
}

/// The first argument that neither the program nor the command that it names has a use for, which may be a misspelt
/// name; nothing where there is none.
std::optional<std::string> complaint_about_stranger(const CLI::App& program) {
    const auto asked = program.get_subcommands();
    const bool is_before_command = asked.empty() || !program.remaining().empty();
    const CLI::App& app = is_before_command ? program : *asked.front();
    const std::vector<std::string> strangers = app.remaining();
    if (strangers.empty()) {
        return std::nullopt;
    }
    const std::string& first = strangers.front();
    std::vector<std::string> known;
    if (first.starts_with("-")) {
        for (const CLI::Option* const has : app.get_options()) {
            std::ranges::transform(has->get_lnames(), std::back_inserter(known),
                                   [](const std::string& name) { return "--" + name; });
        }
        const std::string name = first.substr(0, first.find('='));
        return fmt::format("\"{}\" is no option of {}{}", printable(name), app.get_name(), name_hint(name, known));
    }
    if (!is_before_command) {
        return fmt::format("\"{}\" is more than {} takes", printable(first), app.get_name());
    }
    std::ranges::transform(program.get_subcommands({}), std::back_inserter(known), &CLI::App::get_name);
    return fmt::format("\"{}\" is no command{}", printable(first), name_hint(first, known));
}

/// In words that name what is wrong. Whatever lacks is told after what is too much: a misspelt name is both.
std::string complaint(const CLI::App& program, const CLI::ParseError& error) {
    const bool asks_too_much = dynamic_cast<const CLI::ExtrasError*>(&error) != nullptr;
    const bool lacks = dynamic_cast<const CLI::RequiredError*>(&error) != nullptr;
    if (asks_too_much || lacks) {
        if (const std::optional<std::string> stranger = complaint_about_stranger(program)) {
            return *stranger;
        }
    }
    return lacks && program.get_subcommands().empty() ? "expected a command" : error.what();
}

/// What "CRITERION:{paraxial,spot}" lets one choose from.
std::vector<std::string> choices_of(const std::string& type) {
    const std::size_t open = type.find('{');
    const std::size_t close = type.find('}', open);
    if (open == std::string::npos || close == std::string::npos) {
        return {};
    }
    std::istringstream list(type.substr(open + 1, close - open - 1));
    std::vector<std::string> choices;
    for (std::string choice; std::getline(list, choice, ',');) {
        choices.push_back(choice);
    }
    return choices;
}

OptionDescription describe_option(const CLI::Option& option) {
    OptionDescription description{.stands_alone = option.get_positional(),
                                  .is_required = option.get_required(),
                                  .repeats = option.get_expected_max() > 1,
                                  .choices = choices_of(option.get_type_name()),
                                  .default_value = option.get_default_str(),
                                  .help = option.get_description()};
    if (description.stands_alone) {
        description.names = {option.get_name(true)};
    }
    for (const std::string& name : option.get_snames()) {
        description.names.push_back("-" + name);
    }
    for (const std::string& name : option.get_lnames()) {
        description.names.push_back("--" + name);
    }
    if (option.get_items_expected_max() > 0) {
        description.value = option.get_type_name().substr(0, option.get_type_name().find(':'));
    }
    return description;
}

}  // namespace

OptionCheck one_of(const std::vector<std::string>& texts) {
    return check_by(CLI::IsMember(texts));
}

OptionCheck in_range(int from, int to) {
    return check_by(CLI::Range(from, to));
}

OptionCheck in_range(double from, double to) {
    return check_by(CLI::Range(from, to));
}

OptionCheck either(const OptionCheck& one, const OptionCheck& other) {
    return check_by(validator_of(one) | validator_of(other));
}

const OptionCheck kNumberOption{complain_unless_number, "NUMBER"};
const OptionCheck kPositiveOption{complain_unless_positive, "POSITIVE"};
const OptionCheck kNotNegativeOption = check_by(CLI::NonNegativeNumber);
const OptionCheck kSeedOption{complain_unless_seed, "UINT"};

Option& Option::required() {
    option_->required();
    return *this;
}

Option& Option::type_name(const std::string& name) {
    option_->type_name(name);
    return *this;
}

Option& Option::check(const OptionCheck& check) {
    option_->check(validator_of(check));
    return *this;
}

Option& Option::shows_default() {
    option_->capture_default_str();
    return *this;
}

Option& Option::separated_by(char separator) {
    option_->delimiter(separator);
    return *this;
}

Option& Option::takes_one_argument() {
    option_->allow_extra_args(false);
    return *this;
}

Option& Option::takes(int values) {
    option_->expected(values);
    return *this;
}

Option& Option::excludes(const Option& other) {
    option_->excludes(other.option_);
    return *this;
}

Option& Option::needs(const Option& other) {
    option_->needs(other.option_);
    return *this;
}

template <class T>
Option Command::add_option(const std::string& names, T& value, const std::string& help) {
    return Option(app_->add_option(names, value, help));
}

template Option Command::add_option(const std::string&, std::string&, const std::string&);
template Option Command::add_option(const std::string&, double&, const std::string&);
template Option Command::add_option(const std::string&, int&, const std::string&);
template Option Command::add_option(const std::string&, unsigned int&, const std::string&);
template Option Command::add_option(const std::string&, std::uint64_t&, const std::string&);
template Option Command::add_option(const std::string&, std::optional<std::string>&, const std::string&);
template Option Command::add_option(const std::string&, std::optional<double>&, const std::string&);
template Option Command::add_option(const std::string&, std::optional<int>&, const std::string&);
template Option Command::add_option(const std::string&, std::vector<std::string>&, const std::string&);
template Option Command::add_option(const std::string&, std::vector<double>&, const std::string&);

Option Command::add_flag(const std::string& names, bool& value, const std::string& help) {
    return Option(app_->add_flag(names, value, help));
}

Option Command::add_flag(const std::string& names, const std::function<void()>& given, const std::string& help) {
    return Option(app_->add_flag_callback(names, given, help));
}

void Command::footer(const std::string& text) {
    app_->footer(text);
}

void Command::runs(const std::function<int()>& run) {
    app_->callback([run, status = status_] { *status = run(); });
}

Program::Program(const std::string& name, const std::string& description, const std::function<std::string()>& version,
                 const std::string& footer, std::ostream& result)
    : app_(std::make_unique<CLI::App>(description, name)), name_(name), result_(&result) {
    app_->set_version_flag("--version", version);
    app_->footer(footer);
    app_->require_subcommand(1);
}

Program::~Program() = default;

Command Program::add_command(const std::string& name, const std::string& description) {
    return {app_->add_subcommand(name, description), &status_, result_};
}

std::vector<CommandDescription> Program::describe() const {
    std::vector<CommandDescription> commands;
    for (const CLI::App* const app : app_->get_subcommands({})) {
        CommandDescription& command = commands.emplace_back();
        command.name = app->get_name();
        command.help = app->get_description();
        command.footer = app->get_footer();
        for (const CLI::Option* const option : app->get_options()) {
            if (option != app->get_help_ptr()) {
                command.options.push_back(describe_option(*option));
            }
        }
    }
    return commands;
}

int Program::run(const std::vector<std::string>& arguments) {
    std::vector<const char*> words = {name_.c_str()};
    std::ranges::transform(arguments, std::back_inserter(words), &std::string::c_str);
    try {
        app_->parse(static_cast<int>(words.size()), words.data());
    } catch (const CLI::Success& success) {
        return app_->exit(success);  // --help, --version
    } catch (const CLI::ParseError& error) {
        const auto asked = app_->get_subcommands();
        throw UsageError(complaint(*app_, error),
                         fmt::format("Try: {} {}--help", name_, asked.empty() ? "" : asked.front()->get_name() + " "));
    }
    return status_;
}

}  // namespace lensproof::cli
