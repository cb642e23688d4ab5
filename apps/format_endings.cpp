#include "format_endings.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "apriltrack/base/error.h"
#include "apriltrack/io/lower_case.h"
#include "apriltrack/io/staged_files.h"

namespace apriltrack::app {

std::span<const FormatEnding> map_endings() {
  static const std::vector<std::string_view> yaml = {"apriltrack", "apriltag_ros", "apriltag_ros2",
                                                     "tagslam",    "aruco",        "kalibr"};
  static const std::vector<FormatEnding> endings = {{".yaml", yaml},
                                                    {".yml", yaml},
                                                    {".json", {"wpilib", "corners-json"}},
                                                    {".csv", {"wpilib-csv", "corners-csv"}},
                                                    {".fmap", {"limelight"}},
                                                    {".ini", {"rtabmap"}},
                                                    {".gltf", {"gltf"}},
                                                    {".glb", {"glb"}},
                                                    {".urdf", {"urdf"}},
                                                    {".sdf", {"sdf"}},
                                                    {".g2o", {"g2o"}}};
  return endings;
}

std::span<const FormatEnding> camera_endings() {
  static const std::vector<std::string_view> yaml = {"kalibr", "ros", "opencv"};
  static const std::vector<FormatEnding> endings = {
      {".yaml", yaml}, {".yml", yaml}, {".json", {"wpilib", "photonvision"}}, {".cameramodel", {"mrcal"}}};
  return endings;
}

std::span<const FormatEnding> trajectory_endings() {
  // Tables by commas are many programs', so that .csv promises EuRoC's less than .kitti KITTI's.
  static const std::vector<FormatEnding> endings = {
      {".tum", {"tum"}}, {".csv", {"euroc", "csv"}}, {".kitti", {"kitti"}}, {"kitti.txt", {"kitti", "txt"}}};
  return endings;
}

void check_ending(const std::string& output, std::string_view format, std::span<const FormatEnding> endings,
                  std::string_view option, const Console& console) {
  if (is_written_directly(output)) return;
  const auto found = std::ranges::find_if(
      endings, [&](const FormatEnding& one) { return lower_case(output).ends_with(one.ending); });
  if (found == endings.end() || std::ranges::find(found->formats, format) != found->formats.end()) return;
  if (found->formats.size() == 1)
    throw invalid_input(
        option,
        fmt::format("{} is not what {} in '{}' says, which is {}'s alone: name a file "
                    "that ends otherwise, or give {} {}",
                    format, found->ending, output, found->formats.front(), option, found->formats.front()));
  console.warning(
      fmt::format("'{}' is written as {} says, {}, though its name ends in {} as files of other "
                  "formats do: readers that go by the name will not know it",
                  output, option, format, found->ending));
}

}  // namespace apriltrack::app
