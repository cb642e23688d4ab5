#include "inputs.h"

#include <fmt/format.h>

#include "apriltrack/base/error.h"
#include "apriltrack/source/frame_source.h"

namespace apriltrack::app {

std::filesystem::path file_or_own(const std::string& given, const std::optional<std::filesystem::path>& own,
                                  std::string_view option, std::string_view name) {
  if (!given.empty()) return given;
  if (own) return *own;
  throw invalid_input(option,
                      fmt::format("is required: the input is no sequence folder with a {} of its own", name));
}

Camera read_camera(const std::filesystem::path& path, const std::string& name, const Console& console) {
  const CameraRig rig = read_cameras(path, console.log());
  return name.empty() ? rig.cameras.front() : rig.find(name);
}

Camera with_resolution_of_images(Camera camera, const std::string& input) {
  if (camera.width > 0 && camera.height > 0) return camera;
  SourceOptions options;
  options.rate_hz = 1.0;  // when the images were taken is not asked here
  const std::unique_ptr<FrameSource> source = open_source(input, options);
  while (const std::optional<SourceFrame> frame = source->next()) {
    if (!frame->is_readable()) continue;
    camera.width = frame->pixels.width();
    camera.height = frame->pixels.height();
    break;
  }
  return camera;
}

void check_folder_of(const std::filesystem::path& output) {
  const std::filesystem::path folder = output.parent_path();
  if (!folder.empty() && !std::filesystem::is_directory(folder))
    throw io_error(output.string(), "cannot be written: there is no such folder");
}

}  // namespace apriltrack::app
