#include "apriltrack/photometric/visual_gyroscope.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "apriltrack/base/random.h"
#include "apriltrack/geometry/rotation.h"

namespace apriltrack {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr int kLevels = 3;
/// Without blur or noise; a pixel of the small pictures is 0.8 degrees wide.
constexpr double kMaxError_rad = 0.15 * kDegree;

/// Light of some waves across the directions of the world: smooth, and told exactly anywhere.
class WavySky {
 public:
  /// most_per_rad: no wave is shorter than 2 pi / most_per_rad.
  explicit WavySky(std::uint64_t seed, double most_per_rad = 40.0) {
    RandomStream random(seed);
    constexpr int kWaves = 16;
    for (int k = 0; k < kWaves; ++k) {
      const Vector3d direction{random.normal(), random.normal(), random.normal()};
      const double per_rad = 4.0 * std::pow(most_per_rad / 4.0, (k + 0.5) / kWaves);
      waves_.push_back({(per_rad * direction.normalized()).cast<float>(),
                        static_cast<float>(random.uniform(0.0, 2.0 * std::numbers::pi))});
    }
  }
  /// points: of one column each.
  Eigen::ArrayXf light(const Eigen::Matrix3Xf& points) const {
    Eigen::ArrayXf light = Eigen::ArrayXf::Constant(points.cols(), 0.5F);
    for (const Wave& wave : waves_)
      light += 0.06F * ((wave.per_rad.transpose() * points).array().transpose() + wave.phase).sin();
    return light;
  }

 private:
  struct Wave {
    Eigen::Vector3f per_rad;
    float phase;
  };
  std::vector<Wave> waves_;
};

struct Look {
  Quaterniond R_world_camera = Quaterniond::Identity();  ///< At the middle of the exposure.
  Vector3d sweep_rad = Vector3d::Zero();                 ///< Turned in the exposure, in the camera's frame.
  float gain = 1.0F, offset = 0.0F;
};

/// A camera at one place, and all that it sees far away.
class SkyCamera {
 public:
  SkyCamera(const CameraModel& model, int width, int height) : width_(width), height_(height) {
    rays_ = Eigen::Matrix3Xf::Constant(3, width * height, std::numeric_limits<float>::quiet_NaN());
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x)
        if (const auto ray = model.unproject({x, y})) rays_.col(y * width + x) = ray->cast<float>();
    }
  }

  LightPyramid look(const WavySky& sky, const Look& look = {}) const {
    const int instants = look.sweep_rad.isZero() ? 1 : 8;
    Eigen::ArrayXf sum = Eigen::ArrayXf::Zero(rays_.cols());
    for (int i = 0; i < instants; ++i) {
      const double share = (i + 0.5) / instants - 0.5;
      const Quaterniond R = look.R_world_camera * rotation_exp(share * look.sweep_rad);
      sum += sky.light(R.toRotationMatrix().cast<float>() * rays_);
    }
    return filmed(look.gain / static_cast<float>(instants) * sum + look.offset);
  }
  /// Of a wall square to the unturned camera's axis, 2 m before the origin.
  LightPyramid look_at_wall(const WavySky& painting, const Vector3d& place_m) const {
    Eigen::Matrix3Xf points = rays_;
    points.array().rowwise() *= (2.0F - static_cast<float>(place_m.z())) / rays_.row(2).array();
    points.colwise() += place_m.cast<float>();
    return filmed(painting.light(points));
  }

 private:
  /// Dark where the lens shows nothing.
  LightPyramid filmed(const Eigen::ArrayXf& light) const {
    Image<float> image(width_, height_);
    for (int y = 0; y < height_; ++y) {
      for (int x = 0; x < width_; ++x) {
        const float here = light[y * width_ + x];
        image(x, y) = std::isnan(here) ? 0.0F : here;
      }
    }
    return light_pyramid(std::move(image), kLevels);
  }

  int width_, height_;
  Eigen::Matrix3Xf rays_;
};

