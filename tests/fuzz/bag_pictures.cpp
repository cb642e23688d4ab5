// Bags as a source of pictures, and as the camera of these.

#include "apriltrack/source/bag_input.h"
#include "apriltrack/source/frame_source.h"
#include "fuzz_input.h"

namespace fuzz = apriltrack::fuzz;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto path = fuzz::file_of(fuzz::text_of(data, size));
  if (!apriltrack::is_bag_input(path.string())) return 0;
  fuzz::reads([&] { apriltrack::bag_camera(path.string(), "", apriltrack::silent_log()); });
  apriltrack::SourceOptions options;
  options.rate_hz = 10.0;
  std::unique_ptr<apriltrack::FrameSource> source;
  if (!fuzz::reads([&] { source = apriltrack::open_source(path.string(), options); })) return 0;
  for (int i = 0; i < 30 && source->next(); ++i) {
  }
  return 0;
}
