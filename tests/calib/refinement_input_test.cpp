#include "photometric/refinement_input.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <vector>

#include "apriltrack/base/parallel.h"
#include "apriltrack/calib/refine_map.h"
#include "filmed_room.h"

// What of the pictures counts, and what those say that are held out.

namespace apriltrack {
namespace {

using test::FilmedRoom;
using ::testing::HasSubstr;

RefinementInput input_of(const FilmedRoom& filmed, const std::vector<FrameDetections>& frames) {
  return refinement_input(filmed.by_corners, frames, filmed.rig, RefinementOptions{}.max_moments,
                          parallel_for(1));
}

/// The mean of `width` x `height` pixels, of grey levels.
void smear(TagPatch& patch, int width, int height) {
  const GrayImage sharp = patch.pixels;
  for (int y = 0; y < sharp.height(); ++y) {
    for (int x = 0; x < sharp.width(); ++x) {
      double sum = 0.0;
      for (int j = 0; j < height; ++j) {
        for (int i = 0; i < width; ++i)
          sum += sharp(std::clamp(x + i - width / 2, 0, sharp.width() - 1),
                       std::clamp(y + j - height / 2, 0, sharp.height() - 1));
      }
      patch.pixels(x, y) = static_cast<std::uint8_t>(std::lround(sum / (width * height)));
    }
  }
}

/// Frames are too far apart in time for poses to tell of motion.
TEST(RefinementInput, LeavesOutPicturesThatSmearWhereNobodyTellsTheMotion) {
  const FilmedRoom& filmed = FilmedRoom::once();
  const auto num_sharp = input_of(filmed, filmed.frames).scene.views.size();
  std::size_t num_patches = 0, num_smeared = 0;
  std::vector<FrameDetections> some_smeared = filmed.frames, none_in_focus = filmed.frames;
  for (std::size_t i = 0; i < test::kNumFilmed; ++i) {
    num_patches += some_smeared[i].patches.size();
    if (i % 5 == 0) num_smeared += some_smeared[i].patches.size();
    for (TagPatch& patch : some_smeared[i].patches) {
      if (i % 5 == 0) smear(patch, 7, 1);
    }
    for (TagPatch& patch : none_in_focus[i].patches) {
      for (int round = 0; round < 2; ++round) smear(patch, 3, 3);
    }
  }
  EXPECT_GT(num_sharp, 0.95 * static_cast<double>(num_patches));
  EXPECT_NEAR(static_cast<double>(input_of(filmed, some_smeared).scene.views.size()),
              static_cast<double>(num_sharp - num_smeared), 0.02 * static_cast<double>(num_patches));
  EXPECT_GT(input_of(filmed, none_in_focus).scene.views.size(), 0.95 * static_cast<double>(num_sharp))
      << "a lens out of focus is no motion";
}

TagKey most_seen_but(const TagKey& held, const std::vector<FrameDetections>& frames) {
  std::map<TagKey, int> counts;
  for (const FrameDetections& frame : frames) {
    for (const TagPatch& patch : frame.patches) counts[patch.tag] += patch.tag == held ? 0 : 1;
  }
  return std::ranges::max_element(counts, {}, [](const auto& one) { return one.second; })->first;
}

/// A tag hangs 6 mm aside in all moments but those that are held out, where the corners have it.
TEST(RefinedMap, IsRefusedWhereItLosesATag) {
  const FilmedRoom& filmed = FilmedRoom::once();
  ASSERT_EQ(input_of(filmed, filmed.frames).num_moments, static_cast<int>(test::kNumFilmed))
      << "every fourth is held out then";
  const MapTag& moved = *filmed.scene.map.find(most_seen_but(filmed.by_corners.held_tag, filmed.frames));
  Scene scene = filmed.scene;
  int num_panels = 0;
  for (Panel& panel : scene.bodies[scene.truth_body].panels) {
    if (!panel.tag || (panel.T_body_panel.translation() - moved.T_map_tag.translation()).norm() > 0.02)
      continue;
    panel.T_body_panel = panel.T_body_panel * Pose(Eigen::Quaterniond::Identity(), {0.006, 0.0, 0.0});
    ++num_panels;
  }
  ASSERT_EQ(num_panels, 1);
  const Renderer renderer(scene, {.seed = 733});
  std::vector<FrameDetections> frames = filmed.frames;
  int num_moved = 0;
  for (std::size_t i = 0; i < test::kNumFilmed; ++i) {
    const auto is_moved = [&](const TagPatch& patch) { return patch.tag == moved.key; };
    if (i % 4 == 3 || std::ranges::none_of(frames[i].patches, is_moved)) continue;
    std::erase_if(frames[i].patches, is_moved);
    for (const TagPatch& patch : test::filmed_frame(renderer, i).patches) {
      if (!is_moved(patch)) continue;
      frames[i].patches.push_back(patch);
      ++num_moved;
    }
  }
  ASSERT_GT(num_moved, 8);
  const RefinementResult refined = refine_map(filmed.by_corners, frames, filmed.rig, {});
  EXPECT_FALSE(refined.is_accepted);
  EXPECT_THAT(refined.reason, HasSubstr("most held-out pictures of " + to_string(moved.key)));
  EXPECT_LT(refined.held_out_after, refined.held_out_before) << "the others gain more than it loses";
}

}  // namespace
}  // namespace apriltrack
