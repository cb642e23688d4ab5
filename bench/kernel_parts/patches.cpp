#include <fmt/format.h>

#include <array>
#include <cmath>
#include <span>

#include "bench_setting.h"
#include "patch_columns.h"
#include "patch_placement.h"
#include "scalar_kernels.h"

namespace apriltrack::bench {
namespace {

struct Kernels {
  decltype(&sum_patch) sum;
  decltype(&cast_patch) cast;
  decltype(&predict_pixels) predict;
};
constexpr Kernels kLibrary = {&sum_patch, &cast_patch, &predict_pixels};
constexpr Kernels kScalar = {&apriltrack_scalar::sum_patch, &apriltrack_scalar::cast_patch,
                             &apriltrack_scalar::predict_pixels};

double by_definition(const Setting& setting, std::size_t i, const TagPrediction* prediction) {
  std::vector<double> seen(setting.grid.num_samples());
  sample_patch(setting.frame.light[0].view(), setting.camera.model, setting.views[i], setting.grid, seen);
  if (prediction == nullptr) return correlate(seen, setting.reference).correlation;
  std::vector<double> expected(seen.size(), kNowhere);
  for (std::size_t k = 0; k < seen.size(); ++k) {
    const int index = static_cast<int>(k), size = setting.grid.size;
    const Eigen::Vector3d point =
        setting.views[i] *
        Eigen::Vector3d(setting.grid.coordinate(index % size), setting.grid.coordinate(index / size), 1.0);
    const PixelPrediction at = prediction->predict((point.head<2>() / point.z()).cast<float>());
    if (at.presence >= TemplateColumns::kLeastPresence)
      expected[k] = static_cast<double>(at.light) + 1.0 - static_cast<double>(at.presence);
  }
  return correlate(seen, expected).correlation;
}

double by_kernels(const Kernels& kernels, const Setting& setting, const PairedRows& rows,
                  const LensFactors& lens, const PatchColumns& columns, std::size_t i,
                  const TagPrediction* prediction) {
  const PatchPlacement placement =
      place_patch(setting.frame.light[0].view(), setting.camera.model, setting.views[i], setting.grid)
          .placement;
  if (prediction == nullptr) {
    return match_of(kernels.sum(rows, lens, placement, columns.samples(0, columns.size()),
                                {columns.light.data(), nullptr, 0.0, columns.sum_squares}))
        .correlation;
  }
  constexpr std::size_t kStrip = 8 * kPatchBlock;
  std::array<float, kStrip> ray_x, ray_y, light, presence;
  PatchSums sums;
  for (std::size_t first = 0; first < columns.size(); first += kStrip) {
    const SampleColumns samples = columns.samples(first, kStrip);
    kernels.cast(by_rows(setting.views[i]), samples, ray_x.data(), ray_y.data());
    kernels.predict(prediction->texel_path(), {ray_x.data(), ray_y.data(), kStrip}, light.data(),
                    presence.data());
    sums.add(kernels.sum(rows, lens, placement, samples, {light.data(), presence.data()}));
  }
  return match_of(sums).correlation;
}

struct Differences {
  double largest = 0.0, rms = 0.0;
};
Differences differences(const std::vector<double>& found, const std::vector<double>& expected) {
  Differences result;
  for (std::size_t i = 0; i < found.size(); ++i) {
    const double difference = std::abs(found[i] - expected[i]);
    result.largest = std::max(result.largest, difference);
    result.rms += difference * difference / static_cast<double>(found.size());
  }
  result.rms = std::sqrt(result.rms);
  return result;
}

}  // namespace

/// Patches one by one, then evaluate() as a whole.
void bench_patches(double tag_px, bool has_pattern, int repetitions) {
  const Setting setting(tag_px);
  const std::size_t count = has_pattern ? kNumWithPattern : kNumHypotheses;
  PhotometricWorld world(setting.camera, setting.map, TrackMode::kJoint, kWidth, kHeight);
  std::vector<TagPrediction> predictions;
  for (std::size_t i = 0; has_pattern && i < count; ++i) {
    ViewPath path(setting.hypotheses[i], setting.frame.exposure_s, world.mode);
    predictions.emplace_back(world, world.tags[0], path, 0);
  }
  const auto prediction = [&](std::size_t i) { return has_pattern ? &predictions[i] : nullptr; };
  RowPairs pairs;
  pairs.start(setting.frame.light[0].view(), std::numeric_limits<double>::infinity());
  pairs.make({0, kWidth - 1, 0, kHeight - 2});
  const PairedRows rows = pairs.rows();
  const LensFactors lens = lens_factors(setting.camera.model);
  PatchColumns columns;
  fill_columns(setting.grid, all_cells(setting.grid),
               has_pattern ? std::span<const double>() : std::span<const double>(setting.reference),
               &columns);

  std::vector<std::vector<double>> found;
  found.reserve(32);
  std::vector<Way> ways;
  const auto add = [&](const std::string& name, std::int64_t set, const auto& correlation_of) {
    std::vector<double>& results = found.emplace_back(count);
    ways.push_back({name,
                    set,
                    [&results, correlation_of] {
                      for (std::size_t i = 0; i < results.size(); ++i) results[i] = correlation_of(i);
                    },
                    {}});
  };
  add("definition (double)", 0, [&](std::size_t i) { return by_definition(setting, i, prediction(i)); });
  add("SCALAR (float)", 0,
      [&](std::size_t i) { return by_kernels(kScalar, setting, rows, lens, columns, i, prediction(i)); });
  for (const std::int64_t set : instruction_sets()) {
    add(hwy::TargetName(set), set,
        [&](std::size_t i) { return by_kernels(kLibrary, setting, rows, lens, columns, i, prediction(i)); });
  }
  const std::size_t num_patch_ways = ways.size();
  JointLikelihoodOptions options;
  options.tag_template = has_pattern ? TagTemplate::kPattern : TagTemplate::kReference;
  JointLikelihood likelihood(setting.camera, setting.map, TrackMode::kJoint, options);
  JointLikelihoodOptions in_full = options;
  in_full.negligible_log_ratio = std::numeric_limits<double>::infinity();
  JointLikelihood full(setting.camera, setting.map, TrackMode::kJoint, in_full);
  options.coarse_sigmas = 3.0;
  JointLikelihood rejecting(setting.camera, setting.map, TrackMode::kJoint, options);
  for (JointLikelihood* one : {&likelihood, &full, &rejecting}) one->set_reference(0, setting.reference);
  JointScores scores;
  const std::span<const MotionState> hypotheses = std::span(setting.hypotheses).first(count);
  const ParallelFor serial = parallel_for(1);
  for (const std::int64_t set : instruction_sets()) {
    ways.push_back({fmt::format("evaluate(), {}", hwy::TargetName(set)),
                    set,
                    [&] { likelihood.evaluate(setting.frame, hypotheses, serial, &scores); },
                    {}});
  }
  ways.push_back({"evaluate(), best, all in full",
                  0,
                  [&] { full.evaluate(setting.frame, hypotheses, serial, &scores); },
                  {}});
  ways.push_back({"evaluate(), best, 64 samples first",
                  0,
                  [&] { rejecting.evaluate(setting.frame, hypotheses, serial, &scores); },
                  {}});
  take_turns(ways, repetitions);

  const double scalar_s = std::min(ways[0].median_s(), ways[1].median_s());
  const int num_instants = has_pattern ? predictions[0].num_instants() : 0;
  fmt::print("\n### Tag of {} px, {}\n\n", tag_px,
             has_pattern ? fmt::format("pattern over {} instants, {} hypotheses", num_instants, count)
                         : fmt::format("reference, {} hypotheses", count));
  fmt::print(
      "| way | ns per sample | us per patch | frames/s at N = 3000 | x faster scalar | largest dc | rms dc "
      "|\n"
      "|---|---|---|---|---|---|---|\n");
  for (std::size_t k = 0; k < ways.size(); ++k) {
    const double patch_s = ways[k].median_s() / static_cast<double>(count);
    std::string error = " | ";
    if (k < num_patch_ways) {
      const Differences off = differences(found[k], found[0]);
      error = fmt::format("{:.1e} | {:.1e}", off.largest, off.rms);
    }
    fmt::print("| {} | {:.2f} | {:.2f} | {:.0f} | {:.1f} | {} |\n", ways[k].name, patch_s / 1024.0 * 1e9,
               patch_s * 1e6, 1.0 / (patch_s * static_cast<double>(kNumHypotheses)),
               scalar_s / ways[k].median_s(), error);
  }
}

}  // namespace apriltrack::bench
