#include "apriltrack/calib/refine_map.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <utility>

#include "apriltrack/base/error.h"
#include "apriltrack/base/parallel.h"
#include "constrained_map.h"
#include "joint_tag_covariance.h"
#include "photometric_adjustment.h"
#include "picture_cameras.h"
#include "refinement_input.h"

namespace apriltrack {
namespace {

constexpr int kMostSteps = 30;
constexpr int kHeldOut = 4;  ///< Every so many moments, one.
constexpr int kLeastMoments = 8;

/// The moments that are held out, or the others.
std::vector<bool> moments_where(int num_moments, bool is_held_out) {
  std::vector<bool> chosen(static_cast<std::size_t>(num_moments));
  for (std::size_t i = 0; i < chosen.size(); ++i) chosen[i] = (i % kHeldOut == kHeldOut - 1) == is_held_out;
  return chosen;
}

/// Root mean square, per number; nullopt where no picture is explained.
std::optional<double> disagreement(const std::vector<LinearView>& views) {
  if (views.empty()) return std::nullopt;
  double squares = 0.0, count = 0.0;
  for (const LinearView& view : views) {
    squares += view.residual.squaredNorm();
    count += static_cast<double>(view.residual.size());
  }
  return std::sqrt(squares / count);
}

class Refinement {
 public:
  Refinement(const RefinementInput& input, int held_tag, const CalibrationResult& calibration,
             ParallelFor parallel)
      : input_(input), held_tag_(held_tag), calibration_(calibration), parallel_(std::move(parallel)) {}

  /// What moments that are held out say of the calibration, and of a map refined without them. Both with the
  /// light and the lens of the latter, so that only places differ. False where the refinement fails.
  bool judge(RefinementResult& result) {
    PhotometricAdjustment others(input_.scene, input_.start, parallel_);
    others.choose_moments(moments_where(input_.num_moments, false));
    if (!others.run({.held_tag = held_tag_}, kMostSteps)) return false;
    trained_ = others.state();
    follow_tags(input_.start.T_map_tag, moments_where(input_.num_moments, true), trained_);
    PhotometricState before = trained_;
    before.T_map_tag = input_.start.T_map_tag;
    before.T_map_rig = input_.start.T_map_rig;
    const auto disagreement_before = disagreement_of_held_out(std::move(before));
    const auto disagreement_after = disagreement_of_held_out(trained_);
    if (!disagreement_before || !disagreement_after) return false;
    result.held_out_before = *disagreement_before;
    result.held_out_after = *disagreement_after;
    return true;
  }

  /// From all moments; false where it fails.
  bool refine(const RefinementOptions& options, RefinementResult& result) {
    PhotometricAdjustment all(input_.scene, trained_, parallel_);
    if (!all.run({.held_tag = held_tag_}, kMostSteps)) return false;
    const std::vector<LinearView> views = all.linear_views();
    const TagMap before = result.map;
    if (!take_places(all.state(), views, options, result)) {
      result.map = before;
      result.joint = {};
      return false;
    }
    for (std::size_t i = 0; i < input_.map_index.size(); ++i)
      result.refined.push_back(map_tag(i, result.map).key);
    result.views_used = static_cast<int>(views.size());
    result.moments_used = input_.num_moments;
    result.psf_sigma_px = all.state().psf_sigma_px;
    return true;
  }

 private:
  MapTag& map_tag(std::size_t place, TagMap& map) const {
    return map.tags[static_cast<std::size_t>(input_.map_index[place])];
  }

  /// The tags' new poses with covariances, kept to the constraints. Maps too large for covariances
  /// (CalibrationOptions::max_tags_with_covariance) stay without. False where the views leave a pose
  /// undetermined, or contradict the constraints: result.reason.
  bool take_places(const PhotometricState& state, const std::vector<LinearView>& views,
                   const RefinementOptions& options, RefinementResult& result) const {
    const bool has_covariances = map_tag(0, result.map).covariance.has_value();
    for (std::size_t i = 0; i < input_.map_index.size(); ++i)
      map_tag(i, result.map).T_map_tag = state.T_map_tag[i];
    if (!has_covariances) return true;
    std::vector<int> tags(input_.map_index.size());
    std::iota(tags.begin(), tags.end(), 0);
    const auto poses = PoseInformation::of(views, tags, held_tag_);
    if (!poses) return false;
    const ErrorScale scale = error_scale(views, *poses, options.picture_bias_px * options.picture_bias_px);
    const auto cameras = errors_of_cameras(calibration_, input_.scene, state, views, *poses, scale);
    std::vector<TagCovariance> covariances = tag_covariances(*poses, tags, cameras);
    scale_by(scale, covariances);
    if (!calibration_.evidence.joint.is_empty()) {
      std::vector<TagKey> keys;
      for (std::size_t i = 0; i < tags.size(); ++i) keys.push_back(map_tag(i, result.map).key);
      result.joint = joint_tag_covariance(*poses, tags, std::move(keys), scale, cameras);
      // What more views would bring is reckoned for their corners.
      result.joint.noise_variance = calibration_.evidence.joint.noise_variance;
      result.joint.bias_sigma /= calibration_.evidence.noise.sigma_px;
    }
    for (std::size_t i = 0; i < tags.size(); ++i)
      map_tag(i, result.map).covariance = covariances[i].by_noise + covariances[i].by_bias;
    if (calibration_.constraints.empty()) return true;
    try {
      keep_to_constraints(CovarianceOperator(*poses, scale, cameras), tags, result);
      return true;
    } catch (const Error& error) {  // the pictures claim more than the corners do; the corners' map stands
      result.reason = error.what();
      return false;
    }
  }

