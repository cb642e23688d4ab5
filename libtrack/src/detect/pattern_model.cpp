#include "pattern_model.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "pattern_step.h"
#include "tag_quad.h"

namespace apriltrack {
namespace {

constexpr double kPixelVariance = 1.0 / 12.0;  // of a pixel's own area
constexpr double kMinBlur_px = 0.2, kMaxBlur_px = 30.0;
/// A pixel counts where at least so much of its light comes from the print.
constexpr double kMinShareOfPrint = 0.3;
/// What a family leaves to the printer (corners of circles) may be of any colour.
constexpr double kMaxShareUnknown = 0.02;
/// Of full scale: from here on a sensor may be full, and more light no contradiction (code 252 in sRGB).
constexpr double kSaturated = 0.975;
/// How often pixels are predicted, on average, before a new texture is made.
constexpr std::size_t kTimesAsked = 2;

/// How far a lens moves what lies `out` of the tag's middle.
Eigen::Vector2d bend_at(const Eigen::Vector3d& bend, const Eigen::Vector2d& out) {
  return out.squaredNorm() * (bend.head<2>() + bend[2] * out);
}

/// How far off the tag's middle lies what a lens moves to `unbent` off it: out = unbent + bend_at(out).
/// nullopt where the bend is so strong that it folds the picture.
std::optional<Eigen::Vector2d> bent(const Eigen::Vector3d& bend, const Eigen::Vector2d& unbent) {
  constexpr int kMaxRounds = 20;
  constexpr double kSame_px = 1e-9;
  Eigen::Vector2d out = unbent;
  for (int round = 0; round < kMaxRounds; ++round) {
    const Eigen::Vector2d next = unbent + bend_at(bend, out);
    const double change_px = (next - out).norm();
    out = next;
    if (change_px <= kSame_px * std::max(1.0, unbent.norm())) return out;
  }
  return std::nullopt;
}

/// Derivative of bend_at() by `bend`.
Eigen::Matrix<double, 2, 3> bend_by_unknowns(const Eigen::Vector2d& out) {
  const double r2 = out.squaredNorm();
  Eigen::Matrix<double, 2, 3> by_bend;
  by_bend << r2, 0.0, r2 * out.x(), 0.0, r2, r2 * out.y();
  return by_bend;
}

/// Derivative of bend_at() by `out`.
Eigen::Matrix2d bend_by_place(const Eigen::Vector3d& bend, const Eigen::Vector2d& out) {
  return 2.0 * (bend.head<2>() + bend[2] * out) * out.transpose() +
         bend[2] * out.squaredNorm() * Eigen::Matrix2d::Identity();
}

}  // namespace

PatternState PatternState::start(const TagPlaces& places, const Eigen::Matrix3d& straight_from_tag,
                                 double blur_sigma_px) {
  const Eigen::Matrix2d D = places.straight_by_pixel();
  PatternState state;
  state.tag_from_straight = straight_from_tag.inverse();
  state.blur_px2 =
      std::max(blur_sigma_px * blur_sigma_px - kPixelVariance, kMinBlur_px * kMinBlur_px) * D * D.transpose();
  return state;
}

double PatternState::take(PatternStep* asked, double max_move) {
  PatternStep& step = *asked;
  const double move = largest_corner_move(step.head<8>());
  if (move > max_move) step.head<8>() *= max_move / move;
  tag_from_straight = moved_plane(tag_from_straight, step.head<8>());
  const Eigen::Matrix2d before = blur_px2;
  blur_px2 = changed_blur(blur_px2, step.segment<3>(kBlurUnknowns), kMinBlur_px, kMaxBlur_px);
  const Eigen::Matrix2d change = blur_px2 - before;
  step.segment<3>(kBlurUnknowns) << change(0, 0), change(0, 1), change(1, 1);
  bend += step.segment<3>(kBendUnknowns);
  colours += step.tail<kNumColours>();
  return std::min(move, max_move);
}

void PatternModel::predict(const PatternState& state, std::span<const PatternPixel> pixels,
                           double max_blur_change, PatternPrediction* prediction) {
  const auto n = static_cast<Eigen::Index>(pixels.size());
  prediction->by_unknowns.resize(kNumPatternUnknowns, n);
  prediction->residuals.resize(n);
  prediction->gradient2.resize(n);
  prediction->counts.resize(n);
  const Eigen::Matrix2d D = places_.straight_by_pixel();
  const Eigen::Matrix2d blur = state.blur_px2 + kPixelVariance * D * D.transpose();
  prepare_texture(state, blur, max_blur_change, pixels.size());
  for (Eigen::Index i = 0; i < n; ++i)
    predict_pixel(state, pixels[static_cast<std::size_t>(i)], blur, i, prediction);
}

void PatternModel::prepare_texture(const PatternState& state, const Eigen::Matrix2d& blur,
                                   double max_blur_change, std::size_t num_pixels) {
  const Eigen::Vector2d centre = state.tag_from_straight.inverse().col(2).hnormalized();
  const Eigen::Matrix2d J =
      projective_derivative(state.tag_from_straight, state.tag_from_straight * centre.homogeneous());
  const Eigen::Matrix2d in_plane = J * blur * J.transpose();
  if (texture_ && (texture_->covariance() - in_plane).norm() < max_blur_change * in_plane.norm()) return;
  texture_ = PatternTexture::of(pattern_, in_plane, kTimesAsked * num_pixels);
}

void PatternModel::predict_pixel(const PatternState& state, const PatternPixel& pixel,
                                 const Eigen::Matrix2d& blur, Eigen::Index i,
                                 PatternPrediction* prediction) const {
  const Eigen::Vector2d out = pixel.straight - places_.middle();
  const Eigen::Vector2d unbent = pixel.straight - bend_at(state.bend, out);
  const Eigen::Vector3d image = state.tag_from_straight * unbent.homogeneous();
  const Eigen::Matrix2d J = projective_derivative(state.tag_from_straight, image);
  const double u = image.x() / image.z(), v = image.y() / image.z();
  const Eigen::Matrix2d in_plane = J * blur * J.transpose();
  const PatternSample sample =
      texture_ ? texture_->at(u, v, in_plane) : pattern_.at(u, v, PatternBlur::of(in_plane));
  Eigen::Matrix<double, kNumColours, 1> by_colours;
  by_colours << sample.light, sample.light * u, sample.light * v, 1.0, u, v, sample.beyond[kLeftSide],
      sample.beyond[kRightSide], sample.beyond[kTopSide], sample.beyond[kBottomSide];
  const double residual = pixel.light - by_colours.dot(state.colours);
  const double printed = std::max(0.0, 1.0 - sample.beyond[kLeftSide] - sample.beyond[kRightSide]) *
                         std::max(0.0, 1.0 - sample.beyond[kTopSide] - sample.beyond[kBottomSide]);
  prediction->counts[i] =
      printed >= kMinShareOfPrint && printed - sample.known <= kMaxShareUnknown ? 1.0 : 0.0;
  auto by = prediction->by_unknowns.col(i);
  if (pixel.light >= kSaturated && residual <= 0.0) {
    prediction->residuals[i] = prediction->gradient2[i] = prediction->counts[i] = 0.0;
    by.setZero();
    return;
  }
  prediction->residuals[i] = residual;
  const double white = state.colours[0] + state.colours[1] * u + state.colours[2] * v;
  by.head<kNumShapeUnknowns>() = white * by_shape(sample, u, v, J, out);
  prediction->gradient2[i] = (J.transpose() * by.head<2>()).squaredNorm();
  by.segment<kNumColours>(kWhiteUnknowns) = by_colours;
}

std::optional<PatternModel::Corners> PatternModel::corners(const PatternState& state) const {
  const Eigen::Matrix3d straight_from_tag = state.tag_from_straight.inverse();
  Corners corners;
  corners.by_unknowns.setZero();
  for (std::size_t k = 0; k < kNumCorners; ++k) {
    const Eigen::Vector3d image = straight_from_tag * kTagQuad[k].homogeneous();
    const auto out = bent(state.bend, image.hnormalized() - places_.middle());
    if (!out) return std::nullopt;
    Eigen::Matrix2d by_straight;
    const auto pixel = places_.pixel(places_.middle() + *out, &by_straight);
    if (!pixel || !pixel->allFinite()) return std::nullopt;
    corners.px[k] = *pixel;
    const auto row = 2 * static_cast<Eigen::Index>(k);
    const Eigen::Matrix2d by_unbent =
        by_straight * (Eigen::Matrix2d::Identity() - bend_by_place(state.bend, *out)).inverse();
    // The generators move the plane under the picture: where one moves it outwards, the corner goes inwards.
    corners.by_unknowns.block<2, 8>(row, kPlaceUnknowns) =
        -by_unbent * projective_derivative(straight_from_tag, image) * corner_moves().middleRows<2>(row);
    corners.by_unknowns.block<2, 3>(row, kBendUnknowns) = by_unbent * bend_by_unknowns(*out);
  }
  return corners;
}

Eigen::Matrix2d PatternModel::blur_px2(const PatternState& state) const {
  const Eigen::Matrix2d pixel_by_straight = places_.straight_by_pixel().inverse();
  return pixel_by_straight * state.blur_px2 * pixel_by_straight.transpose();
}

double PatternModel::blur_sigma_px(const PatternState& state) const {
  return std::sqrt(0.5 * blur_px2(state).trace() + kPixelVariance);
}

}  // namespace apriltrack
