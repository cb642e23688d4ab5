#include "photometric/refined_places.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <utility>

#include "apriltrack/calib/map_constraints.h"
#include "apriltrack/calib/systematic_errors.h"
#include "apriltrack/tags/tag_map.h"
#include "assess/tag_flags.h"
#include "numerics/words.h"
#include "photometric/errors_from_corners.h"
#include "uncertainty/joint_tag_covariance.h"

namespace apriltrack {
namespace {

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
      "measured with, or take them out",
      join_first(titles, ", ", 5));
}

/// Covariances of what was refined, by place of RefinedTags::tags.
struct Covariances {
  std::vector<TagCovariance> in_pictures;
  std::vector<std::optional<Matrix6d>> constrained;  ///< Where something was measured beside the images.
};

class RefinedPlaces {
 public:
  RefinedPlaces(const RefinedTags& refined, const CalibrationResult& calibration)
      : refined_(refined),
        input_(refined.input),
        tags_(refined.tags),
        anchor_(refined.anchor),
        calibration_(calibration) {}

  /// As take_places().
  std::string take(const PhotometricState& state, const std::vector<LinearView>& views,
                   const RefinementOptions& options, RefinementResult& result,
                   std::optional<ConstraintNotes>& notes) const {
    const bool has_covariances = map_tag(anchor_, result.map).covariance.has_value();
    for (const int tag : tags_)
      map_tag(tag, result.map).T_map_tag = state.T_map_tag[static_cast<std::size_t>(tag)];
    if (!has_covariances) return "";
    if (std::string why = why_constrained_tag_is_needed(result.refined, calibration_.constraints);
        !why.empty())
      return why;
    if (std::string why = why_held_tag_is_needed(); !why.empty()) return why;
    const auto poses = PoseInformation::of(views, tags_, anchor_);
    if (!poses) return "the pictures leave places of tags undetermined";
    const ErrorScale scale = error_scale(views, *poses, options.picture_bias_px * options.picture_bias_px);
    const auto shared = errors_from_corners(calibration_, input_.scene, keys_of_scene(result.map), state,
                                            views, *poses, scale);
    Covariances covariances{tag_covariances(*poses, tags_, shared), {}};
    covariances.constrained.resize(tags_.size());
    scale_by(scale, covariances.in_pictures);
    if (!calibration_.evidence.joint.is_empty()) take_joint(*poses, scale, shared, result);
    if (!is_held_tag_refined()) add_error_of_anchor(covariances, result);
    for (std::size_t i = 0; i < tags_.size(); ++i)
      map_tag(tags_[i], result.map).covariance =
          covariances.in_pictures[i].by_noise + covariances.in_pictures[i].by_bias;
    if (!calibration_.constraints.empty()) {
      try {
        notes = keep_to_constraints(CovarianceOperator(*poses, scale, shared), covariances, result);
      } catch (const ConstraintError& error) {  // the pictures claim more than the corners do
        return contradiction_in_words(error);
      }
    }
    take_flags(covariances, result);
    return "";
  }

 private:
  MapTag& map_tag(int place, TagMap& map) const { return refined_.in(map, place); }
  std::vector<TagKey> keys_of_scene(TagMap& map) const {
    std::vector<TagKey> keys;
    for (std::size_t place = 0; place < input_.map_index.size(); ++place)
      keys.push_back(map_tag(static_cast<int>(place), map).key);
    return keys;
  }
  bool is_held_tag_refined() const { return anchor_ == input_.held_tag; }

  /// Where the held tag has no pictures to be used, places rest on another one, and on what the corners say
  /// of that one. Errors that corners and pictures share then count twice; nothing tells how those of cameras
  /// or constraints add up.
  std::string why_held_tag_is_needed() const {
    if (is_held_tag_refined()) return "";
    const bool has_cameras =
        !std::ranges::all_of(calibration_.corrections, &CameraCorrection::is_of_edges) ||
        !std::ranges::all_of(calibration_.open_corrections, &CameraCorrection::is_of_edges);
    const bool has_prints = calibration_.print_batches || calibration_.print_aspect;
    if (calibration_.constraints.empty() && !has_cameras && !has_prints) return "";
    return fmt::format(
        "too few pictures of the held tag {} can be used, and {} weigh against them: hold another tag",
        to_string(calibration_.held_tag),
        !calibration_.constraints.empty() ? "constraints"
        : has_cameras                     ? "cameras that are not as their file says"
                                          : "prints that may not be as stated");
  }

  void take_joint(const PoseInformation& poses, const ErrorScale& scale,
                  const std::optional<SharedErrors>& shared, RefinementResult& result) const {
    std::vector<int> tags = tags_;
    if (!is_held_tag_refined() && input_.held_tag >= 0)  // its rows are zero
      tags.insert(std::ranges::lower_bound(tags, input_.held_tag), input_.held_tag);
    std::vector<TagKey> keys;
    for (const int tag : tags) keys.push_back(map_tag(tag, result.map).key);
    result.joint = joint_tag_covariance(poses, tags, std::move(keys), scale, shared);
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

  ConstraintNotes keep_to_constraints(const CovarianceOperator& joint, Covariances& covariances,
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
    take_audits(constrained.audits, result);
    return std::move(constrained.notes);
  }

  /// Of the constraints that are used; what was said of the others stands.
  static void take_audits(const std::vector<ConstraintAudit>& audits, RefinementResult& result) {
    auto audit = audits.begin();
    for (ConstraintAudit& one : result.constraint_audits) {
      if (one.is_used && audit != audits.end()) one = *audit++;
    }
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

  const RefinedTags& refined_;
  const RefinementInput& input_;
  const std::vector<int>& tags_;
  const int anchor_;
  const CalibrationResult& calibration_;
};

}  // namespace

MapTag& RefinedTags::in(TagMap& map, int tag) const {
  return map.tags[static_cast<std::size_t>(input.map_index[static_cast<std::size_t>(tag)])];
}

std::string why_constrained_tag_is_needed(const std::vector<TagKey>& refined,
                                          const std::vector<MapConstraint>& constraints) {
  for (const MapConstraint& constraint : constraints) {
    for (const TagKey& key : tags_of(constraint)) {
      if (std::ranges::find(refined, key) == refined.end())
        return fmt::format("a constraint names {}, of which too few pictures can be used", to_string(key));
    }
  }
  return "";
}

std::string take_places(const RefinedTags& refined, const CalibrationResult& calibration,
                        const PhotometricState& state, const std::vector<LinearView>& views,
                        const RefinementOptions& options, RefinementResult& result,
                        std::optional<ConstraintNotes>& notes) {
  return RefinedPlaces(refined, calibration).take(state, views, options, result, notes);
}

}  // namespace apriltrack
