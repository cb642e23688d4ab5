#pragma once

#include <cstddef>
#include <string>

#include "option_table.h"

namespace apriltrack::app {

/// What `--help` prints, in lines of at most `width` characters where words allow. Command lines that can be
/// pasted are not cut.
std::string help_text(const CommandTable& command, std::size_t width);

/// "apriltrack track [OPTIONS] [INPUT]"
std::string usage_of(const CommandTable& command);

/// "-h, --help", "--mode ego|joint", "INPUT": how an option is written.
std::string form_of(const OptionRow& option);

/// Its help, with whether it must be given and what holds where it is left out.
std::string full_help_of(const OptionRow& option);

}  // namespace apriltrack::app
