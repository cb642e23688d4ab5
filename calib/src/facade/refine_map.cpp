#include "apriltrack/calib/refine_map.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>
#include <utility>

#include "apriltrack/base/error.h"
#include "apriltrack/base/log.h"
#include "apriltrack/base/parallel.h"
#include "apriltrack/calib/calibration_result.h"
#include "apriltrack/calib/stop.h"
#include "apriltrack/camera/camera.h"
#include "apriltrack/detect/detection.h"
#include "apriltrack/tags/tag_map.h"
#include "messages/calibration_messages.h"
#include "numerics/normal_distribution.h"
#include "numerics/words.h"
#include "observations/claimed_noise.h"
#include "photometric/held_out.h"
#include "photometric/photometric_adjustment.h"
#include "photometric/refined_places.h"
#include "photometric/refinement_input.h"

namespace apriltrack {
namespace {

constexpr int kMostRefinementSteps = 30;
constexpr int kMomentsPerHeldOut = 4;      ///< Every so many moments, one.
constexpr int kLeastMomentsToRefine = 12;  ///< Three are held out: Student's test needs them.
/// One map in fifty that is no better is taken for a better one: sigmas, were moments many.
constexpr double kClearGain = 2.05;

/// The moments that are held out, or the others.
std::vector<bool> moments_where(int num_moments, bool is_held_out) {
  std::vector<bool> chosen(static_cast<std::size_t>(num_moments));
  for (std::size_t i = 0; i < chosen.size(); ++i)
    chosen[i] = (i % kMomentsPerHeldOut == kMomentsPerHeldOut - 1) == is_held_out;
  return chosen;
}

/// Of the scene, in words.
std::string names_of(const std::vector<int>& places, const TagMap& map, const RefinementInput& input) {
  std::vector<std::string> names;
  for (const int place : places)
    names.push_back(
        to_string(map.tags[static_cast<std::size_t>(input.map_index[static_cast<std::size_t>(place)])].key));
  return join_first(names, ", ", 10);
}

class Refinement {
 public:
  Refinement(const RefinementInput& input, const CalibrationResult& calibration, ParallelFor parallel)
      : input_(input), calibration_(calibration), parallel_(std::move(parallel)) {}

  /// What moments that are held out say of the calibration, and of a map refined without them, each with the
  /// light and the lens that the other moments show with its places: light that was fitted to refined places
  /// takes up a part of what these are wrong by, and would speak against all others. Why the latter is not to
  /// be taken; empty where it is.
  std::string judge(RefinementResult& result) {
    PhotometricAdjustment others(input_.scene, input_.start, parallel_);
    others.choose_moments(moments_where(input_.num_moments, false));
    if (!others.run({.held_tag = input_.held_tag}, kMostRefinementSteps))
      return "the refinement of three moments of four does not settle";
    trained_ = others.state();
    follow_tags(input_.start.T_map_tag, moments_where(input_.num_moments, true), trained_);
    PhotometricAdjustment unmoved(input_.scene, input_.start, parallel_);
    unmoved.choose_moments(moments_where(input_.num_moments, false));
    if (!unmoved.run({.held_tag = std::nullopt, .is_light_free = true}, kMostRefinementSteps))
      return "the light of three moments of four does not settle on the map of the corners";
    PhotometricState before = unmoved.state();
    before.T_map_rig = input_.start.T_map_rig;
    const auto of_before = disagreements2_of_held_out(std::move(before));
    if (!of_before) return "the poses of pictures that were held out do not settle on the map of the corners";
    const auto of_after = disagreements2_of_held_out(trained_);
    if (!of_after) return "the poses of pictures that were held out do not settle on the refined map";
    const auto compared = compare_held_out(input_.scene.views, *of_before, *of_after);
    if (!compared) return "no picture that was held out is explained, neither before nor after";
    result.held_out_before = compared->before;
    result.held_out_after = compared->after;
    if (!compared->lost_tags.empty())
      return fmt::format(
          "most held-out pictures of {} show it where the corners have it, and not where other pictures "
          "moved it: it hung in two places, or something like it is in its pictures; leave it out, or film "
          "again",
          names_of(compared->lost_tags, calibration_.map, input_));
    if (compared->moments < 3 ||
        !(compared->gain_in_errors > student_place(kClearGain, compared->moments - 1.0)))
      return fmt::format(
          "pictures that were held out do not agree clearly better with it ({:.2f} sigmas before, {:.2f} "
          "after, in {} frames)",
          compared->before, compared->after, compared->moments);
    return "";
  }

