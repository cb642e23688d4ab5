#include "apriltrack/calib/estimate_response.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "apriltrack/base/random.h"
#include "apriltrack/tags/tag_corners.h"
#include "apriltrack/tags/tag_family.h"

// Tags painted point by point, blurred in linear light and put into grey levels by code of these tests alone.

namespace apriltrack {
namespace {

using ::testing::HasSubstr;

constexpr double kSize_m = 0.16, kFocal_px = 520.0, kCentre_px = 40.0;
constexpr int kImageSide_px = 81;
constexpr int kSide = 12;  // points of a pixel's blur along each axis

Camera square_camera(const ResponseCurve& assumed) {
  return {.name = "cam0",
          .model = CameraModel({kFocal_px, kFocal_px, kCentre_px, kCentre_px}, NoDistortion{}),
          .width = kImageSide_px,
          .height = kImageSide_px,
          .response = assumed};
}

/// Points that stand for equal shares of a Gaussian of 0.5 px smeared over a pixel, on one axis.
std::array<double, kSide> blur_points() {
  constexpr std::size_t kShare = 2000;
  RandomStream random(3);
  std::vector<double> all;
  while (all.size() < kShare * kSide) {
    const double place = 0.5 * random.normal() + random.uniform() - 0.5;
    all.insert(all.end(), {place, -place});
  }
  std::ranges::sort(all);
  std::array<double, kSide> points{};
  for (std::size_t i = 0; i < all.size(); ++i) points[i / kShare] += all[i] / kShare;
  return points;
}

struct Film {
  double exponent = 1.0;  ///< Of the curve; 0: sRGB, as IEC 61966-2-1 has it.
  int num_frames = 24;
  double ink_m = 0.0;  ///< White cells are printed wider by so much on every side.
};

class Painter {
 public:
  explicit Painter(const Film& film) : film_(film), random_(11) {}

  FrameDetections frame(int index) {
    const double size_px = 26.0 + 30.0 * random_.uniform();
    const Eigen::Vector3d axis(random_.normal(), random_.normal(), 0.0);
    const Eigen::Quaterniond tilt(Eigen::AngleAxisd(0.5 * random_.uniform(), axis.normalized()));
    const Eigen::Quaterniond turn(Eigen::AngleAxisd(6.0 * random_.uniform(), Eigen::Vector3d::UnitZ()));
    const double z = kFocal_px * kSize_m / size_px;
    const Pose pose(tilt * turn, {z * (random_.uniform() - 0.5) / kFocal_px,
                                  z * (random_.uniform() - 0.5) / kFocal_px, z});
    const int id = index % 3;
    FrameDetections frame;
    frame.timestamp = Timestamp{100'000'000LL * index};
    frame.detections.push_back({{"tag36h11", id}, corners(pose), 0, 50.0});
    frame.patches.push_back({{"tag36h11", id}, 0, 0, painted(TagFamily::get("tag36h11").pattern(id), pose)});
    return frame;
  }

 private:
  /// A third of a pixel inside, as corners of the wrong response are.
  static std::array<Eigen::Vector2d, kNumCorners> corners(const Pose& pose) {
    std::array<Eigen::Vector2d, kNumCorners> corners;
    const double half = 0.5 * kSize_m * (1.0 - 0.33 * 2.0 / 40.0);
    const std::array<Eigen::Vector2d, kNumCorners> signs = {Eigen::Vector2d(-1, 1), Eigen::Vector2d(1, 1),
                                                            Eigen::Vector2d(1, -1), Eigen::Vector2d(-1, -1)};
    for (std::size_t k = 0; k < corners.size(); ++k) {
      const Eigen::Vector3d p = pose * Eigen::Vector3d(half * signs[k].x(), half * signs[k].y(), 0.0);
      corners[k] = kFocal_px * p.head<2>() / p.z() + Eigen::Vector2d::Constant(kCentre_px);
    }
    return corners;
  }

  GrayImage painted(const TagPattern& pattern, const Pose& pose) {
    GrayImage image(kImageSide_px, kImageSide_px);
    const Eigen::Matrix3d R = pose.rotation_matrix();
    for (int y = 0; y < kImageSide_px; ++y) {
      for (int x = 0; x < kImageSide_px; ++x) {
        double sum = 0.0;
        for (const double dx : points_) {
          for (const double dy : points_) sum += light(pattern, R, pose.translation(), x + dx, y + dy);
        }
        image(x, y) = code(sum / (kSide * kSide));
      }
    }
    return image;
  }

