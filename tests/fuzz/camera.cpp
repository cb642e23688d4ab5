// Every camera file, by the door that recognises them; what was read is written in every format.

#include "apriltrack/camera/auto_response.h"
#include "apriltrack/camera/camera_formats.h"
#include "apriltrack/camera/response_tables.h"
#include "apriltrack/camera/ros_topics.h"
#include "fuzz_input.h"

namespace fuzz = apriltrack::fuzz;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto path = fuzz::file_of(fuzz::text_of(data, size));
  fuzz::reads([&] { apriltrack::ros_topics(path); });
  fuzz::reads([&] { apriltrack::response_tables(path); });
  fuzz::reads([&] { apriltrack::read_cameras_to_estimate(path); });
  apriltrack::CameraFile file;
  if (!fuzz::reads([&] {
        file =
            apriltrack::read_camera_file(path, apriltrack::silent_log(), apriltrack::BeyondOurLenses::kFit);
      }))
    return 0;
  const auto written = fuzz::file_of("", ".written");
  for (const apriltrack::CameraFormatInfo& format : apriltrack::camera_formats())
    fuzz::reads([&] { apriltrack::write_cameras_as(written, file.rig, format.format); });
  return 0;
}
