#include "tag_fields.h"

#include "apriltrack/tags/tag_family.h"
#include "family_source.h"
#include "tag_faults.h"

namespace apriltrack {

double read_tag_size(const YamlNode& node) {
  const double size_m = node.as_double();
  if (const auto fault = fault_of_size(size_m)) node.fail(*fault);
  return size_m;
}

void expect_known_family(const YamlNode& node, const std::string& family) {
  if (!TagFamily::is_known(family)) node.fail(unknown_family_message(family));
}

void expect_id_of_family(const YamlNode& node, const TagKey& key) {
  if (const auto fault = fault_of_id(key)) node.fail(*fault);
}

}  // namespace apriltrack