/// 65 x 51 degrees.
class SeenTurns : public ::testing::Test {
 protected:
  static CameraModel lens() {
    return {{500.0, 500.0, 322.0, 237.0}, RadtanDistortion({-0.12, 0.03, 1e-3, -5e-4})};
  }
  std::optional<CameraTurn> turn_between(const Look& before, const Look& now) {
    VisualGyroscope gyroscope(lens());
    EXPECT_FALSE(gyroscope.turn(camera_.look(sky_, before)));
    return gyroscope.turn(camera_.look(sky_, now));
  }
  /// now: after a turn of `turn_rad` from `before`. Infinite where no turn was told.
  double error_rad(Look before, Look now, const Vector3d& turn_rad) {
    now.R_world_camera = before.R_world_camera * rotation_exp(turn_rad);
    const std::optional<CameraTurn> turn = turn_between(before, now);
    if (!turn) return std::numeric_limits<double>::infinity();
    return rotation_log(turn->R_before_now.conjugate() * rotation_exp(turn_rad)).norm();
  }
  /// Nowhere special.
  static Look somewhere() { return {.R_world_camera = rotation_exp({0.4, -1.1, 0.7})}; }

  SkyCamera camera_{lens(), 640, 480};
  WavySky sky_{1};
};

TEST_F(SeenTurns, AreThoseOfTheCameraAboutEveryAxis) {
  double most = 0.0;
  for (const double angle : {0.0, 1.0, 4.0, 8.0, 12.0}) {
    for (int axis = 0; axis < 3; ++axis) {
      if (axis == 2 && angle > 8.0) continue;  // no shift comes near enough to start from
      for (const double sign : {-1.0, 1.0}) {
        const double error = error_rad(somewhere(), {}, sign * angle * kDegree * Vector3d::Unit(axis));
        EXPECT_LT(error, kMaxError_rad) << sign * angle << " degrees about axis " << axis;
        most = std::max(most, error);
      }
    }
  }
  RecordProperty("most_deg", std::to_string(most / kDegree));
}

TEST_F(SeenTurns, AreRightOrNoneWhereTheCameraRolls) {
  for (const double angle : {-30.0, -20.0, -12.0, 12.0, 20.0, 30.0}) {
    const double error = error_rad(somewhere(), {}, Vector3d(0.0, 0.0, angle * kDegree));
    EXPECT_TRUE(error < kMaxError_rad || std::isinf(error)) << angle << " degrees: " << error / kDegree;
  }
}

TEST_F(SeenTurns, MayBeAboutSeveralAxesAtOnce) {
  EXPECT_LT(error_rad(somewhere(), {}, Vector3d(6.0, -8.0, 4.0) * kDegree), kMaxError_rad);
  EXPECT_LT(error_rad(somewhere(), {}, Vector3d(-3.0, 9.0, 8.0) * kDegree), kMaxError_rad);
}

TEST_F(SeenTurns, ShowThroughLongBlurThatTurnsAbout) {
  // 60 px at the middle of the image in both frames; level with the turn, across it, and against it.
  const double sweep = 60.0 / 500.0;
  const Vector3d turn = Vector3d(-2.0, 6.0, 1.0) * kDegree;
  double most = 0.0;
  for (const auto& [before, now] : std::vector<std::pair<Vector3d, Vector3d>>{
           {{0.0, sweep, 0.0}, {0.0, sweep, 0.0}},
           {{0.0, sweep, 0.0}, {0.0, -sweep, 0.0}},
           {{0.0, sweep, 0.0}, {sweep, 0.0, 0.0}},
           {{0.7 * sweep, 0.7 * sweep, 0.0}, {0.7 * sweep, -0.7 * sweep, 0.0}},
           {{0.0, 0.0, 0.0}, {0.0, sweep, 0.0}}}) {
    Look first = somewhere(), second;
    first.sweep_rad = before;
    second.sweep_rad = now;
    const double error = error_rad(first, second, turn);
    EXPECT_LT(error, 0.3 * kDegree) << before.transpose() << ", then " << now.transpose();
    most = std::max(most, error);
  }
  RecordProperty("most_deg", std::to_string(most / kDegree));
}

TEST_F(SeenTurns, DoNotDependOnTheLight) {
  const Vector3d turn = Vector3d(3.0, -5.0, 2.0) * kDegree;
  for (const auto& [gain, offset] :
       {std::pair(0.3F, 0.0F), std::pair(2.5F, 0.0F), std::pair(0.5F, 0.4F), std::pair(1.6F, -0.3F)}) {
    EXPECT_LT(error_rad(somewhere(), {.gain = gain, .offset = offset}, turn), kMaxError_rad)
        << gain << ", " << offset;
  }
}

