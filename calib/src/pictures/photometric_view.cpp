#include "pictures/photometric_view.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "numerics/upper_median.h"
#include "pictures/plane_ray.h"

namespace apriltrack {
namespace {

constexpr float kSaturatedLight = 0.97F;
constexpr int kAboutSaturated_px = 2;
constexpr double kAllPrinted = 0.99;
constexpr std::size_t kLeastPixels = 150;
/// Of a patch, about: of larger ones every second row and column is read, or every third; their edges are
/// long.
constexpr double kMostPixels = 8000.0;
/// Of a residual, in robust standard deviations: hands and glare are not the tag.
constexpr double kResidualReach = 4.0;
constexpr int kRoundsOfWeights = 4;
constexpr double kLeastScaleOfContrast = 0.01;
/// Less is a tag half hidden, or another.
constexpr double kLeastCorrelation = 0.9;

bool is_near_saturated(const TagPatch& patch, const ResponseCurve& response, int x, int y) {
  const int x1 = std::min(x + kAboutSaturated_px, patch.pixels.width() - 1);
  const int y1 = std::min(y + kAboutSaturated_px, patch.pixels.height() - 1);
  for (int row = std::max(y - kAboutSaturated_px, 0); row <= y1; ++row) {
    for (int column = std::max(x - kAboutSaturated_px, 0); column <= x1; ++column) {
      if (response.to_linear(patch.pixels(column, row)) > kSaturatedLight) return true;
    }
  }
  return false;
}

/// Every other one of every other row, which are shifted by turns: a fourth of all.
bool is_on_coarse_grid(int column, int row) {
  return row % 2 == 0 && (column + row / 2) % 2 == 0;
}

/// Pixels as numbers to fit: light = columns [pattern, 1, pattern across, pattern down] times colours.
class PixelFit {
 public:
  static constexpr int kNumColours = 4, kNumUnknowns = 7;
  using Colours = Eigen::Matrix<double, Eigen::Dynamic, kNumColours>;
  using Unknowns = Eigen::Matrix<double, Eigen::Dynamic, kNumUnknowns>;

  PixelFit(const PhotometricView& view, const PrintedTag& tag, const Pose& T_camera_tag,
           const PlaneBlur& blur, const TagLight& light, Pixels pixels)
      : view_(view) {
    const bool is_coarse = pixels == Pixels::kCoarse && view.num_coarse >= kLeastPixels;
    const auto count = static_cast<Eigen::Index>(is_coarse ? view.num_coarse : view.light.size());
    places_.resize(2, count);
    factors_.resize(count);
    colours_.resize(count, kNumColours);
    unknowns_.resize(count, kNumUnknowns);
    seen_ = Eigen::Map<const Eigen::VectorXd>(view.light.data(), count);
    predict(tag, T_camera_tag, blur, light);
    fit_colours();
  }

  bool is_tag() const { return gains_[0] > 0.0 && correlation() >= kLeastCorrelation; }
  double correlation() const {
    const double total = (seen_.array() - seen_.mean()).square().sum();
    return std::sqrt(std::max(0.0, 1.0 - residuals_.squaredNorm() / std::max(total, 1e-12)));
  }

  void add_to(const TagLight& light, TagLight::Sums& sums) const {
    for (Eigen::Index i = 0; i < seen_.size(); ++i)
      sums.add(light, places_(0, i), places_(1, i), slope(i) * colours_(i, 0) / factors_[i], residuals_[i],
               weights_[i] / (scale_ * scale_));
  }

  /// Colours eliminated.
  ViewEquations equations() const {
    Unknowns by_unknowns = unknowns_;
    for (Eigen::Index i = 0; i < seen_.size(); ++i) by_unknowns.row(i) *= slope(i) * factors_[i];
    const Eigen::VectorXd weights = weights_ / (scale_ * scale_);
    const Colours weighted_colours = colours_.array().colwise() * weights.array();
    const Unknowns weighted = by_unknowns.array().colwise() * weights.array();
    Eigen::Matrix4d of_colours = weighted_colours.transpose() * colours_;
    of_colours.diagonal().array() += 1e-9 * of_colours.trace();
    const Eigen::Matrix<double, kNumColours, kNumUnknowns> coupling =
        weighted_colours.transpose() * by_unknowns;
    const Eigen::LDLT<Eigen::Matrix4d> colour_factor(of_colours);
    ViewEquations result;
    result.correlation = correlation();
    result.H = weighted.transpose() * by_unknowns - coupling.transpose() * colour_factor.solve(coupling);
    const Eigen::Vector4d by_colours = weighted_colours.transpose() * residuals_;
    result.g = coupling.transpose() * colour_factor.solve(by_colours) - weighted.transpose() * residuals_;
    return result;
  }

