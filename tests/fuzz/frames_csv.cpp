// Exposures and gains of a sequence, and the list of a EuRoC camera.

#include "apriltrack/io/csv.h"
#include "fuzz_input.h"
#include "image_times.h"

namespace fuzz = apriltrack::fuzz;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto path = fuzz::file_of(fuzz::text_of(data, size), ".csv");
  std::vector<apriltrack::ImageEntry> images(3);
  for (std::size_t i = 0; i < images.size(); ++i)
    images[i] = {.path = "x.png", .timestamp = {static_cast<std::int64_t>(1000 * i)}};
  fuzz::reads([&] { apriltrack::add_frame_facts(path, images, apriltrack::silent_log()); });
  return 0;
}
