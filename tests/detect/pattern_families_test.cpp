// Corners by the whole pattern, and their covariance, of every kind of print: against the simulator's exact
// pictures.

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>

#include "apriltrack/base/random.h"
#include "apriltrack/detect/detector.h"
#include "apriltrack/sim/renderer.h"
#include "apriltrack/tags/tag_family.h"
#include "apriltrack/tags/tag_map.h"
#include "corner_statistics.h"
#include "edge_frame.h"
#include "lit_boards.h"

namespace apriltrack {
namespace {

using std::numbers::pi;

/// A kind of print.
struct Print {
  const char* family;
  bool has_squares = false;  ///< Kalibr's: black, 0.3 tags wide, at the tags' corners.
};

/// Twelve boards with a tag each, of cells of 2.5 to 7 px, seen at 0 to 50 degrees.
Scene scene_of_prints(const Print& print, std::uint64_t seed) {
  const TagFamily& family = TagFamily::get(print.family);
  RandomStream random(seed);
  Scene scene = test::lit_scene(random);
  Body boards{.name = "world", .T_world_body = {}, .panels = {}};
  const TagPrint paper{.margin_cells = 2.5};
  for (int i = 0; i < 12; ++i) {
    const double axis = random.uniform(0.0, 2.0 * pi);
    MapTag tag;
    tag.key = {family.name(), (i * family.num_codes() / 12 + static_cast<int>(seed)) % family.num_codes()};
    tag.size_m = family.width_at_border() * 2.5 * std::pow(2.8, random.uniform()) / test::kBoardsFocal_px;
    tag.T_map_tag = test::pose_of_board(i, axis, 50.0, random);
    scene.map.tags.push_back(tag);
  }
  add_tags(boards, scene.map, paper);
  if (print.has_squares) {
    for (const MapTag& tag : scene.map.tags) {
      for (const Eigen::Vector3d& corner : tag_corners(tag.size_m)) {
        Panel square;
        const double half_m = 0.15 * tag.size_m;
        const Eigen::Vector3d outwards = corner.cwiseSign() * half_m;
        square.T_body_panel = tag.T_map_tag * Pose(Eigen::Quaterniond::Identity(), corner + outwards);
        square.half_size_m = Eigen::Vector2d::Constant(half_m);
        square.reflectance = paper.ink;
        square.is_decal = true;
        boards.panels.push_back(square);
      }
    }
  }
  scene.bodies.push_back(boards);
  return scene;
}

class PatternFitOfPrint : public ::testing::TestWithParam<Print> {};

TEST_P(PatternFitOfPrint, IsUnbiasedAndClaimsTheErrorsThatItMakes) {
  test::CornerStatistics errors;
  double nees = 0.0;
  int tags = 0, found = 0, with_covariance = 0;
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const Scene scene = scene_of_prints(GetParam(), seed);
    const GrayImage image = Renderer(scene, {.seed = seed}).render(0).pixels;
    Detector detector({.families = {GetParam().family}, .camera_model = scene.camera.model});
    const auto detections = detector.detect(image.view());
    for (const MapTag& tag : scene.map.tags) {
      ++tags;
      const auto detection = std::ranges::find(detections, tag.key, &Detection::tag);
      if (detection == detections.end()) continue;
      ++found;
      Quad truth;
      Eigen::Matrix<double, 8, 1> error;
      for (std::size_t k = 0; k < kNumCorners; ++k) {
        truth[k] = *scene.camera.model.project(corners_in_map(tag)[k]);
        error.segment<2>(2 * static_cast<Eigen::Index>(k)) = detection->corners_px[k] - truth[k];
      }
      errors.add(detection->corners_px, truth);
      if (!detection->covariance_px2) continue;
      ++with_covariance;
      nees += error.dot(detection->covariance_px2->ldlt().solve(error)) / 8.0;
    }
  }
  EXPECT_GE(found, 54) << "of " << tags;
  EXPECT_EQ(with_covariance, found);
  EXPECT_LT(std::abs(errors.radial_bias_px()), 0.005);
  EXPECT_LT(errors.rms_per_axis_px(), 0.02);
  EXPECT_LT(errors.largest_px(), 0.15);
  // The mean of 430 numbers and more has a standard deviation of 0.07. A lens that is no Gaussian leaves 1.2
  // to 1.54.
  EXPECT_GT(nees / with_covariance, 0.8);
  EXPECT_LT(nees / with_covariance, 1.7);
}

INSTANTIATE_TEST_SUITE_P(Kinds, PatternFitOfPrint,
                         ::testing::Values(Print{"tag36h11"}, Print{"tag16h5"}, Print{"tag36h11b2"},
                                           Print{"tag36h11b2", true}, Print{"tagStandard41h12"},
                                           Print{"tagCircle21h7"}, Print{"tagCircle49h12"},
                                           Print{"tagCustom48h12"}, Print{"tagStandard52h13"}));

}  // namespace
}  // namespace apriltrack
