#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace apriltrack {

/// The bytes that a text in base64 (RFC 4648, section 4) stands for, with or without the = at its end;
/// nullopt where it is none.
std::optional<std::string> bytes_of_base64(std::string_view text);

}  // namespace apriltrack
