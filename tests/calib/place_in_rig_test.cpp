// Where a camera sits in its rig, by what the camera file says of it and of those before it.
#include "observations/place_in_rig.h"

#include <gtest/gtest.h>

#include "apriltrack/base/error.h"
#include "support/pose_matchers.h"
#include "synthetic_world.h"

namespace apriltrack {
namespace {

using test::PoseNear;

Pose shifted(double x_m, double y_m) {
  return {Eigen::Quaterniond::Identity(), {x_m, y_m, 0.0}};
}

/// cam1 is 0.1 m, cam2 another 0.2 m to the right of the camera before: what lies in cam1 lies in cam2 at
/// 0.2 m less.
CameraRig three_cameras() {
  CameraRig rig;
  for (const char* name : {"cam0", "cam1", "cam2"})
    rig.cameras.push_back({.name = name, .model = test::perspective_camera().model});
  rig.cameras[1].T_this_previous = shifted(-0.1, 0.0);
  rig.cameras[2].T_this_previous = shifted(-0.2, 0.05);
  return rig;
}

TEST(PlaceInRig, IsTheProductOfTheExtrinsicsBefore) {
  for (const bool is_one_of_several : {false, true}) {
    EXPECT_THAT(place_in_rig(three_cameras(), 0, is_one_of_several),
                PoseNear(Pose::identity(), 1e-12, 1e-12));
    EXPECT_THAT(place_in_rig(three_cameras(), 2, is_one_of_several),
                PoseNear(shifted(-0.3, 0.05), 1e-12, 1e-12));
  }
}

TEST(PlaceInRig, ACameraAloneNeedsNoExtrinsics) {
  CameraRig rig = three_cameras();
  rig.cameras[1].T_this_previous.reset();
  EXPECT_THAT(place_in_rig(rig, 1, false), PoseNear(Pose::identity(), 1e-12, 1e-12));
  // Nor one behind it, which hangs on what is not known.
  EXPECT_THAT(place_in_rig(rig, 2, false), PoseNear(Pose::identity(), 1e-12, 1e-12));
}

TEST(PlaceInRig, OneOfSeveralMustBePlaced) {
  CameraRig rig = three_cameras();
  rig.cameras[1].T_this_previous.reset();
  EXPECT_THROW(place_in_rig(rig, 1, true), Error);
  EXPECT_THROW(place_in_rig(rig, 2, true), Error);
}

}  // namespace
}  // namespace apriltrack