  /// From all moments; why not, or empty. `result` is as it was then.
  std::string refine(const RefinementOptions& options, RefinementResult& result) {
    PhotometricAdjustment all(input_.scene, trained_, parallel_);
    if (!all.run({.held_tag = input_.held_tag}, kMostRefinementSteps))
      return "the refinement of all pictures does not settle";
    const std::vector<LinearView> views = all.linear_views();
    if (views.empty()) return "too few pictures are explained by the refined map";
    PhotometricState state = all.state();
    const int anchor = all.held_tag();
    put_tag(anchor, input_.start.T_map_tag[static_cast<std::size_t>(anchor)], state);
    RefinementResult taken = result;
    const RefinedTags refined{input_, tags_in(views), anchor};
    for (const int tag : refined.tags) taken.refined.push_back(refined.in(taken.map, tag).key);
    std::optional<ConstraintNotes> notes;
    if (std::string why_not = take_places(refined, calibration_, state, views, options, taken, notes);
        !why_not.empty())
      return why_not;
    taken.views_used = static_cast<int>(views.size());
    taken.moments_used = moments_in(views);
    take_lens_blurs(state, views, taken);
    if (notes) {  // in place of what the corners' map had of them
      std::erase_if(taken.findings, [](const CalibrationFinding& finding) {
        return finding.kind == CalibrationFinding::Kind::kConstraintInDoubt;
      });
      report_constraints(*notes, taken.findings);
    }
    report_unrefined(unrefined_tags(taken), taken.findings);
    result = std::move(taken);
    return "";
  }

 private:
  static int moments_in(const std::vector<LinearView>& views) {
    std::set<int> moments;
    for (const LinearView& view : views) moments.insert(view.frame);
    return static_cast<int>(moments.size());
  }

  static std::vector<int> tags_in(const std::vector<LinearView>& views) {
    std::set<int> seen;
    for (const LinearView& view : views) seen.insert(view.tag);
    return {seen.begin(), seen.end()};
  }

  void take_lens_blurs(const PhotometricState& state, const std::vector<LinearView>& views,
                       RefinementResult& result) const {
    std::set<int> cameras;
    for (const LinearView& view : views) cameras.insert(view.camera);
    for (const int camera : cameras) {
      const auto c = static_cast<std::size_t>(camera);
      result.lens_blurs.push_back({input_.scene.cameras[c].name, state.psf_sigma_px[c]});
    }
  }

  static std::vector<TagKey> unrefined_tags(const RefinementResult& result) {
    std::vector<TagKey> tags;
    for (const MapTag& tag : result.map.tags)
      if (std::ranges::find(result.refined, tag.key) == result.refined.end()) tags.push_back(tag.key);
    return tags;
  }

  /// Moves the moments that were not adjusted with a tag that they show, from where it was before.
  void follow_tags(const std::vector<Pose>& tags_before, const std::vector<bool>& moments,
                   PhotometricState& state) const {
    std::vector<bool> is_done(moments.size(), false);
    for (const PhotometricView& view : input_.scene.views) {
      const auto moment = static_cast<std::size_t>(view.moment), tag = static_cast<std::size_t>(view.tag);
      if (!moments[moment] || is_done[moment]) continue;
      state.T_map_rig[moment] = state.T_map_tag[tag] * tags_before[tag].inverse() * state.T_map_rig[moment];
      is_done[moment] = true;
    }
  }

