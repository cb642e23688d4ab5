#include "pattern_fit.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "apriltrack/base/geman_mcclure.h"
#include "apriltrack/geometry/homography.h"
#include "apriltrack/tags/blurred_pattern.h"
#include "lens_priors.h"
#include "pattern_model.h"
#include "pattern_pixels.h"
#include "residual_noise.h"
#include "tag_quad.h"

namespace apriltrack {
namespace {

using Information = Eigen::Matrix<double, kNumPatternUnknowns, kNumPatternUnknowns>;

constexpr std::size_t kMinPixels = 60;

/// How a part of the steps is gone.
struct Stage {
  double max_pixels;  ///< Of larger tags a part is asked.
  int max_steps;
  /// A step that moves no corner by more, in sigmas of the blur, is the last: but for a part as small, the
  /// light follows it in straight lines.
  double small_step;
  double same_blur;  ///< The texture is made anew where the blur has changed by more than this part.
};
constexpr Stage kCoarse = {.max_pixels = 250.0, .max_steps = 8, .small_step = 0.2, .same_blur = 0.4};
/// Of 1,700 tags of rendered and recorded pictures one takes over 4 steps; a fit that takes over 6 is none.
constexpr Stage kFine = {.max_pixels = 1000.0, .max_steps = 6, .small_step = 0.05, .same_blur = 0.1};
/// Nor may a last step change the blur's covariance by more than this part of it.
constexpr double kSmallBlurStep = 0.2;
constexpr double kMaxStep_cells = 0.5;
constexpr double kMaxMove_cells = 2.0;
/// Residuals beyond so much of the contrast, and of the robust standard deviation, are of something else.
constexpr double kMinOutlierScale = 0.06, kOutlierScale = 4.0;
/// What a quad is off by shows at edges alone, and most pixels of a large tag are elsewhere: so at first
/// hardly a residual is of something else. The least scale begins with so much of the contrast, and takes
/// this share of itself at each step.
constexpr double kFirstOutlierScale = 0.5, kNextOutlierScale = 1.0 / 3.0;
/// Of a fit that is accepted. Another tag of the family leaves 0.65 to 0.72 of the pixels, the right one 0.9.
constexpr double kMaxResidual = 0.15, kMinUsedShare = 0.8;
/// Of a large tag most pixels lie where nothing changes, and a fit beside the edges keeps those. Right tags
/// leave 0.62 to 0.95 of the edges in rendered and path-traced pictures, a fit that stands beside them 0.23
/// and less.
constexpr double kMinUsedEdges = 0.5;

// What is known of the unknowns before a pixel is seen: one standard deviation each.
/// Slopes of light over half a tag, as shares of the contrast: a lamp near the tag. Black reflects a
/// twentieth of white, and so is its slope smaller.
constexpr double kWhiteSlope = 0.15, kBlackSlope = 0.03;
constexpr double kBeyondSpread = 0.5;  // of the contrast

/// An unknown that is held: by how much it exceeds what is expected of it, and what it may exceed that by.
struct PatternPrior {
  Eigen::Index unknown;
  double excess, sigma;
};

std::vector<PatternPrior> priors_at(const PatternState& state, bool is_straightened) {
  std::vector<PatternPrior> priors;
  const double contrast = state.contrast();
  for (Eigen::Index slope = 1; slope <= 2; ++slope) {
    priors.push_back({kWhiteUnknowns + slope, state.colours[slope], kWhiteSlope * contrast});
    const Eigen::Index black = kBlackUnknowns + slope;
    priors.push_back({black, state.colours[black - kWhiteUnknowns], kBlackSlope * contrast});
  }
  for (Eigen::Index side = kBeyondUnknowns; side < kNumPatternUnknowns; ++side)
    priors.push_back({side, state.colours[side - kWhiteUnknowns], kBeyondSpread * contrast});
  priors.push_back({kBlurUnknowns, state.blur_px2(0, 0) - kBlurPrior_px2, kBlurPriorSpread_px2});
  priors.push_back({kBlurUnknowns + 1, state.blur_px2(0, 1), kBlurPriorSpread_px2});
  priors.push_back({kBlurUnknowns + 2, state.blur_px2(1, 1) - kBlurPrior_px2, kBlurPriorSpread_px2});
  const double share = is_straightened ? kBendPriorLeft : 1.0;
  priors.push_back({kBendUnknowns, state.bend[0], share * kBendPrior_per_px});
  priors.push_back({kBendUnknowns + 1, state.bend[1], share * kBendPrior_per_px});
  priors.push_back({kBendUnknowns + 2, state.bend[2], share * kBendPrior_per_px2});
  return priors;
}

/// Gauss and Newton's steps from a start to the state that explains the pixels best, robustly.
class PatternFit {
 public:
  PatternFit(PatternModel model, PatternPixels* pixels, const PatternState& start, double half_size_px)
      : model_(std::move(model)), pixels_(*pixels), state_(start), half_size_px_(half_size_px) {}

