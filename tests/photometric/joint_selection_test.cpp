#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <vector>

#include "joint_fixture.h"
#include "patch_columns.h"

namespace apriltrack {
namespace {

using namespace test;  // NOLINT(google-build-using-namespace)

/// Noise that is alike over some pixels, so that a patch has a neighbourhood.
PhotometricFrame blurred_noise(std::uint64_t seed) {
  const PhotometricFrame noise = noise_frame(seed);
  PhotometricFrame frame = noise;
  for (int y = 6; y < 234; ++y) {
    for (int x = 6; x < 314; ++x) {
      float sum = 0.0F;
      for (int dy = -6; dy <= 6; ++dy)
        for (int dx = -6; dx <= 6; ++dx) sum += noise.light[0](x + dx, y + dy);
      frame.light[0](x, y) = sum / 169.0F;
    }
  }
  return frame;
}

TEST(JointLikelihood, RejectsOnlyHypothesesThatAreFarFromTheBest) {
  const Pose truth = facing(0.0, 0.0, 0.8);
  RandomStream random(12);
  std::vector<MotionState> hypotheses;
  for (int i = 0; i < 1000; ++i) {  // within some 15 pixels
    const Eigen::Vector2d off_m{0.03 * random.normal(), 0.03 * random.normal()};
    hypotheses.push_back(at_rest(facing(off_m.x(), off_m.y(), 0.8)));
  }
  JointLikelihoodOptions options = with_references(PatchError::kLinear, 32);
  const PhotometricFrame earlier = blurred_noise(12);
  PhotometricFrame frame = earlier;
  for (int y = 0; y < 240; ++y)
    for (int x = 0; x < 320; ++x) frame.light[0](x, y) += static_cast<float>(0.01 * random.normal());
  JointScores full, coarse;
  for (const double sigmas : {0.0, 3.0}) {
    options.coarse_sigmas = sigmas;
    JointLikelihood likelihood(camera_320(), one_tag(), TrackMode::kJoint, options);
    likelihood.set_reference(0, patch_of(earlier, options, truth));
    likelihood.evaluate(frame, hypotheses, kSerial, sigmas > 0.0 ? &coarse : &full);
  }
  const auto best =
      static_cast<std::size_t>(std::ranges::max_element(full.log_likelihoods) - full.log_likelihoods.begin());
  const double best_c = full.tag(best, 0).correlation;
  ASSERT_GT(best_c, 0.8);
  ASSERT_LT(best_c, 0.97);
  EXPECT_EQ(coarse.log_likelihoods[best], full.log_likelihoods[best]);
  std::size_t num_rejected = 0;
  double square = 0.0;
  for (std::size_t i = 0; i < hypotheses.size(); ++i) {
    const double c = full.tag(i, 0).correlation, difference = coarse.tag(i, 0).correlation - c;
    if (difference == 0.0) continue;
    ++num_rejected;
    const double sigma = (1.0 - c * c) / 8.0;
    EXPECT_LT(c, best_c - 0.5 * sigma) << i;
    square += difference * difference / (sigma * sigma);
  }
  EXPECT_GT(num_rejected, 700U);
  EXPECT_LT(num_rejected, 990U);
  // The score kept is that of a sample of 64, or better: neighbouring samples are alike.
  EXPECT_LT(square / static_cast<double>(num_rejected), 1.3);
}

/// Light that is known at some samples, and unknown at the others.
TEST(MaxCorrelation, IsNeverExceededAndCanBeReached) {
  RandomStream random(41);
  double least_gap = 1.0;
  for (int trial = 0; trial < 2000; ++trial) {
    constexpr std::size_t kPart = 12, kAll = 40;
    std::vector<double> pattern, seen;
    const double noise = random.uniform(0.05, 3.0), sign = trial % 3 == 0 ? -1.0 : 1.0;
    for (std::size_t i = 0; i < kAll; ++i) {
      pattern.push_back(random.normal());
      seen.push_back(sign * pattern[i] + noise * random.normal());
    }
    const auto squares = [&](std::size_t count) {
      double sum = 0.0, sum2 = 0.0;
      for (std::size_t i = 0; i < count; ++i) {
        sum += pattern[i];
        sum2 += pattern[i] * pattern[i];
      }
      return sum2 - sum * sum / static_cast<double>(count);
    };
    const double c1 = correlate(std::span(seen).first(kPart), std::span(pattern).first(kPart)).correlation;
    const double bound = max_correlation(c1, squares(kPart) / squares(kAll));
    EXPECT_LE(correlate(seen, pattern).correlation, bound + 1e-12) << trial;
    if (c1 < 0.2) continue;
    // The best that the rest can show: what the fit over the part predicts.
    double mean_seen = 0.0, mean_pattern = 0.0, product = 0.0, square = 0.0;
    for (std::size_t i = 0; i < kPart; ++i) {
      mean_seen += seen[i] / kPart;
      mean_pattern += pattern[i] / kPart;
    }
    for (std::size_t i = 0; i < kPart; ++i) {
      product += (seen[i] - mean_seen) * (pattern[i] - mean_pattern);
      square += (seen[i] - mean_seen) * (seen[i] - mean_seen);
    }
    for (std::size_t i = kPart; i < kAll; ++i)
      seen[i] = mean_seen + (pattern[i] - mean_pattern) * square / product;
    EXPECT_NEAR(correlate(seen, pattern).correlation, bound, 1e-9) << trial;
    least_gap = std::min(least_gap, 1.0 - bound);
  }
  EXPECT_LT(least_gap, 0.01);
}

TEST(JointLikelihood, DropsOnlyHypothesesThatAreNegligibleWhateverTheRestShows) {
  RandomStream random(42);
  for (const double edge_m : {0.0, -0.27}) {  // in the middle, and cut by the image's edge
    const Pose truth = facing(edge_m, 0.0, 0.8);
    std::vector<MotionState> hypotheses;
    for (int i = 0; i < 1000; ++i) {  // within some 15 pixels
      const Eigen::Vector2d off_m{0.03 * random.normal(), 0.03 * random.normal()};
      hypotheses.push_back(at_rest(facing(edge_m + off_m.x(), off_m.y(), 0.8)));
    }
    hypotheses.push_back(at_rest(truth));
    for (const bool has_unknown : {false, true}) {
      JointLikelihoodOptions options = with_references(PatchError::kGaussianProfile, 32);
      const PhotometricFrame frame = blurred_noise(13);
      std::vector<double> reference = patch_of(frame, options, truth);
      if (has_unknown)
        for (std::size_t i = 0; i < reference.size(); i += 1 + i % 5)
          reference[i] = std::numeric_limits<double>::quiet_NaN();
      options.negligible_log_ratio = 5.0;
      EXPECT_GT(num_dropped(options, frame, reference, hypotheses), 100);
      options.negligible_log_ratio = 1e4;
      EXPECT_EQ(num_dropped(options, frame, reference, hypotheses), 0);
    }
  }
}

}  // namespace
}  // namespace apriltrack
