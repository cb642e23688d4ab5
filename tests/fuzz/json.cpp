// JSON: the tree, and each way to ask it.

#include "apriltrack/io/yaml_reader.h"
#include "ask_node.h"
#include "fuzz_input.h"

namespace fuzz = apriltrack::fuzz;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string text(fuzz::text_of(data, size));
  fuzz::reads([&] { fuzz::ask(apriltrack::YamlNode::read_json_text(text, "x")); });
  return 0;
}
