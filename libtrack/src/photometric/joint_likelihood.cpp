#include "apriltrack/photometric/joint_likelihood.h"

#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <numeric>

#include "apriltrack/base/check.h"
#include "apriltrack/base/error.h"
#include "patch_columns.h"
#include "patch_placement.h"
#include "row_pairs.h"
#include "tag_prediction.h"
#include "view_cone.h"

namespace apriltrack {
namespace {

/// Hypotheses: enough work for a thread, little enough to share out.
constexpr std::size_t kMaxPerTask = 32;
constexpr std::size_t kMaxPerBatch = 1024;
/// A batch's predictions, of 1 kB each, are held at once.
constexpr std::size_t kMaxPredictions = 2048;
/// Samples whose template is held at once: rays, light and presence stay in the innermost cache.
constexpr std::size_t kMaxPredicted = 8 * kPatchBlock;
/// Samples that are summed in single precision.
constexpr std::size_t kMaxSummed = 64 * kPatchBlock;

void require(bool holds, const char* field, double value, const char* range) {
  if (!holds) throw invalid_input(field, fmt::format("must lie in {} (is {})", range, value));
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

/// A patch against a reference.
PatchSums sums_of(const PairedRows& image, const LensFactors& lens, const PatchPlacement& placement,
                  const PatchColumns& columns) {
  PatchSums sums;
  for (std::size_t first = 0; first < columns.size(); first += kMaxSummed) {
    const std::size_t count = std::min(kMaxSummed, columns.size() - first);
    // Of all the template: where it is read at all, every part of it is seen.
    const bool is_first = first == 0;
    const TemplateColumns expected = {columns.light.data() + first, nullptr, 0.0,
                                      is_first ? columns.sum_squares : 0.0};
    sums.add(sum_patch(image, lens, placement, columns.samples(first, count), expected));
  }
  return sums;
}

/// A patch against the tag's pattern along the hypothesis' path.
PatchSums sums_of(const PairedRows& image, const LensFactors& lens, const PatchPlacement& placement,
                  const PatchColumns& columns, const TagPrediction& prediction,
                  const std::array<float, 9>& camera_from_plane) {
  std::array<float, kMaxPredicted> ray_x, ray_y, light, presence;
  PatchSums sums;
  for (std::size_t first = 0; first < columns.size(); first += kMaxPredicted) {
    const std::size_t count = std::min(kMaxPredicted, columns.size() - first);
    const SampleColumns samples = columns.samples(first, count);
    cast_patch(camera_from_plane, samples, ray_x.data(), ray_y.data());
    predict_pixels(prediction.texel_path(), {ray_x.data(), ray_y.data(), count}, light.data(),
                   presence.data());
    sums.add(sum_patch(image, lens, placement, samples, {light.data(), presence.data()}));
  }
  return sums;
}

}  // namespace

/// What a hypothesis makes of a tag before its samples are looked at.
struct PatchInView {
  PlacedPatch placed;
  std::array<float, 9> camera_from_plane{};
  double num_independent = 0.0;
  bool is_in_view = false;
};

struct JointLikelihood::Workspace {
  ViewCone cone;  ///< What the frame shows.
  LensFactors lens;
  RowPairs rows;
  std::vector<std::size_t> cells, coarse_cells;
  PatchColumns grid, coarse_grid;  ///< Of patterns.
  std::vector<PatchColumns> references, coarse_references;
  std::vector<std::size_t> selection;      ///< Hypotheses to evaluate.
  std::vector<PatchInView> views;          ///< Of a batch, hypothesis by hypothesis.
  std::vector<TagPrediction> predictions;  ///< Likewise, with patterns.
};

/// Hypotheses that are evaluated together.
struct JointLikelihood::Batch {
  const PhotometricFrame& frame;
  std::span<const MotionState> hypotheses;  ///< All of them,
  std::span<const std::size_t> selection;   ///< and which are of this batch.
  bool is_coarse = false;
  PairedRows image;

