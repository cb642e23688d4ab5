#include "pattern_fit.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "apriltrack/base/geman_mcclure.h"
#include "apriltrack/geometry/homography.h"
#include "apriltrack/tags/blurred_pattern.h"
#include "pattern_pixels.h"
#include "pattern_texture.h"
#include "residual_noise.h"
#include "tag_quad.h"

namespace apriltrack {
namespace {

/// The unknowns, by their first index. The homography moves by the eight generators of projective maps of the
/// tag's plane: (1, 0), (0, 1), (u, 0), (v, 0), (0, u), (0, v), (u^2, uv), (uv, v^2).
constexpr int kPlace = 0;
constexpr int kBlur = 8;     // xx, xy, yy of the lens's and the motion's covariance, straightened px^2
constexpr int kBend = 11;    // where no camera is known: x and y by r^2, and radially by r^3
constexpr int kWhite = 14;   // of white less black: at the centre, per u, per v
constexpr int kBlack = 17;   // the same
constexpr int kBeyond = 20;  // of what lies beyond each side, less white paper
constexpr int kNumUnknowns = 24;
constexpr int kNumColours = kNumUnknowns - kWhite;
using Unknowns = Eigen::Matrix<double, kNumUnknowns, 1>;
using Information = Eigen::Matrix<double, kNumUnknowns, kNumUnknowns>;
using Colours = Eigen::Matrix<double, kNumColours, 1>;
using Matrix8d = Eigen::Matrix<double, 8, 8>;

constexpr double kPixelVariance = 1.0 / 12.0;  // of a pixel's own area
constexpr int kMinPixels = 60;
/// A pixel counts where at least so much of its light comes from the print.
constexpr double kMinShareOfPrint = 0.3;
/// What a family leaves to the printer (corners of circles) may be of any colour.
constexpr double kMaxShareUnknown = 0.02;
/// Of full scale: from here on a sensor may be full, and more light no contradiction (code 252 in sRGB).
constexpr double kSaturated = 0.975;

constexpr int kMaxCoarseSteps = 8, kMaxFineSteps = 4;
/// A step that moves a corner less is the last: the next would move it by a tenth of that at most.
constexpr double kConverged_px = 0.03;
constexpr double kMaxStep_cells = 0.5;
constexpr double kMaxMove_cells = 2.0;
/// The texture is made anew where the blur has changed by more than this part.
constexpr double kSameBlur = 0.4, kSameFineBlur = 0.1;

// Priors: one standard deviation each.
/// Slopes of light over half a tag, as shares of the contrast: a lamp near the tag. Black reflects a
/// twentieth of white, and so is its slope smaller.
constexpr double kWhiteSlope = 0.15, kBlackSlope = 0.03;
constexpr double kBeyondSpread = 0.5;  // of the contrast
constexpr double kLens_px2 = 0.25;     // of a lens in focus
constexpr double kBlurSpread_px2 = 2.0;
constexpr double kMinBlur_px = 0.2, kMaxBlur_px = 30.0;
/// What a lens displaces a point by that lies r from the middle: 1.2e-4 r^2 (k1 = -0.3, a fifth of the focal
/// length off the axis, f = 500 px: |k1| x / f), and 1.2e-6 r^3 (|k1| / f^2).
constexpr double kBend_per_px = 1.2e-4, kBend_per_px2 = 1.2e-6;

/// Residuals beyond so much of the contrast, and of the robust standard deviation, are of something else.
constexpr double kMinOutlierScale = 0.06, kOutlierScale = 4.0;
/// Of a fit that is accepted. Another tag of the family leaves 0.65 to 0.72 of the pixels, the right one 0.9.
constexpr double kMaxResidual = 0.15, kMinUsedShare = 0.8;

/// Everything that is estimated.
struct PatternState {
  Eigen::Matrix3d tag_from_straight;
  Eigen::Matrix2d blur_px2;
  Eigen::Vector3d bend = Eigen::Vector3d::Zero();
  Colours colours = Colours::Zero();  ///< In the order of the unknowns from kWhite on.

  double contrast() const { return colours[0]; }
};

/// How far the corners move in the plane (x0 y0 x1 ...), by the eight generators.
const Matrix8d& corner_moves() {
  static const Matrix8d moves = [] {
    Matrix8d m;
    for (std::size_t k = 0; k < kNumCorners; ++k) {
      const double u = kTagQuad[k].x(), v = kTagQuad[k].y();
      const auto row = 2 * static_cast<Eigen::Index>(k);
      m.row(row) << 1, 0, u, v, 0, 0, u * u, u * v;
      m.row(row + 1) << 0, 1, 0, 0, u, v, u * v, v * v;
    }
    return m;
  }();
  return moves;
}

class PatternFit {
 public:
  PatternFit(const BlurredPattern& pattern, const TagPlaces& places, PatternPixels pixels,
             const PatternState& start, double half_size_px)
      : pattern_(pattern),
        places_(places),
        pixels_(std::move(pixels)),
        state_(start),
        converged_(kConverged_px / half_size_px) {}

