// What `track --tags-csv` tells of a tag in a frame.
#include "commands/track/tag_sights.h"

#include <gmock/gmock.h>

#include <Eigen/Cholesky>
#include <random>

namespace apriltrack::test {
namespace {

using app::SightStatus;
using app::TagSight;

const TagKey kFirst{"tag36h11", 1}, kSecond{"tag36h11", 2}, kThird{"tag36h11", 3}, kStray{"tag36h11", 99};

/// Three tags on a wall two metres away, which faces the camera at the origin of the map.
TagMap wall() {
  TagMap map;
  for (int i = 0; i < 3; ++i) {
    MapTag tag;
    tag.key = {"tag36h11", i + 1};
    tag.size_m = 0.2;
    tag.T_map_tag = Pose(Eigen::Quaterniond(0.995, 0.0, 0.0998, 0.0), {0.4 * i - 0.4, 0.1 * i, 2.0});
    map.tags.push_back(tag);
  }
  return map;
}

Camera lens() {
  return {.name = "cam0",
          .model = CameraModel({520.0, 515.0, 322.0, 238.0}, RadtanDistortion({-0.2, 0.05, 0.001, -0.002})),
          .width = 640,
          .height = 480};
}

/// The camera moves through the map; the pose is off the origin.
Pose some_pose() {
  return {Eigen::Quaterniond(0.98, 0.05, -0.08, 0.17), {0.1, -0.05, 0.2}};
}

Matrix6d uneven_covariance() {
  Matrix6d root = Matrix6d::Zero();
  root.diagonal() << 2e-3, 1e-3, 3e-3, 2e-3, 1e-3, 4e-3;
  root(3, 1) = -1.5e-3;
  root(4, 0) = 1e-3;
  return root * root.transpose();
}

std::array<Eigen::Vector2d, 4> pixels_of(const MapTag& tag, const Pose& T_camera_map, const Camera& camera) {
  std::array<Eigen::Vector2d, 4> pixels;
  const auto corners = corners_in_map(tag);
  for (std::size_t i = 0; i < corners.size(); ++i)
    pixels[i] = *camera.model.project(T_camera_map * corners[i]);
  return pixels;
}

class TagSights : public ::testing::TestWithParam<TrackMode> {
 protected:
  TagSights() {
    result_.status = TrackStatus::kTracked;
    result_.pose = GetParam() == TrackMode::kEgo ? some_pose() : some_pose().inverse();
    result_.covariance = uneven_covariance();
  }
  Pose T_camera_map(const Pose& pose) const { return GetParam() == TrackMode::kEgo ? pose.inverse() : pose; }
  void report(const TagKey& tag, TagState state, bool is_read) {
    TagReport report;
    report.tag = tag;
    report.state = state;
    report.is_read = is_read;
    result_.tags.push_back(report);
  }
  void read(const TagKey& tag, const Eigen::Vector2d& shift_px) {
    const MapTag* known = map_.find(tag);
    Detection detection;
    detection.tag = tag;
    detection.corners_px = pixels_of(known ? *known : map_.tags[0], T_camera_map(*result_.pose), camera_);
    for (Eigen::Vector2d& corner : detection.corners_px) corner += shift_px;
    detections_.push_back(detection);
  }
  std::vector<TagSight> sights() const {
    return app::tag_sights(result_, detections_, {camera_, map_, GetParam()});
  }

  const Camera camera_ = lens();
  const TagMap map_ = wall();
  TrackResult result_;
  std::vector<Detection> detections_;
};

std::vector<std::string> words_of(const std::vector<TagSight>& sights) {
  std::vector<std::string> words;
  for (const TagSight& sight : sights)
    words.push_back(std::to_string(sight.tag.id) + " " + to_string(sight.status) +
                    (sight.is_read ? " read" : ""));
  return words;
}

TEST_P(TagSights, HaveTheStatusOfTheirReport) {
  report(kSecond, TagState::kUsed, true);
  report(kFirst, TagState::kUsed, false);
  report(kThird, TagState::kOccluded, false);
  read(kSecond, {0, 0});
  read(kStray, {0, 0});
  EXPECT_THAT(words_of(sights()),
              testing::ElementsAre("1 tracked", "2 detected read", "3 occluded", "99 unmapped read"));
  result_.tags[0].state = TagState::kElsewhere;
  result_.tags[1].state = TagState::kSuspect;
  result_.tags[2].state = TagState::kHidden;
  EXPECT_THAT(words_of(sights()),
              testing::ElementsAre("1 suspect", "2 elsewhere read", "3 hidden", "99 unmapped read"));
}

TEST_P(TagSights, OfMethodsThatReportNoneAreWhatWasRead) {
  result_.status = TrackStatus::kDetected;
  read(kFirst, {0, 0});
  read(kSecond, {40, 0});
  result_.contradicting_tags = {kSecond, kThird};
  EXPECT_THAT(words_of(sights()), testing::ElementsAre("1 detected read", "2 elsewhere read", "3 suspect"));
  EXPECT_EQ(sights()[0].log_odds, std::nullopt);
  result_.status = TrackStatus::kPredicted;
  EXPECT_THAT(words_of(sights()), testing::ElementsAre("1 unjudged read", "2 unjudged read", "3 suspect"));
  result_.pose.reset();
  for (const TagSight& sight : sights()) EXPECT_EQ(sight.projected_px, std::nullopt);
}

TEST_P(TagSights, ResidualIsHowFarTheNearestReadingLies) {
  read(kFirst, {3, 4});
  EXPECT_NEAR(sights()[0].residual_px.value(), 5.0, 1e-9);
  read(kFirst, {0, -2});  // it hangs twice
  EXPECT_NEAR(sights()[0].residual_px.value(), 2.0, 1e-9);
}

TEST_P(TagSights, SigmaIsThatOfSampledPoses) {
  report(kFirst, TagState::kUsed, false);
  const TagSight sight = sights()[0];
  const auto expected = pixels_of(map_.tags[0], T_camera_map(*result_.pose), camera_);
  for (std::size_t i = 0; i < 4; ++i) EXPECT_LT(((*sight.projected_px)[i] - expected[i]).norm(), 1e-12);
  const Matrix6d root = uneven_covariance().llt().matrixL();
  std::mt19937_64 random(6);
  std::normal_distribution<double> normal;
  constexpr int kSamples = 20'000;
  double sum_px2 = 0.0;
  for (int k = 0; k < kSamples; ++k) {
    const Vector6d xi = root * Vector6d::NullaryExpr([&] { return normal(random); });
    const auto moved = pixels_of(map_.tags[0], T_camera_map(*result_.pose * Pose::exp(xi)), camera_);
    for (std::size_t i = 0; i < 4; ++i) sum_px2 += (moved[i] - expected[i]).squaredNorm() / 4.0;
  }
  const double sampled_px = std::sqrt(sum_px2 / kSamples);
  EXPECT_NEAR(sight.sigma_px.value() / sampled_px, 1.0, 0.02);  // 4 sigma of sampling
}

INSTANTIATE_TEST_SUITE_P(Modes, TagSights, testing::Values(TrackMode::kEgo, TrackMode::kJoint),
                         [](const auto& mode) { return mode.param == TrackMode::kEgo ? "ego" : "joint"; });

}  // namespace
}  // namespace apriltrack::test
