#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace apriltrack {

/// RFC 4648, section 4: the usual alphabet, padded.
std::string base64(std::string_view bytes);

/// The bytes that such a text stands for, with or without the = at its end; nullopt where it is none.
std::optional<std::string> bytes_of_base64(std::string_view text);

}  // namespace apriltrack
