// Fuzzer of the header below.

#include "apriltrack/detect/detections_csv.h"

#include "fuzz_input.h"

namespace fuzz = apriltrack::fuzz;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto path = fuzz::file_of(fuzz::text_of(data, size));
  std::vector<apriltrack::FrameDetections> frames;
  if (!fuzz::reads([&] { frames = apriltrack::read_detections_csv(path); })) return 0;
  fuzz::reads([&] { apriltrack::write_detections_csv(fuzz::file_of("", ".written"), frames); });
  return 0;
}
