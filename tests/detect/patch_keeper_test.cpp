// The pictures of a long recording stay few, and a tag that is seen seldom keeps its own.

#include "apriltrack/detect/patch_keeper.h"

#include <gtest/gtest.h>

namespace apriltrack {
namespace {

/// A tag of 40 px with its paper around it.
Detection tag_at(int id, double left_px) {
  return {{"tag36h11", id},
          {Eigen::Vector2d(left_px, 120.0), Eigen::Vector2d(left_px + 40.0, 120.0),
           Eigen::Vector2d(left_px + 40.0, 80.0), Eigen::Vector2d(left_px, 80.0)},
          0,
          80.0};
}

TEST(PatchKeeper, KeepsFewerOfALongRecordingAndAllOfARareTag) {
  const GrayImage image(320, 240);
  PatchKeeper keeper;
  int kept = 0, rare = 0, of_first = 0;
  for (int i = 0; i < 10'000; ++i) {
    FrameDetections frame;
    frame.detections = {tag_at(1, 40.0)};
    if (i % 500 == 7) frame.detections.push_back(tag_at(2, 200.0));  // 20 views in all
    keeper.keep(image.view(), frame);
    kept += !frame.patches.empty();
    rare += frame.patches.size() == 2;
    of_first += i < 400 && !frame.patches.empty();
  }
  EXPECT_EQ(of_first, 400);
  EXPECT_EQ(rare, 20);
  EXPECT_GT(kept, 1'500);
  EXPECT_LT(kept, 2'500);
}

}  // namespace
}  // namespace apriltrack