TEST_F(SeenTurns, AreTheMiddlesOfExposuresOfAnyTurns) {
  const CameraModel lens({250.0, 250.0, 160.0, 120.0}, NoDistortion{});
  const SkyCamera camera(lens, 320, 240);
  RandomStream random(2);
  const auto any = [&](double most) -> Vector3d {
    return most * Vector3d{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)};
  };
  double most = 0.0;
  for (int i = 0; i < 20; ++i) {
    const Vector3d turn = any(7.0 * kDegree);
    const Look before{.R_world_camera = rotation_exp(any(2.0)), .sweep_rad = any(0.08)};
    const Look now{.R_world_camera = before.R_world_camera * rotation_exp(turn),
                   .sweep_rad = any(0.08),
                   .gain = static_cast<float>(random.uniform(0.5, 1.5))};
    VisualGyroscope gyroscope(lens);
    gyroscope.turn(camera.look(sky_, before));
    const std::optional<CameraTurn> seen = gyroscope.turn(camera.look(sky_, now));
    ASSERT_TRUE(seen) << i;
    const double error = rotation_log(seen->R_before_now.conjugate() * rotation_exp(turn)).norm();
    EXPECT_LT(error, 0.3 * kDegree) << i;
    EXPECT_LT(error, seen->sigma_rad) << i;
    EXPECT_LT(seen->sigma_rad, 2.0 * kDegree) << i;  // else it tells nothing
    most = std::max(most, error);
  }
  RecordProperty("most_deg", std::to_string(most / kDegree));
}

TEST_F(SeenTurns, AreSinceTheFrameBefore) {
  VisualGyroscope gyroscope(lens());
  Look look = somewhere();
  EXPECT_FALSE(gyroscope.turn(camera_.look(sky_, look)));
  for (const Vector3d& step :
       {Vector3d(0.0, 0.1, 0.0), Vector3d(-0.05, 0.1, 0.0), Vector3d(0.0, -0.1, 0.05)}) {
    look.R_world_camera = look.R_world_camera * rotation_exp(step);
    const std::optional<CameraTurn> turn = gyroscope.turn(camera_.look(sky_, look));
    ASSERT_TRUE(turn);
    EXPECT_LT((rotation_log(turn->R_before_now) - step).norm(), 0.2 * kDegree) << step.transpose();
  }
}

TEST_F(SeenTurns, LookLikeStepsToTheSameSide) {
  // x to the right, y down: who goes right by a twentieth of the distance sees what turning right by that
  // shows, about y; who goes down sees what looking down shows, about -x.
  const WavySky painting(3, 15.0);
  const LightPyramid start = camera_.look_at_wall(painting, Vector3d::Zero());
  for (const auto& [place, expected] : {std::pair(Vector3d(0.1, 0.0, 0.0), Vector3d(0.0, 0.05, 0.0)),
                                        std::pair(Vector3d(0.0, 0.1, 0.0), Vector3d(-0.05, 0.0, 0.0))}) {
    VisualGyroscope gyroscope(lens());
    gyroscope.turn(start);
    const std::optional<CameraTurn> turn = gyroscope.turn(camera_.look_at_wall(painting, place));
    ASSERT_TRUE(turn);
    EXPECT_LT((rotation_log(turn->R_before_now) - expected).norm(), 0.01) << place.transpose();
  }
}

TEST_F(SeenTurns, AreThoseOfACameraOnEnd) {
  const CameraModel lens({250.0, 250.0, 119.5, 159.5}, NoDistortion{});
  const SkyCamera camera(lens, 240, 320);
  const Vector3d turn = Vector3d(7.0, 2.0, -3.0) * kDegree;
  VisualGyroscope gyroscope(lens);
  gyroscope.turn(camera.look(sky_));
  const auto seen = gyroscope.turn(camera.look(sky_, {.R_world_camera = rotation_exp(turn)}));
  ASSERT_TRUE(seen);
  EXPECT_LT((rotation_log(seen->R_before_now) - turn).norm(), 0.2 * kDegree);
}

TEST_F(SeenTurns, AreThoseOfAFisheyeLens) {
  // Its corners are farther off the axis than any small picture reaches.
  const CameraModel lens({150.0, 150.0, 159.5, 119.5}, EquidistantDistortion({0.0, 0.0, 0.0, 0.0}));
  const SkyCamera camera(lens, 320, 240);
  const Vector3d turn = Vector3d(4.0, -9.0, 6.0) * kDegree;
  VisualGyroscope gyroscope(lens);
  const WavySky sky(4, 20.0);
  gyroscope.turn(camera.look(sky));
  const auto seen = gyroscope.turn(camera.look(sky, {.R_world_camera = rotation_exp(turn)}));
  ASSERT_TRUE(seen);
  EXPECT_LT((rotation_log(seen->R_before_now) - turn).norm(), 0.3 * kDegree);
}

