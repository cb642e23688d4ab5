#include "apriltrack/tags/tag_key.h"

namespace apriltrack {

std::string to_string(const TagKey& key) {
  return key.family + "/" + std::to_string(key.id);
}

}  // namespace apriltrack
