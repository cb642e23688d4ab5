#include "apriltrack/calib/joint_covariance.h"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <string>
#include <string_view>

#include "apriltrack/base/check.h"
#include "apriltrack/io/atomic_file.h"
#include "apriltrack/io/numbers.h"
#include "apriltrack/tags/tag_map.h"

namespace apriltrack {
namespace {

/// Some rows at a time: neither the whole matrix nor its text is ever in memory.
void write_rows(const JointCovariance& joint, const std::function<void(std::string_view)>& write) {
  constexpr Eigen::Index kRows = 96;
  const Eigen::Index size = joint.by_noise.rows();
  Eigen::MatrixXd rows;
  for (Eigen::Index first = 0; first < size; first += kRows) {
    const Eigen::Index count = std::min(kRows, size - first);
    rows = joint.by_noise.middleRows(first, count);
    rows.noalias() += joint.by_errors.middleRows(first, count) * joint.by_errors.transpose();
    for (Eigen::Index row = 0; row < count; ++row) {
      std::string text = "  - [";
      for (Eigen::Index column = 0; column < size; ++column)
        text += (column == 0 ? "" : ", ") + format_exact(rows(row, column));
      write(text + "]\n");
    }
  }
}

}  // namespace

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
  const std::string head = fmt::format(
      "# Covariance of the poses T_map_tag of all tags together: right perturbations [translation; "
      "rotation],\n"
      "# m and rad, six rows and columns for each tag in the order of `tags`; frame '{}'.\n"
      "apriltrack_joint_covariance: 1\ntags:\n",
      map.frame);
  write_pieces_atomically(path, [&](const auto& write) {
    write(head);
    for (const TagKey& tag : joint.tags)
      write(fmt::format("  - {{family: {}, id: {}}}\n", tag.family, tag.id));
    write("covariance:  # rows\n");
    write_rows(joint, write);
  });
}

}  // namespace apriltrack
