#pragma once

#include <string>

namespace apriltrack {

/// INPUT that is standard input.
inline constexpr const char* kStandardInput = "-";

/// Whether it is standard input or a FIFO (/dev/stdin, /dev/fd/N of a shell's <(...)): it is read once, from
/// its beginning to its end, and nothing may look into it beforehand.
bool is_pipe_input(const std::string& input);

}  // namespace apriltrack
