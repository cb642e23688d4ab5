#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <optional>
#include <vector>

#include "apriltrack/tags/tag_map.h"

namespace apriltrack {

/// How the errors of all tags of a map hang together: what a covariance per tag cannot tell. Right
/// perturbations of T_map_tag, [translation; rotation], six rows for each of `tags`, relative to the map's
/// gauge; the rows of a held tag are zero.
struct JointCovariance {
  std::vector<TagKey> tags;  ///< Empty where there is none: the map has too many tags, or its views are gone.
  Eigen::MatrixXd by_noise;  ///< 6N x 6N: what more views lessen.
  /// 6N x 8N: how the poses follow the errors that each tag keeps in all of its views, eight independent ones
  /// of unit variance per tag: of its edges, whitened, or of its corners (x0, y0, x1, ...).
  Eigen::MatrixXd by_errors;
  bool are_errors_of_corners = false;
  double noise_variance = 1.0;  ///< Of one view's corners, whitened as MapEvidence::noise has it expected.
  double bias_sigma = 0.0;      ///< Of the errors that a tag keeps: in the same units; of corners, in pixels.

  bool is_empty() const { return tags.empty(); }
  /// Where the tag's six rows start; nullopt for a tag that is not in it.
  std::optional<Eigen::Index> row_of(const TagKey& tag) const;
  /// 6N x 6N: all of it.
  Eigen::MatrixXd matrix() const;
  /// The 6 x 6 block between two tags, by their rows.
  Matrix6d block(Eigen::Index row_a, Eigen::Index row_b) const;
};

/// Covariance of T_a_b, the pose of tag b seen from tag a (right perturbation, so in tag b's own axes). Does
/// not depend on the gauge: whichever tag is held, it stays the same. nullopt where `joint` does not have
/// both tags. Requires both in `map`, where the poses are those that `joint` was made at.
std::optional<Matrix6d> relative_covariance(const TagMap& map, const JointCovariance& joint, const TagKey& a,
                                            const TagKey& b);

/// Writes tags and covariance as YAML (docs/file_formats.md). Throws Error(kIo); an existing file is replaced
/// only when the new one is complete.
void write_joint_covariance(const std::filesystem::path& path, const TagMap& map,
                            const JointCovariance& joint);

}  // namespace apriltrack
