// What stands before FFmpeg, and what is made of its answers; FFmpeg itself is not instrumented.

#include "apriltrack/source/decoder_messages.h"
#include "apriltrack/source/frame_source.h"
#include "fuzz_input.h"

namespace fuzz = apriltrack::fuzz;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  apriltrack::silence_decoders();
  const auto path = fuzz::file_of(fuzz::text_of(data, size), ".mkv");
  apriltrack::SourceOptions options;
  options.rate_hz = 10.0;
  std::unique_ptr<apriltrack::FrameSource> source;
  if (!fuzz::reads([&] { source = apriltrack::open_source(path.string(), options); })) return 0;
  for (int i = 0; i < 30 && source->next(); ++i) {
  }
  return 0;
}
