#include "calibrate_findings.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

namespace apriltrack::app {
namespace {

nlohmann::json told(const WeakDirection& one) {
  return {{"tag", to_string(one.tag)},
          {"relative_to", to_string(one.neighbour)},
          {"kind", one.is_rotation ? "rotation" : "position"},
          {"axis", {one.axis.x(), one.axis.y(), one.axis.z()}},
          {one.is_rotation ? "sigma_rad" : "sigma_m", one.sigma},
          {"text", one.words}};
}

nlohmann::json told(const HangingPart& part) {
  return {{"tags", told_keys(part.tags)},
          {"frames", part.frames},
          {"hinge_of_part", told_keys(part.hinge_of_part)},
          {"hinge_of_rest", told_keys(part.hinge_of_rest)},
          {"text", part.words}};
}

nlohmann::json told(const ViewAdvice& one) {
  const Eigen::Vector3d& position = one.T_map_camera.translation();
  const Eigen::Quaterniond& q = one.T_map_camera.rotation();
  return {{"tag", to_string(one.tag)},
          {"show", {to_string(one.before), to_string(one.partner)}},
          {"pictures", one.pictures},
          {"distance_m", one.distance_m},
          {"aside_rad", one.aside_rad},
          {"above_rad", one.above_rad},
          {"T_map_camera", {position.x(), position.y(), position.z(), q.x(), q.y(), q.z(), q.w()}},
          {"sigma_position_m", {one.sigma_before_m, one.sigma_after_m}},
          {"sigma_rotation_rad", {one.sigma_before_rad, one.sigma_after_rad}},
          {"text", one.words}};
}

nlohmann::json told(const JoinAdvice& one) {
  return {{"show", {to_string(one.of_map), to_string(one.of_other)}},
          {"joins", told_keys(one.others)},
          {"apart_s", one.apart_s ? nlohmann::json(*one.apart_s) : nlohmann::json(nullptr)},
          {"text", one.words}};
}

nlohmann::json told(const CrossValidation& halves) {
  if (!halves.why_not.empty()) return {{"why_not", halves.why_not}};
  nlohmann::json tags = nlohmann::json::array();
  for (const HalvesOfTag& tag : halves.tags)
    tags.push_back({{"tag", to_string(tag.tag)},
                    {"difference_m", tag.difference_m},
                    {"difference_rad", tag.difference_rad},
                    {"sigma_m", tag.sigma_m},
                    {"sigma_rad", tag.sigma_rad},
                    {"normalised_error_squared", tag.normalised_error_squared}});
  return {{"held_tag", to_string(halves.held_tag)},
          {"moments", {halves.moments_of_first, halves.moments_of_second}},
          {"normalised_error_squared", halves.normalised_error_squared},
          {"tags", tags},
          {"text", halves.words}};
}

template <typename T>
nlohmann::json list_told(const std::vector<T>& all) {
  nlohmann::json list = nlohmann::json::array();
  for (const T& one : all) list.push_back(told(one));
  return list;
}

}  // namespace

nlohmann::json told_keys(const std::vector<TagKey>& keys) {
  nlohmann::json list = nlohmann::json::array();
  for (const TagKey& key : keys) list.push_back(to_string(key));
  return list;
}

bool is_lens_refined(const CalibrationResult& result) {
  return !std::ranges::all_of(result.corrections, &CameraCorrection::is_of_edges);
}

CalibrationFindings find(const CalibrationResult& result, const std::optional<RefinementResult>& refinement,
                         const std::vector<FrameDetections>& frames) {
  CalibrationFindings findings;
  const bool is_refined = refinement && refinement->is_accepted && !refinement->joint.is_empty();
  findings.joint = is_refined ? &refinement->joint : &result.evidence.joint;
  findings.of_map = assess_map(result.map, *findings.joint, result.evidence, result.rig);
  for (std::size_t i = 0; i < result.other_parts.size(); ++i) {
    const MapEvidence& evidence = result.evidence_of_other_parts[i];
    findings.of_other_parts.push_back(
        assess_map(result.other_parts[i], evidence.joint, evidence, result.rig));
  }
  findings.joining = advise_joining(result, frames);
  return findings;
}

void tell_machines(const CalibrationFindings& findings, const CalibrationResult& result,
                   nlohmann::json& summary) {
  std::vector<WeakDirection> weak = findings.of_map.directions;
  std::erase_if(weak, [](const WeakDirection& one) { return !one.is_weak; });
  summary["weak_directions"] = list_told(weak);
  summary["hanging"] = list_told(findings.of_map.hanging);
  summary["advice"] = list_told(findings.of_map.advice);
  summary["joining"] = list_told(findings.joining);
  if (result.cross_validation) summary["cross_validation"] = told(*result.cross_validation);
}

std::string tell_people(const CalibrationFindings& findings, const CalibrationResult& result) {
  std::string text;
  if (!findings.of_map.hanging.empty()) text += "\nhanging: " + findings.of_map.hanging.front().words;
  const auto weak = std::ranges::max_element(findings.of_map.directions, {}, [](const WeakDirection& one) {
    return one.is_weak ? one.weakness : 0.0;
  });
  if (weak != findings.of_map.directions.end() && weak->is_weak) text += "\nweak: " + weak->words;
  if (!findings.of_map.advice.empty()) text += "\nwould help most: " + findings.of_map.advice.front().words;
  if (!findings.joining.empty()) text += "\nto join: " + findings.joining.front().words;
  if (result.cross_validation) {
    const std::string& why_not = result.cross_validation->why_not;
    text += "\ncross-validation: " + (why_not.empty() ? result.cross_validation->words : "none: " + why_not);
  }
  return text;
}

}  // namespace apriltrack::app