  double light(const TagPattern& pattern, const Eigen::Matrix3d& R, const Eigen::Vector3d& t, double x,
               double y) const {
    const Eigen::Vector3d ray((x - kCentre_px) / kFocal_px, (y - kCentre_px) / kFocal_px, 1.0);
    const Eigen::Vector3d point = R.transpose() * (R.col(2).dot(t) / R.col(2).dot(ray) * ray - t);
    const double u = point.x() / (0.5 * kSize_m), v = point.y() / (0.5 * kSize_m);
    if (std::max(std::abs(u), std::abs(v)) > pattern.half_extent()) return 0.3;
    const double ink = film_.ink_m / (0.5 * kSize_m);
    double white = pattern.brightness(u, v);
    if (ink > 0.0) {
      for (const double du : {-ink, ink}) {
        for (const double dv : {-ink, ink})
          white = std::max(white, double{pattern.brightness(u + du, v + dv)});
      }
    }
    return (0.05 + 0.6 * white) * (1.0 + 0.1 * u);
  }

  std::uint8_t code(double light) {
    const double grey = film_.exponent > 0.0 ? std::pow(light, 1.0 / film_.exponent)
                        : light <= 0.0031308 ? 12.92 * light
                                             : 1.055 * std::pow(light, 1.0 / 2.4) - 0.055;
    return static_cast<std::uint8_t>(std::lround(std::clamp(255.0 * grey + random_.normal(), 0.0, 255.0)));
  }

  Film film_;
  RandomStream random_;
  std::array<double, kSide> points_ = blur_points();
};

ResponseEstimate estimated(const Film& film, const ResponseCurve& assumed) {
  Painter painter(film);
  std::vector<FrameDetections> frames;
  for (int i = 0; i < film.num_frames; ++i) frames.push_back(painter.frame(i));
  return estimate_response(frames, square_camera(assumed), TagSizes(kSize_m));
}

TEST(EstimateResponse, FindsTheCurveThatPicturesWereTakenWith) {
  for (const double exponent : {1.0, 1.5, 2.7}) {
    const ResponseEstimate found = estimated({.exponent = exponent}, ResponseCurve::srgb());
    ASSERT_TRUE(found.is_found) << found.reason;
    EXPECT_NEAR(found.exponent, exponent, 0.02);
    EXPECT_NEAR(found.exponent, exponent, 3.0 * found.sigma);
    EXPECT_LT(found.sigma, 0.15);
    EXPECT_EQ(found.response.name() == "linear", exponent == 1.0) << found.response.name();
    EXPECT_NE(found.response.name(), "srgb") << exponent;
    EXPECT_TRUE(found.contradicts_assumed);
    EXPECT_GT(found.held_out_sigmas, 3.0);
  }
}

TEST(EstimateResponse, TakesTheCurveWithANameWherePicturesCannotTell) {
  const ResponseEstimate found = estimated({.exponent = 0.0}, ResponseCurve::linear());
  ASSERT_TRUE(found.is_found) << found.reason;
  EXPECT_EQ(found.response.name(), "srgb");
  EXPECT_TRUE(found.contradicts_assumed);
  EXPECT_NEAR(found.assumed_exponent, 1.0, 1e-9);
}

TEST(EstimateResponse, AgreesWithACameraThatIsAsItsFileSays) {
  for (const auto& [exponent, assumed] :
       {std::pair(0.0, ResponseCurve::srgb()), std::pair(1.0, ResponseCurve::linear()),
        std::pair(1.5, ResponseCurve::gamma(1.5))}) {
    const ResponseEstimate found = estimated({.exponent = exponent}, assumed);
    EXPECT_FALSE(found.contradicts_assumed) << assumed.name();
    EXPECT_EQ(found.response.name(), assumed.name());
  }
}

TEST(EstimateResponse, SigmaCoversInkThatRan) {
  const ResponseEstimate even = estimated({.exponent = 1.5}, ResponseCurve::srgb());
  const ResponseEstimate ran = estimated({.exponent = 1.5, .ink_m = 1e-4}, ResponseCurve::srgb());
  EXPECT_GT(std::abs(ran.exponent - even.exponent), 1.2 * ran.sigma);  // ink of 2 sigma shows
  EXPECT_LT(std::abs(ran.exponent - even.exponent), 3.0 * ran.sigma);
}

TEST(EstimateResponse, SaysWhenPicturesAreTooFew) {
  const ResponseEstimate found = estimated({.exponent = 1.5, .num_frames = 6}, ResponseCurve::srgb());
  EXPECT_FALSE(found.is_found);
  EXPECT_FALSE(found.contradicts_assumed);
  EXPECT_EQ(found.response.name(), "srgb");
  EXPECT_THAT(found.reason, HasSubstr("too few sharp pictures of tags: 6 in 6"));
}

}  // namespace
}  // namespace apriltrack