  const MotionState& hypothesis(std::size_t position) const { return hypotheses[selection[position]]; }
};

void JointLikelihoodOptions::check() const {
  grid.check();
  require(gamma > 0.0 && std::isfinite(gamma), "gamma", gamma, "(0, inf)");
  require(min_correlation > 0.0 && min_correlation < 1.0, "min_correlation", min_correlation, "(0, 1)");
  require(kappa > 0.0 && kappa < 1.0, "kappa", kappa, "(0, 1)");
  require(max_light > 0.0, "max_light", max_light, "(0, inf]");
  require(coarse_sigmas >= 0.0 && std::isfinite(coarse_sigmas), "coarse_sigmas", coarse_sigmas, "[0, inf)");
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
  work_->cells = all_cells(options.grid);
  work_->coarse_cells = stratified_cells(options.grid);
  fill_columns(options.grid, work_->cells, {}, &work_->grid);
  fill_columns(options.grid, work_->coarse_cells, {}, &work_->coarse_grid);
  work_->references.resize(num_tags());
  work_->coarse_references.resize(num_tags());
}

JointLikelihood::~JointLikelihood() = default;
JointLikelihood::JointLikelihood(JointLikelihood&&) noexcept = default;
JointLikelihood& JointLikelihood::operator=(JointLikelihood&&) noexcept = default;

void JointLikelihood::set_reference(std::size_t index, std::span<const double> samples) {
  APRILTRACK_CHECK(index < num_tags(), "no such tag");
  APRILTRACK_CHECK(samples.size() == options_.grid.num_samples(), "samples must be as many as the grid's");
  references_[index].assign(samples.begin(), samples.end());
  fill_columns(options_.grid, work_->cells, samples, &work_->references[index]);
  fill_columns(options_.grid, work_->coarse_cells, samples, &work_->coarse_references[index]);
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
  if (options_.coarse_sigmas > 0.0) {
    score(frame, hypotheses, true, parallel, scores);
    select_promising(*scores);
  }
  score(frame, hypotheses, false, parallel, scores);
}

/// The hypotheses selected.
void JointLikelihood::score(const PhotometricFrame& frame, std::span<const MotionState> hypotheses,
                            bool is_coarse, const ParallelFor& parallel, JointScores* scores) {
  const std::size_t per_batch =
      std::clamp(kMaxPredictions / std::max<std::size_t>(1, num_tags()), std::size_t{1}, kMaxPerBatch);
  // The fewer hypotheses in a batch, the more tags each has: as much work for a thread.
  const std::size_t per_task = std::max<std::size_t>(1, kMaxPerTask * per_batch / kMaxPerBatch);
  const std::span<const std::size_t> selection = work_->selection;
  for (std::size_t begin = 0; begin < selection.size(); begin += per_batch) {
    Batch batch{frame,
                hypotheses,
                selection.subspan(begin, std::min(per_batch, selection.size() - begin)),
                is_coarse,
                {}};
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

/// Of what the coarse scores say, those that may yet be the best.
void JointLikelihood::select_promising(const JointScores& scores) {
  struct Coarse {
    double mean = 0.0, variance = 0.0;
  };
  const auto coarse_of = [&](std::size_t hypothesis) {
    Coarse coarse;
    for (std::size_t k = 0; k < num_tags(); ++k) {
      const TagScore& tag = scores.tag(hypothesis, k);
      if (!(tag.seen_share > 0.0)) continue;
      const double c = tag.correlation;
      coarse.mean += std::min(c, c * tag.seen_share);  // (12)
      const double num_seen = tag.seen_share * static_cast<double>(work_->coarse_cells.size());
      coarse.variance += tag.seen_share * tag.seen_share * (1.0 - c * c) * (1.0 - c * c) / num_seen;
    }
    return coarse;
  };
  Coarse best{.mean = -std::numeric_limits<double>::infinity()};
  for (const std::size_t hypothesis : work_->selection) {
    const Coarse coarse = coarse_of(hypothesis);
    if (coarse.mean > best.mean) best = coarse;
  }
  std::erase_if(work_->selection, [&](std::size_t hypothesis) {
    const Coarse coarse = coarse_of(hypothesis);
    return coarse.mean + options_.coarse_sigmas * std::sqrt(coarse.variance + best.variance) < best.mean;
  });
}

/// Writes the views of the batch's hypothesis at `position`. Most tags of a room are turned away or out of
/// view: they cost little more than where their centre is.
void JointLikelihood::place(const Batch& batch, std::size_t position) {
  const Pose T_camera_map = camera_from_map(batch.hypothesis(position).pose, mode_);
  const Eigen::Matrix3d R = T_camera_map.rotation_matrix();
  for (std::size_t k = 0; k < num_tags(); ++k) {
    PatchInView& view = work_->views[position * num_tags() + k];
    const Tag& tag = tags_[k];
    const Eigen::Vector3d centre = R * tag.map_from_plane.col(2) + T_camera_map.translation();
    view.is_in_view =
        takes_part(k) && (R * tag.normal_map).dot(centre) > 0.0 && work_->cone.may_show(centre, tag.radius_m);
    if (!view.is_in_view) continue;
    Eigen::Matrix3d M = R * tag.map_from_plane;
    M.col(2) = centre;
    view.num_independent = num_independent(model_, M, options_.grid);
    view.placed = place_patch(batch.frame.light[0].view(), model_, M, options_.grid);
    view.camera_from_plane = by_rows(M);
  }
}

/// Serially, for the textures are shared and made when first asked for. None without patterns.
void JointLikelihood::predict(const Batch& batch) {
  work_->predictions.clear();
  if (!world_) return;
  work_->predictions.reserve(batch.selection.size() * num_tags());
  for (std::size_t position = 0; position < batch.selection.size(); ++position) {
    ViewPath path(batch.hypothesis(position), batch.frame.exposure_s, mode_);
    for (std::size_t k = 0; k < num_tags(); ++k) {
      const TagPrediction& prediction = work_->predictions.emplace_back(*world_, world_->tags[k], path, 0);
      PatchInView& view = work_->views[position * num_tags() + k];
      view.is_in_view = view.is_in_view && prediction.is_visible();
    }
  }
}

/// Those parts of the image that the batch's patches lie on.
void JointLikelihood::make_rows() {
  PixelBox box;
  for (const PatchInView& view : work_->views)
    if (view.is_in_view) box.add(view.placed.box);
  work_->rows.make(box);
}

void JointLikelihood::score_hypothesis(const Batch& batch, std::size_t position, JointScores* scores) const {
  const std::size_t hypothesis = batch.selection[position];
  double sum = 0.0;
  int num_used = 0;
  for (std::size_t k = 0; k < num_tags(); ++k) {
    TagScore& score = scores->tags[hypothesis * num_tags() + k];
    score = {};
    if (!takes_part(k)) continue;
    score = score_tag(batch, position, k);
    sum += score.log_likelihood;
    ++num_used;
  }
  const bool is_mean = options_.average_over_tags && num_used > 0;
  scores->log_likelihoods[hypothesis] = is_mean ? sum / num_used : sum;  // (16), (17)
}

TagScore JointLikelihood::score_tag(const Batch& batch, std::size_t position, std::size_t index) const {
  TagScore score;
  const std::size_t at = position * num_tags() + index;
  const PatchInView& view = work_->views[at];
  if (view.is_in_view) {
    const PatchPlacement& placement = view.placed.placement;
    PatchMatch match;
    if (world_) {
      const PatchColumns& columns = batch.is_coarse ? work_->coarse_grid : work_->grid;
      match = match_of(sums_of(batch.image, work_->lens, placement, columns, work_->predictions[at],
                               view.camera_from_plane));
    } else {
      const auto& references = batch.is_coarse ? work_->coarse_references : work_->references;
      match = match_of(sums_of(batch.image, work_->lens, placement, references[index]));
    }
    const std::size_t num_cells = batch.is_coarse ? work_->coarse_cells.size() : work_->cells.size();
    score.correlation = match.correlation;
    // Too few to tell anything are none.
    if (match.num_samples >= PatchMatch::kMinSamples)
      score.seen_share = static_cast<double>(match.num_samples) / static_cast<double>(num_cells);
  }
  score.log_likelihood = log_likelihood(options_, score, view.is_in_view ? view.num_independent : 0.0);
  return score;
}

}  // namespace apriltrack
