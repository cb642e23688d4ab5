#include "apriltrack/calib/refine_map.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>
#include <set>
#include <utility>

#include "apriltrack/base/error.h"
#include "apriltrack/base/parallel.h"
#include "constrained_map.h"
#include "held_out.h"
#include "joint_tag_covariance.h"
#include "photometric_adjustment.h"
#include "picture_cameras.h"
#include "refinement_input.h"
#include "tag_flags.h"
#include "words.h"

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

/// Of the scene, in words.
std::string names_of(const std::vector<int>& places, const TagMap& map, const RefinementInput& input) {
  std::vector<std::string> names;
  for (const int place : places)
    names.push_back(
        to_string(map.tags[static_cast<std::size_t>(input.map_index[static_cast<std::size_t>(place)])].key));
  return join_first(names, ", ", 10);
}

/// Constraints weigh against the pictures of all tags that they name.
std::optional<TagKey> constrained_tag_without(const std::vector<TagKey>& refined,
                                              const std::vector<MapConstraint>& constraints) {
  for (const MapConstraint& constraint : constraints) {
    for (const TagKey& key : tags_of(constraint)) {
      if (std::ranges::find(refined, key) == refined.end()) return key;
    }
  }
  return std::nullopt;
}

/// Why pictures do not fit constraints that corners fitted.
std::string contradiction_in_words(const ConstraintError& error) {
  std::vector<std::string> titles;
  for (const ConstraintAudit& audit : error.audits()) {
    if (audit.is_used) continue;
    titles.push_back(audit.z ? fmt::format("{} by {:.1f} sigmas", audit.title, *audit.z) : audit.title);
  }
  if (titles.empty()) return fmt::format("with the pictures' covariance, {}", error.what());
  return fmt::format(
      "they contradict constraints that the corners agree with: {}; give these the sigma that they were "
      "measured "
      "with, or take them out",
      join_first(titles, ", ", 5));
}

/// Covariances of what was refined, by place of Refined::tags.
struct Covariances {
  std::vector<TagCovariance> in_pictures;
  std::vector<std::optional<Matrix6d>> constrained;  ///< Where something was measured beside the images.
};

class Refinement {
 public:
  Refinement(const RefinementInput& input, const CalibrationResult& calibration, ParallelFor parallel)
      : input_(input), calibration_(calibration), parallel_(std::move(parallel)) {}

