// Every layout of tags, by the door that recognises them; what was read is written in every format.

#include "apriltrack/tags/map_formats.h"
#include "fuzz_input.h"

namespace fuzz = apriltrack::fuzz;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto path = fuzz::file_of(fuzz::text_of(data, size));
  apriltrack::MapReading reading;
  apriltrack::MapReadOptions options;
  options.sizes.set_default(0.16);
  if (!fuzz::reads([&] { reading = apriltrack::read_tag_map(path, options); })) return 0;
  const auto written = fuzz::file_of("", ".written");
  for (const apriltrack::MapFormatInfo& format : apriltrack::map_formats())
    fuzz::reads([&] { apriltrack::write_tag_map_as(written, reading.map, format.format); });
  return 0;
}
