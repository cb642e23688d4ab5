#include "apriltrack/calib/joint_covariance.h"

#include <fmt/format.h>

#include <algorithm>
#include <string>

#include "apriltrack/base/check.h"
#include "apriltrack/io/atomic_file.h"
#include "apriltrack/io/numbers.h"

namespace apriltrack {

std::optional<Eigen::Index> JointCovariance::row_of(const TagKey& tag) const {
  const auto found = std::ranges::find(tags, tag);
  if (found == tags.end()) return std::nullopt;
  return 6 * static_cast<Eigen::Index>(found - tags.begin());
}

Eigen::MatrixXd JointCovariance::matrix() const {
  return by_noise + by_errors * by_errors.transpose();
}

Matrix6d JointCovariance::block(Eigen::Index row_a, Eigen::Index row_b) const {
  return by_noise.block<6, 6>(row_a, row_b) +
         by_errors.middleRows<6>(row_a) * by_errors.middleRows<6>(row_b).transpose();
}

std::optional<Matrix6d> relative_covariance(const TagMap& map, const JointCovariance& joint, const TagKey& a,
                                            const TagKey& b) {
  const MapTag *tag_a = map.find(a), *tag_b = map.find(b);
  APRILTRACK_CHECK(tag_a != nullptr && tag_b != nullptr, "both tags must be in the map");
  const auto row_a = joint.row_of(a), row_b = joint.row_of(b);
  if (!row_a || !row_b) return std::nullopt;
  // T_a_b' = exp(-xi_a) T_a_b exp(xi_b) = T_a_b exp(xi_b - Ad(T_b_a) xi_a), to first order
  const Matrix6d A = (tag_b->T_map_tag.inverse() * tag_a->T_map_tag).adjoint();
  const Matrix6d cross = A * joint.block(*row_a, *row_b);
  const Matrix6d covariance = joint.block(*row_b, *row_b) - cross - cross.transpose() +
                              A * joint.block(*row_a, *row_a) * A.transpose();
  return Matrix6d(0.5 * (covariance + covariance.transpose()));
}

void write_joint_covariance(const std::filesystem::path& path, const TagMap& map,
                            const JointCovariance& joint) {
  std::string text = fmt::format(
      "# Covariance of the poses T_map_tag of all tags together: right perturbations [translation; "
      "rotation],\n"
      "# m and rad, six rows and columns for each tag in the order of `tags`; frame '{}'.\n"
      "apriltrack_joint_covariance: 1\ntags:\n",
      map.frame);
  for (const TagKey& tag : joint.tags)
    text += fmt::format("  - {{family: {}, id: {}}}\n", tag.family, tag.id);
  text += "covariance:  # rows\n";
  const Eigen::MatrixXd all = joint.matrix();
  for (Eigen::Index row = 0; row < all.rows(); ++row) {
    text += "  - [";
    for (Eigen::Index column = 0; column < all.cols(); ++column)
      text += (column == 0 ? "" : ", ") + format_exact(all(row, column));
    text += "]\n";
  }
  write_file_atomically(path, text);
}

}  // namespace apriltrack
