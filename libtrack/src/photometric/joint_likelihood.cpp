#include "apriltrack/photometric/joint_likelihood.h"

#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "apriltrack/base/check.h"
#include "apriltrack/base/error.h"
#include "tag_prediction.h"
#include "view_cone.h"

namespace apriltrack {
namespace {

/// Hypotheses: enough work for a thread, little enough to share out.
constexpr std::size_t kMaxPerTask = 32;
constexpr std::size_t kMaxPerBatch = 1024;
/// A batch's predictions, of 1 kB each, are held at once.
constexpr std::size_t kMaxPredictions = 2048;
constexpr double kLeastPresence = 0.5;  // of the printed cells in a sample's light
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

void require(bool holds, const char* field, double value, const char* range) {
  if (!holds) throw invalid_input(field, fmt::format("must lie in {} (is {})", range, value));
}

/// Whether no point of the patch can be in the image: most tags of a room, at no cost.
bool is_out_of_view(const Eigen::Matrix3d& camera_from_plane, const PatchGrid& grid, double max_angle_rad) {
  const double radius = std::numbers::sqrt2 * grid.half_extent * camera_from_plane.col(0).norm();
  return !may_be_in_view(camera_from_plane.col(2), radius, max_angle_rad);
}

/// Independent samples in a patch: one of more pixels than samples has no more than its samples.
double num_independent(const CameraModel& model, const Eigen::Matrix3d& camera_from_plane,
                       const PatchGrid& grid) {
  const double depth = camera_from_plane(2, 2);
  if (!(depth > 0.0)) return 0.0;
  // d pixel / d plane of the homography at the patch's centre, times the grid's area.
  const double area_px = model.pinhole().fx * model.pinhole().fy * camera_from_plane.determinant() /
                         (depth * depth * depth) * 4.0 * grid.half_extent * grid.half_extent;
  return std::clamp(area_px, 0.0, static_cast<double>(grid.num_samples())) / kPixelsPerIndependentSample;
}

/// docs/algorithms/paper_filter.md, equations (13) to (15).
double log_likelihood(const JointLikelihoodOptions& options, const TagScore& score, double independent) {
  // What is not seen counts as uncorrelated; what speaks against the hypothesis is not made less of.
  const double c = std::min(score.correlation, score.correlation * score.seen_share);  // (12)
  switch (options.error) {
    case PatchError::kLinear:
      return -options.gamma * (0.5 - 0.5 * c);
    case PatchError::kMinusLog:
      return options.gamma * std::log(std::max(c, options.min_correlation));
    case PatchError::kGaussianProfile:
      break;
  }
  const double positive = std::max(score.correlation, 0.0);
  const double num_samples = independent * score.seen_share;
  return profile_log_likelihood(positive, num_samples, options.kappa) -
         profile_log_likelihood(0.0, num_samples, options.kappa);
}

/// What the pattern looks like along the hypothesis' path, at the samples of `grid`.
void sample_pattern(const TagPrediction& prediction, const Eigen::Matrix3d& camera_from_plane,
                    const PatchGrid& grid, std::span<double> samples) {
  std::size_t index = 0;
  for (int row = 0; row < grid.size; ++row) {
    for (int column = 0; column < grid.size; ++column, ++index) {
      samples[index] = kNaN;
      const Eigen::Vector3d point_camera =
          camera_from_plane * Eigen::Vector3d(grid.coordinate(column), grid.coordinate(row), 1.0);
      if (!(point_camera.z() > 0.0)) continue;
      const Eigen::Vector2f ray = (point_camera.head<2>() / point_camera.z()).cast<float>();
      const PixelPrediction seen = prediction.predict(ray);
      // Beyond its cells a tag is printed on white paper.
      if (seen.presence >= kLeastPresence) samples[index] = seen.light + (1.0 - seen.presence);
    }
  }
}

}  // namespace

struct JointLikelihood::PatchPair {
  explicit PatchPair(std::size_t num_samples) : seen(num_samples), expected(num_samples) {}
  std::vector<double> seen;
  std::vector<double> expected;
};

void JointLikelihoodOptions::check() const {
  grid.check();
  require(gamma > 0.0 && std::isfinite(gamma), "gamma", gamma, "(0, inf)");
  require(min_correlation > 0.0 && min_correlation < 1.0, "min_correlation", min_correlation, "(0, 1)");
  require(kappa > 0.0 && kappa < 1.0, "kappa", kappa, "(0, 1)");
}

JointLikelihood::JointLikelihood(const Camera& camera, const TagMap& map, TrackMode mode,
                                 const JointLikelihoodOptions& options)
    : model_(camera.model), mode_(mode), options_(options), references_(map.tags.size()) {
  options.check();
  for (const MapTag& tag : map.tags) tags_.push_back({tag.size_m, tag.T_map_tag});
  // Patches are projected into the image: no pixel needs a ray, so that the world has no picture.
  if (options.tag_template == TagTemplate::kPattern) world_.emplace(camera, map, mode, 0, 0);
}

void JointLikelihood::set_reference(std::size_t index, std::span<const double> samples) {
  APRILTRACK_CHECK(index < num_tags(), "no such tag");
  APRILTRACK_CHECK(samples.size() == options_.grid.num_samples(), "samples must be as many as the grid's");
  references_[index].assign(samples.begin(), samples.end());
}

void JointLikelihood::clear_reference(std::size_t index) {
  APRILTRACK_CHECK(index < num_tags(), "no such tag");
  references_[index].clear();
}

bool JointLikelihood::takes_part(std::size_t index) const {
  return options_.tag_template == TagTemplate::kPattern || !references_[index].empty();
}

void JointLikelihood::evaluate(const PhotometricFrame& frame, std::span<const MotionState> hypotheses,
                               const ParallelFor& parallel, JointScores* scores) {
  APRILTRACK_CHECK(!frame.light.empty() && !frame.light[0].is_empty(),
                   "a frame has a level of light at least");
  max_view_angle_rad_ = max_view_angle_rad(model_, frame.light[0].width(), frame.light[0].height());
  if (world_) world_->max_view_angle_rad = max_view_angle_rad_;
  scores->num_tags = num_tags();
  scores->log_likelihoods.resize(hypotheses.size());
  scores->tags.resize(hypotheses.size() * num_tags());
  const std::size_t per_batch =
      std::clamp(kMaxPredictions / std::max<std::size_t>(1, num_tags()), std::size_t{1}, kMaxPerBatch);
  // The fewer hypotheses in a batch, the more tags each has: as much work for a thread.
  const std::size_t per_task = std::max<std::size_t>(1, kMaxPerTask * per_batch / kMaxPerBatch);
  for (std::size_t begin = 0; begin < hypotheses.size(); begin += per_batch) {
    const std::span batch = hypotheses.subspan(begin, std::min(per_batch, hypotheses.size() - begin));
    const std::vector<TagPrediction> predictions = predict_tags(frame, batch);
    parallel((batch.size() + per_task - 1) / per_task, [&](std::size_t task) {
      const std::size_t first = task * per_task;
      const std::size_t count = std::min(per_task, batch.size() - first);
      const std::span<const TagPrediction> theirs =
          predictions.empty() ? std::span<const TagPrediction>()
                              : std::span(predictions).subspan(first * num_tags(), count * num_tags());
      score_range(frame, batch.subspan(first, count), theirs, begin + first, scores);
    });
  }
}

/// Serially, for the textures are shared and made when first asked for. None without patterns.
std::vector<TagPrediction> JointLikelihood::predict_tags(const PhotometricFrame& frame,
                                                         std::span<const MotionState> hypotheses) {
  std::vector<TagPrediction> predictions;
  if (!world_) return predictions;
  predictions.reserve(hypotheses.size() * num_tags());
  for (const MotionState& state : hypotheses) {
    ViewPath path(state, frame.exposure_s, mode_);
    for (const PhotometricTag& tag : world_->tags) predictions.emplace_back(*world_, tag, path, 0);
  }
  return predictions;
}

void JointLikelihood::score_range(const PhotometricFrame& frame, std::span<const MotionState> hypotheses,
                                  std::span<const TagPrediction> predictions, std::size_t first,
                                  JointScores* scores) const {
  PatchPair patches(options_.grid.num_samples());
  for (std::size_t i = 0; i < hypotheses.size(); ++i) {
    const Pose T_camera_map = camera_from_map(hypotheses[i].pose, mode_);
    double sum = 0.0;
    int num_used = 0;
    for (std::size_t k = 0; k < num_tags(); ++k) {
      TagScore& score = scores->tags[(first + i) * num_tags() + k];
      score = {};
      if (!takes_part(k)) continue;
      const TagPrediction* prediction = predictions.empty() ? nullptr : &predictions[i * num_tags() + k];
      score = score_tag(frame, k, T_camera_map, prediction, patches);
      sum += score.log_likelihood;
      ++num_used;
    }
    const bool is_mean = options_.average_over_tags && num_used > 0;
    scores->log_likelihoods[first + i] = is_mean ? sum / num_used : sum;  // (16), (17)
  }
}

TagScore JointLikelihood::score_tag(const PhotometricFrame& frame, std::size_t index,
                                    const Pose& T_camera_map, const TagPrediction* prediction,
                                    PatchPair& patches) const {
  TagScore score;
  const Tag& tag = tags_[index];
  const Eigen::Matrix3d M = camera_from_tag_plane(T_camera_map * tag.T_map_tag, tag.size_m);
  const bool is_hidden = (prediction != nullptr && !prediction->is_visible()) ||
                         is_out_of_view(M, options_.grid, max_view_angle_rad_);
  const int num_seen =
      is_hidden ? 0 : sample_patch(frame.light[0].view(), model_, M, options_.grid, patches.seen);
  if (num_seen >= PatchMatch::kMinSamples) {
    if (prediction != nullptr) sample_pattern(*prediction, M, options_.grid, patches.expected);
    const PatchMatch match =
        correlate(patches.seen, prediction != nullptr ? std::span<const double>(patches.expected)
                                                      : std::span<const double>(references_[index]));
    score.correlation = match.correlation;
    score.seen_share =
        static_cast<double>(match.num_samples) / static_cast<double>(options_.grid.num_samples());
  }
  score.log_likelihood = log_likelihood(options_, score, num_independent(model_, M, options_.grid));
  return score;
}

}  // namespace apriltrack
