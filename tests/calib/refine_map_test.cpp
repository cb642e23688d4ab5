#include "apriltrack/calib/refine_map.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <functional>
#include <map>
#include <numeric>
#include <optional>

#include "apriltrack/base/error.h"
#include "apriltrack/base/parallel.h"
#include "apriltrack/detect/detector.h"
#include "apriltrack/sim/named_scenes.h"
#include "apriltrack/sim/renderer.h"
#include "calibrating.h"
#include "refinement_input.h"
#include "synthetic_world.h"

// Maps refined on rendered pictures, against the scene that they were rendered from.

namespace apriltrack {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr std::size_t kNumFrames = 60;

/// A frame of the scene, with corners and pictures of what is seen.
FrameDetections filmed_frame(const Renderer& renderer, std::size_t i) {
  const Scene& scene = renderer.scene();
  DetectorOptions options;
  options.families = {"tag36h11"};
  options.response = scene.camera.response;
  Detector detector(options);
  const RenderedFrame rendered = renderer.render(i * scene.num_frames / kNumFrames);
  FrameDetections frame{rendered.timestamp, scene.camera.name, detector.detect(rendered.pixels.view())};
  frame.exposure_s = scene.exposure_s;
  for (const Detection& detection : frame.detections)
    frame.patches.push_back(*cut_patch(rendered.pixels.view(), detection));
  return frame;
}

/// A slow round past the walls, and the corners and pictures of what is seen.
struct Filmed {
  Scene scene = make_scene("room-gentle", {.texel_m = 0.02});
  std::vector<FrameDetections> frames;
  CameraRig rig;
  CalibrationResult by_corners;

  Filmed() {
    scene.exposure_s = 0.003;
    rig.cameras.push_back(scene.camera);
    const Renderer renderer(scene, {.seed = 733});
    for (std::size_t i = 0; i < kNumFrames; ++i) frames.push_back(filmed_frame(renderer, i));
    by_corners = calibrate_map(frames, rig, TagSizes(scene.map.tags.front().size_m), {});
  }