  /// False where it leads to no tag.
  bool run() {
    use_pixels(pixels_.num_coarse);
    predict();
    if (!fit_colours()) return false;
    if (!iterate(kMaxCoarseSteps)) return false;
    if (pixels_.num_coarse < pixels_.all.size()) {
      use_pixels(pixels_.all.size());
      same_blur_ = kSameFineBlur;
      predict();
      if (!iterate(kMaxFineSteps)) return false;
    }
    factor_equations();
    return state_.contrast() > 0.0;
  }

  std::optional<FittedPattern> result() const {
    FittedPattern fitted;
    fitted.contrast = state_.contrast();
    fitted.residual_rms = residual_rms_ / state_.contrast();
    fitted.used_share = weights_.sum() / std::max(1.0, num_counted_);
    const Eigen::Matrix2d pixel_by_straight = places_.straight_by_pixel().inverse();
    fitted.blur_px2 = pixel_by_straight * state_.blur_px2 * pixel_by_straight.transpose();
    const Eigen::Matrix3d straight_from_tag = state_.tag_from_straight.inverse();
    Matrix8d px_by_place = corner_moves();
    for (std::size_t k = 0; k < kNumCorners; ++k) {
      const Eigen::Vector3d image = straight_from_tag * kTagQuad[k].homogeneous();
      Eigen::Matrix2d by_straight;
      const auto pixel = places_.pixel(bent(image.hnormalized()), &by_straight);
      if (!pixel || !pixel->allFinite()) return std::nullopt;
      fitted.corners_px[k] = *pixel;
      auto rows = px_by_place.middleRows<2>(2 * static_cast<Eigen::Index>(k));
      rows = (by_straight * projective_derivative(straight_from_tag, image) * rows).eval();
    }
    fitted.covariance_px2 = px_by_place * covariance_of_place() * px_by_place.transpose();
    if (!fitted.covariance_px2.allFinite()) return std::nullopt;
    return fitted;
  }

 private:
  void use_pixels(std::size_t count) {
    const auto n = static_cast<Eigen::Index>(count);
    rows_.resize(kNumUnknowns, n);
    gradient2_.resize(n);
    residuals_.resize(n);
    weights_.resize(n);
  }

  /// Where the lens shows what a straight picture has at `straight`.
  Eigen::Vector2d bent(const Eigen::Vector2d& straight) const {
    const Eigen::Vector2d out = straight - places_.middle();
    const double r2 = out.squaredNorm();
    return straight + r2 * (state_.bend.head<2>() + state_.bend[2] * out);
  }

  Eigen::Matrix2d image_blur() const {
    const Eigen::Matrix2d D = places_.straight_by_pixel();
    return state_.blur_px2 + kPixelVariance * D * D.transpose();
  }

  void prepare_texture(const Eigen::Matrix2d& blur) {
    const Eigen::Vector2d centre = state_.tag_from_straight.inverse().col(2).hnormalized();
    const Eigen::Matrix2d J =
        projective_derivative(state_.tag_from_straight, state_.tag_from_straight * centre.homogeneous());
    const Eigen::Matrix2d in_plane = J * blur * J.transpose();
    if (texture_ && (texture_->covariance() - in_plane).norm() < same_blur_ * in_plane.norm()) return;
    texture_ = PatternTexture::of(pattern_, in_plane);
  }

  /// The light of each pixel, and its derivatives.
  void predict() {
    const Eigen::Matrix2d blur = image_blur();
    prepare_texture(blur);
    num_counted_ = 0.0;
    for (Eigen::Index i = 0; i < residuals_.size(); ++i)
      predict_pixel(i, pixels_.all[static_cast<std::size_t>(i)], blur);
  }

