#include "coded_view.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "plane_ray.h"
#include "upper_median.h"

namespace apriltrack {
namespace {

constexpr double kReachInNoise = 4.0;  // Geman and McClure's, of residuals
constexpr double kFirstNoise = 0.03;
constexpr double kLeastNoise = 0.3 / 255.0;  // of rounding to grey levels
constexpr int kMostStepsOfView = 8;
constexpr double kSettledView = 1e-3;  // of a step's worth, in squared standard deviations
constexpr double kMostBlurStep_px = 0.2;
constexpr double kLeastBlur_px = 0.1, kMostBlur_px = 5.0;
constexpr double kIsBlack = 0.1, kIsWhite = 0.9;
constexpr std::size_t kLeastOfColour = 10;
constexpr int kFirstColour = 7;

}  // namespace

CodedView::CodedView(PhotometricView pixels, const CameraModel& camera, const PrintedTag& tag,
                     const Pose& T_camera_tag)
    : pixels_(std::move(pixels)),
      camera_(&camera),
      tag_(tag),
      T_camera_tag_(T_camera_tag),
      noise_(kFirstNoise) {}

bool CodedView::predict_picture(Rows& rows) const {
  const auto blur = plane_blur(*camera_, T_camera_tag_, tag_.half_size_m, {psf_sigma_px_, pixels_.streak_px});
  if (!blur) return false;
  const BlurredPattern picture(tag_.pattern);
  const TagPlane plane(T_camera_tag_, tag_.half_size_m);
  const auto count = static_cast<Eigen::Index>(pixels_.light.size());
  rows.by_unknowns.resize(count, kNumUnknowns);
  rows.by_print.resize(count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const Eigen::Vector2d& ray = pixels_.rays[static_cast<std::size_t>(i)];
    const PlanePoint at = plane.meet(ray);
    const PatternSample sample = picture.at(at.uv.x(), at.uv.y(), blur->pattern);
    rows.by_unknowns.row(i) << plane.by_pose(ray, at, sample), sample.by_covariance(blur->covariance_by_psf),
        sample.light, 1.0, sample.light * at.uv.x(), sample.light * at.uv.y();
    rows.by_print[i] = std::hypot(sample.by_u, sample.by_v) / tag_.half_size_m;
  }
  return true;
}

void CodedView::predict_codes(const CodeCurve& curve, Rows& rows) {
  const auto count = static_cast<Eigen::Index>(pixels_.light.size());
  residuals_.resize(count);
  rows.by_exponent.resize(count);
  rows.weights.resize(count);
  rows.cost = 0.0;
  for (Eigen::Index i = 0; i < count; ++i) {
    auto row = rows.by_unknowns.row(i);
    const double white = row[kFirstColour];
    const double light = row.segment<kNumColours>(kFirstColour) * colours_;
    const CodeCurve::Sample code = curve.at(light);
    residuals_[i] = pixels_.light[static_cast<std::size_t>(i)] - code.code;
    const double by_white = code.by_light * (white > 1e-9 ? (light - colours_[1]) / white : colours_[0]);
    row.head<kFirstColour>() *= by_white;
    row.segment<kNumColours>(kFirstColour) *= code.by_light;
    rows.by_print[i] *= by_white;
    rows.by_exponent[i] = code.by_exponent;
    const double square = residuals_[i] * residuals_[i] / (noise_ * noise_);
    const double doubt = 1.0 + square / (kReachInNoise * kReachInNoise);
    rows.weights[i] = 1.0 / (doubt * doubt * noise_ * noise_);
    rows.cost += 0.5 * square / doubt;
  }
}

bool CodedView::begin(const CodeCurve& curve) {
  Rows rows;
  if (!predict_picture(rows)) return false;
  std::vector<double> black, white;
  for (Eigen::Index i = 0; i < rows.by_print.size(); ++i) {
    const double share = rows.by_unknowns(i, kFirstColour);
    const double light = curve.light(pixels_.light[static_cast<std::size_t>(i)]);
    if (share < kIsBlack) black.push_back(light);
    if (share > kIsWhite) white.push_back(light);
  }
  if (std::min(black.size(), white.size()) < kLeastOfColour) return false;
  const double black_light = upper_median(std::move(black));
  colours_ << upper_median(std::move(white)) - black_light, black_light, 0.0, 0.0;
  return colours_[0] > 0.0;
}

CodedView::Step CodedView::eliminate(const Rows& rows) const {
  const auto weighted = rows.weights.asDiagonal();
  Eigen::Matrix<double, kNumUnknowns, kNumUnknowns> H =
      rows.by_unknowns.transpose() * weighted * rows.by_unknowns;
  H.diagonal() *= 1.0 + 1e-9;
  const auto factor = H.ldlt();
  const Unknowns by_residuals = rows.by_unknowns.transpose() * weighted * residuals_;
  const Unknowns by_exponent = rows.by_unknowns.transpose() * weighted * rows.by_exponent;
  const Eigen::VectorXd exponent_alone =
      weighted * (rows.by_exponent - rows.by_unknowns * factor.solve(by_exponent));
  Step step;
  step.equation = {exponent_alone.dot(rows.by_exponent), exponent_alone.dot(residuals_),
                   exponent_alone.dot(rows.by_print), rows.cost};
  step.unknowns = factor.solve(by_residuals);
  step.worth = step.unknowns.dot(by_residuals);
  return step;
}

std::optional<CodedView::Equation> CodedView::settle(const CodeCurve& curve) {
  Step step;
  for (int i = 0; i < kMostStepsOfView; ++i) {
    Rows rows;
    if (!predict_picture(rows)) return std::nullopt;
    predict_codes(curve, rows);
    step = eliminate(rows);
    if (!step.unknowns.allFinite()) return std::nullopt;
    move(step.unknowns);
    if (!(colours_[0] > 0.0)) return std::nullopt;
    if (step.worth < kSettledView) break;
  }
  return step.equation;
}

void CodedView::move(const Unknowns& step) {
  T_camera_tag_ = Pose::exp(Vector6d(step.head<6>())) * T_camera_tag_;
  psf_sigma_px_ += std::clamp(step[6], -kMostBlurStep_px, kMostBlurStep_px);
  psf_sigma_px_ = std::clamp(psf_sigma_px_, kLeastBlur_px, kMostBlur_px);
  colours_ += step.segment<kNumColours>(kFirstColour);
}

void CodedView::measure_noise() {
  std::vector<double> sizes(static_cast<std::size_t>(residuals_.size()));
  for (std::size_t i = 0; i < sizes.size(); ++i)
    sizes[i] = std::abs(residuals_[static_cast<Eigen::Index>(i)]);
  noise_ = std::max(1.4826 * upper_median(std::move(sizes)), kLeastNoise);
}

double CodedView::correlation() const {
  const Eigen::Map<const Eigen::VectorXd> seen(pixels_.light.data(), residuals_.size());
  const double total = (seen.array() - seen.mean()).square().sum();
  return std::sqrt(std::max(0.0, 1.0 - residuals_.squaredNorm() / std::max(total, 1e-12)));
}

}  // namespace apriltrack