  void keep_to_constraints(const CovarianceOperator& joint, const std::vector<int>& tags,
                           RefinementResult& result) const {
    ImageMap map{{}, tags, held_tag_, {}, {}};
    const Pose T_map_held = map_tag(static_cast<std::size_t>(held_tag_), result.map).T_map_tag;
    for (std::size_t i = 0; i < tags.size(); ++i) {
      const MapTag& tag = map_tag(i, result.map);
      map.keys.push_back(tag.key);
      map.T_held_tag.push_back(T_map_held.inverse() * tag.T_map_tag);
      map.covariances.push_back(*tag.covariance);
    }
    ConstrainedMap constrained = constrain_map(calibration_.constraints, map, joint);
    keep_to(constrained.change, result.joint);
    // Tags that were not refined move with the frame.
    for (MapTag& tag : result.map.tags)
      tag.T_map_tag = constrained.T_map_held * T_map_held.inverse() * tag.T_map_tag;
    for (std::size_t i = 0; i < tags.size(); ++i) {
      map_tag(i, result.map).T_map_tag = constrained.T_map_tag[i];
      map_tag(i, result.map).covariance = constrained.covariances[i];
    }
    if (!constrained.gauge.empty()) result.gauge = constrained.gauge;
    result.constraint_audits = std::move(constrained.audits);
    result.warnings = std::move(constrained.warnings);
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

  /// nullopt where their poses do not settle, or none is explained: what is left then says nothing of the
  /// map.
  std::optional<double> disagreement_of_held_out(PhotometricState state) const {
    PhotometricAdjustment held_out(input_.scene, std::move(state), parallel_);
    held_out.choose_moments(moments_where(input_.num_moments, true));
    if (!held_out.run({.held_tag = std::nullopt, .is_light_free = false}, kMostSteps)) return std::nullopt;
    return disagreement(held_out.linear_views());
  }

  const RefinementInput& input_;
  int held_tag_;
  const CalibrationResult& calibration_;
  ParallelFor parallel_;
  PhotometricState trained_;
};

std::optional<int> place_of(const TagKey& key, const TagMap& map, const RefinementInput& input) {
  for (std::size_t i = 0; i < input.map_index.size(); ++i) {
    if (map.tags[static_cast<std::size_t>(input.map_index[i])].key == key) return static_cast<int>(i);
  }
  return std::nullopt;
}

/// Constraints weigh against the pictures of all tags that they name.
std::optional<TagKey> constrained_tag_without_picture(const CalibrationResult& calibration,
                                                      const RefinementInput& input) {
  for (const MapConstraint& constraint : calibration.constraints) {
    for (const TagKey& key : tags_of(constraint)) {
      if (!place_of(key, calibration.map, input)) return key;
    }
  }
  return std::nullopt;
}

}  // namespace

void RefinementOptions::check() const {
  if (max_moments < kLeastMoments)
    throw invalid_input("max_moments", fmt::format("must be {} or more (is {})", kLeastMoments, max_moments));
  if (!(picture_bias_px >= 0.0 && picture_bias_px <= 100.0))
    throw invalid_input("picture_bias_px", fmt::format("must be in [0, 100] (is {})", picture_bias_px));
  if (num_threads < 0)
    throw invalid_input("num_threads", fmt::format("must be 0 (all cores) or more (is {})", num_threads));
}

RefinementResult refine_map(const CalibrationResult& calibration, std::span<const FrameDetections> frames,
                            const CameraRig& rig, const RefinementOptions& options, const LogSink& log) {
  options.check();
  RefinementResult result;
  result.map = calibration.map;
  result.gauge = calibration.gauge;
  result.constraint_audits = calibration.constraint_audits;
  const ParallelFor parallel = parallel_for(options.num_threads);
  const RefinementInput input = refinement_input(calibration, frames, rig, options.max_moments, parallel);
  const auto held_tag = place_of(calibration.held_tag, calibration.map, input);
  if (!held_tag || input.num_moments < kLeastMoments) {
    result.reason = fmt::format("too few pictures: {} moments show two tags or more, {} are needed",
                                input.num_moments, kLeastMoments);
    return result;
  }
  log(LogLevel::kInfo,
      fmt::format("refining {} tags on {} pictures", input.scene.tags.size(), input.scene.views.size()));
  if (const auto unseen = constrained_tag_without_picture(calibration, input)) {
    result.reason = fmt::format("a constraint names {}, which too few pictures show", to_string(*unseen));
    return result;
  }
  Refinement refinement(input, *held_tag, calibration, parallel);
  if (!refinement.judge(result)) {
    result.reason = "the refinement does not settle";
  } else if (!(result.held_out_after < result.held_out_before)) {
    result.reason = fmt::format(
        "pictures that were held out agree no better with it ({:.2f} sigmas before, {:.2f} after)",
        result.held_out_before, result.held_out_after);
  } else if (!refinement.refine(options, result)) {
    if (result.reason.empty()) result.reason = "the refinement of all pictures does not settle";
  } else {
    result.is_accepted = true;
  }
  return result;
}

}  // namespace apriltrack
