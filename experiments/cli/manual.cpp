#include "experiments/cli/manual.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <iterator>
#include <string_view>

namespace lensproof::cli {

namespace {

/// The text as roff takes it for text: no escapes, no requests at a line's start, hyphens that may be copied.
std::string roff(std::string_view text) {
    std::string plain;
    for (const char letter : text) {
        if ((letter == '.' || letter == '\'') && (plain.empty() || plain.back() == '\n')) {
            plain += "\\&";
        }
        plain += letter == '\\' ? "\\e" : letter == '-' ? "\\-" : std::string(1, letter);
    }
    return plain;
}

std::string entry(const OptionDescription& option) {
    std::string names;
    for (const std::string& name : option.names) {
        names += (names.empty() ? "\\fB" : ", \\fB") + roff(name) + "\\fR";
    }
    if (!option.stands_alone && !option.value.empty()) {
        names += fmt::format(" \\fI{}\\fR{}", roff(option.value),
                             option.repeats && !option.value.ends_with("…") ? " ..." : "");
    }
    std::string help = option.help;
    if (!option.choices.empty()) {
        help += fmt::format("; one of {}", fmt::join(option.choices, ", "));
    }
    if (!option.default_value.empty()) {
        help += fmt::format(" (default: {})", option.default_value);
    }
    return fmt::format(".TP\n{}\n{}\n", names, roff(help));
}

bool has(const CommandDescription& command, const OptionDescription& option) {
    return std::ranges::find(command.options, option) != command.options.end();
}

/// Whether it is one of those that take --json and what goes with it: all but the few that write texts alone.
bool finds_something(const CommandDescription& command) {
    return std::ranges::any_of(command.options, [](const OptionDescription& option) {
        return std::ranges::find(option.names, "--json") != option.names.end();
    });
}

/// The options that all those have.
std::vector<OptionDescription> common_options(const std::vector<CommandDescription>& commands) {
    std::vector<OptionDescription> common;
    std::ranges::copy_if(commands.front().options, std::back_inserter(common), [&](const OptionDescription& option) {
        return std::ranges::all_of(
            commands, [&](const CommandDescription& other) { return has(other, option) || !finds_something(other); });
    });
    return common;
}

std::string synopsis(const CommandDescription& command) {
    std::string text = fmt::format("\\fBlensproof {}\\fR [\\fIOPTIONS\\fR]", roff(command.name));
    for (const OptionDescription& option : command.options) {
        if (option.stands_alone) {
            const std::string name =
                fmt::format("\\fI{}\\fR{}", roff(option.names.front()), option.repeats ? " ..." : "");
            text += option.is_required ? " " + name : " [" + name + "]";
        }
    }
    return text;
}

/// The lines of a footer, each by itself.
std::string lines(std::string_view text) {
    std::string broken = roff(text);
    for (std::size_t at = 0; (at = broken.find('\n', at)) != std::string::npos; at += 5) {
        broken.insert(at, "\n.br");
    }
    return broken;
}

std::string section(const CommandDescription& command, const std::vector<OptionDescription>& common) {
    std::string text = fmt::format(".SS {}\n{}\n.PP\n{}.\n", roff(command.name), synopsis(command), roff(command.help));
    for (const OptionDescription& option : command.options) {
        if (std::ranges::find(common, option) == common.end()) {
            text += entry(option);
        }
    }
    return text + ".PP\n" + lines(command.footer) + "\n";
}

constexpr std::string_view kEnd = R"(.SH EXIT STATUS
.TP
0
done, and every check and threshold held
.TP
1
done, and a check or threshold did not hold
.TP
2
the command line or an input is unusable; the message names file, line or key, what was found and what is expected
.TP
3
something failed that is not the input's fault
.SH ENVIRONMENT
.TP
\fBLENSPROOF_HOME\fR
the folder that holds lenses, experiments and reference_photos, in place of the one that was installed
.TP
\fBLENSPROOF_CACHE\fR
where what is found by tracing a lens is kept, in place of ~/.cache/lensproof; off: nowhere
)";

}  // namespace

std::string manual_page(const std::vector<CommandDescription>& commands, const std::string& version) {
    const std::vector<OptionDescription> common = common_options(commands);
    std::string page = fmt::format(
        ".TH LENSPROOF 1 \"\" \"lensproof {}\" \"User Commands\"\n"
        ".SH NAME\nlensproof \\- a reference optics engine, and the validation suite around it\n"
        ".SH SYNOPSIS\n\\fBlensproof\\fR \\fICOMMAND\\fR [\\fIOPTIONS\\fR] ...\n.br\n"
        "\\fBlensproof\\fR [\\fICOMMAND\\fR] \\fB\\-\\-help\\fR\n.br\n\\fBlensproof \\-\\-version\\fR\n"
        ".SH DESCRIPTION\nDoes the simulated lens behave like the real one, where not, by how much, and how sure are "
        "we? "
        "Standard output holds the result, standard error progress and messages.\n.SH COMMON OPTIONS\n",
        roff(version));
    for (const OptionDescription& option : common) {
        page += entry(option);
    }
    page += ".SH COMMANDS\n";
    for (const CommandDescription& command : commands) {
        page += section(command, common);
    }
    return page + std::string(kEnd);
}

}  // namespace lensproof::cli