  static const Filmed& once() {
    static const Filmed filmed;
    return filmed;
  }
};

double rms_m(const TagMap& truth, const TagKey& held, const TagMap& map) {
  double sum = 0.0;
  for (const MapTag& tag : map.tags)
    sum +=
        (tag.T_map_tag.translation() - test::T_origin_tag(truth, held, tag.key).translation()).squaredNorm();
  return std::sqrt(sum / static_cast<double>(map.tags.size()));
}

/// xi' covariance^-1 xi / 6 of every tag but the held one, relative to it; their mean.
double mean_normalised_error(const TagMap& truth, const TagKey& held, const TagMap& map, double* largest) {
  double sum = 0.0;
  *largest = 0.0;
  for (const MapTag& tag : map.tags) {
    if (tag.key == held) continue;
    const Vector6d xi = (tag.T_map_tag.inverse() * test::T_origin_tag(truth, held, tag.key)).log();
    const double error = xi.dot(tag.covariance->ldlt().solve(xi)) / 6.0;
    *largest = std::max(*largest, error);
    sum += error;
  }
  return sum / static_cast<double>(map.tags.size() - 1);
}

TEST(RefinedMap, IsNearerToTheTruthThanItsCornersAndClaimsNoMore) {
  const Filmed& filmed = Filmed::once();
  const RefinementResult refined = refine_map(filmed.by_corners, filmed.frames, filmed.rig, {});
  ASSERT_TRUE(refined.is_accepted) << refined.reason;
  const TagKey held = filmed.by_corners.held_tag;
  const double before_m = rms_m(filmed.scene.map, held, filmed.by_corners.map);
  const double after_m = rms_m(filmed.scene.map, held, refined.map);
  EXPECT_LT(after_m, 0.6 * before_m) << before_m;
  EXPECT_LT(refined.held_out_after, refined.held_out_before);
  ASSERT_EQ(refined.lens_blurs.size(), 1U);
  EXPECT_EQ(refined.lens_blurs[0].camera, filmed.rig.cameras[0].name);
  EXPECT_NEAR(refined.lens_blurs[0].sigma_px, 0.5, 0.1);  // the renderer's lens
  EXPECT_EQ(refined.refined.size(), refined.map.tags.size());
  EXPECT_EQ(refined.warnings, filmed.by_corners.warnings);

  double largest = 0.0;
  EXPECT_LT(mean_normalised_error(filmed.scene.map, held, refined.map, &largest), 1.5);
  EXPECT_LT(largest, 4.0);
  EXPECT_TRUE(refined.map.find(held)->covariance->isZero());
}

TEST(RefinedMap, KeepsToConstraintsInTheMeasuredFrame) {
  const Filmed& filmed = Filmed::once();
  CalibrationOptions options;
  for (const std::size_t i : {0U, 4U, 8U, 12U}) {
    const MapTag& tag = filmed.scene.map.tags[i];
    const Eigen::Vector3d p = tag.T_map_tag.translation();
    options.constraints.push_back({.what = PositionConstraint{tag.key, {p.x(), p.y(), p.z()}, 1e-4}});
  }
  const TagSizes sizes(filmed.scene.map.tags.front().size_m);
  CalibrationResult by_corners = calibrate_map(filmed.frames, filmed.rig, sizes, options);
  ConstraintAudit unused;
  unused.title = "of the corners";
  unused.reason = "its tags lie in a line";
  by_corners.constraint_audits.insert(by_corners.constraint_audits.begin() + 1, unused);
  by_corners.constraint_doubts = {"constraint in doubt: by the corners"};
  by_corners.warnings = {"of something else", by_corners.constraint_doubts.front()};
  const RefinementResult refined = refine_map(by_corners, filmed.frames, filmed.rig, {});
  ASSERT_TRUE(refined.is_accepted) << refined.reason;
  EXPECT_EQ(refined.gauge, by_corners.gauge);
  EXPECT_EQ(refined.warnings, std::vector<std::string>{"of something else"});
  ASSERT_EQ(refined.constraint_audits.size(), 5U);
  for (std::size_t i = 0; i < 5; ++i) {
    EXPECT_EQ(refined.constraint_audits[i].title, by_corners.constraint_audits[i].title);
    EXPECT_EQ(refined.constraint_audits[i].is_used, i != 1);
  }
  EXPECT_LT(*refined.constraint_audits[0].readings[0].sigma,
            *by_corners.constraint_audits[0].readings[0].sigma)
      << "the pictures predict better than the corners";
  // In the world's frame, the held tag too.
  double sum = 0.0;
  for (const MapTag& tag : refined.map.tags) {
    const Vector6d xi = (tag.T_map_tag.inverse() * filmed.scene.map.find(tag.key)->T_map_tag).log();
    const double error = xi.dot(tag.covariance->ldlt().solve(xi)) / 6.0;
    EXPECT_LT(error, 4.0) << to_string(tag.key);
    sum += error;
  }
  EXPECT_LT(sum / static_cast<double>(refined.map.tags.size()), 1.5);
  for (const std::size_t i : {0U, 4U, 8U, 12U}) {
    const MapTag& truth = filmed.scene.map.tags[i];
    EXPECT_LT((refined.map.find(truth.key)->T_map_tag.translation() - truth.T_map_tag.translation()).norm(),
              3e-4);
  }
}

TEST(RefinedMap, DoesNotDependOnTheNumberOfThreads) {
  const Filmed& filmed = Filmed::once();
  const RefinementResult one =
      refine_map(filmed.by_corners, filmed.frames, filmed.rig, {.max_moments = 20, .num_threads = 1});
  const RefinementResult three =
      refine_map(filmed.by_corners, filmed.frames, filmed.rig, {.max_moments = 20, .num_threads = 3});
  ASSERT_TRUE(one.is_accepted) << one.reason;
  for (std::size_t i = 0; i < one.map.tags.size(); ++i) {
    EXPECT_EQ(one.map.tags[i].T_map_tag.matrix(), three.map.tags[i].T_map_tag.matrix());
    EXPECT_EQ(*one.map.tags[i].covariance, *three.map.tags[i].covariance);
  }
}

/// Rotations are half a metre's worth of translation, that both may be judged in one number.
double norm_m(const Vector6d& xi) {
  return std::hypot(xi.head<3>().norm(), 0.5 * xi.tail<3>().norm());
}

TEST(RefinedMap, FollowsErrorsOfALensThatWasEstimatedWithIt) {
  // The share of the covariances, against maps refined with the lens moved either way.
  const Filmed& filmed = Filmed::once();
  constexpr double kSigma = 0.001;  // of the focal length
  constexpr double kCenterSigma_px = 0.3;
  CalibrationResult given = filmed.by_corners;
  given.constraints.clear();
  const auto refined_with = [&](double focal_share, double center_px) {
    CalibrationResult moved = given;
    Pinhole pinhole = given.rig.cameras[0].model.pinhole();
    pinhole.fx *= 1.0 + focal_share;
    pinhole.fy *= 1.0 + focal_share;
    pinhole.cx += center_px;
    moved.rig.cameras[0].model = CameraModel(pinhole, given.rig.cameras[0].model.distortion());
    const RefinementResult result = refine_map(moved, filmed.frames, moved.rig, {});
    EXPECT_TRUE(result.is_accepted) << result.reason;
    return result.map;
  };
  const auto by_difference = [&](const TagMap& above, const TagMap& below, const TagKey& key) {
    return Vector6d(0.5 * (below.find(key)->T_map_tag.inverse() * above.find(key)->T_map_tag).log());
  };
  const TagMap longer = refined_with(kSigma, 0.0), shorter = refined_with(-kSigma, 0.0);
  const TagMap right = refined_with(0.0, kCenterSigma_px), left = refined_with(0.0, -kCenterSigma_px);
  const RefinementResult exact = refine_map(given, filmed.frames, given.rig, {});
  ASSERT_TRUE(exact.is_accepted) << exact.reason;

  const std::string& camera = given.rig.cameras[0].name;
  given.corrections = {{camera, "edge offset", "px", 0.0, 0.1},
                       {camera, "focal length", "1", 0.0, kSigma},
                       {camera, "cx", "px", 0.0, kCenterSigma_px}};
  given.corrections_covariance =
      Eigen::Vector3d(0.01, kSigma * kSigma, kCenterSigma_px * kCenterSigma_px).asDiagonal();
  const RefinementResult estimated = refine_map(given, filmed.frames, given.rig, {});
  ASSERT_TRUE(estimated.is_accepted) << estimated.reason;

  double expected2 = 0.0, squared_difference = 0.0;
  for (const MapTag& tag : exact.map.tags) {
    const Vector6d by_focal = by_difference(longer, shorter, tag.key);
    const Vector6d by_center = by_difference(right, left, tag.key);
    const double expected_m = std::hypot(norm_m(by_focal), norm_m(by_center));
    const Matrix6d added = *estimated.map.find(tag.key)->covariance - *tag.covariance;
    const double added_m =
        std::sqrt(added.topLeftCorner<3, 3>().trace() + 0.25 * added.bottomRightCorner<3, 3>().trace());
    expected2 += expected_m * expected_m;
    squared_difference += std::pow(added_m - expected_m, 2);
  }
  const auto num = static_cast<double>(exact.map.tags.size());
  EXPECT_GT(std::sqrt(expected2 / num), 5e-4) << "a case in which it matters";
  EXPECT_LT(std::sqrt(squared_difference / expected2), 0.1);
  // In units of the corners' noise, whatever the pictures' own units are.
  EXPECT_EQ(exact.joint.noise_variance, given.evidence.joint.noise_variance);
  const double bias_px = exact.joint.bias_sigma * given.evidence.noise.sigma_px;
  EXPECT_GE(bias_px, 0.99 * RefinementOptions{}.picture_bias_px);
  EXPECT_LT(bias_px, 5.0 * RefinementOptions{}.picture_bias_px);
  const TagKey& key = estimated.joint.tags.back();
  const auto row = *estimated.joint.row_of(key);
  EXPECT_LT((estimated.joint.block(row, row) - *estimated.map.find(key)->covariance).norm(),
            1e-9 * estimated.map.find(key)->covariance->norm());
}

TEST(RefinedMap, StaysAsItWasWithoutPictures) {
  const Filmed& filmed = Filmed::once();
  std::vector<FrameDetections> frames = filmed.frames;
  for (FrameDetections& frame : frames) frame.patches.clear();
  const RefinementResult refined = refine_map(filmed.by_corners, frames, filmed.rig, {});
  EXPECT_FALSE(refined.is_accepted);
  EXPECT_EQ(refined.reason, "too few pictures: 0 moments show two tags or more, 8 are needed");
  for (std::size_t i = 0; i < refined.map.tags.size(); ++i)
    EXPECT_EQ(refined.map.tags[i].T_map_tag.matrix(), filmed.by_corners.map.tags[i].T_map_tag.matrix());
}

/// What frames show is not where they say: by a pixel to the left and to the right, tag by tag.
TEST(RefinedMap, IsRefusedWherePicturesContradictEachOther) {
  const Filmed& filmed = Filmed::once();
  std::vector<FrameDetections> frames = filmed.frames;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    for (std::size_t k = 0; k < frames[i].patches.size(); ++k)
      frames[i].patches[k].x += static_cast<int>((i + k) % 3) - 1;
  }
  const RefinementResult refined = refine_map(filmed.by_corners, frames, filmed.rig, {});
  EXPECT_FALSE(refined.is_accepted);
  EXPECT_THAT(refined.reason, HasSubstr("held out agree no better"));
  for (std::size_t i = 0; i < refined.map.tags.size(); ++i)
    EXPECT_EQ(refined.map.tags[i].T_map_tag.matrix(), filmed.by_corners.map.tags[i].T_map_tag.matrix());
}

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

