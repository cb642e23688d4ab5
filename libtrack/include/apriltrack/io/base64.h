#pragma once

#include <string>
#include <string_view>

namespace apriltrack {

/// RFC 4648, section 4: the usual alphabet, padded.
std::string base64(std::string_view bytes);

}  // namespace apriltrack
