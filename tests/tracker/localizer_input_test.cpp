#include <gmock/gmock.h>

#include <functional>
#include <limits>

#include "apriltrack/base/error.h"
#include "apriltrack/tracker/localizer.h"
#include "synthetic_world.h"

namespace apriltrack {
namespace {

TEST(Localizer, SaysWhyThereIsNoPose) {
  const Camera camera = test::radtan();
  Localizer localizer(camera, test::only(test::room(), {0, 1}));
  EXPECT_EQ(localizer.localize(FrameDetections{}).reason, "no tag seen");
  const TrackResult unmapped = localizer.localize(test::seen(camera, test::only(test::room(), {5}), Pose()));
  EXPECT_EQ(unmapped.status, TrackStatus::kLost);
  EXPECT_EQ(unmapped.tags_detected, 0);
  EXPECT_EQ(unmapped.reason, "no tag of the map seen");

  // One edge looks three times as long as the one across: a square of 0.16 m would have to reach 0.5 m in
  // depth.
  FrameDetections bent = test::seen(camera, test::only(test::room(), {0}), Pose());
  bent.detections[0].corners_px = {Eigen::Vector2d(250, 300), {350, 300}, {450, 100}, {150, 100}};
  const TrackResult lost = localizer.localize(bent);
  EXPECT_EQ(lost.status, TrackStatus::kLost);
  EXPECT_EQ(lost.reason, "the corners seen fit no pose");
}

TEST(Localizer, NoDetectionWhateverGivesANaNOrAnException) {
  const Camera camera = test::radtan();
  RandomStream random(306);
  Localizer localizer(camera, test::room());
  int num_poses = 0;
  for (int i = 0; i < 2000; ++i) {
    FrameDetections frame;
    frame.timestamp = {static_cast<std::int64_t>(random.uniform(0.0, 1e9))};  // backwards, too
    const int num_tags = static_cast<int>(random.uniform(0.0, 5.0));
    const double spread_px = std::pow(10.0, random.uniform(-6.0, 3.0));
    for (int k = 0; k < num_tags; ++k) {
      Detection detection{.tag = {"tag36h11", static_cast<int>(random.uniform(0.0, 7.0))},
                          .corners_px = {},
                          .hamming = {},
                          .decision_margin = {}};
      const Eigen::Vector2d centre{random.uniform(0.0, 640.0), random.uniform(0.0, 480.0)};
      for (Eigen::Vector2d& corner : detection.corners_px) {
        corner = centre + spread_px * Eigen::Vector2d{random.normal(), random.normal()};
      }
      if (i % 50 == 0) detection.corners_px[1].x() = std::numeric_limits<double>::quiet_NaN();
      frame.detections.push_back(detection);
    }
    const TrackResult result = localizer.localize(frame);
    EXPECT_EQ(result.pose.has_value(), result.status == TrackStatus::kDetected);
    EXPECT_EQ(result.pose.has_value(), result.reason.empty());
    if (!result.pose) continue;
    EXPECT_TRUE(result.pose->is_finite());
    EXPECT_TRUE(result.covariance->allFinite());
    ++num_poses;
  }
  EXPECT_GT(num_poses, 20) << "some random quads are tags";
}

TEST(Localizer, RefusesAMapWithoutTagsAndUnknownFamilies) {
  EXPECT_THROW(Localizer(test::radtan(), TagMap()), Error);
  TagMap map = test::room();
  map.tags[2].key.family = "tag99h1";
  try {
    Localizer localizer(test::radtan(), map);
    FAIL() << "an unknown family must be refused";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::kInvalidInput);
    EXPECT_THAT(error.what(), testing::HasSubstr("tag99h1/2"));
    EXPECT_THAT(error.what(), testing::HasSubstr("tag36h11"));
  }
}

/// A map that a program made: what tags/ refuses in files, it must not pass here.
TEST(Localizer, RefusesAMapWithValuesThatNoFileMayHave) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const std::vector<std::pair<std::string, std::function<void(TagMap&)>>> spoilers = {
      {"tag36h11/2: size_m: must be > 0 and at most 100 (is nan)",
       [&](TagMap& m) { m.tags[2].size_m = nan; }},
      {"tag36h11/2: size_m: must be > 0 and at most 100 (is 0)", [](TagMap& m) { m.tags[2].size_m = 0.0; }},
      {"tag36h11/2: size_m", [](TagMap& m) { m.tags[2].size_m = -0.16; }},
      {"tag36h11/2: T_map_tag",
       [&](TagMap& m) {
         m.tags[2].T_map_tag = Pose(Eigen::Quaterniond::Identity(), {nan, 0.0, 0.0});
       }},
      {"tag36h11/2: covariance", [&](TagMap& m) { m.tags[2].covariance = Matrix6d::Constant(nan); }},
      {"tag36h11/2: covariance", [](TagMap& m) { m.tags[2].covariance = -Matrix6d::Identity(); }},
      {"tag36h11/900: id", [](TagMap& m) { m.tags[2].key.id = 900; }},
      {"tag36h11/2 is in it twice", [](TagMap& m) { m.tags.push_back(m.tags[2]); }}};
  for (const auto& [message, spoil] : spoilers) {
    TagMap map = test::room();
    spoil(map);
    try {
      Localizer localizer(test::radtan(), map);
      ADD_FAILURE() << "not refused: " << message;
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::kInvalidInput);
      EXPECT_THAT(error.what(), testing::HasSubstr(message));
    }
  }
}

