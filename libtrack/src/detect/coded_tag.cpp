#include "coded_tag.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

#include "apriltrack/base/geman_mcclure.h"
#include "apriltrack/geometry/homography.h"
#include "apriltrack/tags/tag_family.h"
#include "lens_priors.h"
#include "pattern_pixels.h"
#include "pattern_step.h"
#include "tag_quad.h"

namespace apriltrack {
namespace {

// The unknowns, by their first index; of place, blur and bend as in pattern_model.h.
constexpr int kCodedBlur = 8, kCodedBend = 11, kCodedColour = 14;

constexpr double kReachInNoise = 4.0;  // Geman and McClure's, of residuals
constexpr double kFirstNoise = 0.03;
constexpr double kLeastNoise = 0.3 / 255.0;  // of rounding to grey levels
constexpr int kMostSteps = 8;
constexpr double kSettled = 1e-3;  // of a step's worth, in squared standard deviations
constexpr double kMostStep_cells = 0.5, kMostMove_cells = 2.0;
constexpr double kFirstBlur_px = 0.5, kLeastBlur_px = 0.1;
constexpr double kMostBlur_px = 5.0;  // those of over 1 px are not used (response_views.cpp)
constexpr double kPixelArea_px2 = 1.0 / 12.0;
constexpr double kSameTextureBlur = 0.1;  // the texture is made anew where the blur changed by a larger part
constexpr double kIsBlack = 0.1, kIsWhite = 0.9;
constexpr std::size_t kLeastOfColour = 10;
constexpr std::size_t kLeastPixels = 150;
constexpr double kMostCodedPixels = 1000.0;  // of a large tag
/// Beyond the print anything may lie.
constexpr double kAllPrinted = 0.99;
/// A sensor that is full tells no light, nor do pixels beside those, into which charge may have run over.
constexpr int kFullCode = 250, kAboutFull_px = 2;
constexpr double kMostFull = 0.02;  // of the pixels

double median_of(std::vector<double>& values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, middle);
  return *middle;
}

bool is_near_full(const GrayImage& image, int x, int y) {
  const int x1 = std::min(x + kAboutFull_px, image.width() - 1);
  const int y1 = std::min(y + kAboutFull_px, image.height() - 1);
  for (int row = std::max(y - kAboutFull_px, 0); row <= y1; ++row)
    for (int column = std::max(x - kAboutFull_px, 0); column <= x1; ++column)
      if (image(column, row) >= kFullCode) return true;
  return false;
}

/// Of the picture's part that begins at (x, y).
CameraModel camera_of_part(const CameraModel& camera, int x, int y) {
  Pinhole pinhole = camera.pinhole();
  pinhole.cx -= x;
  pinhole.cy -= y;
  return CameraModel(pinhole, camera.distortion());
}

}  // namespace

std::optional<CodedTag> CodedTag::of(const TagPatch& patch, const Quad& corners_px,
                                     const CameraModel* camera) {
  std::optional<CameraModel> own;
  if (camera) own = camera_of_part(*camera, patch.x, patch.y);
  Quad corners = corners_px;
  for (Eigen::Vector2d& corner : corners) corner -= Eigen::Vector2d(patch.x, patch.y);
  const Eigen::Vector2d middle = 0.25 * (corners[0] + corners[1] + corners[2] + corners[3]);
  const auto places = TagPlaces::about(middle, own ? &*own : nullptr);
  if (!places) return std::nullopt;
  for (Eigen::Vector2d& corner : corners) {
    const auto straight = places->straight(corner);
    if (!straight) return std::nullopt;
    corner = *straight;
  }
  const auto straight_from_tag = estimate_homography(kTagQuad, corners);
  if (!straight_from_tag || !(std::abs(straight_from_tag->determinant()) > 0.0)) return std::nullopt;

  const TagPattern pattern = TagFamily::get(patch.tag.family).pattern(patch.tag.id);
  CodedTag tag;
  tag.pattern_ = std::make_shared<const BlurredPattern>(pattern);
  tag.straight_by_pixel_ = places->straight_by_pixel();
  tag.is_straightened_ = places->is_straightened();
  Eigen::Matrix3d about_middle = Eigen::Matrix3d::Identity();
  about_middle.topRightCorner<2, 1>() = middle;
  tag.tag_from_straight_ = straight_from_tag->inverse() * about_middle;
  tag.blur_px2_ = kFirstBlur_px * kFirstBlur_px * tag.straight_by_pixel_ * tag.straight_by_pixel_.transpose();
  tag.noise_ = kFirstNoise;
  const ResponseCurve as_it_is = ResponseCurve::linear();
  const LightSampler codes(patch.pixels.view(), as_it_is);
  const double blur_px = std::sqrt(kFirstBlur_px * kFirstBlur_px + kPixelArea_px2);
  PatternPixels seen(codes, *places, pattern);
  std::vector<Pixel> pixels;
  std::size_t num_full = 0;
  for (const PatternPixel& pixel : seen.pick(*straight_from_tag, blur_px, kMostCodedPixels)) {
    const Eigen::Vector2d out = pixel.straight - middle;
    const Eigen::Vector3d image = tag.tag_from_straight_ * out.homogeneous();
    const Eigen::Matrix2d J = projective_derivative(tag.tag_from_straight_, image);
    const Eigen::Matrix2d in_plane = blur_px * blur_px * J * J.transpose();
    const PatternSample sample =
        tag.pattern_->at(image.x() / image.z(), image.y() / image.z(), PatternBlur::of(in_plane));
    if (sample.known < kAllPrinted) continue;
    if (is_near_full(patch.pixels, pixel.x, pixel.y))
      ++num_full;
    else
      pixels.push_back({out, pixel.light});
  }
  if (pixels.size() < kLeastPixels ||
      static_cast<double>(num_full) > kMostFull * static_cast<double>(pixels.size()))
    return std::nullopt;
  tag.pixels_ = std::make_shared<const std::vector<Pixel>>(std::move(pixels));
  return tag;
}

