#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <functional>
#include <vector>

#include "apriltrack/calib/refine_map.h"
#include "filmed_room.h"

// Maps refined where pictures are missing, or show what they should not.

namespace apriltrack {
namespace {

using test::FilmedRoom;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;

using PatchChange = std::function<void(TagPatch&)>;

std::vector<FrameDetections> with_patches_of(const TagKey& tag, std::vector<FrameDetections> frames,
                                             const PatchChange& change) {
  for (FrameDetections& frame : frames) {
    for (TagPatch& patch : frame.patches) {
      if (patch.tag == tag) change(patch);
    }
  }
  return frames;
}

void overexpose(TagPatch& patch) {
  for (int y = 0; y < patch.pixels.height(); ++y)
    std::fill_n(patch.pixels.row(y), patch.pixels.width(), std::uint8_t{255});
}

TEST(RefinedMap, StaysAsItWasWithoutPictures) {
  const FilmedRoom& filmed = FilmedRoom::once();
  std::vector<FrameDetections> frames = filmed.frames;
  for (FrameDetections& frame : frames) frame.patches.clear();
  const RefinementResult refined = refine_map(filmed.by_corners, frames, filmed.rig, {});
  EXPECT_FALSE(refined.is_accepted);
  EXPECT_EQ(refined.reason, "too few pictures: 0 moments show two tags or more, 12 are needed");
  for (std::size_t i = 0; i < refined.map.tags.size(); ++i)
    EXPECT_EQ(refined.map.tags[i].T_map_tag.matrix(), filmed.by_corners.map.tags[i].T_map_tag.matrix());
}

TEST(RefinedMap, LeavesATagWithoutPicturesAndRefinesTheOthers) {
  const FilmedRoom& filmed = FilmedRoom::once();
  const TagKey overexposed = filmed.by_corners.map.tags[5].key;
  ASSERT_NE(overexposed, filmed.by_corners.held_tag);
  std::vector<FrameDetections> without = filmed.frames;
  for (FrameDetections& frame : without)
    std::erase_if(frame.patches, [&](const TagPatch& patch) { return patch.tag == overexposed; });
  const RefinementResult expected = refine_map(filmed.by_corners, without, filmed.rig, {});
  ASSERT_TRUE(expected.is_accepted) << expected.reason;
  const RefinementResult refined =
      refine_map(filmed.by_corners, with_patches_of(overexposed, filmed.frames, overexpose), filmed.rig, {});
  ASSERT_TRUE(refined.is_accepted) << refined.reason;
  EXPECT_EQ(refined.refined.size(), filmed.by_corners.map.tags.size() - 1);
  EXPECT_THAT(refined.refined, Not(Contains(overexposed)));
  EXPECT_THAT(refined.warnings,
              Contains(HasSubstr(to_string(overexposed) + " stays as the corners have it")));
  for (const MapTag& tag : refined.map.tags) {
    const MapTag& other = *(tag.key == overexposed ? filmed.by_corners.map : expected.map).find(tag.key);
    EXPECT_LT((tag.T_map_tag.inverse() * other.T_map_tag).log().norm(), 1e-7) << to_string(tag.key);
    EXPECT_LT((*tag.covariance - *other.covariance).norm(), 1e-3 * other.covariance->norm() + 1e-12);
  }
}

/// Its paper shows, and its cells are another tag's.
TEST(RefinedMap, LeavesATagWhosePicturesAreNotItsOwn) {
  const FilmedRoom& filmed = FilmedRoom::once();
  const TagKey mirrored = filmed.by_corners.map.tags[5].key;
  const RefinementResult refined = refine_map(
      filmed.by_corners,
      with_patches_of(mirrored, filmed.frames,
                      [](TagPatch& patch) {
                        for (int y = 0; y < patch.pixels.height(); ++y)
                          std::reverse(patch.pixels.row(y), patch.pixels.row(y) + patch.pixels.width());
                      }),
      filmed.rig, {});
  ASSERT_TRUE(refined.is_accepted) << refined.reason;
  EXPECT_THAT(refined.refined, Not(Contains(mirrored)));
  EXPECT_EQ(refined.map.find(mirrored)->T_map_tag.matrix(),
            filmed.by_corners.map.find(mirrored)->T_map_tag.matrix());
}

TEST(RefinedMap, HoldsAnotherTagWhereTheHeldOneHasNoPictures) {
  const FilmedRoom& filmed = FilmedRoom::once();
  const TagKey held = filmed.by_corners.held_tag;
  const std::vector<FrameDetections> frames = with_patches_of(held, filmed.frames, overexpose);
  const RefinementResult refined = refine_map(filmed.by_corners, frames, filmed.rig, {});
  ASSERT_TRUE(refined.is_accepted) << refined.reason;
  EXPECT_THAT(refined.refined, Not(Contains(held)));
  EXPECT_EQ(refined.map.find(held)->T_map_tag.matrix(), filmed.by_corners.map.find(held)->T_map_tag.matrix());
  EXPECT_TRUE(refined.map.find(held)->covariance->isZero());
  double largest = 0.0;
  const double error = test::mean_normalised_error(filmed.scene.map, held, refined.map, &largest);
  EXPECT_GT(error, 0.015);
  EXPECT_LT(error, 1.5);
  EXPECT_LT(largest, 4.0);
  // Among each other they are as near to the truth as ever, and as sure of it.
  const TagKey a = refined.refined.front();
  double normalised = 0.0;
  for (const TagKey& b : refined.refined) {
    const Pose T_a_b = refined.map.find(a)->T_map_tag.inverse() * refined.map.find(b)->T_map_tag;
    const Vector6d xi = (T_a_b.inverse() * test::T_origin_tag(filmed.scene.map, a, b)).log();
    EXPECT_LT(xi.head<3>().norm(), 2e-3) << to_string(b);
    if (b != a)
      normalised += xi.dot(relative_covariance(refined.map, refined.joint, a, b)->ldlt().solve(xi)) / 6.0;
  }
  normalised /= static_cast<double>(refined.refined.size() - 1);
  EXPECT_GT(normalised, 0.015);
  EXPECT_LT(normalised, 1.5);
  for (const MapTag& tag : refined.map.tags) {
    const auto row = refined.joint.row_of(tag.key);
    ASSERT_TRUE(row.has_value()) << to_string(tag.key);
    EXPECT_LT((refined.joint.block(*row, *row) - *tag.covariance).norm(),
              1e-9 * tag.covariance->norm() + 1e-30);
  }

  CalibrationOptions options;
  const TagKey b = refined.refined.back();
  const double distance_m = test::T_origin_tag(filmed.scene.map, a, b).translation().norm();
  options.constraints.push_back({.what = DistanceConstraint{a, b, distance_m, 1e-3}});
  const TagSizes sizes(filmed.scene.map.tags.front().size_m);
  const CalibrationResult constrained = calibrate_map(filmed.frames, filmed.rig, sizes, options);
  const RefinementResult refused = refine_map(constrained, frames, filmed.rig, {});
  EXPECT_FALSE(refused.is_accepted);
  EXPECT_EQ(refused.reason, "too few pictures of the held tag " + to_string(held) +
                                " can be used, and constraints weigh against them: hold another tag");

  CalibrationResult open = filmed.by_corners;
  open.open_corrections = {{filmed.rig.cameras[0].name, "focal length", "1", 0.01, 0.01}};
  open.open_covariance = Eigen::MatrixXd::Constant(1, 1, 2e-4);
  EXPECT_THAT(refine_map(open, frames, filmed.rig, {}).reason,
              HasSubstr("and cameras that are not as their file says weigh against them"));
}

/// What frames show is not where they say: by a pixel to the left and to the right, tag by tag.
TEST(RefinedMap, IsRefusedWherePicturesContradictEachOther) {
  const FilmedRoom& filmed = FilmedRoom::once();
  std::vector<FrameDetections> frames = filmed.frames;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    for (std::size_t k = 0; k < frames[i].patches.size(); ++k)
      frames[i].patches[k].x += static_cast<int>((i + k) % 3) - 1;
  }
  const RefinementResult refined = refine_map(filmed.by_corners, frames, filmed.rig, {});
  EXPECT_FALSE(refined.is_accepted);
  EXPECT_THAT(refined.reason, HasSubstr("held out do not agree clearly better"));
  for (std::size_t i = 0; i < refined.map.tags.size(); ++i)
    EXPECT_EQ(refined.map.tags[i].T_map_tag.matrix(), filmed.by_corners.map.tags[i].T_map_tag.matrix());
}

}  // namespace
}  // namespace apriltrack