  /// False where it leads to no tag.
  bool run() {
    if (!use(kCoarse)) return false;
    predict();
    if (!fit_colours()) return false;
    predict();  // with colours, the light's derivatives by the place are not zero
    if (!iterate()) return false;
    if (!use(kFine)) return false;
    predict();
    if (!iterate() || !is_settled_) return false;
    factor_equations();
    return state_.contrast() > 0.0;
  }

  std::optional<FittedPattern> result() const {
    const std::optional<PatternModel::Corners> corners = model_.corners(state_);
    if (!corners) return std::nullopt;
    FittedPattern fitted;
    fitted.corners_px = corners->px;
    fitted.covariance_px2 = covariance_of_corners(corners->by_unknowns);
    fitted.blur_px2 = model_.blur_px2(state_);
    fitted.contrast = state_.contrast();
    fitted.residual_rms = residual_rms_ / state_.contrast();
    fitted.used_share = weights_.sum() / std::max(1.0, predicted_.counts.sum());
    const double of_edges = predicted_.counts.dot(predicted_.gradient2);
    fitted.used_edges = of_edges > 0.0 ? weights_.dot(predicted_.gradient2) / of_edges : 0.0;
    if (fitted.covariance_px2.llt().info() != Eigen::Success) return std::nullopt;  // or not finite
    return fitted;
  }

 private:
  /// False where too few pixels show the print.
  bool use(const Stage& stage) {
    stage_ = &stage;
    used_ = pixels_.pick(state_.tag_from_straight.inverse(), model_.blur_sigma_px(state_), stage.max_pixels);
    return used_.size() >= kMinPixels;
  }

  void predict() { model_.predict(state_, used_, stage_->same_blur, &predicted_); }

  /// All colours at once, the place as it is: what the first step starts from. Slopes and surroundings are
  /// held, lest they take the place of a pattern that is not there.
  bool fit_colours() {
    const auto by_colours = predicted_.by_unknowns.bottomRows<kNumColours>();
    const Eigen::VectorXd& counts = predicted_.counts;
    Eigen::Matrix<double, kNumColours, kNumColours> H =
        by_colours * counts.asDiagonal() * by_colours.transpose();
    const double size = H(0, 0);
    if (!(counts.sum() >= kMinPixels && size > 0.0)) return false;
    for (const int slope : {1, 2, 4, 5}) H(slope, slope) += 0.1 * size;
    for (int side = kBeyondUnknowns - kWhiteUnknowns; side < kNumColours; ++side)
      H(side, side) += 0.01 * size;
    H.diagonal().array() += 1e-9 * size;
    state_.colours = H.ldlt().solve(by_colours * counts.cwiseProduct(predicted_.residuals));
    return state_.colours.allFinite() && state_.contrast() > 0.0;
  }

  /// From what is predicted, until a step is so small that what follows from it is linear (is_settled_), or
  /// as often as the stage allows. False where it leads to no tag.
  bool iterate() {
    is_settled_ = false;
    for (int step = 0; step < stage_->max_steps; ++step) {
      if (!weigh()) return false;
      factor_equations();
      Information damped = information_;
      damped.diagonal() *= 1.0 + 1e-6;
      PatternStep by = damped.ldlt().solve(gradient_);
      if (!by.allFinite()) return false;

      const PatternState before = state_;
      const double move = state_.take(&by, kMaxStep_cells * model_.cell_size());
      moved_ += move;
      if (!(moved_ < kMaxMove_cells * model_.cell_size()) || !(state_.contrast() > 0.0)) return false;
      is_settled_ = is_small(move, before) && least_outlier_scale_ <= kMinOutlierScale;
      least_outlier_scale_ = std::max(kMinOutlierScale, kNextOutlierScale * least_outlier_scale_);
      if (is_settled_) {
        predicted_.residuals.noalias() -= predicted_.by_unknowns.transpose() * by;
        break;
      }
      predict();
    }
    return weigh();
  }

  /// move: in half tag sizes.
  bool is_small(double move, const PatternState& before) const {
    return move * half_size_px_ < stage_->small_step * model_.blur_sigma_px(state_) &&
           (state_.blur_px2 - before.blur_px2).norm() < kSmallBlurStep * state_.blur_px2.norm();
  }

