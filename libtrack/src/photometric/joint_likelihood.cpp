#include "apriltrack/photometric/joint_likelihood.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <numeric>

#include "apriltrack/base/check.h"
#include "apriltrack/base/error.h"
#include "joint_workspace.h"

namespace apriltrack {
namespace {

/// Hypotheses: enough work for a thread, little enough to share out.
constexpr std::size_t kMaxPerTask = 32;
constexpr std::size_t kMaxPerBatch = 1024;
/// A batch's predictions, of 1 kB each, are held at once.
constexpr std::size_t kMaxPredictions = 2048;

void require(bool holds, const char* field, double value, const char* range) {
  if (!holds) throw invalid_input(field, fmt::format("must lie in {} (is {})", range, value));
}

}  // namespace

void JointLikelihoodOptions::check() const {
  grid.check();
  require(gamma > 0.0 && std::isfinite(gamma), "gamma", gamma, "(0, inf)");
  require(min_correlation > 0.0 && min_correlation < 1.0, "min_correlation", min_correlation, "(0, 1)");
  require(kappa > 0.0 && kappa < 1.0, "kappa", kappa, "(0, 1)");
  require(max_light > 0.0, "max_light", max_light, "(0, inf]");
  require(coarse_sigmas >= 0.0 && std::isfinite(coarse_sigmas), "coarse_sigmas", coarse_sigmas, "[0, inf)");
  require(negligible_log_ratio > 0.0, "negligible_log_ratio", negligible_log_ratio, "(0, inf]");
}

JointLikelihood::JointLikelihood(const Camera& camera, const TagMap& map, TrackMode mode,
                                 const JointLikelihoodOptions& options)
    : model_(camera.model),
      mode_(mode),
      options_((options.check(), options)),
      references_(map.tags.size()),
      work_(std::make_unique<Workspace>()) {
  for (const MapTag& tag : map.tags) {
    const Eigen::Matrix3d plane = camera_from_tag_plane(tag.T_map_tag, tag.size_m);
    tags_.push_back({plane, plane.col(0).cross(plane.col(1)),
                     std::numbers::sqrt2 * options.grid.half_extent * plane.col(0).norm()});
  }
  // Patches are projected into the image: no pixel needs a ray, so that the world has no picture.
  if (options.tag_template == TagTemplate::kPattern) world_.emplace(camera, map, mode, 0, 0);
  work_->lens = lens_factors(model_);
  work_->of(SampleSet::kSome).cells = stratified_cells(options.grid);
  work_->of(SampleSet::kQuarter).cells = quarter_of_cells(options.grid);
  work_->of(SampleSet::kAll).cells = all_cells(options.grid);
  for (PatchSamples& samples : work_->samples) {
    fill_columns(options.grid, samples.cells, {}, &samples.grid);
    samples.references.resize(num_tags());
  }
}

JointLikelihood::~JointLikelihood() = default;
JointLikelihood::JointLikelihood(JointLikelihood&&) noexcept = default;
JointLikelihood& JointLikelihood::operator=(JointLikelihood&&) noexcept = default;

void JointLikelihood::set_reference(std::size_t index, std::span<const double> samples) {
  APRILTRACK_CHECK(index < num_tags(), "no such tag");
  APRILTRACK_CHECK(samples.size() == options_.grid.num_samples(), "samples must be as many as the grid's");
  references_[index].assign(samples.begin(), samples.end());
  for (PatchSamples& chosen : work_->samples)
    fill_columns(options_.grid, chosen.cells, samples, &chosen.references[index]);
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
  APRILTRACK_CHECK(frame.light[0].width() > 1 && frame.light[0].height() > 1,
                   "a frame has two rows and columns at least");
  const double max_angle_rad = max_view_angle_rad(model_, frame.light[0].width(), frame.light[0].height());
  work_->cone = ViewCone(max_angle_rad);
  if (world_) world_->max_view_angle_rad = max_angle_rad;
  scores->num_tags = num_tags();
  scores->log_likelihoods.resize(hypotheses.size());
  scores->tags.resize(hypotheses.size() * num_tags());
  work_->rows.start(frame.light[0].view(), options_.max_light);
  work_->selection.resize(hypotheses.size());
  std::iota(work_->selection.begin(), work_->selection.end(), std::size_t{0});
  const auto score_selected = [&](SampleSet set) { score(frame, hypotheses, set, parallel, scores); };
  if (options_.coarse_sigmas > 0.0) {
    score_selected(SampleSet::kSome);
    select_promising(*scores);
  } else if (has_bounds() && hypotheses.size() > 1) {
    work_->bounds.resize(hypotheses.size());
    score_selected(SampleSet::kQuarter);
    const std::size_t likeliest = static_cast<std::size_t>(std::ranges::max_element(scores->log_likelihoods) -
                                                           scores->log_likelihoods.begin());
    work_->selection.assign(1, likeliest);
    score_selected(SampleSet::kAll);
    select_possible(scores->log_likelihoods[likeliest]);
  }
  score_selected(SampleSet::kAll);
}

/// The hypotheses selected.
void JointLikelihood::score(const PhotometricFrame& frame, std::span<const MotionState> hypotheses,
                            SampleSet set, const ParallelFor& parallel, JointScores* scores) {
  const std::size_t per_batch =
      std::clamp(kMaxPredictions / std::max<std::size_t>(1, num_tags()), std::size_t{1}, kMaxPerBatch);
  // The fewer hypotheses in a batch, the more tags each has: as much work for a thread.
  const std::size_t per_task = std::max<std::size_t>(1, kMaxPerTask * per_batch / kMaxPerBatch);
  const std::span<const std::size_t> selection = work_->selection;
  for (std::size_t begin = 0; begin < selection.size(); begin += per_batch) {
    Batch batch{
        frame, hypotheses, selection.subspan(begin, std::min(per_batch, selection.size() - begin)), set, {}};
    const std::size_t size = batch.selection.size(), num_tasks = (size + per_task - 1) / per_task;
    const auto for_each = [&](const auto& act) {
      const auto task = [&](std::size_t index) {
        const std::size_t last = std::min(size, (index + 1) * per_task);
        for (std::size_t position = index * per_task; position < last; ++position) act(position);
      };
      parallel(num_tasks, std::ref(task));  // by reference: a copy of it would take memory
    };
    work_->views.resize(size * num_tags());
    for_each([&](std::size_t position) { place(batch, position); });
    predict(batch);
    make_rows();
    batch.image = work_->rows.rows();
    for_each([&](std::size_t position) { score_hypothesis(batch, position, scores); });
  }
}

}  // namespace apriltrack
