#pragma once

#include <optional>
#include <string>

#include "apriltrack/tags/tag_key.h"

namespace apriltrack {

/// Why no tag that is printed has this key: "unknown tag family 'x' (known: tag16h5, ...)", or "tag36h11 has
/// ids 0 to 586 (is 9999)"; nullopt when one has.
std::optional<std::string> fault_of_key(const TagKey& key);

}  // namespace apriltrack