/// What no turn may be told from.
class UnseenTurns : public SeenTurns {
 protected:
  UnseenTurns() : here_(camera_.look(sky_)) {}
  LightPyramid dark(int width = 640, int height = 480) const {
    return light_pyramid(Image<float>(width, height, 0.02F), kLevels);
  }
  /// Without the lowest rows.
  LightPyramid lower() const { return SkyCamera(lens(), 640, 400).look(sky_); }

  LightPyramid here_;
  VisualGyroscope gyroscope_{lens()};
};

TEST_F(UnseenTurns, OfDarkFrames) {
  EXPECT_FALSE(gyroscope_.turn(dark()));
  EXPECT_FALSE(gyroscope_.turn(dark()));
  EXPECT_FALSE(gyroscope_.turn(here_));
  EXPECT_TRUE(gyroscope_.turn(here_));
  EXPECT_FALSE(gyroscope_.turn(dark()));
  EXPECT_FALSE(gyroscope_.turn(light_pyramid(Image<float>(640, 480, 0.0F), kLevels)));
}

TEST_F(UnseenTurns, OfNothingButNoise) {
  RandomStream random(5);
  for (int i = 0; i < 3; ++i) {
    Image<float> noise(640, 480);
    for (int y = 0; y < noise.height(); ++y) {
      for (int x = 0; x < noise.width(); ++x) noise(x, y) = static_cast<float>(random.uniform());
    }
    EXPECT_FALSE(gyroscope_.turn(light_pyramid(std::move(noise), kLevels))) << i;
  }
}

TEST_F(UnseenTurns, OfScenesThatAreNotTheSame) {
  EXPECT_FALSE(gyroscope_.turn(here_));
  for (std::uint64_t seed = 10; seed < 30; ++seed)
    EXPECT_FALSE(gyroscope_.turn(camera_.look(WavySky(seed)))) << seed;
}

TEST_F(UnseenTurns, OfANegative) {
  EXPECT_FALSE(gyroscope_.turn(here_));
  EXPECT_FALSE(gyroscope_.turn(camera_.look(sky_, {.gain = -1.0F, .offset = 1.0F})));
}

TEST_F(UnseenTurns, ThatLeaveTooLittleInCommon) {
  EXPECT_FALSE(gyroscope_.turn(here_));
  EXPECT_FALSE(
      gyroscope_.turn(camera_.look(sky_, {.R_world_camera = rotation_exp({0.0, 50.0 * kDegree, 0.0})})));
}

TEST_F(UnseenTurns, BetweenImagesOfTwoSizes) {
  EXPECT_FALSE(gyroscope_.turn(here_));
  EXPECT_FALSE(gyroscope_.turn(lower()));
  EXPECT_TRUE(gyroscope_.turn(lower()));
  EXPECT_FALSE(gyroscope_.turn(here_));
  EXPECT_TRUE(gyroscope_.turn(here_));
}

TEST_F(UnseenTurns, OfTinyImages) {
  for (const int size : {1, 8, 63}) {
    EXPECT_FALSE(gyroscope_.turn(dark(size, size))) << size;
    EXPECT_FALSE(gyroscope_.turn(dark(size, 480))) << size;
    EXPECT_FALSE(gyroscope_.turn(dark(640, size))) << size;
  }
}

TEST_F(UnseenTurns, AcrossAFrameThatWasTooSmall) {
  // The frame before is the small one, whatever came before it.
  EXPECT_FALSE(gyroscope_.turn(here_));
  EXPECT_FALSE(gyroscope_.turn(dark(8, 8)));
  EXPECT_FALSE(gyroscope_.turn(here_));
  EXPECT_TRUE(gyroscope_.turn(here_));
}

TEST_F(UnseenTurns, AfterItForgets) {
  EXPECT_FALSE(gyroscope_.turn(here_));
  EXPECT_TRUE(gyroscope_.turn(here_));
  gyroscope_.forget();
  EXPECT_FALSE(gyroscope_.turn(here_));
  EXPECT_TRUE(gyroscope_.turn(here_));
}

}  // namespace
}  // namespace apriltrack
