// g2o's types_slam3d: VERTEX_SE3:QUAT id x y z qx qy qz qw; EDGE_SE3:QUAT from to pose and the upper triangle
// of the information. The error of an edge is (translation, vector part of the quaternion) of measurement^-1
// * estimate (edge_se3.cpp, isometry3d_mappings.cpp there): the vector part is half the rotation vector, so
// that its information is four times ours.
#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <set>

#include "apriltrack/io/numbers.h"
#include "export_words.h"
#include "writers.h"

namespace apriltrack {
namespace {

/// The tags' ids where they are distinct, else places in the map.
std::vector<int> vertex_ids(const TagMap& map) {
  std::vector<int> ids;
  for (const MapTag& tag : map.tags) ids.push_back(tag.key.id);
  if (std::set<int>(ids.begin(), ids.end()).size() < ids.size()) {
    for (std::size_t i = 0; i < ids.size(); ++i) ids[i] = static_cast<int>(i);
  }
  return ids;
}

/// The upper triangle, row by row; nullopt of a covariance that has no inverse.
std::optional<std::string> g2o_information(const Matrix6d& covariance) {
  const Eigen::LLT<Matrix6d> llt(covariance);
  if (llt.info() != Eigen::Success || llt.rcond() < 1e-14) return std::nullopt;
  const Vector6d scale = (Vector6d() << 1.0, 1.0, 1.0, 2.0, 2.0, 2.0).finished();
  const Matrix6d information = scale.asDiagonal() * llt.solve(Matrix6d::Identity()) * scale.asDiagonal();
  std::string text;
  for (int row = 0; row < 6; ++row) {
    for (int column = row; column < 6; ++column)
      text += fmt::format(" {}", format_exact(0.5 * (information(row, column) + information(column, row))));
  }
  return text;
}

}  // namespace

std::string g2o_text(const TagMap& map, std::vector<std::string>& left_out) {
  const std::vector<int> ids = vertex_ids(map);
  const int root = *std::ranges::max_element(ids) + 1;
  std::string vertices = fmt::format("VERTEX_SE3:QUAT {} 0 0 0 0 0 0 1\nFIX {}\n", root, root);
  std::string edges, names;
  for (std::size_t i = 0; i < map.tags.size(); ++i) {
    const MapTag& tag = map.tags[i];
    names += fmt::format("# {} is {}\n", ids[i], to_string(tag.key));
    vertices += fmt::format("VERTEX_SE3:QUAT {} {}\n", ids[i], exact_numbers(tag.T_map_tag));
    if (!tag.covariance) continue;
    if (const auto information = g2o_information(*tag.covariance))
      edges +=
          fmt::format("EDGE_SE3:QUAT {} {} {}{}\n", root, ids[i], exact_numbers(tag.T_map_tag), *information);
    else if (tag.covariance->isZero(0.0))
      vertices += fmt::format("FIX {}\n", ids[i]);
    else
      left_out.push_back(to_string(tag.key));
  }
  return fmt::format(
      "# Tags of frame {}, T_map_tag; {} is the map's frame. Edges: covariances, where they are "
      "known.\n{}{}{}",
      plain_name(map.frame), root, names, vertices, edges);
}

}  // namespace apriltrack
