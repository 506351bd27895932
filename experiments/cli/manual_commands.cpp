// experiments/cli/manual_commands.cpp — `lensproof completion SHELL` and `lensproof manual`: what an installation puts
// beside the program.
#include <memory>

#include "engine/formats/prescription/prescription_file.h"
#include "experiments/cli/command.h"
#include "experiments/cli/completion.h"
#include "experiments/cli/manual.h"
#include "experiments/cli/terminal.h"
#include "experiments/runner/provenance.h"

namespace lensproof::cli {

void add_completion_command(Program& program) {
    const auto shell = std::make_shared<std::string>();
    Command command =
        program.add_command("completion", "Write what makes a shell complete this program's command lines");
    command.footer(
        "Example: lensproof completion bash > ~/.local/share/bash-completion/completions/lensproof\n"
        "For zsh, into a file _lensproof in a folder of $fpath.");
    command.add_option("SHELL", *shell, "bash or zsh").required().check(one_of({"bash", "zsh"}));
    command.runs([&program, shell] {
        const std::vector<std::string> lenses = formats::shipped_lens_names();
        show(*shell == "bash" ? bash_completion(program.describe(), lenses)
                              : zsh_completion(program.describe(), lenses));
        return kDone;
    });
}

void add_manual_command(Program& program) {
    Command command = program.add_command("manual", "Write the manual page, as man reads it");
    command.footer("Example: lensproof manual | man -l -");
    command.runs([&program] {
        show(manual_page(program.describe(), runner::program_version()));
        return kDone;
    });
}

}  // namespace lensproof::cli
