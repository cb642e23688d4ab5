#include "apriltrack/tags/tag_sizes.h"

#include <fmt/format.h>

#include "apriltrack/io/yaml_reader.h"
#include "tag_fields.h"

namespace apriltrack {
namespace {

void read_size(const std::string& name, const YamlNode& value, TagSizes& sizes) {
  const auto key = parse_tag_key(name);
  if (!key) value.fail(fmt::format("'{}' is no tag: write ID or family/ID, such as 7 or tag36h11/7", name));
  const double size_m = read_tag_size(value);
  if (name.find('/') == std::string::npos) {
    sizes.set(key->id, size_m);
    return;
  }
  expect_known_family(value, key->family);
  expect_id_of_family(value, *key);
  sizes.set(*key, size_m);
}

}  // namespace

std::optional<double> TagSizes::find(const TagKey& key) const {
  if (const auto exact = sizes_m_.find(key); exact != sizes_m_.end()) return exact->second;
  if (const auto by_id = sizes_by_id_m_.find(key.id); by_id != sizes_by_id_m_.end()) return by_id->second;
  return default_size_m_;
}

TagSizes read_tag_sizes(const std::filesystem::path& path, std::optional<double> fallback_size_m) {
  const YamlNode root = YamlNode::read_file(path);
  root.expect_keys({"default", "sizes"});
  TagSizes sizes(fallback_size_m);
  const auto default_size = root.find("default");
  const auto named = root.find("sizes");
  if (!default_size && !named) root.fail("gives no size: write 'default: METRES' or 'sizes: {ID: METRES}'");
  if (default_size) sizes.set_default(read_tag_size(*default_size));
  if (named) {
    for (const auto& [name, value] : named->entries()) read_size(name, value, sizes);
  }
  return sizes;
}

}  // namespace apriltrack
