// Fuzzer of the header below.

#include "apriltrack/eval/trajectory.h"
#include "fuzz_input.h"

namespace fuzz = apriltrack::fuzz;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto path = fuzz::file_of(fuzz::text_of(data, size));
  apriltrack::Trajectory trajectory;
  if (!fuzz::reads([&] { trajectory = apriltrack::read_tum(path); })) return 0;
  fuzz::reads([&] { apriltrack::write_tum(fuzz::file_of("", ".written"), trajectory); });
  return 0;
}
