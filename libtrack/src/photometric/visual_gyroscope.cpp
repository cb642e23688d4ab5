#include "apriltrack/photometric/visual_gyroscope.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "apriltrack/base/check.h"
#include "apriltrack/base/held.h"
#include "picture_shift.h"
#include "small_picture.h"
#include "turn_fit.h"

namespace apriltrack {
namespace {

constexpr int kLevel = 2;            // of the pyramid, that the small pictures are made of
constexpr int kLongerSide = 80;      // of the small pictures, pixels
constexpr int kLeastLevelSize = 16;  // pixels: below, the pictures would be of nothing
constexpr double kMaxTangent =
    1.2;  // 50 degrees off the axis: farther, a picture without distortion stretches
constexpr double kLeastCommonShare = 0.4;
constexpr double kLeastCorrelation = 0.8;
/// Neighbours err together.
constexpr double kSigmaFactor = 3.0;
/// Against the exact truth of fourteen recordings, tags' places in the image after a turn of up to 130 px are
/// off by 3.4 px in the middle and 8 to 20 px in one of a hundred: one degree.
constexpr double kLeastSigma_rad = 0.02;

/// Means of two by two.
void halve(const Image<float>& picture, Image<float>& half) {
  for (int y = 0; y < half.height(); ++y) {
    const float *a = picture.row(2 * y), *b = picture.row(2 * y + 1);
    for (int x = 0; x < half.width(); ++x)
      half(x, y) = 0.25F * (a[2 * x] + a[2 * x + 1] + b[2 * x] + b[2 * x + 1]);
  }
}

}  // namespace

class VisualGyroscope::Implementation {
 public:
  explicit Implementation(const CameraModel& model) : model_(model) {}

  std::optional<CameraTurn> turn(const LightPyramid& light) {
    APRILTRACK_CHECK(static_cast<int>(light.size()) > kLevel,
                     "pictures are made of the third level of a pyramid");
    const Image<float>& level = light[static_cast<std::size_t>(kLevel)];
    if (std::min(level.width(), level.height()) < kLeastLevelSize) {
      forget();
      return std::nullopt;
    }
    if (level.width() != source_width_ || level.height() != source_height_) fit_size(level);
    std::swap(before_, now_);
    look(level);
    if (!std::exchange(has_before_, true)) return std::nullopt;
    const FittedTurn fit = fit_turn({before_.fine, now_.fine, focal_px_}, start());
    if (fit.common_share < kLeastCommonShare || fit.correlation < kLeastCorrelation) return std::nullopt;
    return CameraTurn{fit.R_before_now, std::hypot(kSigmaFactor * fit.sigma_rad, kLeastSigma_rad)};
  }

  void forget() { has_before_ = false; }

 private:
  struct Pictures {
    Image<float> fine, coarse;  ///< NaN where nothing is seen.
  };
  /// A pixel of a fine picture is the mean of four places in the pyramid's level; NaN beyond the lens.
  using Places = std::array<Eigen::Vector2f, 4>;

  void fit_size(const Image<float>& level) {
    source_width_ = level.width();
    source_height_ = level.height();
    has_before_ = false;
    const Eigen::Vector2d half = half_extent(level);
    focal_px_ = static_cast<float>(0.5 * kLongerSide / half.maxCoeff());
    const auto pixels = [&](double half_side) {
      return 2 * std::max(4, static_cast<int>(std::lround(half_side * static_cast<double>(focal_px_))));
    };
    const int width = pixels(half.x()), height = pixels(half.y());
    before_ = now_ = {Image<float>(width, height), Image<float>(width / 2, height / 2)};
    places_.clear();
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        places_.emplace_back();
        for (std::size_t k = 0; k < 4; ++k) {
          const Eigen::Vector2d quarter(x + 0.25 + 0.5 * static_cast<double>(k % 2),
                                        y + 0.25 + 0.5 * static_cast<double>(k / 2));
          places_.back()[k] =
              place((quarter - 0.5 * Eigen::Vector2d(width, height)) / static_cast<double>(focal_px_));
        }
      }
    }
  }

  /// Tangents of the angles that the image reaches off its axis, along its two middle lines.
  Eigen::Vector2d half_extent(const Image<float>& level) const {
    const auto tangents = [&](double x, double y) -> Eigen::Vector2d {
      const auto ray = model_.unproject({base_pixel(x, kLevel), base_pixel(y, kLevel)});
      if (!ray || ray->z() <= 0.0) return Eigen::Vector2d::Constant(kMaxTangent);
      return ray->hnormalized().cwiseAbs().cwiseMin(kMaxTangent);
    };
    const double right = level.width() - 1, bottom = level.height() - 1;
    return {std::max(tangents(0.0, 0.5 * bottom).x(), tangents(right, 0.5 * bottom).x()),
            std::max(tangents(0.5 * right, 0.0).y(), tangents(0.5 * right, bottom).y())};
  }

  Eigen::Vector2f place(const Eigen::Vector2d& tangents) const {
    const auto pixel = model_.project(tangents.homogeneous());
    if (!pixel) return Eigen::Vector2f::Constant(std::numeric_limits<float>::quiet_NaN());
    return {static_cast<float>(level_pixel(pixel->x(), kLevel)),
            static_cast<float>(level_pixel(pixel->y(), kLevel))};
  }

  void look(const Image<float>& level) {
    auto places = places_.begin();
    for (int y = 0; y < now_.fine.height(); ++y) {
      for (int x = 0; x < now_.fine.width(); ++x, ++places) {
        float sum = 0.0F;
        for (const Eigen::Vector2f& place : *places) sum += light_at(level, place.x(), place.y());
        now_.fine(x, y) = 0.25F * sum;
      }
    }
    halve(now_.fine, now_.coarse);
  }

  Eigen::Quaterniond start() {
    const PictureShift shift = shifts_.best(before_.coarse, now_.coarse);
    const double focal_px = 0.5 * static_cast<double>(focal_px_);
    return Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(),
                                              Eigen::Vector3d(shift.dx / focal_px, shift.dy / focal_px, 1.0));
  }

  CameraModel model_;
  int source_width_ = 0, source_height_ = 0;
  float focal_px_ = 0.0F;  ///< Of the fine pictures, which have no distortion.
  std::vector<Places> places_;
  Pictures before_, now_;
  bool has_before_ = false;
  PictureShifts shifts_{kLeastCommonShare};
};

VisualGyroscope::VisualGyroscope(const CameraModel& model)
    : implementation_(std::make_unique<Implementation>(model)) {}
VisualGyroscope::~VisualGyroscope() = default;
VisualGyroscope::VisualGyroscope(VisualGyroscope&&) noexcept = default;
VisualGyroscope& VisualGyroscope::operator=(VisualGyroscope&&) noexcept = default;

std::optional<CameraTurn> VisualGyroscope::turn(const LightPyramid& light) {
  return held(implementation_).turn(light);
}
void VisualGyroscope::forget() {
  held(implementation_).forget();
}

}  // namespace apriltrack
