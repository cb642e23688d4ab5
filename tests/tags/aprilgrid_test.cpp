#include "apriltrack/tags/aprilgrid.h"

#include <gtest/gtest.h>

#include <cmath>

#include "apriltrack/base/error.h"
#include "apriltrack/io/atomic_file.h"
#include "apriltrack/tags/tag_corners.h"
#include "support/shared_data.h"

namespace apriltrack {
namespace {

/// What a reader says about a file of this text.
std::string complaint_about(const std::string& text) {
  const auto path = test::temporary_folder() / "target.yaml";
  write_file_atomically(path, text);
  try {
    read_aprilgrid(path);
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::kInvalidInput);
    return error.what();
  }
  return "no complaint";
}

/// Kalibr's drawing, filled shape by shape as kalibr_create_target_pdf does, y up: an independent
/// construction.
double brush(const AprilGrid& grid, double x, double y_up) {
  const double lane = grid.tag_spacing * grid.tag_size_m;
  const auto within = [](double a, double low, double width) { return a > low && a < low + width; };
  double light = 1.0;
  for (int row = 0; row < grid.rows; ++row) {
    for (int column = 0; column < grid.columns; ++column) {
      const double left = column * (1.0 + grid.tag_spacing) * grid.tag_size_m;
      const double bottom = row * (1.0 + grid.tag_spacing) * grid.tag_size_m;
      for (const double dx : {-lane, grid.tag_size_m}) {
        for (const double dy : {-lane, grid.tag_size_m}) {
          if (within(x, left + dx, lane) && within(y_up, bottom + dy, lane)) light = 0.0;
        }
      }
      if (within(x, left, grid.tag_size_m) && within(y_up, bottom, grid.tag_size_m)) {
        const auto pattern =
            TagFamily::get("tag36h11b2").pattern(grid.first_id + row * grid.columns + column);
        const int from_left = static_cast<int>((x - left) / grid.tag_size_m * 10.0);
        const int from_top = 9 - static_cast<int>((y_up - bottom) / grid.tag_size_m * 10.0);
        light = pattern.cells()(1 + from_left, 1 + from_top);
      }
    }
  }
  return light;
}

TEST(AprilGrid, PictureIsKalibrsDrawing) {
  const AprilGrid grid{.rows = 3, .columns = 4, .tag_size_m = 0.1, .tag_spacing = 0.25, .first_id = 7};
  const AprilGridPicture picture(grid);
  int black = 0;
  int points = 0;
  // Steps that share no factor with the cells' edges, so that no point lies on one.
  for (double x = -0.0503; x < 0.56; x += 0.00317) {
    for (double y = -0.0507; y < 0.43; y += 0.00323) {
      ASSERT_EQ(picture.brightness(x, -y), brush(grid, x, y)) << "x " << x << " up " << y;
      black += picture.brightness(x, -y) == 0.0;
      ++points;
    }
  }
  EXPECT_GT(points, 20000);
  EXPECT_GT(black, points / 4);
  EXPECT_LT(black, points * 3 / 4);
}

TEST(AprilGrid, CornerSquaresTouchTheTagsCorners) {
  const AprilGrid grid;
  const AprilGridPicture picture(grid);
  const double lane = 0.3 * 0.088;
  // 7 x 7 squares for 6 x 6 tags; the lanes between two squares are white.
  for (int row = 0; row <= 6; ++row) {
    for (int column = 0; column <= 6; ++column) {
      const double x = column * 0.1144 - 0.5 * lane;
      const double y = -(row * 0.1144 - 0.5 * lane);
      EXPECT_EQ(picture.brightness(x, y), 0.0);
      EXPECT_EQ(picture.brightness(x + 0.49 * lane, y - 0.49 * lane), 0.0);
      EXPECT_EQ(picture.brightness(x + 0.55 * lane, y), 1.0);
      EXPECT_EQ(picture.brightness(x, y + 0.55 * lane), 1.0);
    }
  }
  const auto area = grid.printed_area_m();
  EXPECT_NEAR(area.min().x(), -lane, 1e-15);
  EXPECT_NEAR(area.max().x(), 6 * 0.1144, 1e-15);
  EXPECT_NEAR(area.min().y(), -6 * 0.1144, 1e-15);
  EXPECT_NEAR(area.max().y(), lane, 1e-15);
  EXPECT_EQ(picture.brightness(std::nan(""), 0.0), 1.0);
  EXPECT_EQ(picture.brightness(1e300, 0.0), 1.0);
}

TEST(AprilGrid, PictureAndMapAgree) {
  const AprilGrid grid{.rows = 2, .columns = 3, .tag_size_m = 0.05, .tag_spacing = 0.4, .first_id = 100};
  const AprilGridPicture picture(grid);
  const TagMap map = grid.map();
  ASSERT_EQ(map.tags.size(), 6u);
  for (const MapTag& tag : map.tags) {
    const TagPattern pattern = TagFamily::get("tag36h11b2").pattern(tag.key.id);
    for (double u = -0.99; u < 1.0; u += 0.0931) {
      for (double v = -0.99; v < 1.0; v += 0.0931) {
        const Eigen::Vector3d point = tag.T_map_tag * Eigen::Vector3d(0.025 * u, 0.025 * v, 0.0);
        ASSERT_EQ(picture.brightness(point.x(), point.y()), pattern.brightness(u, v)) << to_string(tag.key);
      }
    }
  }
}

TEST(AprilGrid, MapIsThatOfThePrintedBoardOfEuroc) {
  APRILTRACK_SHARED_OR_SKIP(path, "data/euroc_aprilgrid/map.yaml");
  const TagMap expected = read_tag_map(path);
  const TagMap map = AprilGrid{}.map();
  ASSERT_EQ(map.tags.size(), expected.tags.size());
  for (const MapTag& tag : expected.tags) {
    const MapTag* ours = map.find({"tag36h11b2", tag.key.id});  // The recording labels its tags tag36h11.
    ASSERT_NE(ours, nullptr) << tag.key.id;
    EXPECT_EQ(ours->size_m, tag.size_m);
    for (int i = 0; i < 4; ++i) {
      EXPECT_LT((corners_in_map(*ours)[i] - corners_in_map(tag)[i]).norm(), 1e-9) << "tag " << tag.key.id;
    }
  }
}

TEST(AprilGrid, ReadsKalibrsTargetFile) {
  const auto path = test::temporary_folder() / "april_6x6.yaml";
  write_file_atomically(path,
                        "target_type: 'aprilgrid' #gridtype\ntagCols: 5  #number of apriltags\ntagRows: 7\n"
                        "tagSize: 0.088  #edge to edge [m]\ntagSpacing: 0.3 #ratio\ncodeOffset: 3\n");
  const AprilGrid grid = read_aprilgrid(path);
  EXPECT_EQ(grid.columns, 5);
  EXPECT_EQ(grid.rows, 7);
  EXPECT_EQ(grid.tag_size_m, 0.088);
  EXPECT_EQ(grid.tag_spacing, 0.3);
  EXPECT_EQ(grid.first_id, 3);
  EXPECT_EQ(grid.map().tags.back().key.id, 37);
}

TEST(AprilGrid, NamesLineAndKeyOfAWrongTargetFile) {
  const auto text = [](const std::string& type, const std::string& rows, const std::string& size,
                       const std::string& spacing, const std::string& more) {
    return "target_type: " + type + "\ntagRows: " + rows + "\ntagCols: 6\ntagSize: " + size +
           "\ntagSpacing: " + spacing + "\n" + more;
  };
  const std::vector<std::pair<std::string, std::string>> cases = {
      {text("checkerboard", "6", "0.1", "0.3", ""), "target.yaml:1: target_type: "},
      {text("aprilgrid", "0", "0.1", "0.3", ""), "target.yaml:2: tagRows: "},
      {text("aprilgrid", "1001", "0.1", "0.3", ""), "target.yaml:2: tagRows: "},
      {text("aprilgrid", "6.5", "0.1", "0.3", ""), "target.yaml:2: tagRows: "},
      {text("aprilgrid", "6", "-0.1", "0.3", ""), "target.yaml:4: tagSize: "},
      {text("aprilgrid", "6", ".nan", "0.3", ""), "target.yaml:4: tagSize: "},
      {text("aprilgrid", "6", "0.1", "0", ""), "target.yaml:5: tagSpacing: "},
      {text("aprilgrid", "6", "0.1", "1.5", ""), "target.yaml:5: tagSpacing: "},
      {text("aprilgrid", "6", "0.1", "0.3", "codeOffset: 552"), "target.yaml:6: codeOffset: "},
      {text("aprilgrid", "6", "0.1", "0.3", "codeOffset: -1"), "target.yaml:6: codeOffset: "},
      {text("aprilgrid", "6", "0.1", "0.3", "tagsize: 1"), "target.yaml:6: tagsize: "},
      {text("aprilgrid", "100", "0.1", "0.3", ""), "target.yaml:2: tagRows: "},
      {"target_type: aprilgrid\n", "'tagRows' is missing"},
  };
  for (const auto& [contents, expected] : cases) {
    const std::string message = complaint_about(contents);
    EXPECT_NE(message.find(expected), std::string::npos) << message << "\nfor\n" << contents;
  }
  // 36 tags from id 551 on are the last that fit.
  EXPECT_EQ(complaint_about(text("aprilgrid", "6", "0.1", "0.3", "codeOffset: 551")), "no complaint");
}

TEST(AprilGrid, RefusesFieldsOutOfRange) {
  for (const AprilGrid& grid :
       {AprilGrid{.rows = 0}, AprilGrid{.columns = -1}, AprilGrid{.tag_size_m = 0.0},
        AprilGrid{.tag_size_m = HUGE_VAL}, AprilGrid{.tag_spacing = 0.0}, AprilGrid{.tag_spacing = 1.01},
        AprilGrid{.first_id = -1}, AprilGrid{.first_id = 552}}) {
    EXPECT_THROW(grid.check(), Error);
    EXPECT_THROW(grid.map(), Error);
    EXPECT_THROW(AprilGridPicture{grid}, Error);
  }
}

}  // namespace
}  // namespace apriltrack