  /// What moments that are held out say of the calibration, and of a map refined without them. Both with the
  /// light and the lens of the latter, so that only places differ. Why the latter is not to be taken; empty
  /// where it is.
  std::string judge(RefinementResult& result) {
    PhotometricAdjustment others(input_.scene, input_.start, parallel_);
    others.choose_moments(moments_where(input_.num_moments, false));
    if (!others.run({.held_tag = input_.held_tag}, kMostSteps))
      return "the refinement of three moments of four does not settle";
    trained_ = others.state();
    follow_tags(input_.start.T_map_tag, moments_where(input_.num_moments, true), trained_);
    PhotometricState before = trained_;
    before.T_map_tag = input_.start.T_map_tag;
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
          "moved it: it "
          "hung in two places, or something like it is in its pictures; leave it out, or film again",
          names_of(compared->lost_tags, calibration_.map, input_));
    if (!(compared->after < compared->before))
      return fmt::format(
          "pictures that were held out agree no better with it ({:.2f} sigmas before, {:.2f} after)",
          compared->before, compared->after);
    return "";
  }

  /// From all moments; why not, or empty. `result` is as it was then.
  std::string refine(const RefinementOptions& options, RefinementResult& result) {
    PhotometricAdjustment all(input_.scene, trained_, parallel_);
    if (!all.run({.held_tag = input_.held_tag}, kMostSteps))
      return "the refinement of all pictures does not settle";
    const std::vector<LinearView> views = all.linear_views();
    if (views.empty()) return "too few pictures are explained by the refined map";
    PhotometricState state = all.state();
    anchor_ = all.held_tag();
    put_tag(anchor_, input_.start.T_map_tag[static_cast<std::size_t>(anchor_)], state);
    RefinementResult taken = result;
    choose_tags(views, taken);
    if (std::string why_not = take_places(state, views, options, taken); !why_not.empty()) return why_not;
    taken.views_used = static_cast<int>(views.size());
    taken.moments_used = moments_in(views);
    take_lens_blurs(state, views, taken);
    warn_of_unrefined(taken);
    result = std::move(taken);
    return "";
  }

 private:
  MapTag& map_tag(int place, TagMap& map) const {
    return map.tags[static_cast<std::size_t>(input_.map_index[static_cast<std::size_t>(place)])];
  }

  bool is_held_tag_refined() const { return anchor_ == input_.held_tag; }

  static int moments_in(const std::vector<LinearView>& views) {
    std::set<int> moments;
    for (const LinearView& view : views) moments.insert(view.frame);
    return static_cast<int>(moments.size());
  }

  void choose_tags(const std::vector<LinearView>& views, RefinementResult& result) {
    std::set<int> seen;
    for (const LinearView& view : views) seen.insert(view.tag);
    tags_.assign(seen.begin(), seen.end());
    for (const int tag : tags_) result.refined.push_back(map_tag(tag, result.map).key);
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

  void warn_of_unrefined(RefinementResult& result) const {
    std::vector<std::string> names;
    for (const MapTag& tag : result.map.tags) {
      if (std::ranges::find(result.refined, tag.key) == result.refined.end())
        names.push_back(to_string(tag.key));
    }
    if (names.empty()) return;
    result.warnings.push_back(fmt::format(
        "{} as the corners have {}, for too few pictures can be used that join {} to the others (too "
        "bright, covered, blurred, or another tag's)",
        names.size() == 1 ? names.front() + " stays" : join_first(names, ", ", 10) + " stay",
        names.size() == 1 ? "it" : "them", names.size() == 1 ? "it" : "them"));
  }

  /// Where the held tag has no pictures to be used, places rest on another one, and on what the corners say
  /// of that one. Errors that corners and pictures share then count twice; nothing tells how those of cameras
  /// or constraints add up.
  std::string why_held_tag_is_needed() const {
    if (is_held_tag_refined()) return "";
    const bool has_lens = std::ranges::any_of(
        calibration_.corrections, [](const CameraCorrection& one) { return one.parameter != "edge offset"; });
    if (calibration_.constraints.empty() && !has_lens) return "";
    return fmt::format(
        "too few pictures of the held tag {} can be used, and {} weigh against them: hold another tag "
        "(--held-tag)",
        to_string(calibration_.held_tag),
        calibration_.constraints.empty() ? "the estimates of the cameras" : "constraints");
  }

  /// The tags' new poses with covariances, kept to the constraints. Maps too large for covariances
  /// (CalibrationOptions::max_tags_with_covariance) stay without. Why not, where the views leave a pose
  /// undetermined, or contradict the constraints.
  std::string take_places(const PhotometricState& state, const std::vector<LinearView>& views,
                          const RefinementOptions& options, RefinementResult& result) const {
    const bool has_covariances = map_tag(anchor_, result.map).covariance.has_value();
    for (const int tag : tags_)
      map_tag(tag, result.map).T_map_tag = state.T_map_tag[static_cast<std::size_t>(tag)];
    if (!has_covariances) return "";
    if (const auto unseen = constrained_tag_without(result.refined, calibration_.constraints))
      return fmt::format("a constraint names {}, of which too few pictures can be used", to_string(*unseen));
    if (std::string why = why_held_tag_is_needed(); !why.empty()) return why;
    const auto poses = PoseInformation::of(views, tags_, anchor_);
    if (!poses) return "the pictures leave places of tags undetermined";
    const ErrorScale scale = error_scale(views, *poses, options.picture_bias_px * options.picture_bias_px);
    const auto cameras = errors_of_cameras(calibration_, input_.scene, state, views, *poses, scale);
    Covariances covariances{tag_covariances(*poses, tags_, cameras), {}};
    covariances.constrained.resize(tags_.size());
    scale_by(scale, covariances.in_pictures);
    if (!calibration_.evidence.joint.is_empty()) take_joint(*poses, scale, cameras, result);
    if (!is_held_tag_refined()) add_error_of_anchor(covariances, result);
    for (std::size_t i = 0; i < tags_.size(); ++i)
      map_tag(tags_[i], result.map).covariance =
          covariances.in_pictures[i].by_noise + covariances.in_pictures[i].by_bias;
    if (!calibration_.constraints.empty()) {
      try {
        keep_to_constraints(CovarianceOperator(*poses, scale, cameras), covariances, result);
      } catch (const ConstraintError& error) {  // the pictures claim more than the corners do
        return contradiction_in_words(error);
      }
    }
    take_flags(covariances, result);
    return "";
  }

  void take_joint(const PoseInformation& poses, const ErrorScale& scale,
                  const std::optional<SharedErrors>& cameras, RefinementResult& result) const {
    std::vector<int> tags = tags_;
    if (!is_held_tag_refined() && input_.held_tag >= 0)  // its rows are zero
      tags.insert(std::ranges::lower_bound(tags, input_.held_tag), input_.held_tag);
    std::vector<TagKey> keys;
    for (const int tag : tags) keys.push_back(map_tag(tag, result.map).key);
    result.joint = joint_tag_covariance(poses, tags, std::move(keys), scale, cameras);
    // What more views would bring is reckoned for their corners.
    result.joint.noise_variance = calibration_.evidence.joint.noise_variance;
    result.joint.are_errors_of_corners = true;
  }

  /// All that was refined follows the error that the corners leave of the anchor's place.
  void add_error_of_anchor(Covariances& covariances, RefinementResult& result) const {
    const MapTag& anchor = map_tag(anchor_, result.map);
    const Matrix6d of_anchor = *anchor.covariance;
    const auto by_anchor = [&](const Pose& T_map_tag) {
      return Matrix6d((T_map_tag.inverse() * anchor.T_map_tag).adjoint());
    };
    for (std::size_t i = 0; i < tags_.size(); ++i) {
      const Matrix6d follow = by_anchor(map_tag(tags_[i], result.map).T_map_tag);
      covariances.in_pictures[i].by_noise += follow * of_anchor * follow.transpose();
    }
    if (result.joint.is_empty()) return;
    Eigen::MatrixXd follow = Eigen::MatrixXd::Zero(result.joint.by_noise.rows(), 6);
    for (const int tag : tags_) {
      const MapTag& refined = map_tag(tag, result.map);
      follow.middleRows<6>(*result.joint.row_of(refined.key)) = by_anchor(refined.T_map_tag);
    }
    result.joint.by_noise += follow * of_anchor * follow.transpose();
  }

  void keep_to_constraints(const CovarianceOperator& joint, Covariances& covariances,
                           RefinementResult& result) const {
    ImageMap map{{}, tags_, anchor_, {}, {}};
    const Pose T_map_held = map_tag(anchor_, result.map).T_map_tag;
    for (std::size_t place = 0; place < input_.map_index.size(); ++place) {
      const MapTag& tag = map_tag(static_cast<int>(place), result.map);
      map.keys.push_back(tag.key);
      map.T_held_tag.push_back(T_map_held.inverse() * tag.T_map_tag);
    }
    for (const int tag : tags_) map.covariances.push_back(*map_tag(tag, result.map).covariance);
    ConstrainedMap constrained = constrain_map(calibration_.constraints, map, joint);
    keep_to(constrained.change, result.joint);
    // Tags that were not refined move with the frame.
    for (MapTag& tag : result.map.tags)
      tag.T_map_tag = constrained.T_map_held * T_map_held.inverse() * tag.T_map_tag;
    for (std::size_t i = 0; i < tags_.size(); ++i) {
      MapTag& tag = map_tag(tags_[i], result.map);
      tag.T_map_tag = constrained.T_map_tag[static_cast<std::size_t>(tags_[i])];
      tag.covariance = constrained.covariances[i];
      if (!constrained.change.lost_root.isZero(0.0)) covariances.constrained[i] = constrained.covariances[i];
    }
    if (!constrained.gauge.empty()) result.gauge = constrained.gauge;
    take_audits(std::move(constrained), result);
  }

  /// Of the constraints that are used; what was said of the others stands.
  void take_audits(ConstrainedMap constrained, RefinementResult& result) const {
    auto audit = constrained.audits.begin();
    for (ConstraintAudit& one : result.constraint_audits) {
      if (one.is_used && audit != constrained.audits.end()) one = std::move(*audit++);
    }
    std::erase_if(result.warnings, [&](const std::string& warning) {
      return std::ranges::find(calibration_.constraint_doubts, warning) !=
             calibration_.constraint_doubts.end();
    });
    for (const auto* words : {&constrained.warnings, &constrained.doubts})
      result.warnings.insert(result.warnings.end(), words->begin(), words->end());
  }

  void take_flags(const Covariances& covariances, RefinementResult& result) const {
    for (std::size_t i = 0; i < tags_.size(); ++i) {
      MapTag& tag = map_tag(tags_[i], result.map);
      if (!tag.statistics) continue;
      flag_weak(is_weak(tag, tag.statistics->views, covariances.in_pictures[i].by_noise,
                        covariances.constrained[i]),
                *tag.statistics);
    }
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
    if (!held_out.run({.held_tag = std::nullopt, .is_light_free = false}, kMostSteps)) return std::nullopt;
    return held_out.disagreements2();
  }

  const RefinementInput& input_;
  const CalibrationResult& calibration_;
  ParallelFor parallel_;
  PhotometricState trained_;
  int anchor_ = -1;        ///< The held tag, or another where it has no pictures to be used.
  std::vector<int> tags_;  ///< Of the scene, those that are refined, sorted.
};

