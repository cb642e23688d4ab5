#include "messages/camera_messages.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <string_view>
#include <utility>

#include "apriltrack/base/degrees.h"

namespace apriltrack {
namespace {

constexpr double kToldOff = 3.0;  // standard deviations

std::string text_of(const CameraCorrection& one) {
  if (one.parameter == "focal length" || one.parameter == "fy / fx")
    return fmt::format("{} {:+.2f} % (sigma {:.2f})", one.parameter, 100.0 * one.value, 100.0 * one.sigma);
  return fmt::format("{} {:+.4g} {}(sigma {:.2g})", one.parameter, one.value,
                     one.unit == "1" ? "" : one.unit + " ", one.sigma);
}

std::string text_of(const Observations& observations, const EstimatedParameter& one) {
  const RigCamera& camera = observations.cameras[static_cast<std::size_t>(one.parameter.camera)];
  return camera.name + ": " +
         text_of(CameraCorrection{camera.name, name_of(one.parameter, camera), unit_of(one.parameter),
                                  one.value, one.sigma});
}

/// "cam1 0.012 m and 0.3 degrees": how far the places of cameras are from the file's.
std::string places_in_words(const Observations& observations, const CameraRefinement& cameras) {
  std::map<int, std::pair<double, double>> squares;
  for (const EstimatedParameter& one : cameras.estimates) {
    if (one.parameter.kind == CameraParameter::Kind::kTranslation)
      squares[one.parameter.camera].first += one.value * one.value;
    if (one.parameter.kind == CameraParameter::Kind::kRotation)
      squares[one.parameter.camera].second += one.value * one.value;
  }
  std::string words;
  for (const auto& [camera, of] : squares)
    words += fmt::format("{}{} {:.2g} m and {:.2g} degrees", words.empty() ? "" : ", ",
                         observations.cameras[static_cast<std::size_t>(camera)].name, std::sqrt(of.first),
                         std::sqrt(of.second) * kDegPerRad);
  return words;
}

/// Of what is open, the numbers that are worth telling.
std::vector<std::string> told_of(const Observations& observations, const CameraRefinement& open,
                                 bool (*is_meant)(const CameraParameter&)) {
  std::vector<std::string> told;
  for (const EstimatedParameter& one : open.estimates)
    if (is_meant(one.parameter) && std::abs(one.value) > kToldOff * one.sigma)
      told.push_back(text_of(observations, one));
  return told;
}

/// By what the map may be wrong, though it is not by more than its covariances say. Where frames do tell,
/// that is said already.
std::string open_cameras_in_words(const Observations& observations, const BetterCameras& cameras) {
  if (!cameras.open) return "";
  const auto lenses = told_of(observations, *cameras.open, [](const auto& one) { return one.is_of_lens(); });
  const auto places = told_of(observations, *cameras.open, [](const auto& one) { return one.is_of_place(); });
  const auto edges = told_of(observations, *cameras.open,
                             [](const auto& one) { return !one.is_of_lens() && !one.is_of_place(); });
  const std::string_view is_counted =
      "and too few frames tell whether: the map is without it, and its covariances count it";
  if (!places.empty())
    return cameras.places_not_taken
               ? ""
               : fmt::format(
                     "the cameras look as if they sat at other places than the camera file's ({}): the map "
                     "is without it, and its covariances count it. Check T_cn_cnm1, or let the extrinsics be "
                     "refined",
                     fmt::join(places, "; "));
  const bool are_places_open = std::ranges::any_of(
      cameras.open->estimates, [](const EstimatedParameter& one) { return one.parameter.is_of_place(); });
  if (lenses.empty() && are_places_open)
    return edges.empty() ? ""
                         : fmt::format(
                               "an edge offset goes with the places of the cameras ({} with others), "
                               "which scale the map, and its covariances count both. Check T_cn_cnm1",
                               fmt::join(edges, "; "));
  if (!lenses.empty() && cameras.lens_not_taken) return "";
  if (!lenses.empty())
    return fmt::format(
        "the views look as if the lens were another one than the camera file's ({}), {}. Is the "
        "file of this camera, zoom and resolution? Film more frames, from near and far and from "
        "the side, or calibrate the camera",
        fmt::join(lenses, "; "), is_counted);
  if (edges.empty()) return "";
  return fmt::format(
      "corners look as if edges lay inside the true ones, or outside ({}), which moves tags and "
      "scales the map, {}. Film more frames, from near and far; for corners without such an "
      "error set the sigma of edge offsets to 0",
      fmt::join(edges, "; "), is_counted);
}

/// "frames that were held out agree better (1.21 sigmas before, 0.92 after)".
std::string gain_of(const CameraRefinement& cameras) {
  return fmt::format("frames that were held out agree better ({:.2f} sigmas before, {:.2f} after)",
                     cameras.held_out_before, cameras.held_out_after);
}

std::vector<std::string> names_of(const Observations& observations, const CameraRefinement& cameras) {
  std::vector<std::string> names;
  for (const EstimatedParameter& one : cameras.estimates) {
    const std::string& name = observations.cameras[static_cast<std::size_t>(one.parameter.camera)].name;
    if (std::ranges::find(names, name) == names.end()) names.push_back(name);
  }
  return names;
}

CalibrationFinding finding_of(CalibrationFinding::Kind kind, std::vector<std::string> cameras,
                              std::string message) {
  CalibrationFinding finding;
  finding.kind = kind;
  finding.cameras = std::move(cameras);
  finding.message = std::move(message);
  return finding;
}

}  // namespace

std::vector<CalibrationFinding> doubts_of_cameras(const Observations& observations,
                                                  const BetterCameras& cameras) {
  using Kind = CalibrationFinding::Kind;
  std::vector<CalibrationFinding> doubts;
  if (const auto& lens = cameras.lens_not_taken)
    doubts.push_back(finding_of(
        Kind::kOtherLens, names_of(observations, *lens),
        fmt::format("the camera file does not fit: with other intrinsics, {}. It is kept, as was asked "
                    "for: calibrate the camera anew, or let the intrinsics be refined",
                    gain_of(*lens))));
  if (const auto& places = cameras.places_not_taken)
    doubts.push_back(finding_of(
        Kind::kOtherPlaces, names_of(observations, *places),
        fmt::format(
            "the rig of the camera file does not fit: with the cameras at other places ({} from the "
            "file's), {}. Check T_cn_cnm1 (metres; of a point in camera n-1 it makes one in camera n), "
            "or let the extrinsics be refined",
            places_in_words(observations, *places), gain_of(*places))));
  if (std::string open = open_cameras_in_words(observations, cameras); !open.empty())
    doubts.push_back(finding_of(Kind::kOpenCamera, names_of(observations, *cameras.open), std::move(open)));
  return doubts;
}

CalibrationFinding reported(const CameraRefinement& cameras,
                            const std::vector<CameraCorrection>& corrections) {
  std::string words;
  std::vector<std::string> names;
  for (const CameraCorrection& one : corrections) {
    words += fmt::format("{}{}: {}", words.empty() ? "" : "; ", one.camera, text_of(one));
    if (std::ranges::find(names, one.camera) == names.end()) names.push_back(one.camera);
  }
  const auto has = [&](bool (CameraParameter::*is_of)() const) {
    return std::ranges::any_of(cameras.estimates,
                               [&](const EstimatedParameter& one) { return (one.parameter.*is_of)(); });
  };
  const bool has_lens = has(&CameraParameter::is_of_lens), has_places = has(&CameraParameter::is_of_place);
  const std::string what = !has_places ? "intrinsics" : has_lens ? "intrinsics and places" : "places";
  const std::string why = cameras.held_out_before > 0.0
                              ? fmt::format("with other {}, {}", what, gain_of(cameras))
                              : std::string("with another lens, far more of the views agree");
  return finding_of(
      CalibrationFinding::Kind::kCameraCorrected, std::move(names),
      fmt::format("the camera file does not fit: {}. The map rests on these {}: {}. Track with the refined "
                  "camera, or calibrate it anew{}",
                  why, what, words,
                  has_lens ? "; the intrinsics can be kept as the file has them, too" : ""));
}

std::string message_of(const Observations& observations, const LensDoubt& doubt) {
  return fmt::format("by the lens that the camera file has of {}, the tags do not look square",
                     observations.cameras[static_cast<std::size_t>(doubt.camera)].name);
}

CalibrationFinding reported(const Observations& observations, const LensDoubt& doubt,
                            const CalibrationOptions& options) {
  const std::string why =
      doubt.why == LensDoubt::Why::kKeptByOption
          ? "It is kept, as was asked for: calibrate the camera anew, or let the intrinsics be refined"
          : fmt::format(
                "It is kept, for maps of more than {} tags keep their cameras: map some of the tags "
                "first, and give the refined camera",
                options.max_tags_with_covariance);
  return finding_of(CalibrationFinding::Kind::kOtherLens,
                    {observations.cameras[static_cast<std::size_t>(doubt.camera)].name},
                    message_of(observations, doubt) + ". " + why);
}

std::vector<CalibrationFinding> unusual_edges(const std::vector<CameraCorrection>& corrections,
                                              const CalibrationOptions& options) {
  constexpr double kUsual = 2.5;  // of the expected sizes: one camera in 80 is beyond
  std::vector<CalibrationFinding> findings;
  for (const CameraCorrection& one : corrections) {
    if (!one.is_of_edges() || !(std::abs(one.value) > kUsual * options.edge_offset_sigma_px)) continue;
    findings.push_back(finding_of(
        CalibrationFinding::Kind::kEdgeOffset, {one.camera},
        fmt::format("{}: edges are found {:.2f} px aside of where the detector has them (edge offset, sigma "
                    "{:.2f}), more than is usual (sigma {:.3g}): if that is wrong, so is the "
                    "scale of the map. Film from nearer and from further aside, give a measured distance "
                    "as a constraint, or refuse it: a sigma of 0"
                    " estimates none",
                    one.camera, one.value, one.sigma, options.edge_offset_sigma_px)));
    findings.back().value = one.value;
    findings.back().sigma = one.sigma;
    findings.back().unit = "px";
  }
  return findings;
}

}  // namespace apriltrack
