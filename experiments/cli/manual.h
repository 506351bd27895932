// experiments/cli/manual.h — the manual page, made from what --help says.
#pragma once
#include <string>
#include <vector>

#include "experiments/cli/command_line.h"

namespace lensproof::cli {

/// A page for man(1), section 1, in the macros of man(7). Options that commands share stand once.
std::string manual_page(const std::vector<CommandDescription>& commands, const std::string& version);

}  // namespace lensproof::cli
