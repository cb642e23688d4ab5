// Fuzzer of the header below.

#include "apriltrack/tags/tag_sizes.h"

#include "fuzz_input.h"

namespace fuzz = apriltrack::fuzz;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto path = fuzz::file_of(fuzz::text_of(data, size));
  fuzz::reads([&] { apriltrack::read_tag_sizes(path, std::nullopt); });
  return 0;
}
