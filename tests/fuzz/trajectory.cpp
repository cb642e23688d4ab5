// Fuzzer of the header below: content tells the format.

#include "apriltrack/eval/trajectory_formats.h"
#include "fuzz_input.h"

namespace fuzz = apriltrack::fuzz;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto path = fuzz::file_of(fuzz::text_of(data, size));
  apriltrack::TrajectoryReading reading;
  if (!fuzz::reads([&] { reading = apriltrack::read_trajectory_file(path, {.rate_hz = 10.0}); })) return 0;
  for (const apriltrack::TrajectoryFormatInfo& info : apriltrack::trajectory_formats()) {
    fuzz::reads([&] {
      apriltrack::write_trajectory_as(fuzz::file_of("", ".written"), reading.trajectory, info.format);
    });
  }
  return 0;
}
