#include "lens_by_single_views.h"

#include <gtest/gtest.h>

#include "adjusted_world.h"

// What single views, no two of which need to agree, say of a lens.

namespace apriltrack {
namespace {

test::AdjustedWorld filmed() {
  const test::SyntheticWorld world = test::make_room(14, 60, test::perspective_camera());
  std::vector<FrameDetections> frames = test::exact_detections(world);
  RandomStream random(45);
  test::add_edge_noise(frames, 0.15, -0.45, random);
  return {world, frames};
}

CameraModel changed(const CameraModel& model, double focal_factor, double right_px) {
  const Pinhole& p = model.pinhole();
  return {{focal_factor * p.fx, focal_factor * p.fy, p.cx + right_px, p.cy}, model.distortion()};
}

TEST(LensBySingleViews, IsRefutedWhereTagsLookLessSquareByIt) {
  const test::AdjustedWorld one = filmed();
  const CameraModel& right = one.observations.cameras[0].model;
  for (const CameraModel& wrong : {changed(right, 1.0, 60.0), changed(right, 0.92, 0.0)})
    EXPECT_TRUE(do_single_views_refute(one.observations, 0, wrong, parallel_for(2))) << wrong.pinhole().cx;
}

TEST(LensBySingleViews, IsNotRefutedWhereItIsRightAboutOrTheFileIsWrong) {
  test::AdjustedWorld one = filmed();
  const CameraModel right = one.observations.cameras[0].model;
  EXPECT_FALSE(do_single_views_refute(one.observations, 0, changed(right, 1.001, 0.5), parallel_for(2)));
  one.observations.cameras[0].model = changed(right, 1.05, 30.0);
  EXPECT_FALSE(do_single_views_refute(one.observations, 0, right, parallel_for(2)));
}

}  // namespace
}  // namespace apriltrack
