#include <Eigen/Geometry>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <limits>

#include "opencv_lens.h"

namespace apriltrack {
namespace {

/// fx fy cx cy, then the coefficients.
constexpr int kNumParameters = 12;
using Parameters = Eigen::Matrix<double, kNumParameters, 1>;

/// One point of the picture: where it lies in the plane at unit distance, and where the lens shows it.
struct Sample {
  Eigen::Vector2d plane;
  Eigen::Vector2d pixel;
};

/// The further terms move points by some pixels, so that rays by the first eight cover the picture.
std::vector<Sample> samples_over(const OpenCvLens& lens, int width, int height) {
  constexpr int kSteps = 32;
  const CameraModel first = lens.first_eight();
  std::vector<Sample> samples;
  for (int i = 0; i <= kSteps; ++i) {
    for (int j = 0; j <= kSteps; ++j) {
      const auto ray = first.unproject({(width - 1.0) * i / kSteps, (height - 1.0) * j / kSteps});
      if (!ray) continue;
      const Eigen::Vector2d plane = ray->hnormalized();
      samples.push_back({plane, lens.project(plane)});
    }
  }
  return samples;
}

CameraModel model_of(const Parameters& p) {
  return {Pinhole{p[0], p[1], p[2], p[3]},
          RadtanDistortion({p[4], p[5], p[6], p[7], p[8], p[9], p[10], p[11]})};
}

Parameters parameters_of(const CameraModel& model) {
  const Pinhole& lens = model.pinhole();
  const auto k = std::get<RadtanDistortion>(model.distortion()).coefficients();
  Parameters p;
  p << lens.fx, lens.fy, lens.cx, lens.cy, k[0], k[1], k[2], k[3], k[4], k[5], k[6], k[7];
  return p;
}

/// The bare formula, which a trial step may take anywhere.
Eigen::VectorXd residuals(const Parameters& p, const std::vector<Sample>& samples) {
  Eigen::VectorXd all(2 * static_cast<Eigen::Index>(samples.size()));
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const auto& [plane, pixel] = samples[i];
    const double s = plane.squaredNorm();
    const double factor =
        (1.0 + s * (p[4] + s * (p[5] + s * p[8]))) / (1.0 + s * (p[9] + s * (p[10] + s * p[11])));
    const double xy = plane.x() * plane.y();
    const Eigen::Vector2d distorted(
        plane.x() * factor + 2.0 * p[6] * xy + p[7] * (s + 2.0 * plane.x() * plane.x()),
        plane.y() * factor + p[6] * (s + 2.0 * plane.y() * plane.y()) + 2.0 * p[7] * xy);
    all[2 * static_cast<Eigen::Index>(i)] = p[0] * distorted.x() + p[2] - pixel.x();
    all[2 * static_cast<Eigen::Index>(i) + 1] = p[1] * distorted.y() + p[3] - pixel.y();
  }
  return all;
}

Eigen::MatrixXd jacobian(const Parameters& p, const std::vector<Sample>& samples) {
  Eigen::MatrixXd J(2 * static_cast<Eigen::Index>(samples.size()), kNumParameters);
  for (int i = 0; i < kNumParameters; ++i) {
    const double step = 1e-6 * std::max(1.0, std::abs(p[i]));
    const Parameters delta = step * Parameters::Unit(i);
    J.col(i) = (residuals(p + delta, samples) - residuals(p - delta, samples)) / (2.0 * step);
  }
  return J;
}

/// Levenberg and Marquardt, with columns scaled to unit length: the coefficients of the rational polynomial
/// are nearly dependent, and differ by orders of magnitude.
Parameters least_squares(Parameters p, const std::vector<Sample>& samples) {
  constexpr int kMaxSteps = 100;
  constexpr double kConverged = 1e-9;  // of the sum of squares
  double damping = 1e-3;
  Eigen::VectorXd r = residuals(p, samples);
  for (int i = 0; i < kMaxSteps && damping < 1e12; ++i) {
    const Eigen::MatrixXd J = jacobian(p, samples);
    const Parameters scale = J.colwise().norm().transpose().cwiseMax(1e-12);
    Eigen::MatrixXd A(J.rows() + kNumParameters, kNumParameters);
    A << J * scale.cwiseInverse().asDiagonal(),
        std::sqrt(damping) * Eigen::MatrixXd::Identity(kNumParameters, kNumParameters);
    Eigen::VectorXd b = Eigen::VectorXd::Zero(A.rows());
    b.head(r.size()) = -r;
    const Parameters trial =
        p + scale.cwiseInverse().cwiseProduct(Parameters(A.colPivHouseholderQr().solve(b)));
    const Eigen::VectorXd r_trial = residuals(trial, samples);
    const bool is_better = r_trial.squaredNorm() < r.squaredNorm();
    const double gain = r.squaredNorm() - r_trial.squaredNorm();
    damping *= is_better ? 0.1 : 10.0;
    if (!is_better) continue;
    p = trial;
    r = r_trial;
    if (gain <= kConverged * r.squaredNorm()) break;
  }
  return p;
}

}  // namespace

RadtanFit fit_radtan(const OpenCvLens& lens, int width, int height) {
  const std::vector<Sample> samples = samples_over(lens, width, height);
  RadtanFit fit{model_of(least_squares(parameters_of(lens.first_eight()), samples)), 0.0, 0.0};
  double sum = 0.0;
  for (const Sample& sample : samples) {
    const auto pixel = fit.model.project(sample.plane.homogeneous());
    const double error_px = pixel ? (*pixel - sample.pixel).norm() : std::numeric_limits<double>::infinity();
    fit.max_error_px = std::max(fit.max_error_px, error_px);
    sum += error_px * error_px;
  }
  fit.rms_error_px = samples.empty() ? 0.0 : std::sqrt(sum / static_cast<double>(samples.size()));
  if (samples.empty()) fit.max_error_px = std::numeric_limits<double>::infinity();
  return fit;
}

}  // namespace apriltrack