/// A lone tag after a moving pose: its covariance rests on the blur, and so on the exposure.
TEST(Localizer, AnExposureThatCannotBeIsAsIfItWereNotTold) {
  Camera camera = test::radtan();
  camera.exposure_s = std::nullopt;
  const Pose before = Pose::exp((Vector6d() << 0.05, 0, 0, 0, 0, 0.1).finished());
  const auto sigma_with = [&](std::optional<double> exposure_s, std::optional<double> of_camera_s) {
    camera.exposure_s = of_camera_s;
    Localizer localizer(camera, test::room());
    localizer.localize(test::seen(camera, test::room(), before, {1'000'000'000}));
    const TrackResult result = localizer.localize(
        test::seen(camera, test::only(test::room(), {2}), Pose(), {1'033'000'000}), exposure_s);
    EXPECT_TRUE(result.pose && result.covariance->allFinite()) << result.reason;
    const auto is_odd = [](std::optional<double> told_s) {
      return told_s && !(*told_s >= 0.0 && *told_s <= 1.0);
    };
    EXPECT_EQ(result.warning.empty(), !is_odd(exposure_s) && (exposure_s || !is_odd(of_camera_s)))
        << result.warning;
    return result.pose ? std::sqrt(result.covariance->trace()) : 0.0;
  };
  const double not_told = sigma_with(std::nullopt, std::nullopt);
  const double of_camera = sigma_with(std::nullopt, 0.03);
  ASSERT_GT(of_camera, 1.5 * not_told) << "the exposure must matter, or this proves nothing";
  ASSERT_LT(sigma_with(0.0, std::nullopt), 0.7 * not_told);
  for (const double odd_s : {std::numeric_limits<double>::quiet_NaN(), -0.03, -1e300, 10.0,
                             std::numeric_limits<double>::infinity()}) {
    EXPECT_EQ(sigma_with(odd_s, std::nullopt), not_told) << odd_s;
    EXPECT_EQ(sigma_with(odd_s, 0.03), of_camera) << odd_s;
    EXPECT_EQ(sigma_with(std::nullopt, odd_s), not_told) << odd_s;
  }
}

TEST(Localizer, RefusesOptionsOutOfRange) {
  LocalizerOptions options;
  options.corner_sigma_px = 0.0;
  EXPECT_THROW(options.check(), Error);
  options = {};
  options.max_residual_rms_px = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(options.check(), Error);
  EXPECT_NO_THROW(LocalizerOptions().check());
}

TEST(Localizer, AnImageOfAnotherResolutionIsLostAndSaysBothSizes) {
  Localizer localizer(test::radtan(), test::room());
  const GrayImage image(320, 240);
  const TrackResult result =
      localizer.localize(Frame{.image = image.view(), .timestamp = {77}, .exposure_s = {}});
  EXPECT_EQ(result.status, TrackStatus::kLost);
  EXPECT_FALSE(result.pose);
  EXPECT_EQ(result.timestamp, Timestamp{77});
  EXPECT_THAT(result.reason, testing::HasSubstr("320 x 240"));
  EXPECT_THAT(result.reason, testing::HasSubstr("640 x 480"));
  // The next frame is none the worse for it.
  EXPECT_EQ(localizer.localize(test::seen(test::radtan(), test::room(), Pose())).status,
            TrackStatus::kDetected);
}

}  // namespace
}  // namespace apriltrack
