#include "calibrate_report_tables.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string_view>
#include <utility>

#include "apriltrack/base/degrees.h"
#include "apriltrack/base/version.h"
#include "apriltrack/eval/statistics.h"
#include "apriltrack/report/map_scene.h"

namespace apriltrack::app {
namespace {

double position_sigma_mm(const Matrix6d& covariance) {
  return 1e3 * position_sigma_m(covariance);
}

double rotation_sigma_deg(const Matrix6d& covariance) {
  return kDegPerRad * rotation_sigma_rad(covariance);
}

std::string claims(const TagMap& map) {
  std::vector<double> position_mm, rotation_deg;
  for (const MapTag& tag : map.tags) {
    if (!tag.covariance || tag.covariance->isZero()) continue;
    position_mm.push_back(position_sigma_mm(*tag.covariance));
    rotation_deg.push_back(rotation_sigma_deg(*tag.covariance));
  }
  if (position_mm.empty()) return "";
  return fmt::format(
      " In the map's frame, their places are known to {:.2f} mm and {:.3f} degrees (median sigma; at "
      "worst {:.2f} mm and {:.3f} degrees).",
      median(position_mm), median(rotation_deg), *std::ranges::max_element(position_mm),
      *std::ranges::max_element(rotation_deg));
}

std::string number_or_dash(const std::optional<double>& value, int digits) {
  return value ? fmt::format("{:.{}f}", *value, digits) : std::string("-");
}

/// In few letters: "about x 0.30 degrees"; between axes "about x+y".
std::string direction_of(const MapAssessment& assessment, const TagKey& key) {
  const auto one = std::ranges::find(assessment.directions, key, &WeakDirection::tag);
  if (one == assessment.directions.end()) return "-";
  constexpr double kNotable = 0.34;  // 20 degrees off the others
  std::string axis;
  double first = 0.0;
  for (Eigen::Index i = 0; i < 3; ++i) {
    const double along = one->axis[i];
    if (std::abs(along) < kNotable) continue;
    if (axis.empty()) first = along;  // an axis may be turned about: its first letter has no sign
    axis += (axis.empty() ? "" : first * along < 0.0 ? "-" : "+") + std::string(1, "xyz"[i]);
  }
  std::string text = one->is_rotation ? fmt::format("about {} {:.2f}\xC2\xB0", axis, kDegPerRad * one->sigma)
                                      : fmt::format("along {} {:.2f} mm", axis, 1e3 * one->sigma);
  constexpr std::string_view kUnbroken = "\xC2\xA0";  // a blank at which no line ends
  for (auto at = text.find(' '); at != std::string::npos; at = text.find(' ', at))
    text.replace(at, 1, kUnbroken);
  return text;
}

/// By its id alone, where that tells it.
std::string short_name(const TagMap& map, const TagKey& key) {
  const bool is_unique =
      std::ranges::count_if(map.tags, [&](const MapTag& tag) { return tag.key.id == key.id; }) == 1;
  return is_unique ? fmt::format("{}", key.id) : to_string(key);
}

std::string outcome_of(const ResponseFinding& finding) {
  if (finding.origin == ResponseOrigin::kEstimated)
    return finding.is_asked ? "estimated from them, as was asked for"
                            : "estimated from them, for the camera file states none";
  if (!finding.estimate.is_found()) return "in doubt: " + words_of_doubt(finding.estimate);
  if (finding.estimate.contradicts_assumed)
    return fmt::format("wrong: the pictures say {}", finding.estimate.response.name());
  if (finding.differs())
    return fmt::format("the pictures say {}, not beyond doubt", finding.estimate.response.name());
  return "the pictures agree";
}

/// What a number of this unit is told in, and how many of that it is.
std::pair<std::string, double> unit_for_people(const std::string& unit) {
  if (unit == "m") return {"mm", 1e3};
  if (unit == "rad") return {"degrees", kDegPerRad};
  return {unit == "1" ? "-" : unit, 1.0};
}

std::string or_dash(const std::string& text) {
  return text.empty() ? "-" : text;
}

}  // namespace

std::string verdict(const CalibrateRun& run) {
  const CalibrationResult& result = run.result;
  std::string text = fmt::format(
      "{} tags are in the map, from {} of {} frames; {}. {} views of tags were used, {} "
      "rejected; the corners agree with the map to {:.3f} px (root mean square per axis).",
      result.map.tags.size(), result.frames_used, run.sightings.counts.readable, result.gauge,
      result.observations_used, result.observations_rejected, result.residual_rms_px);
  text += claims(result.map);
  if (!result.left_out.empty()) {
    std::vector<std::string> names;
    for (const TagKey& key : result.left_out) names.push_back(to_string(key));
    text += fmt::format(" Left out: {}.", fmt::join(names, ", "));
  }
  if (!result.other_parts.empty())
    text += fmt::format(
        " {} of {} own, which no frame joins to the map, {} below.",
        result.other_parts.size() == 1 ? "A part" : fmt::format("{} parts", result.other_parts.size()),
        result.other_parts.size() == 1 ? "its" : "their",
        result.other_parts.size() == 1 ? "stands" : "stand");
  return text;
}

HtmlTable tags_table(const TagMap& map, const JointCovariance& joint, const MapEvidence& evidence,
                     const MapAssessment& assessment) {
  HtmlTable table{
      {"tag", "size, mm", "views", "rejected", "residual, px", "sigma, mm", "sigma, \xC2\xB0", "relative to",
       "sigma, mm", "sigma, \xC2\xB0", "weakest direction", "flags"},
      {},
      "Sigma: root mean square length of the error that the covariance expects; first relative to "
      "the map's frame, which gathers the errors of all tags between, then relative to the tag that "
      "is seen with it and knows it best. x points right, y down, z into the tag."};
  for (std::size_t i = 0; i < map.tags.size(); ++i) {
    const MapTag& tag = map.tags[i];
    std::optional<double> own_mm, own_deg, relative_mm, relative_deg;
    if (tag.covariance) {
      own_mm = position_sigma_mm(*tag.covariance);
      own_deg = rotation_sigma_deg(*tag.covariance);
    }
    const auto direction = std::ranges::find(assessment.directions, tag.key, &WeakDirection::tag);
    std::string neighbour = "-";
    if (direction != assessment.directions.end()) {
      neighbour = short_name(map, direction->neighbour);
      if (const auto covariance = relative_covariance(map, joint, direction->neighbour, tag.key)) {
        relative_mm = position_sigma_mm(*covariance);
        relative_deg = rotation_sigma_deg(*covariance);
      }
    }
    const bool has_statistics = tag.statistics.has_value();
    table.rows.push_back(
        {to_string(tag.key), fmt::format("{:.4g}", 1e3 * tag.size_m),
         has_statistics ? fmt::format("{}", tag.statistics->views) : "-",
         fmt::format("{}", evidence.rejected[i]),
         has_statistics ? fmt::format("{:.3f}", tag.statistics->residual_rms_px) : "-",
         number_or_dash(own_mm, 2), number_or_dash(own_deg, 3), neighbour, number_or_dash(relative_mm, 2),
         number_or_dash(relative_deg, 3), direction_of(assessment, tag.key),
         has_statistics ? or_dash(fmt::format("{}", fmt::join(tag.statistics->flags, ", "))) : "-"});
  }
  return table;
}

HtmlTable corrections_table(const std::vector<CameraCorrection>& corrections, const std::string& caption) {
  HtmlTable table{{"camera", "what", "correction", "sigma", "unit"},
                  {},
                  "To be added to what was given; of focal lengths and their ratio a share. " + caption};
  for (const CameraCorrection& one : corrections) {
    const auto [unit, factor] = unit_for_people(one.unit);
    table.rows.push_back({one.camera, one.parameter, fmt::format("{:+.5g}", factor * one.value),
                          fmt::format("{:.2g}", factor * one.sigma), unit});
  }
  return table;
}

HtmlTable responses_table(const ResponseFindings& responses) {
  HtmlTable table{{"camera", "taken", "exponent", "sigma", "pictures", "verdict"},
                  {},
                  "Light is grey level to the power of the exponent, as the edges of tags in sharp pictures "
                  "tell it: linear is 1, sRGB about 2.26. With a wrong response edges seem shifted, by up to "
                  "some tenths of a pixel."};
  for (const ResponseFinding& one : responses) {
    const ResponseEstimate& estimate = one.estimate;
    const bool has_exponent = estimate.sigma > 0.0;
    table.rows.push_back({one.camera, one.used(),
                          has_exponent ? fmt::format("{:.2f}", estimate.exponent) : "-",
                          has_exponent ? fmt::format("{:.2f}", estimate.sigma) : "-",
                          std::to_string(estimate.views_used), outcome_of(one)});
  }
  return table;
}

std::string in_words(const std::vector<LensBlur>& lenses) {
  std::vector<std::string> words;
  for (const LensBlur& lens : lenses)
    words.push_back(fmt::format("{} {:.2f} px", lens.camera, lens.sigma_px));
  return fmt::format("{}", fmt::join(words, ", "));
}

std::string words_of_refinement(const RefinementResult& refinement) {
  if (!refinement.is_accepted) return "Not taken: " + refinement.reason + ".";
  return fmt::format(
      "{} tags, on {} pictures of {} moments. Pictures of moments that were held out disagree with the map "
      "by {:.2f} sigmas before and {:.2f} after. Lenses blur (sigma): {}. Places and covariances "
      "above are the refined ones; residuals and the two halves are of corners.",
      refinement.refined.size(), refinement.views_used, refinement.moments_used, refinement.held_out_before,
      refinement.held_out_after, in_words(refinement.lens_blurs));
}

std::string words_of_halves(const CrossValidation& halves) {
  std::string words = halves.words;
  words.front() = 'T';
  return fmt::format(
      "{}. Blocks of neighbouring moments went to the one and the other by turns ({} and {} moments), and a "
      "map was made of each from its corners. Over all tags, the mean squared difference is {:.2f} times "
      "what the covariances expect.",
      words, halves.moments_of_first, halves.moments_of_second, halves.normalised_error_squared);
}

HtmlTable halves_table(const CrossValidation& halves) {
  HtmlTable table{
      {"tag", "differs by, mm", "expected, mm", "differs by, degrees", "expected, degrees",
       "of what is expected"},
      {},
      fmt::format("Both maps with {} held. Expected: from the covariances of both halves. Last: root "
                  "of the squared difference in units of its covariance, over 6; about 1 where "
                  "these are honest.",
                  to_string(halves.held_tag))};
  for (const HalvesOfTag& tag : halves.tags)
    table.rows.push_back({to_string(tag.tag), fmt::format("{:.2f}", 1e3 * tag.difference_m),
                          fmt::format("{:.2f}", 1e3 * tag.sigma_m),
                          fmt::format("{:.3f}", kDegPerRad * tag.difference_rad),
                          fmt::format("{:.3f}", kDegPerRad * tag.sigma_rad),
                          fmt::format("{:.2f}", std::sqrt(tag.normalised_error_squared))});
  return table;
}

HtmlTable calibrate_settings_table(const CalibrateRun& run) {
  const CalibrateOptions& a = run.options;
  HtmlTable table{{"what", "value"}, {}, ""};
  const auto add = [&](std::string what, std::string value) {
    table.rows.push_back({std::move(what), std::move(value)});
  };
  add("program", std::string("apriltrack ") + version());
  add("input", fmt::format("{}", fmt::join(a.detections.empty() ? a.inputs : a.detections, ", ")));
  add("camera", run.camera_file.string());
  add("map", a.output);
  if (a.tag_size_m) add("tag size", fmt::format("{:g} m", *a.tag_size_m));
  if (!a.tag_sizes.empty()) add("sizes by id", a.tag_sizes);
  if (!a.constraints.empty()) add("constraints", a.constraints);
  if (a.detections.empty()) add("families", fmt::format("{}", fmt::join(a.detector.families, ", ")));
  add("least frames together with others", fmt::format("{}", a.calibration.min_views));
  add("intrinsics", name_of_intrinsics(a.calibration.intrinsics));
  add("extrinsics", a.calibration.refine_extrinsics ? "refine" : "keep");
  add("edge offset, sigma", fmt::format("{:g} px", a.calibration.edge_offset_sigma_px));
  const CornerNoise& noise = run.result.evidence.noise;
  add("noise of corners, as expected", fmt::format("{:g} px, correlation {:g} between the ends of an edge",
                                                   noise.sigma_px, noise.end_correlation));
  add("noise of corners, as measured",
      fmt::format("{:.2f} times that where both ends of an edge err alike, {:.2f} times where they err apart",
                  noise.sum_scale, noise.difference_scale));
  return table;
}

}  // namespace apriltrack::app
