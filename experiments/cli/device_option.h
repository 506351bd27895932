// experiments/cli/device_option.h — `--device`: who does a command's loops over rays.
#pragma once
#include <memory>
#include <string>

#include "engine/device/shared_device.h"
#include "experiments/cli/command_line.h"

namespace lensproof::cli {

/// Adds --device.
void add_device_option(Command& command, std::string& wish);

/// What becomes of a command that asks for a GPU by name and has something for it that it cannot do.
enum class OnRefusal {
    end,    // InputError says what
    go_on,  // a line says what
};

/// The device that is wished for; null: the processors. Of `auto` where there is none, and of whatever it cannot do or
/// fails at, a line on standard error says why. Throws InputError for `cuda` where there is none.
std::shared_ptr<device::SharedDevice> shared_device(const std::string& wish, OnRefusal on_refusal);

}  // namespace lensproof::cli
