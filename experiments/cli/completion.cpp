#include "experiments/cli/completion.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <string_view>

namespace lensproof::cli {

namespace {

/// The text as one word of a shell's script.
std::string shell_word(std::string_view text) {
    std::string word = "'";
    for (const char letter : text) {
        word += letter == '\'' ? "'\\''" : std::string(1, letter);
    }
    return word + "'";
}

bool takes_lens(const OptionDescription& option) {
    return option.value == "LENS" || (option.stands_alone && option.names.front() == "LENS");
}

std::vector<std::string> option_names(const CommandDescription& command) {
    std::vector<std::string> names{"-h", "--help"};
    for (const OptionDescription& option : command.options) {
        if (!option.stands_alone) {
            names.insert(names.end(), option.names.begin(), option.names.end());
        }
    }
    return names;
}

/// What bash offers behind an option: a case of its own for those with choices, for lenses and for folders; files
/// behind all others.
std::string bash_cases(const CommandDescription& command) {
    std::string cases;
    for (const OptionDescription& option : command.options) {
        std::string offer;
        if (!option.choices.empty()) {
            offer = fmt::format("_lensproof_words {}", shell_word(fmt::format("{}", fmt::join(option.choices, " "))));
        } else if (takes_lens(option)) {
            offer = "_lensproof_lenses";
        } else if (option.value == "DIR") {
            offer = "_lensproof_files -d";
        }
        if (!offer.empty() && option.stands_alone) {
            cases += fmt::format("        {}:*) {} ;;\n", command.name, offer);
        }
        for (const std::string& name : option.names) {
            if (!offer.empty() && !option.stands_alone) {
                cases.insert(0, fmt::format("        {}:{}) {} ;;\n", command.name, name, offer));
            }
        }
    }
    return cases;
}

/// The text where zsh gives brackets and colons a meaning.
std::string zsh_text(std::string_view text) {
    std::string plain;
    for (const char letter : text) {
        plain +=
            (std::string_view("[]:\\").find(letter) != std::string_view::npos ? "\\" : "") + std::string(1, letter);
    }
    return plain;
}

/// What zsh's _arguments is told of an option by one of its names.
std::string zsh_argument(const OptionDescription& option, const std::string& name) {
    const std::string action = !option.choices.empty() ? fmt::format("({})", fmt::join(option.choices, " "))
                               : takes_lens(option)    ? "_lensproof_lenses"
                               : option.value == "DIR" ? "_files -/"
                                                       : "_files";
    if (option.stands_alone) {
        return shell_word(fmt::format("{}:{}:{}", option.repeats ? "*" : "", zsh_text(name), action));
    }
    const std::string value = option.value.empty() ? "" : fmt::format(":{}:{}", zsh_text(option.value), action);
    return shell_word(fmt::format("{}{}[{}]{}", option.repeats ? "*" : "", name, zsh_text(option.help), value));
}

std::string zsh_arguments(const CommandDescription& command) {
    std::string arguments = " '(-h --help)'{-h,--help}'[Show the help]'";
    for (const OptionDescription& option : command.options) {
        for (const std::string& name : option.names) {
            arguments += " \\\n                    " + zsh_argument(option, name);
        }
    }
    return arguments;
}

}  // namespace

std::string bash_completion(const std::vector<CommandDescription>& commands, const std::vector<std::string>& lenses) {
    std::string names;
    std::string options;
    std::string cases;
    for (const CommandDescription& command : commands) {
        names += command.name + " ";
        options += fmt::format("        {}) options={} ;;\n", command.name,
                               shell_word(fmt::format("{}", fmt::join(option_names(command), " "))));
        cases += bash_cases(command);
    }
    return fmt::format(R"(# bash completion of lensproof, as `lensproof completion bash` writes it
_lensproof_words() {{ mapfile -t COMPREPLY < <(compgen -W "$1" -- "${{COMP_WORDS[COMP_CWORD]}}"); }}
_lensproof_files() {{
    mapfile -t COMPREPLY < <(compgen "$1" -- "${{COMP_WORDS[COMP_CWORD]}}")
    compopt -o filenames 2>/dev/null
}}
_lensproof_lenses() {{
    _lensproof_files -f
    mapfile -t -O "${{#COMPREPLY[@]}}" COMPREPLY < <(compgen -W {2} -- "${{COMP_WORDS[COMP_CWORD]}}")
}}
_lensproof() {{
    local command='' options='' word
    for word in "${{COMP_WORDS[@]:1:COMP_CWORD-1}}"; do
        if [[ $word != -* ]]; then command=$word; break; fi
    done
    case $command in
        '') _lensproof_words {0}; return ;;
{3}    esac
    if [[ ${{COMP_WORDS[COMP_CWORD]}} == -* ]]; then _lensproof_words "$options"; return; fi
    case $command:${{COMP_WORDS[COMP_CWORD-1]}} in
{1}        *) _lensproof_files -f ;;
    esac
}}
complete -F _lensproof lensproof
)",
                       shell_word(names + "--help --version"), cases,
                       shell_word(fmt::format("{}", fmt::join(lenses, " "))), options);
}

std::string zsh_completion(const std::vector<CommandDescription>& commands, const std::vector<std::string>& lenses) {
    std::string names;
    std::string cases;
    for (const CommandDescription& command : commands) {
        names += " " + shell_word(zsh_text(command.name) + ":" + zsh_text(command.help));
        cases += fmt::format("                {}) _arguments{} ;;\n", command.name, zsh_arguments(command));
    }
    return fmt::format(R"(#compdef lensproof
# zsh completion of lensproof, as `lensproof completion zsh` writes it
_lensproof_lenses() {{
    local -a lenses=({0})
    _alternative 'lenses:lens that ships:compadd -a lenses' 'files:prescription:_files'
}}
_lensproof() {{
    local -a commands=({1})
    local state line
    _arguments -C '(-h --help)'{{-h,--help}}'[Show the help]' '--version[Show the version]'         '1:command:->command' '*::argument:->argument'
    case $state in
        command) _describe command commands ;;
        argument)
            case $words[1] in
{2}            esac ;;
    esac
}}
_lensproof "$@"
)",
                       fmt::join(lenses, " "), names, cases);
}

}  // namespace lensproof::cli
