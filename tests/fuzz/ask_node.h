#pragma once

#include "apriltrack/base/error.h"
#include "apriltrack/io/yaml_reader.h"

namespace apriltrack::fuzz {

/// Asks a tree of YAML or JSON in each way there is, node by node. What a node does not hold is refused by
/// Error.
inline void ask(const YamlNode& node) {
  const auto tries = [](const auto& function) {
    try {
      function();
    } catch (const Error&) {
    }
  };
  tries([&] { node.as_string(); });
  tries([&] { node.as_double(); });
  tries([&] { node.as_int(); });
  tries([&] { node.as_bool(); });
  tries([&] { node.as_doubles(); });
  node.as_yaml();
  if (node.is_list())
    for (const YamlNode& item : node.items()) ask(item);
  if (node.is_map())
    for (const auto& [key, value] : node.entries()) ask(value);
}

}  // namespace apriltrack::fuzz
