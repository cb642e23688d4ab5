#include "option_hints.h"

#include <fmt/format.h>

#include <string_view>
#include <utility>

namespace apriltrack::app {
namespace {

using Kind = CalibrationFinding::Kind;

/// Empty where no option helps.
std::string_view hint_of(Kind kind) {
  switch (kind) {
    case Kind::kWrongSize:
    case Kind::kSizeGroups:
    case Kind::kUnusualSize:
      return "sizes are stated by --tag-size, and of single tags by --tag-sizes";
    case Kind::kPrintAnisotropy:
    case Kind::kCameraCorrected:
      return "--intrinsics keep takes the camera file as it is";
    case Kind::kOtherLens:
      return "--intrinsics auto lets them be refined";
    case Kind::kOtherPlaces:
      return "--extrinsics refine takes what fits";
    case Kind::kOpenCamera:
      return "--extrinsics refine takes other places of cameras, --edge-offset-sigma 0 refuses edge offsets";
    case Kind::kEdgeOffset:
      return "--constraints gives a measured distance, --edge-offset-sigma how far edges usually lie off";
    case Kind::kRarelyWithOthers:
      return "--min-views says how many frames it takes";
    default:
      return "";
  }
}

constexpr std::pair<std::string_view, std::string_view> kOptions[] = {
    {"held_tag", "--held-tag"}, {"sizes", "--tag-size"}, {"constraints", "--constraints"}};

}  // namespace

std::string message_with_options(const CalibrationFinding& finding) {
  const std::string_view hint = hint_of(finding.kind);
  return hint.empty() ? finding.message : fmt::format("{} ({})", finding.message, hint);
}

Error with_options(const Error& error) {
  for (const auto& [name, option] : kOptions) {
    if (error.where() != name) continue;
    const bool is_of_sizes = option == "--tag-size";
    return Error(error.kind(), option,
                 std::string(error.cause()) + (is_of_sizes ? " (--tag-size METRES, --tag-sizes FILE)" : ""));
  }
  return error;
}

}  // namespace apriltrack::app
