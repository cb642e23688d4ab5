// Fuzzer of the header below.

#include "apriltrack/eval/frame_log.h"

#include "fuzz_input.h"

namespace fuzz = apriltrack::fuzz;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto path = fuzz::file_of(fuzz::text_of(data, size));
  std::vector<apriltrack::FrameLogRow> rows;
  if (!fuzz::reads([&] { rows = apriltrack::read_frame_log(path); })) return 0;
  apriltrack::write_frame_log(fuzz::file_of("", ".written"), rows);
  return 0;
}
