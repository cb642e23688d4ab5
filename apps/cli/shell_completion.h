#pragma once

#include <string>

#include "option_table.h"

namespace apriltrack::app {

// Scripts that let a shell complete commands, options, their choices, and files and folders where a value is
// one.

std::string bash_completion(
    const CommandTable& program);  ///< To be sourced, or put into bash-completion/completions.
std::string zsh_completion(const CommandTable& program);   ///< A file _apriltrack on zsh's fpath.
std::string fish_completion(const CommandTable& program);  ///< A file in fish's vendor_completions.d.

}  // namespace apriltrack::app
