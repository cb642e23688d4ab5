// A print that is wider than high, or a lens whose pixels are: nothing in the views tells which.
#include "hypotheses/print_aspect.h"

#include <gmock/gmock.h>

#include <cmath>

#include "apriltrack/geometry/tag_corners.h"
#include "calibrating.h"

namespace apriltrack {
namespace {

using test::SyntheticWorld;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;

CameraRefinement with_aspects(const std::vector<std::pair<double, double>>& values_and_sigmas) {
  CameraRefinement cameras;
  cameras.is_accepted = true;
  for (const auto& [value, sigma] : values_and_sigmas) {
    EstimatedParameter one;
    one.parameter.camera = static_cast<int>(cameras.estimates.size());
    one.parameter.kind = CameraParameter::Kind::kAspect;
    one.value = value;
    one.sigma = sigma;
    cameras.estimates.push_back(one);
  }
  return cameras;
}

/// Of cameras 0, 1, ..., in their order.
std::optional<double> aspect_by(const std::vector<std::pair<double, double>>& values_and_sigmas) {
  std::set<int> used;
  for (std::size_t camera = 0; camera < values_and_sigmas.size(); ++camera)
    used.insert(static_cast<int>(camera));
  return find_print_aspect(with_aspects(values_and_sigmas), used);
}

TEST(PrintAspect, IsWhatAllLensesSay) {
  EXPECT_NEAR(*aspect_by({{-0.01, 0.001}}), 0.01, 1e-12);
  EXPECT_NEAR(*aspect_by({{0.010, 0.001}, {0.012, 0.001}}), -0.011, 1e-12);
  EXPECT_FALSE(aspect_by({{0.01, 0.001}, {-0.01, 0.001}})) << "no print is both";
  EXPECT_FALSE(aspect_by({{0.01, 0.001}, {0.0, 0.001}})) << "one lens sees none";
  EXPECT_FALSE(aspect_by({{0.01, 0.005}})) << "not clear";
  EXPECT_FALSE(aspect_by({{0.002, 0.0001}})) << "pixels may be that";
  EXPECT_FALSE(aspect_by({{0.01, 0.001}, {0.02, 0.001}})) << "no print is both";
  EXPECT_FALSE(aspect_by({{0.04, 0.001}})) << "no printer is that far off";
  EXPECT_FALSE(find_print_aspect(with_aspects({{0.01, 0.001}}), {0, 1})) << "of one lens nothing is known";
  EXPECT_FALSE(aspect_by({}));
}

/// All tags printed wider than stated, the height right.
std::vector<FrameDetections> filmed_wider(const SyntheticWorld& world, double wider, double noise_px) {
  std::vector<FrameDetections> frames = test::exact_detections(world);
  for (std::size_t i = 0; i < frames.size(); ++i) {
    for (Detection& detection : frames[i].detections) {
      const MapTag& tag = *world.map.find(detection.tag);
      auto corners = tag_corners(tag.size_m);
      for (std::size_t c = 0; c < corners.size(); ++c) {
        corners[c].x() *= 1.0 + wider;
        detection.corners_px[c] =
            *world.rig.cameras[0].model.project(world.T_world_rig[i].inverse() * tag.T_map_tag * corners[c]);
      }
    }
  }
  RandomStream random(3);
  test::add_edge_noise(frames, noise_px, -0.45, random);
  return frames;
}

TEST(PrintAspect, IsToldAndCountedBesideTheLens) {
  const SyntheticWorld world = test::make_room(14, 120, test::perspective_camera());
  for (const double wider : {0.015, -0.015}) {
    const CalibrationResult result = test::calibrate(world, filmed_wider(world, wider, 0.1));
    ASSERT_TRUE(result.print_aspect) << wider;
    EXPECT_NEAR(*result.print_aspect, wider, 0.005);
    EXPECT_THAT(result.warnings, Contains(HasSubstr(wider > 0.0 ? "% wider than high look like a lens"
                                                                : "% higher than wide look like a lens")));
    EXPECT_LT(test::mean_normalised_error(world, result), 2.5) << wider;
  }
}

TEST(PrintAspect, IsCountedWhereItIsTheLens) {
  const SyntheticWorld truth = test::make_room(14, 120, test::perspective_camera());
  std::vector<FrameDetections> frames = test::exact_detections(truth);
  RandomStream random(3);
  test::add_edge_noise(frames, 0.1, -0.45, random);
  SyntheticWorld stated = truth;
  Pinhole pinhole = truth.rig.cameras[0].model.pinhole();
  pinhole.fy *= 1.01;
  stated.rig.cameras[0].model = CameraModel(pinhole, truth.rig.cameras[0].model.distortion());
  const CalibrationResult result = test::calibrate(stated, frames);
  ASSERT_TRUE(result.print_aspect);
  EXPECT_LT(test::mean_normalised_error(truth, result), 2.0);
  EXPECT_GT(test::mean_normalised_error(truth, result), 0.01);
}

TEST(PrintAspect, IsNotToldOfSquareTags) {
  const SyntheticWorld world = test::make_room(14, 120, test::perspective_camera());
  const CalibrationResult result = test::calibrate(world, filmed_wider(world, 0.0, 0.1));
  EXPECT_FALSE(result.print_aspect);
  EXPECT_THAT(result.warnings, Not(Contains(HasSubstr("wider than high"))));
}

}  // namespace
}  // namespace apriltrack
