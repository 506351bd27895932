#include "experiments/cli/terminal.h"

#include <cstdio>
#include <string>

#include "engine/base/visible.h"

namespace lensproof::cli {

namespace {

void write(std::string_view text, std::FILE* stream) {
    const std::string shown = visible(text);
    std::fwrite(shown.data(), 1, shown.size(), stream);
}

}  // namespace

void show(std::string_view text) {
    write(text, stdout);
}

void show_message(std::string_view text) {
    write(text, stderr);
}

}  // namespace lensproof::cli
