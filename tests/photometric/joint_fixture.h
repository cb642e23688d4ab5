#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <vector>

#include "apriltrack/base/random.h"
#include "apriltrack/geometry/rotation.h"
#include "apriltrack/photometric/joint_likelihood.h"
#include "tag_film.h"

/// What the tests of JointLikelihood look at: tags before a small camera, in pictures of noise.
namespace apriltrack::test {

inline constexpr double kTagSize_m = TagFilm::kSize_m;
inline const ParallelFor kSerial = parallel_for(1);
/// The kernels know places in the image to 2^-15 px and light to 2^-16 of its range.
inline constexpr double kMaxError = 1e-5;  // in a correlation
/// Of what gamma = 10 makes of it, and of n / kappa = 85 / 0.03.
inline constexpr double kMaxPaperError = 1e-4, kMaxProfileError = 1e-2;

inline Camera camera_320() {
  Camera camera{.model = CameraModel({400.0, 400.0, 159.5, 119.5}, NoDistortion{})};
  camera.width = 320;
  camera.height = 240;
  return camera;
}

inline MapTag tag_at(int id, const Pose& T_map_tag) {
  MapTag tag;
  tag.key = {"tag36h11", id};
  tag.size_m = kTagSize_m;
  tag.T_map_tag = T_map_tag;
  return tag;
}

inline TagMap one_tag() {
  TagMap map;
  map.tags = {tag_at(5, Pose())};
  return map;
}

inline TagMap two_tags() {
  TagMap map;
  map.tags = {tag_at(5, Pose()), tag_at(9, {rotation_exp({0, 0.3, 0.1}), {0.2, 0.02, 0.05}})};
  return map;
}

inline MotionState at_rest(const Pose& pose) {
  MotionState state;
  state.pose = pose;
  return state;
}

inline Pose facing(double x, double y, double z) {
  return {Eigen::Quaterniond::Identity(), {x, y, z}};
}

inline PhotometricFrame noise_frame(std::uint64_t seed) {
  RandomStream random(seed);
  Image<float> image(320, 240);
  for (int y = 0; y < 240; ++y) {
    for (int x = 0; x < 320; ++x) image(x, y) = static_cast<float>(random.uniform());
  }
  PhotometricFrame frame;
  frame.light.push_back(std::move(image));
  return frame;
}

inline JointLikelihoodOptions with_references(PatchError error, int size = 16) {
  JointLikelihoodOptions options;
  options.grid.size = size;
  options.tag_template = TagTemplate::kReference;
  options.error = error;
  return options;
}

inline std::vector<double> patch_of(const PhotometricFrame& frame, const JointLikelihoodOptions& options,
                                    const Pose& T_camera_tag) {
  std::vector<double> patch(options.grid.num_samples());
  sample_patch(frame.light[0].view(), camera_320().model, camera_from_tag_plane(T_camera_tag, kTagSize_m),
               options.grid, patch);
  return patch;
}

/// The reference of tag 0 is what the frame shows at `reference_pose`.
inline JointScores scores_of(const JointLikelihoodOptions& options, const PhotometricFrame& frame,
                             const Pose& reference_pose, const std::vector<MotionState>& hypotheses) {
  JointLikelihood likelihood(camera_320(), one_tag(), TrackMode::kJoint, options);
  likelihood.set_reference(0, patch_of(frame, options, reference_pose));
  JointScores scores;
  likelihood.evaluate(frame, hypotheses, kSerial, &scores);
  return scores;
}

inline constexpr PatchError kErrors[] = {PatchError::kLinear, PatchError::kMinusLog,
                                         PatchError::kGaussianProfile};

/// options: with every hypothesis in full, and as they are. Counts hypotheses whose scores differ.
inline int num_dropped(const JointLikelihoodOptions& options, const PhotometricFrame& frame,
                       const std::vector<double>& reference, const std::vector<MotionState>& hypotheses) {
  JointScores full, bounded;
  for (const bool is_full : {true, false}) {
    JointLikelihoodOptions chosen = options;
    if (is_full) chosen.negligible_log_ratio = std::numeric_limits<double>::infinity();
    JointLikelihood likelihood(camera_320(), one_tag(), TrackMode::kJoint, chosen);
    if (!reference.empty()) likelihood.set_reference(0, reference);
    likelihood.evaluate(frame, hypotheses, kSerial, is_full ? &full : &bounded);
  }
  const double best = *std::ranges::max_element(full.log_likelihoods);
  EXPECT_EQ(*std::ranges::max_element(bounded.log_likelihoods), best);
  int count = 0;
  for (std::size_t i = 0; i < hypotheses.size(); ++i) {
    if (bounded.log_likelihoods[i] == full.log_likelihoods[i]) continue;
    EXPECT_LT(full.log_likelihoods[i], best - options.negligible_log_ratio + 0.1) << i;
    EXPECT_LT(bounded.log_likelihoods[i], best - options.negligible_log_ratio + 0.1) << i;
    ++count;
  }
  return count;
}

}  // namespace apriltrack::test
