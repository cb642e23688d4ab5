#include "camera_words.h"

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

std::string in_words(const CameraCorrection& one) {
  if (one.parameter == "focal length" || one.parameter == "fy / fx")
    return fmt::format("{} {:+.2f} % (sigma {:.2f})", one.parameter, 100.0 * one.value, 100.0 * one.sigma);
  return fmt::format("{} {:+.4g} {}(sigma {:.2g})", one.parameter, one.value,
                     one.unit == "1" ? "" : one.unit + " ", one.sigma);
}

std::string in_words(const Observations& observations, const EstimatedParameter& one) {
  const RigCamera& camera = observations.cameras[static_cast<std::size_t>(one.parameter.camera)];
  return camera.name + ": " +
         in_words(CameraCorrection{camera.name, name_of(one.parameter, camera), unit_of(one.parameter),
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
      told.push_back(in_words(observations, one));
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
                     "is without it, and its covariances count it. Check T_cn_cnm1, or take what fits by "
                     "--extrinsics refine",
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
      "error --edge-offset-sigma 0",
      fmt::join(edges, "; "), is_counted);
}

}  // namespace

std::string gain_of(const CameraRefinement& cameras) {
  return fmt::format("frames that were held out agree better ({:.2f} sigmas before, {:.2f} after)",
                     cameras.held_out_before, cameras.held_out_after);
}

std::vector<std::string> doubts_of_cameras(const Observations& observations, const BetterCameras& cameras) {
  std::vector<std::string> doubts;
  if (const auto& lens = cameras.lens_not_taken)
    doubts.push_back(fmt::format(
        "the camera file does not fit: with other intrinsics, {}. It is kept, as --intrinsics keep says: "
        "calibrate the camera anew, or leave that option away",
        gain_of(*lens)));
  if (const auto& places = cameras.places_not_taken)
    doubts.push_back(fmt::format(
        "the rig of the camera file does not fit: with the cameras at other places ({} from the file's), {}. "
        "Check T_cn_cnm1 (metres; of a point in camera n-1 it makes one in camera n), or take what fits by "
        "--extrinsics refine",
        places_in_words(observations, *places), gain_of(*places)));
  if (std::string open = open_cameras_in_words(observations, cameras); !open.empty())
    doubts.push_back(std::move(open));
  return doubts;
}

std::string corrections_in_words(const CameraRefinement& cameras,
                                 const std::vector<CameraCorrection>& corrections) {
  std::string words;
  for (const CameraCorrection& one : corrections)
    words += fmt::format("{}{}: {}", words.empty() ? "" : "; ", one.camera, in_words(one));
  const auto has = [&](bool (CameraParameter::*is_of)() const) {
    return std::ranges::any_of(cameras.estimates,
                               [&](const EstimatedParameter& one) { return (one.parameter.*is_of)(); });
  };
  const bool has_lens = has(&CameraParameter::is_of_lens), has_places = has(&CameraParameter::is_of_place);
  const std::string what = !has_places ? "intrinsics" : has_lens ? "intrinsics and places" : "places";
  const std::string why = cameras.held_out_before > 0.0
                              ? fmt::format("with other {}, {}", what, gain_of(cameras))
                              : std::string("with another lens, far more of the views agree");
  return fmt::format(
      "the camera file does not fit: {}. The map rests on these {}: {}. Track with the refined camera, or "
      "calibrate it anew{}",
      why, what, words, has_lens ? "; --intrinsics keep takes the file as it is" : "");
}

}  // namespace apriltrack