  void predict_pixel(Eigen::Index i, const PatternPixel& pixel, const Eigen::Matrix2d& blur) {
    const Eigen::Vector2d out = pixel.straight - places_.middle();
    const double r2 = out.squaredNorm();
    const Eigen::Vector2d unbent = pixel.straight - r2 * (state_.bend.head<2>() + state_.bend[2] * out);
    const Eigen::Vector3d image = state_.tag_from_straight * unbent.homogeneous();
    const Eigen::Matrix2d J = projective_derivative(state_.tag_from_straight, image);
    const double u = image.x() / image.z(), v = image.y() / image.z();
    const Eigen::Matrix2d in_plane = J * blur * J.transpose();
    const PatternSample sample =
        texture_ ? texture_->at(u, v, in_plane) : pattern_.at(u, v, PatternBlur::of(in_plane));
    const double printed = std::max(0.0, 1.0 - sample.beyond[kLeftSide] - sample.beyond[kRightSide]) *
                           std::max(0.0, 1.0 - sample.beyond[kTopSide] - sample.beyond[kBottomSide]);
    Colours by_colours;
    by_colours << sample.light, sample.light * u, sample.light * v, 1.0, u, v, sample.beyond[kLeftSide],
        sample.beyond[kRightSide], sample.beyond[kTopSide], sample.beyond[kBottomSide];
    residuals_[i] = pixel.light - by_colours.dot(state_.colours);
    const bool counts = printed >= kMinShareOfPrint && printed - sample.known <= kMaxShareUnknown;
    weights_[i] = counts ? 1.0 : 0.0;
    num_counted_ += weights_[i];
    auto row = rows_.col(i);
    if (pixel.light >= kSaturated && residuals_[i] <= 0.0) {
      residuals_[i] = gradient2_[i] = 0.0;
      row.setZero();
      return;
    }
    const double white = state_.colours[0] + state_.colours[1] * u + state_.colours[2] * v;
    const double by_u = white * sample.by_u, by_v = white * sample.by_v, radial = u * by_u + v * by_v;
    row.segment<8>(kPlace) << by_u, by_v, u * by_u, v * by_u, u * by_v, v * by_v, u * radial, v * radial;
    const Eigen::Matrix2d cross = J.col(0) * J.col(1).transpose();
    row.segment<3>(kBlur) << white * sample.by_covariance(J.col(0) * J.col(0).transpose()),
        white * sample.by_covariance(cross + cross.transpose()),
        white * sample.by_covariance(J.col(1) * J.col(1).transpose());
    const Eigen::Vector2d gradient = J.transpose() * Eigen::Vector2d(by_u, by_v);
    gradient2_[i] = gradient.squaredNorm();
    row.segment<3>(kBend) << -r2 * gradient, -r2 * out.dot(gradient);
    row.segment<kNumColours>(kWhite) = by_colours;
  }

  /// All colours at once, the place as it is: what the first step starts from. Slopes and surroundings are
  /// held, lest they take the place of a pattern that is not there.
  bool fit_colours() {
    const auto rows = rows_.bottomRows<kNumColours>();
    Eigen::Matrix<double, kNumColours, kNumColours> H = rows * weights_.asDiagonal() * rows.transpose();
    const double size = H(0, 0);
    if (!(num_counted_ >= kMinPixels && size > 0.0)) return false;
    for (const int slope : {1, 2, 4, 5}) H(slope, slope) += 0.1 * size;
    for (int side = kBeyond - kWhite; side < kNumColours; ++side) H(side, side) += 0.01 * size;
    H.diagonal().array() += 1e-9 * size;
    state_.colours = H.ldlt().solve(rows * (weights_.array() * residuals_.array()).matrix());
    residuals_ -= rows.transpose() * state_.colours;
    return state_.colours.allFinite() && state_.contrast() > 0.0;
  }

  /// Gauss and Newton's steps, from what is predicted, until the corners stay.
  bool iterate(int max_steps) {
    bool has_geometry = rows_.topRows<8>().squaredNorm() > 0.0;
    for (int step = 0; step < max_steps; ++step) {
      if (!has_geometry) predict();  // with colours, the light's derivatives by the place are not zero
      has_geometry = true;
      weigh();
      factor_equations();
      Information damped = information_;
      damped.diagonal() *= 1.0 + 1e-6;
      const Unknowns by = damped.ldlt().solve(gradient_);
      if (!by.allFinite()) return false;

      const double move = take(by);
      moved_ += move;
      if (!(moved_ < kMaxMove_cells * pattern_.cell_size()) || !(state_.contrast() > 0.0)) return false;
      predict();
      if (move < converged_) break;
    }
    weigh();
    return true;
  }