/// Of the picture, black 0 and white 1, the derivatives by place, blur and bend, and the colours' factors.
void CodedTag::predict_picture() {
  const Eigen::Matrix2d blur =
      blur_px2_ + kPixelArea_px2 * straight_by_pixel_ * straight_by_pixel_.transpose();
  const Eigen::Vector3d centre = tag_from_straight_.inverse().col(2);
  const Eigen::Matrix2d J_centre =
      projective_derivative(tag_from_straight_, tag_from_straight_ * centre / centre.z());
  const Eigen::Matrix2d at_centre = J_centre * blur * J_centre.transpose();
  if (!texture_ || (texture_->covariance() - at_centre).norm() > kSameTextureBlur * at_centre.norm())
    texture_ = PatternTexture::of(*pattern_, at_centre, pixels_->size());
  const auto count = static_cast<Eigen::Index>(pixels_->size());
  rows_.resize(kNumUnknowns, count);
  by_print_.resize(count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const Eigen::Vector2d& out = (*pixels_)[static_cast<std::size_t>(i)].straight;
    const double r2 = out.squaredNorm();
    const Eigen::Vector2d unbent = out - r2 * (bend_.head<2>() + bend_[2] * out);
    const Eigen::Vector3d image = tag_from_straight_ * unbent.homogeneous();
    const Eigen::Matrix2d J = projective_derivative(tag_from_straight_, image);
    const double u = image.x() / image.z(), v = image.y() / image.z();
    const Eigen::Matrix2d in_plane = J * blur * J.transpose();
    const PatternSample sample =
        texture_ ? texture_->at(u, v, in_plane) : pattern_->at(u, v, PatternBlur::of(in_plane));
    rows_.col(i) << by_shape(sample, u, v, J, out), sample.light, 1.0, sample.light * u, sample.light * v;
    by_print_[i] = std::hypot(sample.by_u, sample.by_v);
  }
}

/// In grey levels, where predict_picture() left light.
void CodedTag::predict_codes(const CodeCurve& curve) {
  const auto count = static_cast<Eigen::Index>(pixels_->size());
  residuals_.resize(count);
  by_exponent_.resize(count);
  weights_.resize(count);
  const GemanMcClure error(kReachInNoise * noise_);
  cost_ = 0.0;
  for (Eigen::Index i = 0; i < count; ++i) {
    auto row = rows_.col(i);
    const double u_white = row[kCodedColour + 2], v_white = row[kCodedColour + 3];
    const double white = row[kCodedColour];
    const double light = row.tail<kNumColours>().dot(colours_);
    const CodeCurve::Sample code = curve.at(light);
    residuals_[i] = (*pixels_)[static_cast<std::size_t>(i)].code - code.code;
    const double contrast =
        colours_[0] + (white > 1e-9 ? (colours_[2] * u_white + colours_[3] * v_white) / white : 0.0);
    row.head<kCodedColour>() *= code.by_light * contrast;
    row.tail<kNumColours>() *= code.by_light;
    by_print_[i] *= code.by_light * contrast;
    by_exponent_[i] = code.by_exponent;
    const double square = residuals_[i] * residuals_[i];
    weights_[i] = error.weight(square) / (noise_ * noise_);
    cost_ += 0.5 * error.penalty(square) / (noise_ * noise_);
  }
}

