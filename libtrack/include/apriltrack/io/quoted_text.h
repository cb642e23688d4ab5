#pragma once

#include <string>
#include <string_view>

namespace apriltrack {

/// In double quotes, as both JSON and YAML read it. Bytes beyond ASCII stay as they are.
std::string quoted_text(std::string_view text);

}  // namespace apriltrack