 private:
  void predict(const PrintedTag& tag, const Pose& T_camera_tag, const PlaneBlur& blur,
               const TagLight& light) {
    const BlurredPattern picture(tag.pattern);
    const TagPlane plane(T_camera_tag, tag.half_size_m);
    for (Eigen::Index i = 0; i < seen_.size(); ++i) {
      const Eigen::Vector2d& ray = view_.rays[static_cast<std::size_t>(i)];
      const PlanePoint at = plane.meet(ray);
      const PatternSample sample = picture.at(at.uv.x(), at.uv.y(), blur.pattern);
      places_.col(i) = at.uv;
      factors_[i] = light.factor(at.uv.x(), at.uv.y());
      const double white = factors_[i] * sample.light;
      colours_.row(i) << white, 1.0, white * at.uv.x(), white * at.uv.y();
      unknowns_.row(i) << plane.by_pose(ray, at, sample), sample.by_covariance(blur.covariance_by_psf);
    }
  }

  /// Light of the white where its factor is 1, less the black's.
  double slope(Eigen::Index i) const {
    return gains_[0] + gains_[2] * places_(0, i) + gains_[3] * places_(1, i);
  }

  /// Reweighted by Geman and McClure's function.
  void fit_colours() {
    weights_ = Eigen::VectorXd::Ones(seen_.size());
    for (int round = 0; round < kRoundsOfWeights; ++round) {
      const Colours weighted = colours_.array().colwise() * weights_.array();
      Eigen::Matrix4d A = weighted.transpose() * colours_;
      A.diagonal().array() += 1e-9 * A.trace();
      gains_ = A.ldlt().solve(weighted.transpose() * seen_);
      residuals_ = seen_ - colours_ * gains_;
      scale_ = std::max({1.4826 * median_size(), kLeastScaleOfContrast * std::abs(gains_[0]), 1e-6});
      weights_ = (1.0 + (residuals_ / (kResidualReach * scale_)).array().square()).square().inverse();
    }
  }

  double median_size() const {
    std::vector<double> sizes(residuals_.begin(), residuals_.end());
    for (double& size : sizes) size = std::abs(size);
    return upper_median(std::move(sizes));
  }

  const PhotometricView& view_;
  Eigen::Matrix2Xd places_;
  Eigen::VectorXd factors_, seen_, residuals_, weights_;
  Colours colours_;
  Unknowns unknowns_;  ///< Of the pattern: times slope() and factor, of the pixel.
  Eigen::Vector4d gains_ = Eigen::Vector4d::Zero();
  double scale_ = 0.0;
};

}  // namespace

bool read_pixels(const TagPatch& patch, const Camera& camera, const PrintedTag& tag, const Pose& T_camera_tag,
                 double psf_sigma_px, PhotometricView& view) {
  const auto blur = plane_blur(camera.model, T_camera_tag, tag.half_size_m, {psf_sigma_px, view.streak_px});
  if (!blur) return false;
  const BlurredPattern picture(tag.pattern);
  const Eigen::Vector3d normal = T_camera_tag.rotation_matrix().col(2);
  const TagPlane plane(T_camera_tag, tag.half_size_m);
  const double area = static_cast<double>(patch.pixels.width()) * patch.pixels.height();
  const int stride = std::max(1, static_cast<int>(std::lround(std::sqrt(area / kMostPixels))));
  const auto read = [&](int x, int y) {
    const auto ray = camera.model.unproject(Eigen::Vector2d(patch.x + x, patch.y + y));
    if (!ray || !(ray->z() > 0.0) || !(normal.dot(*ray) > 0.0)) return;
    const Eigen::Vector2d slope = ray->hnormalized();
    const PlanePoint at = plane.meet(slope);
    if (picture.at(at.uv.x(), at.uv.y(), blur->pattern).known < kAllPrinted) return;
    if (is_near_saturated(patch, camera.response, x, y)) return;
    view.rays.push_back(slope);
    view.light.push_back(static_cast<double>(camera.response.to_linear(patch.pixels(x, y))));
  };
  for (const bool is_coarse : {true, false}) {
    for (int row = 0; row * stride < patch.pixels.height(); ++row) {
      // Every other row is shifted, so that edges along a column are met at more than one phase.
      const int first = row % 2 * (stride / 2);
      for (int column = 0; first + column * stride < patch.pixels.width(); ++column) {
        if (is_on_coarse_grid(column, row) == is_coarse) read(first + column * stride, row * stride);
      }
    }
    if (is_coarse) view.num_coarse = view.light.size();
  }
  return view.light.size() >= kLeastPixels;
}

std::optional<ViewEquations> view_equations(const PhotometricView& view, const CameraModel& camera,
                                            const PrintedTag& tag, const Pose& T_camera_tag,
                                            double psf_sigma_px, const TagLight& light, TagLight::Sums& sums,
                                            Pixels pixels) {
  const auto blur = plane_blur(camera, T_camera_tag, tag.half_size_m, {psf_sigma_px, view.streak_px});
  if (!blur) return std::nullopt;
  const PixelFit fit(view, tag, T_camera_tag, *blur, light, pixels);
  if (!fit.is_tag()) return std::nullopt;
  fit.add_to(light, sums);
  return fit.equations();
}

}  // namespace apriltrack
