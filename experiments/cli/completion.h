// experiments/cli/completion.h — what shells offer where a command line is typed.
#pragma once
#include <string>
#include <vector>

#include "experiments/cli/command_line.h"

namespace lensproof::cli {

/// A script that teaches bash, or zsh, to complete the program's commands, options, their choices, lenses that ship and
/// files. bash's needs no bash-completion; zsh's lies as `_lensproof` in a folder of $fpath.
std::string bash_completion(const std::vector<CommandDescription>& commands, const std::vector<std::string>& lenses);
std::string zsh_completion(const std::vector<CommandDescription>& commands, const std::vector<std::string>& lenses);

}  // namespace lensproof::cli
