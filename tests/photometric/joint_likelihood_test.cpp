#include "apriltrack/photometric/joint_likelihood.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "allocation_limit.h"
#include "apriltrack/base/error.h"
#include "apriltrack/base/random.h"
#include "apriltrack/geometry/rotation.h"
#include "tag_film.h"

namespace apriltrack {
namespace {

constexpr double kTagSize_m = test::TagFilm::kSize_m;
const ParallelFor kSerial = parallel_for(1);
/// The kernels know places in the image to 2^-15 px and light to 2^-16 of its range.
constexpr double kMaxError = 1e-5;  // in a correlation
/// Of what gamma = 10 makes of it, and of n / kappa = 85 / 0.03.
constexpr double kMaxPaperError = 1e-4, kMaxProfileError = 1e-2;

Camera camera_320() {
  Camera camera{.model = CameraModel({400.0, 400.0, 159.5, 119.5}, NoDistortion{})};
  camera.width = 320;
  camera.height = 240;
  return camera;
}

MapTag tag_at(int id, const Pose& T_map_tag) {
  MapTag tag;
  tag.key = {"tag36h11", id};
  tag.size_m = kTagSize_m;
  tag.T_map_tag = T_map_tag;
  return tag;
}

TagMap one_tag() {
  TagMap map;
  map.tags = {tag_at(5, Pose())};
  return map;
}

TagMap two_tags() {
  TagMap map;
  map.tags = {tag_at(5, Pose()), tag_at(9, {rotation_exp({0, 0.3, 0.1}), {0.2, 0.02, 0.05}})};
  return map;
}

MotionState at_rest(const Pose& pose) {
  MotionState state;
  state.pose = pose;
  return state;
}

Pose facing(double x, double y, double z) {
  return {Eigen::Quaterniond::Identity(), {x, y, z}};
}

PhotometricFrame noise_frame(std::uint64_t seed) {
  RandomStream random(seed);
  Image<float> image(320, 240);
  for (int y = 0; y < 240; ++y) {
    for (int x = 0; x < 320; ++x) image(x, y) = static_cast<float>(random.uniform());
  }
  PhotometricFrame frame;
  frame.light.push_back(std::move(image));
  return frame;
}

JointLikelihoodOptions with_references(PatchError error, int size = 16) {
  JointLikelihoodOptions options;
  options.grid.size = size;
  options.tag_template = TagTemplate::kReference;
  options.error = error;
  return options;
}

std::vector<double> patch_of(const PhotometricFrame& frame, const JointLikelihoodOptions& options,
                             const Pose& T_camera_tag) {
  std::vector<double> patch(options.grid.num_samples());
  sample_patch(frame.light[0].view(), camera_320().model, camera_from_tag_plane(T_camera_tag, kTagSize_m),
               options.grid, patch);
  return patch;
}

/// The reference of tag 0 is what the frame shows at `reference_pose`.
JointScores scores_of(const JointLikelihoodOptions& options, const PhotometricFrame& frame,
                      const Pose& reference_pose, const std::vector<MotionState>& hypotheses) {
  JointLikelihood likelihood(camera_320(), one_tag(), TrackMode::kJoint, options);
  likelihood.set_reference(0, patch_of(frame, options, reference_pose));
  JointScores scores;
  likelihood.evaluate(frame, hypotheses, kSerial, &scores);
  return scores;
}

constexpr PatchError kErrors[] = {PatchError::kLinear, PatchError::kMinusLog, PatchError::kGaussianProfile};

TEST(JointLikelihood, FollowsTheErrorChosen) {
  const PhotometricFrame frame = noise_frame(1);
  const Pose truth = facing(0.02, 0.01, 0.5), near = facing(0.0201, 0.0101, 0.5);
  for (const PatchError error : kErrors) {
    JointLikelihoodOptions options = with_references(error);
    options.gamma = 7.0;
    options.kappa = 0.03;
    const JointScores scores = scores_of(options, frame, truth, {at_rest(truth), at_rest(near)});
    const double c = correlate(patch_of(frame, options, near), patch_of(frame, options, truth)).correlation;
    ASSERT_GT(c, 0.2);  // noise moved by a tenth of a pixel
    ASSERT_LT(c, 0.999);
    const double n = 16.0 * 16.0 / 3.0;  // the tag covers 128 x 128 px, far more than the grid has
    const auto expected = [&](double corr) {
      if (error == PatchError::kLinear) return -7.0 * (1.0 - corr) / 2.0;
      if (error == PatchError::kMinusLog) return 7.0 * std::log(corr);
      return -n / 2.0 * (std::log(1.0 - corr * corr + 0.03) - std::log(1.03));
    };
    const double max_error = error == PatchError::kGaussianProfile ? kMaxProfileError : kMaxPaperError;
    EXPECT_NEAR(scores.log_likelihoods[0], expected(1.0), max_error);
    EXPECT_NEAR(scores.log_likelihoods[1], expected(c), max_error);
    EXPECT_NEAR(scores.tag(1, 0).correlation, c, kMaxError);
    EXPECT_EQ(scores.tag(1, 0).seen_share, 1.0);
  }
}

TEST(JointLikelihood, CountsIndependentSamplesOfASmallTag) {
  const PhotometricFrame frame = noise_frame(2);
  const Pose far = facing(0.0, 0.0, 8.0);  // 8 x 8 px: 64 of the grid's 256 samples
  const JointLikelihoodOptions options = with_references(PatchError::kGaussianProfile);
  const JointScores scores = scores_of(options, frame, far, {at_rest(far)});
  EXPECT_NEAR(scores.log_likelihoods[0], -64.0 / 3.0 / 2.0 * std::log(options.kappa / (1.0 + options.kappa)),
              kMaxProfileError);
}

TEST(JointLikelihood, DoesNotRewardLeavingTheImage) {
  const PhotometricFrame frame = noise_frame(3);
  const Pose truth = facing(0.0, 0.0, 0.5);
  // Out on the left, above, behind the camera, turned away.
  const std::vector<MotionState> gone = {at_rest(facing(-1.0, 0.0, 0.5)), at_rest(facing(0.0, -1.0, 0.5)),
                                         at_rest(facing(0.0, 0.0, -0.5)),
                                         at_rest({rotation_exp({3.14, 0, 0}), {0, 0, 0.5}})};
  std::vector<MotionState> here;
  for (int i = 0; i < 40; ++i) here.push_back(at_rest(facing(0.002 * i - 0.04, 0.0, 0.5)));
  for (const PatchError error : kErrors) {
    JointLikelihoodOptions options = with_references(error);
    options.min_correlation = 0.2;
    const JointScores away = scores_of(options, frame, truth, gone);
    const JointScores in_view = scores_of(options, frame, truth, here);
    int num_better = 0;
    for (std::size_t i = 0; i < gone.size(); ++i) {
      EXPECT_EQ(away.tag(i, 0).seen_share, 0.0);
      EXPECT_EQ(away.log_likelihoods[i], away.log_likelihoods[0]);
      for (std::size_t k = 0; k < here.size(); ++k) {
        if (in_view.tag(k, 0).correlation <= 0.0) continue;
        EXPECT_GE(in_view.log_likelihoods[k], away.log_likelihoods[i]);
        ++num_better;
      }
    }
    EXPECT_GT(num_better, 40);
  }
}

TEST(JointLikelihood, MakesLessOfATagThatIsHalfOut) {
  const PhotometricFrame frame = noise_frame(4);
  const Pose whole = facing(0.0, 0.0, 0.5);
  const Pose half = facing(-159.5 / 400.0 * 0.5, 0.0, 0.5);  // its centre on the leftmost pixels
  for (const PatchError error : kErrors) {
    const JointLikelihoodOptions options = with_references(error);
    // Each compared with its own view: what is seen agrees entirely.
    const JointScores in_view = scores_of(options, frame, whole, {at_rest(whole)});
    const JointScores cut = scores_of(options, frame, half, {at_rest(half)});
    EXPECT_NEAR(cut.tag(0, 0).correlation, 1.0, kMaxError);
    EXPECT_EQ(cut.tag(0, 0).seen_share, 0.5);
    EXPECT_LT(cut.log_likelihoods[0], in_view.log_likelihoods[0] - 1.0);
  }
  const JointScores cut = scores_of(with_references(PatchError::kLinear), frame, half, {at_rest(half)});
  EXPECT_NEAR(cut.log_likelihoods[0], -10.0 * (0.5 - 0.25), kMaxPaperError);
}

TEST(JointLikelihood, SumsOverTheTagsThatHaveTemplates) {
  const PhotometricFrame frame = noise_frame(5);
  const TagMap map = two_tags();
  const std::vector<MotionState> hypotheses = {at_rest(facing(-0.1, 0, 0.7)),
                                               at_rest(facing(-0.1, 0.001, 0.7))};
  for (const bool is_mean : {false, true}) {
    JointLikelihoodOptions options = with_references(PatchError::kLinear);
    options.average_over_tags = is_mean;
    JointLikelihood likelihood(camera_320(), map, TrackMode::kJoint, options);
    JointScores scores;
    likelihood.evaluate(frame, hypotheses, kSerial, &scores);
    EXPECT_EQ(scores.log_likelihoods, std::vector<double>(2, 0.0));  // no template, no evidence
    for (std::size_t k = 0; k < 2; ++k)
      likelihood.set_reference(k, patch_of(frame, options, hypotheses[0].pose * map.tags[k].T_map_tag));
    likelihood.evaluate(frame, hypotheses, kSerial, &scores);
    EXPECT_NEAR(scores.log_likelihoods[0], 0.0, kMaxPaperError);
    const double sum = scores.tag(1, 0).log_likelihood + scores.tag(1, 1).log_likelihood;
    EXPECT_LT(scores.tag(1, 0).log_likelihood, -0.1);
    EXPECT_LT(scores.tag(1, 1).log_likelihood, -0.1);
    EXPECT_NEAR(scores.log_likelihoods[1], is_mean ? sum / 2.0 : sum, 1e-12);
    likelihood.clear_reference(1);
    likelihood.evaluate(frame, hypotheses, kSerial, &scores);
    EXPECT_EQ(scores.log_likelihoods[1], scores.tag(1, 0).log_likelihood);
  }
}

TEST(JointLikelihood, EgoMotionIsJointMotionSeenFromTheMap) {
  const PhotometricFrame frame = noise_frame(6);
  const TagMap map = two_tags();
  const JointLikelihoodOptions options = with_references(PatchError::kLinear);
  const Pose T_camera_body(rotation_exp({0.1, -0.2, 0.3}), {-0.1, 0.02, 0.7});
  JointScores ego, joint;
  for (const TrackMode mode : {TrackMode::kEgo, TrackMode::kJoint}) {
    JointLikelihood likelihood(camera_320(), map, mode, options);
    for (std::size_t k = 0; k < 2; ++k)
      likelihood.set_reference(k, patch_of(frame, options, facing(0.01, 0, 0.7) * map.tags[k].T_map_tag));
    const bool is_ego = mode == TrackMode::kEgo;
    likelihood.evaluate(frame, std::vector{at_rest(is_ego ? T_camera_body.inverse() : T_camera_body)},
                        kSerial, is_ego ? &ego : &joint);
  }
  EXPECT_NE(joint.log_likelihoods[0], 0.0);
  EXPECT_NEAR(ego.log_likelihoods[0], joint.log_likelihoods[0], kMaxPaperError);
}

TEST(JointLikelihood, SameBitsOnAnyNumberOfThreads) {
  const PhotometricFrame frame = noise_frame(7);
  RandomStream random(7);
  std::vector<MotionState> hypotheses;
  for (int i = 0; i < 1500; ++i) {  // more than a batch
    MotionState state = at_rest(facing(random.uniform(-0.2, 0.2), random.uniform(-0.2, 0.2), 0.8));
    for (int k = 0; k < 6; ++k) state.velocity[k] = random.normal();
    hypotheses.push_back(state);
  }
  for (const TagTemplate kind : {TagTemplate::kReference, TagTemplate::kPattern}) {
    JointLikelihoodOptions options = with_references(PatchError::kLinear, 8);
    options.tag_template = kind;
    JointScores serial, threaded;
    for (const int num_threads : {1, 3}) {
      JointLikelihood likelihood(camera_320(), two_tags(), TrackMode::kJoint, options);
      likelihood.set_reference(1, patch_of(frame, options, facing(0.0, 0, 0.7)));
      PhotometricFrame exposed = frame;
      exposed.exposure_s = 0.02;
      likelihood.evaluate(exposed, hypotheses, parallel_for(num_threads),
                          num_threads == 1 ? &serial : &threaded);
    }
    EXPECT_EQ(serial.log_likelihoods, threaded.log_likelihoods);
    EXPECT_NE(serial.log_likelihoods.front(), serial.log_likelihoods.back());
  }
}

TEST(JointLikelihood, ManyTagsTakeLittleMemoryAndChangeNoScore) {
  constexpr int kNumTags = 400;
  TagMap wall;  // 20 x 20 tags, 20 cm apart
  for (int i = 0; i < kNumTags; ++i)
    wall.tags.push_back(tag_at(i, facing(0.2 * (i % 20) - 1.9, 0.2 * (i / 20) - 1.9, 0.0)));
  PhotometricFrame frame = noise_frame(9);
  frame.exposure_s = 0.02;
  RandomStream random(9);
  std::vector<MotionState> hypotheses;
  for (int i = 0; i < 70; ++i) {
    MotionState state = at_rest(facing(random.uniform(-0.5, 0.5), random.uniform(-0.5, 0.5), 3.0));
    for (int k = 0; k < 3; ++k) state.velocity[k] = random.normal();
    hypotheses.push_back(state);
  }
  JointLikelihoodOptions options;
  options.grid.size = 8;
  JointLikelihood likelihood(camera_320(), wall, TrackMode::kJoint, options);
  JointScores together, threaded, alone;
  {
    // All predictions at once: 28,000 of more than 130 bytes, without what hangs on them.
    const test::AllocationLimit limit(2'500'000);
    ASSERT_NO_THROW(likelihood.evaluate(frame, hypotheses, kSerial, &together));
    ASSERT_NO_THROW(likelihood.evaluate(frame, hypotheses, parallel_for(3), &threaded));
  }
  EXPECT_EQ(together.log_likelihoods, threaded.log_likelihoods);
  int num_seen = 0;
  for (std::size_t i = 0; i < hypotheses.size(); ++i) {
    likelihood.evaluate(frame, {&hypotheses[i], 1}, kSerial, &alone);
    EXPECT_EQ(together.log_likelihoods[i], alone.log_likelihoods[0]);
    for (std::size_t k = 0; k < kNumTags; ++k) {
      EXPECT_EQ(together.tag(i, k).log_likelihood, alone.tag(0, k).log_likelihood);
      EXPECT_EQ(together.tag(i, k).correlation, alone.tag(0, k).correlation);
      num_seen += alone.tag(0, k).seen_share > 0.0 ? 1 : 0;
    }
  }
  EXPECT_GT(num_seen, 70 * 50);
}

TEST(JointLikelihood, MissesNoPartOfATagThatIsInTheImage) {
  const PhotometricFrame frame = noise_frame(8);
  const JointLikelihoodOptions options = with_references(PatchError::kLinear, 8);
  for (const Distortion& lens :
       {Distortion(NoDistortion{}), Distortion(RadtanDistortion({-0.3, 0.1, 2e-3, -1e-3})),
        Distortion(EquidistantDistortion({0.02, 0.0, 0.0, 0.0}))}) {
    Camera camera = camera_320();
    camera.model = CameraModel({200.0, 200.0, 150.0, 130.0}, lens);
    JointLikelihood likelihood(camera, one_tag(), TrackMode::kJoint, options);
    std::vector<double> patch = patch_of(frame, options, facing(0, 0, 0.5));
    likelihood.set_reference(0, patch);
    RandomStream random(8);
    std::vector<MotionState> hypotheses;
    for (int i = 0; i < 3000; ++i) {
      Eigen::Vector3d place(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-0.3, 1.0));
      hypotheses.push_back(at_rest({rotation_exp(random.normal() * place), place}));
    }
    JointScores scores;
    likelihood.evaluate(frame, hypotheses, kSerial, &scores);
    int num_partly = 0, num_unseen = 0;
    for (std::size_t i = 0; i < hypotheses.size(); ++i) {
      const int seen =
          sample_patch(frame.light[0].view(), camera.model,
                       camera_from_tag_plane(hypotheses[i].pose, kTagSize_m), options.grid, patch);
      EXPECT_EQ(scores.tag(i, 0).seen_share, seen < PatchMatch::kMinSamples ? 0.0 : seen / 64.0);
      num_partly += seen > 0 && seen < 64 ? 1 : 0;
      num_unseen += seen == 0 ? 1 : 0;
    }
    EXPECT_GT(num_partly, 100);
    EXPECT_GT(num_unseen, 500);
  }
}

TEST(JointLikelihood, AsksForNoMemoryOnceItHasSeenAFrame) {
  PhotometricFrame frame = noise_frame(10);
  frame.exposure_s = 0.02;
  RandomStream random(10);
  std::vector<MotionState> hypotheses;
  for (int i = 0; i < 1500; ++i) {  // more than a batch
    MotionState state = at_rest(facing(random.uniform(-0.2, 0.2), random.uniform(-0.2, 0.2), 0.8));
    state.velocity[0] = random.normal();
    hypotheses.push_back(state);
  }
  for (const TagTemplate kind : {TagTemplate::kReference, TagTemplate::kPattern}) {
    JointLikelihoodOptions options = with_references(PatchError::kLinear, 16);
    options.tag_template = kind;
    options.coarse_sigmas = 3.0;
    JointLikelihood likelihood(camera_320(), two_tags(), TrackMode::kJoint, options);
    likelihood.set_reference(1, patch_of(frame, options, facing(0.0, 0, 0.7)));
    JointScores first, second;
    likelihood.evaluate(frame, hypotheses, kSerial, &first);
    second = first;
    std::fill(second.log_likelihoods.begin(), second.log_likelihoods.end(), 1e9);
    {
      const test::AllocationLimit limit(1);
      ASSERT_NO_THROW(likelihood.evaluate(frame, hypotheses, kSerial, &second));
    }
    EXPECT_EQ(first.log_likelihoods, second.log_likelihoods);
  }
}

TEST(JointLikelihood, DoesNotSeeWhatLiesBesideSaturatedPixels) {
  PhotometricFrame frame = noise_frame(11);
  for (int y = 0; y < 240; ++y)
    for (int x = 160; x < 200; ++x) frame.light[0](x, y) = 0.99F;
  JointLikelihoodOptions options = with_references(PatchError::kLinear);
  const Pose pose =
      facing(0.0, 0.0, 0.5);  // 128 pixels wide about pixel 159.5: columns from 159.5 on are bright
  const JointScores all = scores_of(options, frame, pose, {at_rest(pose)});
  options.max_light = 0.985;
  for (int y = 0; y < 240; ++y)
    for (int x = 0; x < 320; ++x) frame.light[0](x, y) *= x >= 160 && x < 200 ? 1.0F : 0.9F;
  const JointScores unsaturated = scores_of(options, frame, pose, {at_rest(pose)});
  EXPECT_EQ(all.tag(0, 0).seen_share, 1.0);
  // Of 16 columns at 163.5, 171.5 ... 219.5 to the right of the middle, those up to 195.5 are lost.
  EXPECT_EQ(unsaturated.tag(0, 0).seen_share, 11.0 / 16.0);
}

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
  for (int i = 0; i < 1000; ++i)  // within some 15 pixels
    hypotheses.push_back(at_rest(facing(0.03 * random.normal(), 0.03 * random.normal(), 0.8)));
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

TEST(JointLikelihood, RefusesOptionsOutOfRange) {
  JointLikelihoodOptions options;
  options.gamma = -1.0;
  EXPECT_THROW(JointLikelihood(camera_320(), one_tag(), TrackMode::kEgo, options), Error);
  options = {};
  options.coarse_sigmas = -1.0;
  EXPECT_THROW(JointLikelihood(camera_320(), one_tag(), TrackMode::kEgo, options), Error);
  options = {};
  options.max_light = 0.0;
  EXPECT_THROW(JointLikelihood(camera_320(), one_tag(), TrackMode::kEgo, options), Error);
  TagMap map = one_tag();
  map.tags[0].key.id = 100'000;
  EXPECT_THROW(JointLikelihood(camera_320(), map, TrackMode::kEgo), Error);
}

Motion across_the_picture() {
  Motion motion = Motion::fixed(facing(0.0, 0.0, 0.7));
  motion.position_m[0].rate_per_s = 1.1;  // 12.6 px during the exposure, of a tag of 91 px
  motion.position_m[1].rate_per_s = 0.6;
  return motion;
}

class FilmedTag : public ::testing::Test {
 protected:
  JointScores evaluate(const std::vector<MotionState>& hypotheses) const {
    JointLikelihood likelihood(camera_320(), one_tag(), TrackMode::kJoint);
    JointScores scores;
    likelihood.evaluate(film_.frame, hypotheses, kSerial, &scores);
    return scores;
  }

