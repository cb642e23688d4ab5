#include "tag_fields.h"

#include <fmt/format.h>

#include "apriltrack/tags/tag_family.h"
#include "family_source.h"

namespace apriltrack {

double read_tag_size(const YamlNode& node) {
  const double size_m = node.as_double();
  constexpr double kMaxSize_m = 100.0;  // as --tag-size: beyond, it was given in millimetres
  if (!(size_m > 0.0 && size_m <= kMaxSize_m)) {
    node.fail(fmt::format("must be > 0 and at most {:g} (is {}); metres, the edge of the detected square",
                          kMaxSize_m, size_m));
  }
  return size_m;
}

void expect_known_family(const YamlNode& node, const std::string& family) {
  if (!TagFamily::is_known(family)) node.fail(unknown_family_message(family));
}

void expect_id_of_family(const YamlNode& node, const TagKey& key) {
  const int num_codes = TagFamily::get(key.family).num_codes();
  if (key.id < 0 || key.id >= num_codes) {
    node.fail(fmt::format("{} has ids 0 to {} (is {})", key.family, num_codes - 1, key.id));
  }
}

}  // namespace apriltrack