  /// Robust weights, and the variance of the residuals. False where too few pixels count.
  bool weigh() {
    const Eigen::VectorXd& residuals = predicted_.residuals;
    weights_ = predicted_.counts;
    std::vector<double> sizes;
    sizes.reserve(static_cast<std::size_t>(residuals.size()));
    for (Eigen::Index i = 0; i < residuals.size(); ++i)
      if (weights_[i] > 0.0) sizes.push_back(std::abs(residuals[i]));
    if (sizes.size() < kMinPixels) return false;
    const auto middle = sizes.begin() + static_cast<std::ptrdiff_t>(sizes.size() / 2);
    std::nth_element(sizes.begin(), middle, sizes.end());
    const GemanMcClure error(
        std::max(kOutlierScale * 1.4826 * *middle, least_outlier_scale_ * state_.contrast()));
    double squares = 0.0, sum = 0.0, slopes = 0.0;
    for (Eigen::Index i = 0; i < residuals.size(); ++i) {
      if (weights_[i] == 0.0) continue;
      const double r2 = residuals[i] * residuals[i];
      weights_[i] = error.weight(r2);
      squares += weights_[i] * r2;
      sum += weights_[i];
      slopes += weights_[i] * (4.0 * std::sqrt(weights_[i]) - 3.0);
    }
    share_of_slope_ = std::max(0.5, slopes / std::max(sum, 1.0));
    residual_rms_ = std::sqrt(squares / std::max(sum, 1.0));
    const double freedom = std::max(sum - kNumPatternUnknowns, 0.1 * sum);
    variance_ = std::max(squares / std::max(freedom, 1.0), 1e-6 * state_.contrast() * state_.contrast());
    return true;
  }

  /// Normal equations, in units of the residuals' variance times their inverse: with the priors.
  void factor_equations() {
    const auto& by_unknowns = predicted_.by_unknowns;
    const Eigen::Matrix<double, kNumPatternUnknowns, Eigen::Dynamic> weighted =
        by_unknowns * weights_.cwiseSqrt().asDiagonal();
    information_.setZero();
    information_.selfadjointView<Eigen::Lower>().rankUpdate(weighted);
    information_.triangularView<Eigen::StrictlyUpper>() = information_.transpose();
    gradient_ = by_unknowns * weights_.cwiseProduct(predicted_.residuals);
    held_.setZero();
    for (const auto& [unknown, excess, sigma] : priors_at(state_, model_.is_straightened())) {
      held_[unknown] = variance_ / (sigma * sigma);
      information_(unknown, unknown) += held_[unknown];
      gradient_[unknown] -= held_[unknown] * excess;
    }
  }

  /// What the pixels' noise makes of the estimate, and what the priors may be wrong by: an M-estimate's
  /// covariance (Huber 1981), from the weighted residuals, and how much less they change than the residuals.
  Matrix8d covariance_of_corners(const Eigen::Matrix<double, 8, kNumPatternUnknowns>& by_unknowns) const {
    std::vector<FittedPixel> fitted;
    fitted.reserve(used_.size());
    for (std::size_t k = 0; k < used_.size(); ++k) {
      const auto i = static_cast<Eigen::Index>(k);
      fitted.push_back({used_[k].x, used_[k].y, weights_[i] * predicted_.residuals[i],
                        predicted_.counts[i] > 0.0, predicted_.gradient2[i]});
    }
    const Eigen::Matrix<double, 8, kNumPatternUnknowns> by_gradient =
        by_unknowns * information_.ldlt().solve(Information::Identity());
    const Eigen::Matrix<double, 8, Eigen::Dynamic> by_light =
        by_gradient * predicted_.by_unknowns * (weights_.array() > 0.0).cast<double>().matrix().asDiagonal() /
        share_of_slope_;
    return ResidualNoise(std::move(fitted), kNumPatternUnknowns).covariance_of_sum(by_light) +
           variance_ * by_gradient * held_.asDiagonal() * by_gradient.transpose();
  }

  PatternModel model_;
  PatternPixels& pixels_;
  PatternState state_;
  double half_size_px_;                              ///< Of the tag.
  double moved_ = 0.0;                               ///< By the corners, in half tag sizes.
  double least_outlier_scale_ = kFirstOutlierScale;  ///< Of the contrast.

  const Stage* stage_ = &kCoarse;
  bool is_settled_ = false;  ///< Whether the stage's last step was a small one.
  std::vector<PatternPixel> used_;
  PatternPrediction predicted_;  ///< Of the pixels in use.
  Eigen::VectorXd weights_;      ///< What the robust fit takes them for, 0 to 1.
  double residual_rms_ = 0.0, variance_ = 0.0;
  double share_of_slope_ = 1.0;  ///< Mean of d (weight r) / dr, over the mean weight.
  Information information_;
  PatternStep gradient_, held_;  ///< held_: the priors' part of the information.
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
  const PatternState state = PatternState::start(*places, *straight_from_tag, start.blur_sigma_px);
  PatternPixels pixels(light, *places, pattern);
  const BlurredPattern blurred(pattern);
  PatternFit fit({blurred, *places}, &pixels, state, 0.5 * std::sqrt(quad_area(straight)));
  if (!fit.run()) return std::nullopt;
  const std::optional<FittedPattern> fitted = fit.result();
  if (!fitted || fitted->residual_rms > kMaxResidual || fitted->used_share < kMinUsedShare ||
      fitted->used_edges < kMinUsedEdges)
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