  /// nullopt where their poses do not settle: what is left then says nothing of the map.
  std::optional<std::vector<std::optional<double>>> disagreements2_of_held_out(PhotometricState state) const {
    PhotometricAdjustment held_out(input_.scene, std::move(state), parallel_);
    held_out.choose_moments(moments_where(input_.num_moments, true));
    if (!held_out.run({.held_tag = std::nullopt, .is_light_free = false}, kMostRefinementSteps))
      return std::nullopt;
    return held_out.disagreements2();
  }

  const RefinementInput& input_;
  const CalibrationResult& calibration_;
  ParallelFor parallel_;
  PhotometricState trained_;
};

std::vector<TagKey> tags_with_views(const TagMap& map, const RefinementInput& input) {
  std::set<TagKey> keys;
  for (const PhotometricView& view : input.scene.views)
    keys.insert(map.tags[static_cast<std::size_t>(input.map_index[static_cast<std::size_t>(view.tag)])].key);
  return {keys.begin(), keys.end()};
}

void require_cameras_of(const CalibrationResult& calibration, const CameraRig& rig) {
  if (std::ranges::equal(rig.cameras, calibration.rig.cameras, {}, &Camera::name, &Camera::name)) return;
  throw invalid_input("rig", "must have the cameras that the map was calibrated with, in their order");
}

/// Why not, or empty. `result`: as calibrated, and as it was where the map is not to be taken.
std::string refine_on_pictures(const CalibrationResult& calibration, std::span<const FrameDetections> frames,
                               const CameraRig& rig, const RefinementOptions& options, const LogSink& log,
                               RefinementResult& result) {
  if (!calibration.time_errors.empty())
    return "pictures look as if they were of other moments than their times say";
  const ParallelFor parallel = stoppable(parallel_for(options.num_threads), options.should_stop);
  const RefinementInput input = refinement_input(calibration, frames, rig, options.max_moments, parallel);
  if (input.num_moments < kLeastMomentsToRefine)
    return fmt::format("too few pictures: {} moments show two tags or more, {} are needed", input.num_moments,
                       kLeastMomentsToRefine);
  const std::vector<TagKey> tags = tags_with_views(calibration.map, input);
  log(LogLevel::kInfo, fmt::format("refining {} tags on {} pictures", tags.size(), input.scene.views.size()));
  if (std::string why = why_constrained_tag_is_needed(tags, calibration.constraints); !why.empty())
    return why;
  Refinement refinement(input, calibration, parallel);
  if (std::string why_not = refinement.judge(result); !why_not.empty()) return why_not;
  return refinement.refine(options, result);
}

}  // namespace

void RefinementOptions::check() const {
  if (max_moments < kLeastMomentsToRefine)
    throw invalid_input("max_moments",
                        fmt::format("must be {} or more (is {})", kLeastMomentsToRefine, max_moments));
  if (!(picture_bias_px >= 0.0 && picture_bias_px <= 100.0))
    throw invalid_input("picture_bias_px", fmt::format("must be in [0, 100] (is {})", picture_bias_px));
  if (num_threads < 0)
    throw invalid_input("num_threads", fmt::format("must be 0 (all cores) or more (is {})", num_threads));
}

RefinementResult refine_map(const CalibrationResult& calibration, std::span<const FrameDetections> frames,
                            const CameraRig& rig, const RefinementOptions& options, const LogSink& log) {
  options.check();
  require_cameras_of(calibration, rig);
  RefinementResult result;
  result.map = calibration.map;
  result.gauge = calibration.gauge;
  result.constraint_audits = calibration.constraint_audits;
  result.findings = calibration.findings;
  try {
    RefinementOptions claimed = options;
    if (const auto kept = kept_errors(frames)) claimed.picture_bias_px = kept->pictures_px;
    result.reason = refine_on_pictures(calibration, frames, rig, claimed, log, result);
  } catch (const Stopped&) {
    result.reason = "interrupted";
    result.is_stopped = true;
  }
  result.is_accepted = result.reason.empty();
  result.warnings = messages_of(result.findings);
  return result;
}

}  // namespace apriltrack