void CodedTag::hold(Information& information, Unknowns& gradient) const {
  const auto one = [&](int i, double off, double sigma) {
    information(i, i) += 1.0 / (sigma * sigma);
    gradient[i] -= off / (sigma * sigma);
  };
  one(kCodedBlur, blur_px2_(0, 0) - kBlurPrior_px2, kBlurPriorSpread_px2);
  one(kCodedBlur + 1, blur_px2_(0, 1), kBlurPriorSpread_px2);
  one(kCodedBlur + 2, blur_px2_(1, 1) - kBlurPrior_px2, kBlurPriorSpread_px2);
  const double share = is_straightened_ ? kBendPriorLeft : 1.0;
  for (int axis = 0; axis < 2; ++axis) one(kCodedBend + axis, bend_[axis], share * kBendPrior_per_px);
  one(kCodedBend + 2, bend_[2], share * kBendPrior_per_px2);
}

bool CodedTag::begin(const CodeCurve& curve) {
  predict_picture();
  std::vector<double> black, white;
  for (Eigen::Index i = 0; i < rows_.cols(); ++i) {
    const double share = rows_(kCodedColour, i);
    const double light = curve.light((*pixels_)[static_cast<std::size_t>(i)].code);
    if (share < kIsBlack) black.push_back(light);
    if (share > kIsWhite) white.push_back(light);
  }
  if (std::min(black.size(), white.size()) < kLeastOfColour) return false;
  const double black_light = median_of(black);
  colours_ << median_of(white) - black_light, black_light, 0.0, 0.0;
  return colours_[0] > 0.0;
}

std::optional<CodedTag::Equation> CodedTag::linearise(const CodeCurve& curve) {
  predict_picture();
  predict_codes(curve);
  const Eigen::Matrix<double, kNumUnknowns, Eigen::Dynamic> weighted = rows_ * weights_.asDiagonal();
  Information information = weighted * rows_.transpose();
  Unknowns by_residuals = weighted * residuals_;
  hold(information, by_residuals);
  information.diagonal() *= 1.0 + 1e-9;
  const Eigen::LDLT<Information> factor(information);
  const Unknowns by_exponent = weighted * by_exponent_;
  step_ = factor.solve(by_residuals);
  step_by_exponent_ = factor.solve(by_exponent);
  worth_ = step_.dot(by_residuals);
  if (!step_.allFinite() || !step_by_exponent_.allFinite()) return std::nullopt;
  const Eigen::VectorXd exponent = weights_.array() * by_exponent_.array();
  return Equation{exponent.dot(by_exponent_) - by_exponent.dot(step_by_exponent_),
                  exponent.dot(residuals_) - by_exponent.dot(step_),
                  exponent.dot(by_print_) - step_by_exponent_.dot(weighted * by_print_), cost_};
}

bool CodedTag::advance(double exponent_step) {
  Unknowns step = step_ - exponent_step * step_by_exponent_;
  const double move = largest_corner_move(step.head<8>());
  const double most = kMostStep_cells * pattern_->cell_size();
  if (move > most) step.head<8>() *= most / move;
  moved_ += std::min(move, most);
  tag_from_straight_ = moved_plane(tag_from_straight_, step.head<8>());
  blur_px2_ = changed_blur(blur_px2_, step.segment<3>(kCodedBlur), kLeastBlur_px, kMostBlur_px);
  bend_ += step.segment<3>(kCodedBend);
  colours_ += step.tail<kNumColours>();
  return tag_from_straight_.allFinite() && colours_[0] > 0.0 &&
         moved_ < kMostMove_cells * pattern_->cell_size();
}

std::optional<CodedTag::Equation> CodedTag::settle(const CodeCurve& curve) {
  moved_ = 0.0;
  for (int step = 1;; ++step) {
    const auto equation = linearise(curve);
    if (!equation || worth_ < kSettled || step == kMostSteps) return equation;
    if (!advance(0.0)) return std::nullopt;
  }
}

void CodedTag::measure_noise() {
  std::vector<double> sizes(residuals_.begin(), residuals_.end());
  for (double& size : sizes) size = std::abs(size);
  noise_ = std::max(1.4826 * median_of(sizes), kLeastNoise);
}

double CodedTag::widest_blur_px() const {
  const Eigen::Matrix2d pixel_by_straight = straight_by_pixel_.inverse();
  const Eigen::Matrix2d in_pixels = pixel_by_straight * blur_px2_ * pixel_by_straight.transpose();
  return std::sqrt(Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(in_pixels).eigenvalues()[1]);
}

double CodedTag::correlation() const {
  double sum = 0.0, squares = 0.0;
  for (const Pixel& pixel : *pixels_) {
    sum += pixel.code;
    squares += pixel.code * pixel.code;
  }
  const double total = squares - sum * sum / static_cast<double>(pixels_->size());
  return std::sqrt(std::max(0.0, 1.0 - residuals_.squaredNorm() / std::max(total, 1e-12)));
}

}  // namespace apriltrack