  const test::TagFilm film_{camera_320().model, across_the_picture()};
  const MotionState truth_ = film_.truth;
};

TEST_F(FilmedTag, LooksAsThePatternPredicts) {
  const JointScores scores = evaluate({truth_, at_rest(truth_.pose)});
  EXPECT_GT(scores.tag(0, 0).correlation, 0.99);
  EXPECT_LT(scores.tag(1, 0).correlation, 0.9);  // as if it were sharp
}

TEST_F(FilmedTag, IsLikeliestWhereItIsAndMovesAsItDoes) {
  std::vector<MotionState> hypotheses = {truth_};
  for (int axis = 0; axis < 6; ++axis) {
    for (const double sign : {-1.0, 1.0}) {
      Vector6d step = Vector6d::Zero();
      step[axis] = sign * (axis < 2 ? 0.002 : axis == 2 ? 0.02 : axis == 5 ? 0.02 : 0.1);
      MotionState moved = truth_, faster = truth_;
      moved.pose = moved.pose * Pose::exp(step);
      faster.velocity[axis] += sign * (axis < 2 ? 0.25 : axis == 2 ? 3.0 : axis == 5 ? 3.0 : 12.0);
      hypotheses.push_back(moved);
      hypotheses.push_back(faster);
    }
  }
  const JointScores scores = evaluate(hypotheses);
  for (std::size_t i = 1; i < hypotheses.size(); ++i) {
    EXPECT_GT(scores.log_likelihoods[0], scores.log_likelihoods[i] + 1.0)
        << "pose " << hypotheses[i].pose.log().transpose() << ", velocity "
        << hypotheses[i].velocity.transpose();
  }
}

TEST_F(FilmedTag, TellsForwardFromBackwardByNothing) {
  MotionState backward = truth_;
  backward.velocity = -truth_.velocity;
  const JointScores scores = evaluate({truth_, backward});
  EXPECT_NEAR(scores.log_likelihoods[0], scores.log_likelihoods[1], 0.02 * scores.log_likelihoods[0]);
}

}  // namespace
}  // namespace apriltrack