  /// Robust weights, and the variance of the residuals.
  void weigh() {
    std::vector<double> sizes;
    sizes.reserve(static_cast<std::size_t>(residuals_.size()));
    for (Eigen::Index i = 0; i < residuals_.size(); ++i)
      if (weights_[i] > 0.0) sizes.push_back(std::abs(residuals_[i]));
    if (sizes.empty()) return;
    const auto middle = sizes.begin() + static_cast<std::ptrdiff_t>(sizes.size() / 2);
    std::nth_element(sizes.begin(), middle, sizes.end());
    const GemanMcClure error(
        std::max(kOutlierScale * 1.4826 * *middle, kMinOutlierScale * state_.contrast()));
    double squares = 0.0, sum = 0.0, slopes = 0.0;
    for (Eigen::Index i = 0; i < residuals_.size(); ++i) {
      if (weights_[i] == 0.0) continue;
      const double r2 = residuals_[i] * residuals_[i];
      weights_[i] = error.weight(r2);
      squares += weights_[i] * r2;
      sum += weights_[i];
      slopes += weights_[i] * (4.0 * std::sqrt(weights_[i]) - 3.0);
    }
    share_of_slope_ = std::max(0.5, slopes / std::max(sum, 1.0));
    residual_rms_ = std::sqrt(squares / std::max(sum, 1.0));
    const double freedom = std::max(sum - kNumUnknowns, 0.1 * sum);
    variance_ = std::max(squares / std::max(freedom, 1.0), 1e-6 * state_.contrast() * state_.contrast());
  }

  /// Normal equations, in units of the residuals' variance times their inverse: with the priors.
  void factor_equations() {
    const Eigen::Matrix<double, kNumUnknowns, Eigen::Dynamic> weighted =
        rows_ * weights_.cwiseSqrt().asDiagonal();
    information_.setZero();
    information_.selfadjointView<Eigen::Lower>().rankUpdate(weighted);
    information_.triangularView<Eigen::StrictlyUpper>() = information_.transpose();
    gradient_ = rows_ * (weights_.array() * residuals_.array()).matrix();
    held_.setZero();
    const auto hold = [&](Eigen::Index i, double value, double sigma) {
      held_[i] = variance_ / (sigma * sigma);
      information_(i, i) += held_[i];
      gradient_[i] -= held_[i] * value;
    };
    const double contrast = state_.contrast();
    for (const int slope : {1, 2}) hold(kWhite + slope, state_.colours[slope], kWhiteSlope * contrast);
    for (const int slope : {4, 5}) hold(kWhite + slope, state_.colours[slope], kBlackSlope * contrast);
    for (int side = kBeyond - kWhite; side < kNumColours; ++side)
      hold(kWhite + side, state_.colours[side], kBeyondSpread * contrast);
    hold(kBlur, state_.blur_px2(0, 0) - kLens_px2, kBlurSpread_px2);
    hold(kBlur + 1, state_.blur_px2(0, 1), kBlurSpread_px2);
    hold(kBlur + 2, state_.blur_px2(1, 1) - kLens_px2, kBlurSpread_px2);
    const double share = places_.is_straightened() ? 1e-3 : 1.0;  // straightened pictures are not bent
    for (int axis = 0; axis < 2; ++axis) hold(kBend + axis, state_.bend[axis], share * kBend_per_px);
    hold(kBend + 2, state_.bend[2], share * kBend_per_px2);
  }

  /// How far the corners moved, in half tag sizes.
  double take(Unknowns step) {
    const double limit = kMaxStep_cells * pattern_.cell_size();
    const double move = (corner_moves() * step.head<8>()).cwiseAbs().maxCoeff();
    if (move > limit) step.head<8>() *= limit / move;
    const auto t = step.head<8>();
    Eigen::Matrix3d moved;  // to first order what the generators do
    moved << 1.0 + t[2], t[3], t[0], t[4], 1.0 + t[5], t[1], -t[6], -t[7], 1.0;
    state_.tag_from_straight = moved * state_.tag_from_straight;
    state_.tag_from_straight /= state_.tag_from_straight.norm();
    Eigen::Matrix2d change;
    change << step[kBlur], step[kBlur + 1], step[kBlur + 1], step[kBlur + 2];
    const double size = change.cwiseAbs().maxCoeff(), most = state_.blur_px2.trace();
    state_.blur_px2 = clamped_blur(state_.blur_px2 + std::min(1.0, most / std::max(size, 1e-12)) * change);
    state_.bend += step.segment<3>(kBend);
    state_.colours += step.tail<kNumColours>();
    return std::min(move, limit);
  }

  static Eigen::Matrix2d clamped_blur(const Eigen::Matrix2d& blur_px2) {
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> axes(blur_px2);
    const Eigen::Vector2d variances =
        axes.eigenvalues().cwiseMax(kMinBlur_px * kMinBlur_px).cwiseMin(kMaxBlur_px * kMaxBlur_px);
    return axes.eigenvectors() * variances.asDiagonal() * axes.eigenvectors().transpose();
  }

