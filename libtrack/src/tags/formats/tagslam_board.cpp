// TagSLAM's bodies of the types `board` and `staggered_board` (berndpfrommer/tagslam, src/board.cpp and
// src/staggered_board.cpp). The first tag is at the origin; columns go along +x, and the next row is at +y of
// a board, at -y of a staggered one, which has every other place only, odd rows from the second one on. From
// one column or row to the next it is tag_size * (1 + tag_spacing): the spacing is in tags. Ids go along the
// rows. `pose`, which later versions have, is T_board_body.
#include "tagslam_board.h"

#include <fmt/format.h>

#include "../tag_fields.h"
#include "tagslam_fields.h"

namespace apriltrack {
namespace {

/// More than any family has tags.
constexpr long long kMaxPlaces = 100'000;

int read_count(const YamlNode& node) {
  const int count = node.as_int();
  if (count < 1 || count > kMaxPlaces)
    node.fail(fmt::format("must lie in [1, {}] (is {})", kMaxPlaces, count));
  return count;
}

/// From one place of the grid to the next, in metres.
double read_step_m(const YamlNode& board, double size_m) {
  const YamlNode node = board.at("tag_spacing");
  const double spacing = node.as_double();
  if (!(spacing >= 0.0 && spacing <= 1000.0))
    node.fail(
        fmt::format("is the gap between two tags, in tags, and must lie in [0, 1000] (is {})", spacing));
  return size_m * (1.0 + spacing);
}

double read_noise(const YamlNode& board, std::string_view key) {
  const auto node = board.find(key);
  const double sigma = node ? node->as_double() : 0.0;
  if (sigma < 0.0) node->fail(fmt::format("is a standard deviation and must be >= 0 (is {})", sigma));
  return sigma;
}

/// Of each tag, along each axis; nullopt where none is stated.
std::optional<Matrix6d> covariance_of_board(const YamlNode& board) {
  const double position_m = read_noise(board, "tag_position_noise");
  const double rotation_rad = read_noise(board, "tag_rotation_noise");
  if (position_m == 0.0 && rotation_rad == 0.0) return std::nullopt;
  Vector6d sigmas;
  sigmas << Eigen::Vector3d::Constant(position_m), Eigen::Vector3d::Constant(rotation_rad);
  return Matrix6d(sigmas.cwiseAbs2().asDiagonal());
}

Pose read_T_body_board(const YamlNode& board) {
  const auto pose = board.find("pose");
  const auto T_board_body = pose ? tagslam_pose(*pose) : std::nullopt;
  return T_board_body ? T_board_body->inverse() : Pose();
}

}  // namespace

bool is_tagslam_board(const std::string& type) {
  return type == "board" || type == "staggered_board";
}

std::vector<ForeignTag> tags_of_tagslam_board(const std::string& type, const YamlNode& board,
                                              std::vector<std::string>& foreign) {
  note_foreign_keys(board,
                    {"tag_start_id", "tag_size", "tag_spacing", "tag_rows", "tag_columns", "tag_bits",
                     "tag_rotation_noise", "tag_position_noise", "pose"},
                    foreign);
  const bool is_staggered = type == "staggered_board";
  const int rows = read_count(board.at("tag_rows")), columns = read_count(board.at("tag_columns"));
  if (static_cast<long long>(rows) * columns > kMaxPlaces)
    board.fail(fmt::format("has {} x {} places; at most {} are read", rows, columns, kMaxPlaces));
  ForeignTag tag{.place = MapPlace::of(board), .id = board.at("tag_start_id").as_int()};
  if (tag.id < 0) board.at("tag_start_id").fail(fmt::format("must be >= 0 (is {})", tag.id));
  if (tag.id > 1'000'000'000) board.at("tag_start_id").fail("is an id that no family has");
  tag.size_m = read_tag_size(board.at("tag_size"));
  if (const auto bits = board.find("tag_bits")) tag.family = family_of_bits(*bits);
  const double step_m = read_step_m(board, *tag.size_m);
  tag.covariance = covariance_of_board(board);
  const Pose T_body_board = read_T_body_board(board);
  std::vector<ForeignTag> tags;
  for (int row = 0; row < rows; ++row) {
    for (int column = is_staggered ? row % 2 : 0; column < columns; column += is_staggered ? 2 : 1) {
      const Eigen::Vector3d centre(column * step_m, (is_staggered ? -row : row) * step_m, 0.0);
      const Pose T_board_tag(Eigen::Quaterniond::Identity(), centre);
      tag.T_map_tag = pose_from_frame(T_body_board * T_board_tag, rotation_ros_tag());
      tags.push_back(tag);
      ++tag.id;
    }
  }
  return tags;
}

}  // namespace apriltrack