TEST(RefinedMap, LeavesATagWithoutPicturesAndRefinesTheOthers) {
  const Filmed& filmed = Filmed::once();
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
  const Filmed& filmed = Filmed::once();
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
  const Filmed& filmed = Filmed::once();
  const TagKey held = filmed.by_corners.held_tag;
  const std::vector<FrameDetections> frames = with_patches_of(held, filmed.frames, overexpose);
  const RefinementResult refined = refine_map(filmed.by_corners, frames, filmed.rig, {});
  ASSERT_TRUE(refined.is_accepted) << refined.reason;
  EXPECT_THAT(refined.refined, Not(Contains(held)));
  EXPECT_EQ(refined.map.find(held)->T_map_tag.matrix(), filmed.by_corners.map.find(held)->T_map_tag.matrix());
  EXPECT_TRUE(refined.map.find(held)->covariance->isZero());
  double largest = 0.0;
  EXPECT_LT(mean_normalised_error(filmed.scene.map, held, refined.map, &largest), 1.5);
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
  EXPECT_LT(normalised / static_cast<double>(refined.refined.size() - 1), 1.5);
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
  EXPECT_EQ(refused.reason,
            "too few pictures of the held tag " + to_string(held) +
                " can be used, and constraints weigh against them: hold another tag (--held-tag)");
}

