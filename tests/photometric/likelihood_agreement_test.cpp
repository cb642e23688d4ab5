// The scalar likelihood, which defines what a faster one has to compute, against what the blur tracker
// weighs: patches sampled in the image here, pixels thinned out and cast onto the tag there.

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "apriltrack/base/random.h"
#include "apriltrack/photometric/evidence.h"
#include "apriltrack/photometric/joint_likelihood.h"
#include "tag_film.h"

namespace apriltrack {
namespace {

using test::TagFilm;

const CameraModel kAgreementLens({400.0, 405.0, 155.0, 122.0}, RadtanDistortion({-0.12, 0.03, 1e-3, -5e-4}));

/// At `distance_m`, turned by `tilt`, on its way across the picture by about `blur_px` in an exposure.
TagFilm film_of(double distance_m, const Eigen::Vector3d& tilt, double blur_px, double direction_rad) {
  Motion motion;
  motion.T_end = {rotation_exp(tilt), Eigen::Vector3d::Zero()};
  const double speed_m_per_s = blur_px * distance_m / 400.0 / TagFilm::kExposure_s;
  motion.position_m[0].rate_per_s = speed_m_per_s * std::cos(direction_rad);
  motion.position_m[1].rate_per_s = speed_m_per_s * std::sin(direction_rad);
  motion.position_m[2].offset = distance_m;
  motion.yaw_rad.rate_per_s = 0.05 * blur_px;
  return {kAgreementLens, motion};
}

std::vector<TagFilm> all_films() {
  std::vector<TagFilm> films;
  double direction_rad = 0.3;
  for (const double distance_m : {0.6, 1.2}) {
    for (const Eigen::Vector3d& tilt : {Eigen::Vector3d(0.0, 0.1, 0.4), Eigen::Vector3d(0.7, -0.4, 0.1)}) {
      for (const double blur_px : {0.0, 6.0, 15.0, 30.0})
        films.push_back(film_of(distance_m, tilt, blur_px, direction_rad += 0.9));
    }
  }
  return films;
}

/// One hypothesis as the two see it.
struct TwoViews {
  double correlation = 0.0, log_likelihood = 0.0;                  ///< JointLikelihood's.
  double tracker_correlation = 0.0, tracker_log_likelihood = 0.0;  ///< weigh_evidence's.
  double path_px = 0.0;
};

std::vector<TwoViews> views_of(const TagFilm& film, const std::vector<MotionState>& hypotheses) {
  JointLikelihood likelihood(film.camera, film.map, TrackMode::kJoint);  // kPattern and kGaussianProfile
  JointScores scores;
  likelihood.evaluate(film.frame, hypotheses, parallel_for(1), &scores);
  PhotometricWorld world = film.world();
  std::vector<TwoViews> views(hypotheses.size());
  for (std::size_t i = 0; i < hypotheses.size(); ++i) {
    const std::vector<TagEvidence> evidence = weigh_evidence(world, film.frame, hypotheses[i]);
    views[i] = {scores.tag(i, 0).correlation, scores.log_likelihoods[i],
                evidence.empty() ? 0.0 : evidence[0].correlation, log_likelihood(evidence),
                evidence.empty() ? 0.0 : evidence[0].path_px};
  }
  return views;
}

TEST(LikelihoodAgreement, TheSameShareOfThePictureIsExplained) {
  int num_long = 0;
  for (const TagFilm& film : all_films()) {
    const TwoViews view = views_of(film, {film.truth})[0];
    EXPECT_GT(view.tracker_correlation, 0.97);
    // Of tags of 53 and 107 px. The longer the path, the less are they the same samples: the square where it
    // is at mid-exposure here, all pixels that the print passes there.
    EXPECT_NEAR(view.correlation, view.tracker_correlation, view.path_px < 20.0 ? 0.015 : 0.03);
    num_long += view.path_px < 20.0 ? 0 : 1;
  }
  EXPECT_EQ(num_long, 4);
}

/// The true state first, then others from next to it to where little fits: a pixel or two off, and some of
/// blur.
std::vector<MotionState> truth_and_others(const TagFilm& film, RandomStream& random) {
  const double pixel_m = film.truth.pose.translation().z() / 400.0;
  Vector12d sigma = Vector12d::Constant(1.5 * pixel_m);
  sigma[2] *= 5.0;
  sigma.segment<3>(3).setConstant(0.05);
  sigma.tail<6>() = sigma.head<6>() * (4.0 / TagFilm::kExposure_s);
  std::vector<MotionState> hypotheses = {film.truth};
  for (int i = 0; i < 40; ++i) {
    const double size = 0.5 + 0.05 * i;
    Vector12d step;
    for (Eigen::Index k = 0; k < 12; ++k) step[k] = size * sigma[k] * random.normal();
    hypotheses.push_back(moved(film.truth, step));
  }
  return hypotheses;
}

TEST(LikelihoodAgreement, BothRankTheTrueStateFirstAndTheOthersAlike) {
  constexpr double kClear = 50.0;  // nats, of up to 600
  RandomStream random(21);
  for (const TagFilm& film : all_films()) {
    const std::vector<TwoViews> views = views_of(film, truth_and_others(film, random));
    int num_alike = 0, num_pairs = 0;
    for (std::size_t i = 1; i < views.size(); ++i) {
      EXPECT_LT(views[i].log_likelihood, views[0].log_likelihood) << i;
      EXPECT_LT(views[i].tracker_log_likelihood, views[0].tracker_log_likelihood) << i;
      for (std::size_t k = 0; k < i; ++k) {
        const double more = views[i].log_likelihood - views[k].log_likelihood;
        if (std::abs(more) < kClear) continue;
        const bool is_more = views[i].tracker_log_likelihood > views[k].tracker_log_likelihood;
        num_alike += is_more == (more > 0.0) ? 1 : 0;
        ++num_pairs;
      }
    }
    EXPECT_GT(num_pairs, 100);
    EXPECT_GT(num_alike, 0.9 * num_pairs);
  }
}

}  // namespace
}  // namespace apriltrack
