#include "recordings.h"

#include <fmt/format.h>

#include <filesystem>
#include <system_error>
#include <utility>

#include "apriltrack/base/error.h"
#include "inputs.h"

namespace apriltrack::app {

Recording split_input(const std::string& input) {
  const std::size_t equals = input.find('=');
  std::error_code ignored;
  const bool is_named = equals != std::string::npos && equals > 0 && input.find('/') > equals &&
                        !std::filesystem::exists(input, ignored);
  if (!is_named) return {"", input, false};
  if (equals + 1 == input.size())
    throw invalid_input("INPUT",
                        fmt::format("'{}' names a camera, but no recording: write {}PATH, without a blank "
                                    "after the =",
                                    input, input));
  return {input.substr(0, equals), input.substr(equals + 1), true};
}

std::vector<Recording> parse_recordings(const std::vector<std::string>& inputs, const CameraRig& rig,
                                        const std::string& camera_name) {
  std::vector<Recording> recordings;
  for (const std::string& input : inputs) {
    Recording recording = split_input(input);
    if (recording.is_named && !camera_name.empty())
      throw invalid_input(
          "--camera-name",
          fmt::format("is '{}', but the input {} names its camera: leave one out", camera_name, input));
    if (!camera_name.empty()) recording = {camera_name, input, true};
    const std::string where = camera_name.empty() ? input : "--camera-name";
    recording.camera =
        recording.is_named ? camera_named(rig, recording.camera, where).name : rig.cameras.front().name;
    recordings.push_back(std::move(recording));
  }
  return recordings;
}

}  // namespace apriltrack::app