RefinementInput input_of(const Filmed& filmed, const std::vector<FrameDetections>& frames) {
  return refinement_input(filmed.by_corners, frames, filmed.rig, RefinementOptions{}.max_moments,
                          parallel_for(1));
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
  const Filmed& filmed = Filmed::once();
  ASSERT_EQ(input_of(filmed, filmed.frames).num_moments, static_cast<int>(kNumFrames))
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
  for (std::size_t i = 0; i < kNumFrames; ++i) {
    const auto is_moved = [&](const TagPatch& patch) { return patch.tag == moved.key; };
    if (i % 4 == 3 || std::ranges::none_of(frames[i].patches, is_moved)) continue;
    std::erase_if(frames[i].patches, is_moved);
    for (const TagPatch& patch : filmed_frame(renderer, i).patches) {
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

TEST(RefinedMap, FlagsTagsByTheirPictures) {
  const Filmed& filmed = Filmed::once();
  CalibrationResult by_corners = filmed.by_corners;
  by_corners.map.tags[3].statistics->flags = {"weak", "outliers"};
  by_corners.map.tags[4].statistics->views = 4;
  const RefinementResult refined = refine_map(by_corners, filmed.frames, filmed.rig, {.max_moments = 20});
  ASSERT_TRUE(refined.is_accepted) << refined.reason;
  EXPECT_EQ(refined.map.tags[3].statistics->flags, std::vector<std::string>{"outliers"});
  EXPECT_EQ(refined.map.tags[4].statistics->flags, std::vector<std::string>{"weak"});
}

TEST(RefinedMap, TellsTheBlurOfLensesThatTookPart) {
  const Filmed& filmed = Filmed::once();
  CalibrationResult by_corners = filmed.by_corners;
  Camera idle = by_corners.rig.cameras[0];
  idle.name = "idle";
  by_corners.rig.cameras.insert(by_corners.rig.cameras.begin(), idle);
  by_corners.rig.cameras[1].T_this_previous = Pose();
  const RefinementResult refined = refine_map(by_corners, filmed.frames, by_corners.rig, {.max_moments = 20});
  ASSERT_TRUE(refined.is_accepted) << refined.reason;
  ASSERT_EQ(refined.lens_blurs.size(), 1U);
  EXPECT_EQ(refined.lens_blurs[0].camera, filmed.rig.cameras[0].name);
  EXPECT_NEAR(refined.lens_blurs[0].sigma_px, 0.5, 0.1);
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
  const Filmed& filmed = Filmed::once();
  const auto num_sharp = input_of(filmed, filmed.frames).scene.views.size();
  std::size_t num_patches = 0, num_smeared = 0;
  std::vector<FrameDetections> some_smeared = filmed.frames, none_in_focus = filmed.frames;
  for (std::size_t i = 0; i < kNumFrames; ++i) {
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

TEST(RefinedMap, NamesOptionsOutOfRange) {
  const Filmed& filmed = Filmed::once();
  const auto error = [&](const RefinementOptions& options) {
    return test::error_of(ErrorKind::kInvalidInput,
                          [&] { refine_map(filmed.by_corners, filmed.frames, filmed.rig, options); });
  };
  EXPECT_EQ(error({.max_moments = 7}), "max_moments: must be 8 or more (is 7)");
  EXPECT_EQ(error({.picture_bias_px = -1.0}), "picture_bias_px: must be in [0, 100] (is -1)");
  EXPECT_EQ(error({.num_threads = -1}), "num_threads: must be 0 (all cores) or more (is -1)");
}

}  // namespace
}  // namespace apriltrack