std::vector<TagKey> tags_with_views(const TagMap& map, const RefinementInput& input) {
  std::set<TagKey> keys;
  for (const PhotometricView& view : input.scene.views)
    keys.insert(map.tags[static_cast<std::size_t>(input.map_index[static_cast<std::size_t>(view.tag)])].key);
  return {keys.begin(), keys.end()};
}

/// Why not, or empty. `result`: as calibrated, and as it was where the map is not to be taken.
std::string refine_on_pictures(const CalibrationResult& calibration, std::span<const FrameDetections> frames,
                               const CameraRig& rig, const RefinementOptions& options, const LogSink& log,
                               RefinementResult& result) {
  const ParallelFor parallel = stoppable(parallel_for(options.num_threads), options.should_stop);
  const RefinementInput input = refinement_input(calibration, frames, rig, options.max_moments, parallel);
  if (input.num_moments < kLeastMoments)
    return fmt::format("too few pictures: {} moments show two tags or more, {} are needed", input.num_moments,
                       kLeastMoments);
  const std::vector<TagKey> tags = tags_with_views(calibration.map, input);
  log(LogLevel::kInfo, fmt::format("refining {} tags on {} pictures", tags.size(), input.scene.views.size()));
  if (const auto unseen = constrained_tag_without(tags, calibration.constraints))
    return fmt::format("a constraint names {}, of which too few pictures can be used", to_string(*unseen));
  Refinement refinement(input, calibration, parallel);
  if (std::string why_not = refinement.judge(result); !why_not.empty()) return why_not;
  return refinement.refine(options, result);
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
  result.warnings = calibration.warnings;
  try {
    result.reason = refine_on_pictures(calibration, frames, rig, options, log, result);
  } catch (const Stopped&) {
    result.reason = "interrupted";
    result.is_stopped = true;
  }
  result.is_accepted = result.reason.empty();
  return result;
}

}  // namespace apriltrack
