#include "apriltrack/detect/estimate_response.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "apriltrack/base/random.h"
#include "apriltrack/geometry/pose.h"
#include "apriltrack/tags/tag_corners.h"
#include "apriltrack/tags/tag_family.h"

// Tags painted point by point, blurred in linear light and put into grey levels by code of these tests alone.

namespace apriltrack {
namespace {

using ::testing::HasSubstr;

constexpr double kPaintedSize_m = 0.16, kPaintedFocal_px = 520.0, kPaintedCentre_px = 40.0;
constexpr int kPaintedSide_px = 81;
constexpr int kBlurPoints = 12;  // points of a pixel's blur along each axis

ResponseCamera square_camera(const ResponseCurve& assumed) {
  return {.model = CameraModel({kPaintedFocal_px, kPaintedFocal_px, kPaintedCentre_px, kPaintedCentre_px},
                               NoDistortion{}),
          .assumed = assumed};
}

/// Points that stand for equal shares of a Gaussian of 0.5 px smeared over a pixel, on one axis.
std::array<double, kBlurPoints> blur_points() {
  constexpr std::size_t kShare = 2000;
  RandomStream random(3);
  std::vector<double> all;
  while (all.size() < kShare * kBlurPoints) {
    const double place = 0.5 * random.normal() + random.uniform() - 0.5;
    all.insert(all.end(), {place, -place});
  }
  std::ranges::sort(all);
  std::array<double, kBlurPoints> points{};
  for (std::size_t i = 0; i < all.size(); ++i) points[i / kShare] += all[i] / kShare;
  return points;
}

struct Film {
  double exponent = 1.0;  ///< Of the curve; 0: sRGB, as IEC 61966-2-1 has it.
  int num_frames = 24;
  int tags_of_frame = 1;
  double ink_m = 0.0;  ///< White cells are printed wider by so much on every side.
};

class Painter {
 public:
  explicit Painter(const Film& film) : film_(film), random_(11) {}

  FrameDetections frame(int index) {
    FrameDetections frame;
    frame.timestamp = Timestamp{100'000'000LL * index};
    for (int tag = 0; tag < film_.tags_of_frame; ++tag)
      add_tag(film_.tags_of_frame == 1 ? index % 3 : tag, frame);
    return frame;
  }

 private:
  void add_tag(int id, FrameDetections& frame) {
    const double size_px = 26.0 + 30.0 * random_.uniform();
    const Eigen::Vector3d axis{random_.normal(), random_.normal(), 0.0};
    const Eigen::Quaterniond tilt(Eigen::AngleAxisd(0.5 * random_.uniform(), axis.normalized()));
    const Eigen::Quaterniond turn(Eigen::AngleAxisd(6.0 * random_.uniform(), Eigen::Vector3d::UnitZ()));
    const double z = kPaintedFocal_px * kPaintedSize_m / size_px;
    const Pose pose(tilt * turn, {z * (random_.uniform() - 0.5) / kPaintedFocal_px,
                                  z * (random_.uniform() - 0.5) / kPaintedFocal_px, z});
    frame.detections.push_back({{"tag36h11", id}, corners(pose), 0, 50.0});
    frame.patches.push_back({{"tag36h11", id}, 0, 0, painted(TagFamily::get("tag36h11").pattern(id), pose)});
  }

  /// A third of a pixel inside, as corners of the wrong response are.
  static std::array<Eigen::Vector2d, kNumCorners> corners(const Pose& pose) {
    std::array<Eigen::Vector2d, kNumCorners> corners;
    const double half = 0.5 * kPaintedSize_m * (1.0 - 0.33 * 2.0 / 40.0);
    const std::array<Eigen::Vector2d, kNumCorners> signs = {Eigen::Vector2d(-1, 1), Eigen::Vector2d(1, 1),
                                                            Eigen::Vector2d(1, -1), Eigen::Vector2d(-1, -1)};
    for (std::size_t k = 0; k < corners.size(); ++k) {
      const Eigen::Vector3d p = pose * Eigen::Vector3d(half * signs[k].x(), half * signs[k].y(), 0.0);
      corners[k] = kPaintedFocal_px * p.head<2>() / p.z() + Eigen::Vector2d::Constant(kPaintedCentre_px);
    }
    return corners;
  }

