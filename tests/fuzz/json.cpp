// JSON: the tree, and each way to ask it.

#include "apriltrack/io/yaml_reader.h"
#include "fuzz_input.h"

namespace {

void ask(const apriltrack::YamlNode& node) {
  const auto tries = [](const auto& function) {
    try {
      function();
    } catch (const apriltrack::Error&) {
    }
  };
  tries([&] { node.as_string(); });
  tries([&] { node.as_double(); });
  tries([&] { node.as_int(); });
  tries([&] { node.as_bool(); });
  tries([&] { node.as_doubles(); });
  node.as_yaml();
  if (node.is_list())
    for (const apriltrack::YamlNode& item : node.items()) ask(item);
  if (node.is_map())
    for (const auto& [key, value] : node.entries()) ask(value);
}

}  // namespace

namespace fuzz = apriltrack::fuzz;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string text(fuzz::text_of(data, size));
  fuzz::reads([&] { ask(apriltrack::YamlNode::read_json_text(text, "x")); });
  return 0;
}
