// Grids of tags of TagSLAM, laid out by hand as its board.cpp and staggered_board.cpp do: tags of 0.2 m with
// gaps of a quarter of a tag, so that it is 0.25 m from one to the next.
#include <gmock/gmock.h>

#include "hand_made_layout.h"

namespace apriltrack::test {
namespace {

using ::testing::HasSubstr;

constexpr const char* kGrid =
    "tag_start_id: 20, tag_rows: 2, tag_columns: 3, tag_size: 0.2, tag_spacing: 0.25";

std::string board(const std::string& type, const std::string& more = {}, const std::string& rest = {}) {
  return fmt::format("bodies:\n - wall:\n     type: {0}\n     is_static: true\n     {0}: {{{1}{2}}}\n{3}",
                     type, kGrid, more, rest);
}

/// In the plane of the board, whose y is up and whose z comes out of it.
PlacedTag on_board(double x, double y) {
  return {{x, y, 0}, {1, 0, 0}, {0, -1, 0}};
}

TEST(TagSlamBoard, IdsGoAlongTheRowsWhichGoUp) {
  const MapReading reading = read_layout(board("board"));
  EXPECT_EQ(reading.format, MapFormat::kTagSlam);
  EXPECT_EQ(reading.map.frame, "wall");
  ASSERT_EQ(reading.map.tags.size(), 6U);
  const std::vector<std::pair<double, double>> places = {{0, 0},    {0.25, 0},    {0.5, 0},
                                                         {0, 0.25}, {0.25, 0.25}, {0.5, 0.25}};
  for (std::size_t i = 0; i < places.size(); ++i) {
    const MapTag* tag = reading.map.find({"tag36h11", 20 + static_cast<int>(i)});
    ASSERT_TRUE(tag) << i;
    EXPECT_THAT(*tag, IsAt(on_board(places[i].first, places[i].second))) << i;
    EXPECT_EQ(tag->size_m, 0.2);
    EXPECT_FALSE(tag->covariance);
  }
  EXPECT_FALSE(loss_of(reading.losses, LossKind::kForeignKeys));
  EXPECT_FALSE(loss_of(reading.losses, LossKind::kTags));
}

TEST(TagSlamBoard, StaggeredRowsGoDownAndHaveEveryOtherPlace) {
  const MapReading reading = read_layout(board("staggered_board"));
  ASSERT_EQ(reading.map.tags.size(), 3U);
  EXPECT_THAT(*reading.map.find({"tag36h11", 20}), IsAt(on_board(0, 0)));
  EXPECT_THAT(*reading.map.find({"tag36h11", 21}), IsAt(on_board(0.5, 0)));
  EXPECT_THAT(*reading.map.find({"tag36h11", 22}), IsAt(on_board(0.25, -0.25)));
}

// The board's frame at (1, 2, 3) of the body, not turned: a point of the board is (1, 2, 3) further in the
// body; its pose is T_board_body, so that it says (-1, -2, -3). The body is at (10, 0, 0), turned by 90
// degrees about z: what is at (x, y) of it is at (10 - y, x).
TEST(TagSlamBoard, IsPlacedByItsOwnPoseAndThatOfTheBody) {
  const MapReading reading = read_layout(board(
      "board",
      ", tag_bits: 5, tag_position_noise: 0.01, tag_rotation_noise: 0.1, pose: {position: {x: -1, y: -2, "
      "z: -3}, rotation: {x: 0, y: 0, z: 0}}",
      "     pose:\n       position: {x: 10, y: 0, z: 0}\n       rotation: {x: 0, y: 0, z: "
      "1.5707963267948966}\n"));
  EXPECT_EQ(reading.map.frame, "world");
  const MapTag* tag = reading.map.find({"tag25h9", 25});
  ASSERT_TRUE(tag);
  EXPECT_THAT(*tag, IsAt(PlacedTag{{10 - 2.25, 1.5, 3}, {0, 1, 0}, {1, 0, 0}}));
  ASSERT_TRUE(tag->covariance);
  const Vector6d expected = (Vector6d() << 1e-4, 1e-4, 1e-4, 1e-2, 1e-2, 1e-2).finished();
  EXPECT_LT((tag->covariance->diagonal() - expected).norm(), 1e-15);
}

TEST(TagSlamBoard, TagsWithPosesOfTheirOwnAreThere) {
  const MapReading reading = read_layout(
      board("board", {},
            "     tags: [{id: 21, size: 0.2, pose: {position: {x: 1, y: 2, z: 0}, rotation: {x: 0, "
            "y: 0, z: 0}}}]\n"));
  ASSERT_EQ(reading.map.tags.size(), 6U);
  EXPECT_THAT(*reading.map.find({"tag36h11", 21}), IsAt(floor_tag()));
  EXPECT_THAT(*reading.map.find({"tag36h11", 22}), IsAt(on_board(0.5, 0)));
}

TEST(TagSlamBoard, KeysThatArePassedOverAreToldOfEveryBody) {
  const MapReading reading =
      read_layout(board("board", ", tag_colour: red", "     odom_topic: /odom\n") +
                  " - rig:\n     type: simple\n     is_static: false\n     ignore_tags: [3]\n");
  const ConversionLoss* loss = loss_of(reading.losses, LossKind::kForeignKeys);
  ASSERT_TRUE(loss);
  for (const char* key : {"tag_colour", "odom_topic", "ignore_tags"})
    EXPECT_THAT(loss->value, HasSubstr(key));
}

TEST(TagSlamBoard, WhatIsNoGridIsRefusedWithItsKey) {
  const auto with = [](const std::string& from, const std::string& to) {
    std::string text = board("board");
    return complaint_about_layout(text.replace(text.find(from), from.size(), to));
  };
  EXPECT_THAT(with("tag_rows: 2, ", ""), HasSubstr("tag_rows"));
  EXPECT_THAT(with("tag_rows: 2", "tag_rows: 0"), HasSubstr("tag_rows: must lie in [1, 100000] (is 0)"));
  EXPECT_THAT(with("tag_rows: 2", "tag_rows: 99999"), HasSubstr("99999 x 3 places; at most 100000"));
  EXPECT_THAT(with("tag_start_id: 20", "tag_start_id: -1"), HasSubstr("tag_start_id: must be >= 0 (is -1)"));
  EXPECT_THAT(with("tag_start_id: 20", "tag_start_id: 585"), HasSubstr("587"));
  EXPECT_THAT(with("tag_spacing: 0.25", "tag_spacing: -0.25"), HasSubstr("tag_spacing: is the gap"));
  EXPECT_THAT(with("tag_size: 0.2", "tag_size: 0"), HasSubstr("tag_size"));
}

}  // namespace
}  // namespace apriltrack::test