  GrayImage painted(const TagPattern& pattern, const Pose& pose) {
    GrayImage image(kPaintedSide_px, kPaintedSide_px);
    const Eigen::Matrix3d R = pose.rotation_matrix();
    for (int y = 0; y < kPaintedSide_px; ++y) {
      for (int x = 0; x < kPaintedSide_px; ++x) {
        double sum = 0.0;
        for (const double dx : points_) {
          for (const double dy : points_) sum += light(pattern, R, pose.translation(), x + dx, y + dy);
        }
        image(x, y) = code(sum / (kBlurPoints * kBlurPoints));
      }
    }
    return image;
  }

  double light(const TagPattern& pattern, const Eigen::Matrix3d& R, const Eigen::Vector3d& t, double x,
               double y) const {
    const Eigen::Vector3d ray((x - kPaintedCentre_px) / kPaintedFocal_px,
                              (y - kPaintedCentre_px) / kPaintedFocal_px, 1.0);
    const Eigen::Vector3d point = R.transpose() * (R.col(2).dot(t) / R.col(2).dot(ray) * ray - t);
    const double u = point.x() / (0.5 * kPaintedSize_m), v = point.y() / (0.5 * kPaintedSize_m);
    if (std::max(std::abs(u), std::abs(v)) > pattern.half_extent()) return 0.3;
    const double ink = film_.ink_m / (0.5 * kPaintedSize_m);
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
  std::array<double, kBlurPoints> points_ = blur_points();
};

std::vector<FrameDetections> painted_frames(const Film& film) {
  Painter painter(film);
  std::vector<FrameDetections> frames;
  for (int i = 0; i < film.num_frames; ++i) frames.push_back(painter.frame(i));
  return frames;
}

ResponseEstimate estimated(const Film& film, const ResponseCurve& assumed) {
  return estimate_response(painted_frames(film), square_camera(assumed), TagSizes(kPaintedSize_m));
}

TEST(EstimateResponse, FindsTheCurveThatPicturesWereTakenWith) {
  for (const double exponent : {1.0, 1.5, 2.7}) {
    const ResponseEstimate found = estimated({.exponent = exponent}, ResponseCurve::srgb());
    ASSERT_TRUE(found.is_found()) << words_of_doubt(found);
    EXPECT_NEAR(found.exponent, exponent, 0.02);
    EXPECT_NEAR(found.exponent, exponent, 3.0 * found.sigma);
    EXPECT_LT(found.sigma, 0.15);
    EXPECT_EQ(found.response.name() == "linear", exponent == 1.0) << found.response.name();
    EXPECT_NE(found.response.name(), "srgb") << exponent;
    EXPECT_TRUE(found.contradicts_assumed);
    EXPECT_GT(found.assumed_worse_sigmas, 3.0);
  }
}

TEST(EstimateResponse, TakesTheCurveWithANameWherePicturesCannotTell) {
  const ResponseEstimate found = estimated({.exponent = 0.0}, ResponseCurve::linear());
  ASSERT_TRUE(found.is_found()) << words_of_doubt(found);
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

/// The smaller the tags, the more ink may have made the difference.
TEST(EstimateResponse, ContradictsWhatIsOverFourSigmasAway) {
  const std::vector<FrameDetections> frames = painted_frames({.exponent = 0.0});
  int between_four_and_five = 0, below_four = 0;
  for (double size_m = 0.16; size_m > 0.02; size_m *= 0.9) {
    const ResponseEstimate found =
        estimate_response(frames, square_camera(ResponseCurve::linear()), TagSizes(size_m));
    const double sigmas = std::abs(found.exponent - 1.0) / found.sigma;
    EXPECT_EQ(found.contradicts_assumed, sigmas > 4.0) << size_m << " m: " << sigmas << " sigmas";
    between_four_and_five += sigmas > 4.0 && sigmas < 5.0;
    below_four += sigmas < 4.0;
  }
  EXPECT_GT(between_four_and_five, 0);
  EXPECT_GT(below_four, 0);
}

TEST(EstimateResponse, SigmaCoversInkThatRan) {
  const ResponseEstimate even = estimated({.exponent = 1.5}, ResponseCurve::srgb());
  const ResponseEstimate ran = estimated({.exponent = 1.5, .ink_m = 1e-4}, ResponseCurve::srgb());
  EXPECT_GT(std::abs(ran.exponent - even.exponent), 1.2 * ran.sigma);  // ink of 2 sigma shows
  EXPECT_LT(std::abs(ran.exponent - even.exponent), 3.0 * ran.sigma);
}

/// As of `detect photo.png`: neither lens nor size is known.
TEST(EstimateResponse, IsToldByTheTagsOfOnePicture) {
  for (const double exponent : {1.0, 1.5}) {
    const ResponseEstimate found = estimate_response(
        painted_frames({.exponent = exponent, .num_frames = 1, .tags_of_frame = 12}), {}, TagSizes());
    ASSERT_TRUE(found.is_found()) << words_of_doubt(found);
    EXPECT_EQ(found.frames_used, 1);
    EXPECT_GE(found.views_used, 8);
    EXPECT_NEAR(found.exponent, exponent, 0.03);
    EXPECT_TRUE(found.contradicts_assumed);
    EXPECT_EQ(found.response.name() == "linear", exponent == 1.0) << found.response.name();
  }
}

TEST(EstimateResponse, IsInDoubtWhereInkMayMakeTheDifference) {
  const std::vector<FrameDetections> frames = painted_frames({.exponent = 1.5});
  const ResponseEstimate tiny = estimate_response(frames, {}, TagSizes(0.004));
  EXPECT_EQ(tiny.doubt, ResponseDoubt::kCannotTell) << words_of(tiny);
  EXPECT_EQ(tiny.response.name(), "srgb");
  EXPECT_FALSE(tiny.contradicts_assumed);
}

/// No camera has such a curve: something else made edges so, and may have done as much the other way.
TEST(EstimateResponse, TakesTheNearestThatCamerasHave) {
  const ResponseEstimate low = estimated({.exponent = 0.75}, ResponseCurve::srgb());
  EXPECT_EQ(low.response.name(), "linear") << words_of(low);
  EXPECT_NEAR(low.sigma, 0.25, 0.02);
  const ResponseEstimate high = estimated({.exponent = 3.4}, ResponseCurve::linear());
  EXPECT_EQ(high.response.name(), "srgb") << words_of(high);
  EXPECT_NEAR(high.sigma, 0.6, 0.06);
}

TEST(EstimateResponse, ThreadsChangeNothing) {
  const std::vector<FrameDetections> frames = painted_frames({.exponent = 1.5, .num_frames = 10});
  const ResponseEstimate alone = estimate_response(frames, {}, TagSizes(), 1);
  const ResponseEstimate together = estimate_response(frames, {}, TagSizes(), 3);
  EXPECT_EQ(alone.exponent, together.exponent);
  EXPECT_EQ(alone.sigma, together.sigma);
}

TEST(EstimateResponse, SaysWhenPicturesAreTooFew) {
  const ResponseEstimate found = estimated({.exponent = 1.5, .num_frames = 5}, ResponseCurve::srgb());
  EXPECT_FALSE(found.is_found());
  EXPECT_FALSE(found.contradicts_assumed);
  EXPECT_EQ(found.response.name(), "srgb");
  EXPECT_EQ(found.doubt, ResponseDoubt::kTooFewPictures);
  EXPECT_THAT(words_of_doubt(found), HasSubstr("too few sharp pictures of tags: 5; 6 are needed"));
}

}  // namespace
}  // namespace apriltrack
