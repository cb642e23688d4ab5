// What counts of a part of which some tags are not mapped.
#include "observations/parts.h"

#include <gmock/gmock.h>

namespace apriltrack {
namespace {

using ::testing::ElementsAre;

TEST(NarrowedTo, CountsATagThatTwoCamerasSeeOnce) {
  Observations observations;
  for (int id = 0; id < 3; ++id) observations.tags.push_back({"tag36h11", id});
  const auto add = [&](int frame, int camera, int tag) {
    TagView view;
    view.corners_px.fill(Eigen::Vector2d::Zero());
    view.whitening.setIdentity();
    view.inward.setZero();
    view.frame = frame;
    view.camera = camera;
    view.tag = tag;
    observations.views.push_back(view);
  };
  for (const int camera : {0, 1}) {
    add(0, camera, 0);  // and tag 2, which is not mapped
    add(0, camera, 2);
  }
  for (const int camera : {0, 1}) {
    add(1, camera, 0);
    add(1, camera, 1);
  }
  const Part part{{0, 1, 2}, {0, 1, 2, 3, 4, 5, 6, 7}};
  EXPECT_THAT(narrowed_to(observations, part, {0, 1}).views, ElementsAre(4, 5, 6, 7));
}

}  // namespace
}  // namespace apriltrack