  /// What the pixels' noise makes of the estimate, and what the priors may be wrong by: an M-estimate's
  /// covariance (Huber 1981), from the weighted residuals, and how much less they change than the residuals.
  Matrix8d covariance_of_place() const {
    std::vector<FittedPixel> fitted;
    fitted.reserve(pixels_.all.size());
    for (Eigen::Index i = 0; i < residuals_.size(); ++i) {
      const PatternPixel& pixel = pixels_.all[static_cast<std::size_t>(i)];
      fitted.push_back({pixel.x, pixel.y, weights_[i] * residuals_[i], weights_[i], gradient2_[i]});
    }
    const Eigen::Matrix<double, 8, kNumUnknowns> place_by_gradient =
        information_.ldlt().solve(Information::Identity()).topRows<8>();
    const Eigen::Matrix<double, 8, Eigen::Dynamic> place_by_light =
        place_by_gradient * rows_ * (weights_.array() > 0.0).cast<double>().matrix().asDiagonal() /
        share_of_slope_;
    return ResidualNoise(std::move(fitted), kNumUnknowns).covariance_of_sum(place_by_light) +
           variance_ * place_by_gradient * held_.asDiagonal() * place_by_gradient.transpose();
  }

  const BlurredPattern& pattern_;
  const TagPlaces& places_;
  PatternPixels pixels_;
  PatternState state_;
  std::optional<PatternTexture> texture_;
  double same_blur_ = kSameBlur;
  double converged_, moved_ = 0.0;  ///< In half tag sizes.

  // Of the pixels in use, as predicted last.
  Eigen::Matrix<double, kNumUnknowns, Eigen::Dynamic> rows_;  ///< Derivatives of the light.
  Eigen::VectorXd gradient2_;                                 ///< Of the light, per px, squared.
  Eigen::VectorXd residuals_, weights_;
  double num_counted_ = 0.0;  ///< Pixels that show the print.
  double residual_rms_ = 0.0, variance_ = 0.0;
  double share_of_slope_ = 1.0;  ///< Mean of d (weight r) / dr, over the mean weight.
  Information information_;
  Unknowns gradient_, held_;  ///< held_: the priors' part of the information.
};

}  // namespace

std::optional<FittedPattern> fit_pattern(const LightSampler& light, const TagPattern& pattern,
                                         const PatternFitStart& start) {
  const Quad& corners = start.corners_px;
  const Eigen::Vector2d middle = 0.25 * (corners[0] + corners[1] + corners[2] + corners[3]);
  const std::optional<TagPlaces> places = TagPlaces::about(middle, start.camera);
  if (!places) return std::nullopt;
  Quad straight;
  for (std::size_t k = 0; k < kNumCorners; ++k) {
    const auto at = places->straight(corners[k]);
    if (!at) return std::nullopt;
    straight[k] = *at;
  }
  const auto straight_from_tag = estimate_homography(kTagQuad, straight);
  if (!straight_from_tag || !(std::abs(straight_from_tag->determinant()) > 0.0)) return std::nullopt;
  PatternState state;
  state.tag_from_straight = straight_from_tag->inverse();
  const Eigen::Matrix2d D = places->straight_by_pixel();
  const double variance_px2 = start.blur_sigma_px * start.blur_sigma_px - kPixelVariance;
  state.blur_px2 = std::max(variance_px2, kMinBlur_px * kMinBlur_px) * D * D.transpose();
  PatternPixels pixels = collect_pixels(light, *places, pattern, *straight_from_tag, start.blur_sigma_px);
  if (pixels.num_coarse < static_cast<std::size_t>(kMinPixels)) return std::nullopt;
  const BlurredPattern blurred(pattern);
  PatternFit fit(blurred, *places, std::move(pixels), state, 0.5 * std::sqrt(quad_area(straight)));
  if (!fit.run()) return std::nullopt;
  const std::optional<FittedPattern> fitted = fit.result();
  if (!fitted || fitted->residual_rms > kMaxResidual || fitted->used_share < kMinUsedShare)
    return std::nullopt;
  return fitted;
}

TagPattern without_margin(const TagPattern& pattern) {
  Image<float> inner(pattern.cells().width() - 2, pattern.cells().height() - 2);
  for (int y = 0; y < inner.height(); ++y)
    for (int x = 0; x < inner.width(); ++x) inner(x, y) = pattern.cells()(x + 1, y + 1);
  return {std::move(inner), pattern.width_at_border()};
}

}  // namespace apriltrack
