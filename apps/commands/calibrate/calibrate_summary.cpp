#include "calibrate_summary.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <utility>

#include "calibrate_report_tables.h"
#include "files/corner_claims.h"
#include "files/frame_loop.h"
#include "files/left_out_words.h"
#include "pages/constraint_table.h"

namespace apriltrack::app {
namespace {

std::vector<TagKey> keys_of(const TagMap& map) {
  std::vector<TagKey> keys;
  for (const MapTag& tag : map.tags) keys.push_back(tag.key);
  return keys;
}

nlohmann::json told(const RefinementResult& refinement) {
  nlohmann::json summary = {{"accepted", refinement.is_accepted},
                            {"held_out_before", refinement.held_out_before},
                            {"held_out_after", refinement.held_out_after}};
  if (!refinement.is_accepted) {
    summary["reason"] = refinement.reason;
    return summary;
  }
  summary["tags"] = told_keys(refinement.refined);
  summary["moments_used"] = refinement.moments_used;
  summary["views_used"] = refinement.views_used;
  for (const LensBlur& lens : refinement.lens_blurs) summary["psf_sigma_px"][lens.camera] = lens.sigma_px;
  return summary;
}

nlohmann::json told(const std::vector<CameraCorrection>& corrections) {
  nlohmann::json list = nlohmann::json::array();
  for (const CameraCorrection& one : corrections)
    list.push_back({{"camera", one.camera},
                    {"parameter", one.parameter},
                    {"unit", one.unit},
                    {"value", one.value},
                    {"sigma", one.sigma}});
  return list;
}

template <typename T>
nlohmann::json value_or_null(const std::optional<T>& value) {
  return value ? nlohmann::json(*value) : nlohmann::json(nullptr);
}

nlohmann::json told(const CalibrationFinding& finding) {
  nlohmann::json alternatives = nlohmann::json::array();
  for (const std::vector<TagKey>& board : finding.alternatives) alternatives.push_back(told_keys(board));
  nlohmann::json time_ns = nullptr;
  if (finding.timestamp) time_ns = finding.timestamp->ns;
  return {{"kind", to_string(finding.kind)},
          {"tags", told_keys(finding.tags)},
          {"cameras", finding.cameras},
          {"value", value_or_null(finding.value)},
          {"unit", finding.unit},
          {"sigma", value_or_null(finding.sigma)},
          {"time_ns", std::move(time_ns)},
          {"alternatives", std::move(alternatives)},
          {"in_doubt", finding.is_in_doubt},
          {"left_out", finding.is_left_out},
          {"log_odds", value_or_null(finding.log_odds)},
          {"message", finding.message}};
}

nlohmann::json told(const std::vector<CalibrationFinding>& findings) {
  nlohmann::json list = nlohmann::json::array();
  for (const CalibrationFinding& one : findings) list.push_back(told(one));
  return list;
}

nlohmann::json told(const PrintBatches& batches) {
  return {{"larger", told_keys(batches.larger)},
          {"smaller", told_keys(batches.smaller)},
          {"log_ratio", batches.log_ratio},
          {"sigma", batches.sigma}};
}

nlohmann::json told(const TimeError& error) {
  const bool is_readout = error.kind == TimeError::Kind::kReadout;
  nlohmann::json one = {{"camera", error.camera},
                        {"what", is_readout ? "readout" : "delay"},
                        {"value_s", error.value_s},
                        {"sigma_s", error.sigma_s}};
  if (!is_readout) one["first_camera"] = error.first_camera;
  return one;
}

nlohmann::json told(const ResponseFindings& responses) {
  nlohmann::json list = nlohmann::json::array();
  for (const ResponseFinding& one : responses) list.push_back(json_of(one));
  return list;
}

std::string words_of(const RefinementResult& refinement) {
  return fmt::format(
      "refined on {} pictures of {} tags: those that were held out disagree with the map by {:.1f} sigmas "
      "before, {:.1f} after; lens blur {}",
      refinement.views_used, refinement.refined.size(), refinement.held_out_before, refinement.held_out_after,
      in_words(refinement.lens_blurs));
}

}  // namespace

void tell_calibration(const CalibrateOptions& a, const Sightings& sightings,
                      const ResponseFindings& responses, const CalibrationResult& result,
                      const std::optional<RefinementResult>& refinement, const CalibrationFindings& findings,
                      const CalibrationFiles& files) {
  nlohmann::json other_parts = nlohmann::json::array();
  for (const TagMap& part : result.other_parts) other_parts.push_back(told_keys(keys_of(part)));
  const bool was_interrupted = sightings.counts.is_interrupted || (refinement && refinement->is_stopped);
  nlohmann::json summary = {{"tags", told_keys(keys_of(result.map))},
                            {"held_tag", to_string(result.held_tag)},
                            {"frames", sightings.counts.readable},
                            {"unreadable", sightings.counts.unreadable},
                            {"copied_frames", sightings.counts.copies},
                            {"frames_used", result.frames_used},
                            {"solve_s", result.solve_s},
                            {"frames_at_rest", result.frames_at_rest},
                            {"observations_used", result.observations_used},
                            {"observations_rejected", result.observations_rejected},
                            {"residual_rms_px", result.residual_rms_px},
                            {"left_out", told_keys(result.left_out)},
                            {"findings", told(result.findings)},
                            {"readings_left_out", json_of(sightings.left_out)},
                            {"other_parts", other_parts},
                            {"part_files", files.parts},
                            {"gauge", result.gauge},
                            {"corrections", told(result.corrections)},
                            {"open_corrections", told(result.open_corrections)},
                            {"interrupted", was_interrupted},
                            {"output", a.output}};
  if (files.observations) summary["observations"] = files.observations->string();
  if (!a.detections.empty())
    summary["corner_claims"] =
        json_of(corner_claims_of_calibrate(sightings.frames, a.calibration.corner_bias_px));
  if (!a.constraints.empty()) summary["constraints"] = told_constraints(result.constraint_audits);
  tell_machines(findings, result, summary);
  if (!a.report.empty()) summary["report"] = a.report;
  if (files.has_joint_covariance) summary["joint_covariance"] = a.joint_covariance;
  if (!responses.empty()) summary["responses"] = told(responses);
  for (const auto& [input, range] : sightings.value_ranges)
    summary["value_ranges"][input] = value_range_json(range);
  if (refinement) summary["refinement"] = told(*refinement);
  if (result.print_batches) summary["print_batches"] = told(*result.print_batches);
  if (result.print_aspect) summary["print_aspect"] = *result.print_aspect;
  for (const TimeError& error : result.time_errors) summary["time_errors"].push_back(told(error));
  if (files.camera) summary["camera"] = files.camera->string();
  std::string text = fmt::format(
      "{} tags from {} of {} frames ({} unreadable); {} observations, {} rejected; residual {:.3f} px (rms "
      "per axis)\n"
      "origin: {}\nmap: {}",
      result.map.tags.size(), result.frames_used, sightings.counts.readable, sightings.counts.unreadable,
      result.observations_used, result.observations_rejected, result.residual_rms_px, result.gauge, a.output);
  if (!sightings.left_out.is_empty()) text += "\n" + sightings.left_out.message();
  if (files.observations) text += "\nobservations: " + files.observations->string();
  text += constraint_table(result.constraint_audits);
  if (refinement && refinement->is_accepted) text += "\n" + words_of(*refinement);
  if (files.camera)
    text += fmt::format("\n{} camera: {}", is_lens_refined(result) ? "refined" : "estimated",
                        files.camera->string());
  for (const std::string& file : files.parts) text += "\npart: " + file;
  text += tell_people(findings, result);
  if (files.has_joint_covariance) text += "\njoint covariance: " + a.joint_covariance;
  if (!a.report.empty()) text += "\nreport: " + a.report;
  a.console.finish(summary, text);
}

}  // namespace apriltrack::app
