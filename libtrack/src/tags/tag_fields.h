#pragma once

#include <string>

#include "apriltrack/io/yaml_reader.h"
#include "apriltrack/tags/tag_key.h"

namespace apriltrack {

/// The edge length of a tag, metres; complains unless it is finite and > 0.
double read_tag_size(const YamlNode& node);

/// Complains at `node` unless there is such a family.
void expect_known_family(const YamlNode& node, const std::string& family);

/// Complains at `node` unless the family has the id. Requires a known family.
void expect_id_of_family(const YamlNode& node, const TagKey& key);

}  // namespace apriltrack
