// What the photometric kernels cost on one core of this machine, instruction set by instruction set, and how
// far they are from their definitions in double precision: Markdown on stdout.
//
//   bench_kernels [REPETITIONS]
//
// Medians of the repetitions (default 9), in which all ways take turns.

#include <fmt/format.h>
#include <hwy/highway.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <ctime>
#include <functional>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "apriltrack/base/random.h"
#include "apriltrack/geometry/rotation.h"
#include "apriltrack/photometric/joint_likelihood.h"
#include "patch_columns.h"
#include "patch_placement.h"
#include "scalar_kernels.h"
#include "tag_prediction.h"

namespace apriltrack {
namespace {

constexpr std::size_t kNumHypotheses = 3000;
constexpr std::size_t kNumWithPattern = 300;  // the definition takes a tenth of a millisecond for each
constexpr double kTagSize_m = 0.16, kFocal_px = 800.0;
constexpr int kWidth = 1280, kHeight = 720;
constexpr double kNowhere = std::numeric_limits<double>::quiet_NaN();

/// A way of computing the same, under its name.
struct Way {
  std::string name;
  std::int64_t instruction_set = 0;  ///< 0: as the machine chooses.
  std::function<void()> run;
  std::vector<double> seconds;

  double median_s() const {
    std::vector<double> sorted = seconds;
    std::ranges::sort(sorted);
    return sorted[sorted.size() / 2];
  }
};

void take_turns(std::vector<Way>& ways, int repetitions) {
  for (int repetition = 0; repetition <= repetitions; ++repetition) {
    for (Way& way : ways) {
      hwy::SetSupportedTargetsForTest(way.instruction_set);
      const std::clock_t start = std::clock();  // processor time: others may use the machine meanwhile
      way.run();
      const double taken_s = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
      if (repetition > 0) way.seconds.push_back(taken_s);  // the first warms up
    }
  }
  hwy::SetSupportedTargetsForTest(0);
}

std::vector<std::int64_t> instruction_sets() {
  hwy::SetSupportedTargetsForTest(0);
  std::vector<std::int64_t> sets;
  // What the library was built for; its way without SIMD has a line of its own.
  for (std::int64_t left = hwy::SupportedTargets() & HWY_TARGETS & ~HWY_SCALAR & ~HWY_EMU128; left != 0;
       left &= left - 1)
    sets.push_back(left & -left);
  std::ranges::reverse(sets);  // the best comes last
  return sets;
}

struct Kernels {
  decltype(&sum_patch) sum;
  decltype(&cast_patch) cast;
  decltype(&predict_pixels) predict;
};
constexpr Kernels kLibrary = {&sum_patch, &cast_patch, &predict_pixels};
constexpr Kernels kScalar = {&apriltrack_scalar::sum_patch, &apriltrack_scalar::cast_patch,
                             &apriltrack_scalar::predict_pixels};

/// A tag of so many pixels before a camera, and hypotheses within some pixels and degrees of the truth.
struct Setting {
  explicit Setting(double tag_px) {
    camera.width = kWidth;
    camera.height = kHeight;
    MapTag tag;
    tag.key = {"tag36h11", 5};
    tag.size_m = kTagSize_m;
    map.tags = {tag};
    RandomStream random(static_cast<std::uint64_t>(tag_px));
    frame.exposure_s = 0.01;
    const double distance_m = kFocal_px * kTagSize_m / tag_px, pixel_m = distance_m / kFocal_px;
    for (std::size_t i = 0; i < kNumHypotheses; ++i) {
      MotionState state;
      const Eigen::Vector3d turn(0.1 + 0.05 * random.normal(), 0.4 + 0.05 * random.normal(), 0.3);
      state.pose = {rotation_exp(turn),
                    Eigen::Vector3d(8.0 * random.normal(), 8.0 * random.normal(), 0.0) * pixel_m +
                        Eigen::Vector3d(0.0, 0.0, distance_m)};
      // 9 pixels in an exposure: eight instants.
      const double speed = 9.0 * pixel_m / frame.exposure_s;
      state.velocity.head<3>() = state.pose.rotation().conjugate() * Eigen::Vector3d(speed, 0.0, 0.0);
      hypotheses.push_back(state);
      views.push_back(camera_from_tag_plane(state.pose, kTagSize_m));
    }
    film(random);
    reference.resize(grid.num_samples());
    sample_patch(frame.light[0].view(), camera.model, views[0], grid, reference);
  }

  /// The first hypothesis' view of the tag on a grey ground, with noise.
  void film(RandomStream& random) {
    PhotometricWorld world(camera, map, TrackMode::kJoint, kWidth, kHeight);
    ViewPath path(hypotheses[0], frame.exposure_s, world.mode);
    const TagPrediction truth(world, world.tags[0], path, 0);
    Image<float> light(kWidth, kHeight);
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x) {
        const PixelPrediction seen = truth.predict(world.rays.level(0)(x, y));
        light(x, y) = 0.55F * seen.light + 0.08F * seen.presence + 0.3F * (1.0F - seen.presence) +
                      static_cast<float>(0.01 * random.normal());
      }
    }
    frame.light.push_back(std::move(light));
  }

  Camera camera{.model = CameraModel({kFocal_px, kFocal_px, 640.0, 360.0}, NoDistortion{})};
  TagMap map;
  PatchGrid grid;
  PhotometricFrame frame;
  std::vector<MotionState> hypotheses;
  std::vector<Eigen::Matrix3d> views;
  std::vector<double> reference;
};

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
  options.coarse_sigmas = 3.0;
  JointLikelihood rejecting(setting.camera, setting.map, TrackMode::kJoint, options);
  for (JointLikelihood* one : {&likelihood, &rejecting}) one->set_reference(0, setting.reference);
  JointScores scores;
  const std::span<const MotionState> hypotheses = std::span(setting.hypotheses).first(count);
  const ParallelFor serial = parallel_for(1);
  for (const std::int64_t set : instruction_sets()) {
    ways.push_back({fmt::format("evaluate(), {}", hwy::TargetName(set)),
                    set,
                    [&] { likelihood.evaluate(setting.frame, hypotheses, serial, &scores); },
                    {}});
  }
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

/// As the kernel does it, sample by sample from one piece of memory to another.
void load_all(const PairedRows& rows, const std::vector<std::int32_t>& places) {
  alignas(64) std::array<std::uint64_t, kPatchBlock> quads;
  for (std::size_t first = 0; first < places.size(); first += kPatchBlock) {
    HWY_UNROLL(32)
    for (std::size_t k = 0; k < kPatchBlock; ++k) {
      std::memcpy(quads.data() + k, rows.pairs + places[first + k], sizeof quads[0]);
    }
    asm volatile("" : : "r"(quads.data()) : "memory");  // they are wanted
  }
}

/// What a patch costs at least: its loads, and its projections, without anything else.
void bench_limits(int repetitions) {
  const Setting setting(120.0);
  RowPairs pairs;
  pairs.start(setting.frame.light[0].view(), std::numeric_limits<double>::infinity());
  pairs.make({0, kWidth - 1, 0, kHeight - 2});
  const PairedRows rows = pairs.rows();
  PatchColumns columns;
  fill_columns(setting.grid, all_cells(setting.grid), {}, &columns);
  // Of some hypotheses again and again: where they look is not to be loaded from far away.
  constexpr std::size_t kNumPlaced = 10;
  std::vector<std::int32_t> places;
  for (const Eigen::Matrix3d& view : std::span(setting.views).first(kNumPlaced)) {
    for (std::size_t k = 0; k < setting.grid.num_samples(); ++k) {
      const Eigen::Vector3d point =
          view * Eigen::Vector3d(static_cast<double>(columns.u[k]), static_cast<double>(columns.v[k]), 1.0);
      const Eigen::Vector2d pixel = *setting.camera.model.project(point);
      places.push_back(static_cast<std::int32_t>(pixel.y()) * rows.stride +
                       static_cast<std::int32_t>(pixel.x()));
    }
  }
  std::array<float, 1024> ray_x{}, ray_y{};
  std::vector<Way> ways;
  ways.push_back({"loads alone",
                  0,
                  [&] {
                    for (std::size_t i = 0; i < kNumHypotheses / kNumPlaced; ++i) load_all(rows, places);
                  },
                  {}});
  for (const std::int64_t set : instruction_sets()) {
    ways.push_back({fmt::format("projection alone, {}", hwy::TargetName(set)),
                    set,
                    [&] {
                      for (const Eigen::Matrix3d& view : setting.views)
                        cast_patch(by_rows(view), columns.samples(0, columns.size()), ray_x.data(),
                                   ray_y.data());
                    },
                    {}});
  }
  take_turns(ways, repetitions);
  fmt::print(
      "\n### Limits, tag of 120 px\n\n| part of a patch | ns per sample | us per patch |\n|---|---|---|\n");
  for (const Way& way : ways) {
    const double patch_s = way.median_s() / static_cast<double>(kNumHypotheses);
    fmt::print("| {} | {:.2f} | {:.2f} |\n", way.name, patch_s / 1024.0 * 1e9, patch_s * 1e6);
  }
}

/// The kernels of the blur tracker's fit.
void bench_pixels(int repetitions) {
  constexpr std::size_t kNumPixels = 4096;
  const Setting setting(120.0);
  PhotometricWorld world(setting.camera, setting.map, TrackMode::kJoint, kWidth, kHeight);
  ViewPath path(setting.hypotheses[0], setting.frame.exposure_s, world.mode);
  const TagPrediction prediction(world, world.tags[0], path, 0);
  RandomStream random(3);
  std::vector<float> x(kNumPixels), y(kNumPixels), image(kNumPixels, 0.4F), inverse_sigma(kNumPixels, 1.0F);
  for (float* ray : {x.data(), y.data()})
    for (std::size_t i = 0; i < kNumPixels; ++i) ray[i] = static_cast<float>(random.uniform(-0.07, 0.07));
  std::vector<float> light(kNumPixels), presence(kNumPixels);
  const RayColumns rays = {x.data(), y.data(), kNumPixels};
  const ColourFactors colours = {.gain = 0.55F, .black = 0.08F, .background = 0.3F};
  double sink = 0.0;
  std::vector<Way> ways;
  ways.push_back({"predict, definition",
                  0,
                  [&] {
                    for (std::size_t i = 0; i < kNumPixels; ++i)
                      light[i] = prediction.predict({x[i], y[i]}).light;
                  },
                  {}});
  ways.push_back({"linearise, definition (Jacobian only)",
                  0,
                  [&] {
                    PixelJacobian jacobian;
                    for (std::size_t i = 0; i < kNumPixels; ++i)
                      light[i] = prediction.predict({x[i], y[i]}, jacobian).light;
                  },
                  {}});
  const auto add = [&](const std::string& name, std::int64_t set, const auto& predict,
                       const auto& linearise) {
    ways.push_back({"predict, " + name,
                    set,
                    [&, predict] { predict(prediction.texel_path(), rays, light.data(), presence.data()); },
                    {}});
    ways.push_back({"linearise, " + name,
                    set,
                    [&, linearise] {
                      sink += linearise(prediction.texel_path(), rays, image.data(), inverse_sigma.data(),
                                        colours, 14.0F, 2.5F)[0];
                    },
                    {}});
  };
  add("SCALAR (float)", 0, &apriltrack_scalar::predict_pixels, &apriltrack_scalar::linearise_pixels);
  for (const std::int64_t set : instruction_sets())
    add(hwy::TargetName(set), set, &predict_pixels, &linearise_pixels);
  take_turns(ways, repetitions);
  fmt::print("\n### Pixels of a fit, {} instants\n\n| kernel | ns per pixel and instant |\n|---|---|\n",
             prediction.num_instants());
  for (const Way& way : ways)
    fmt::print("| {} | {:.2f} |\n", way.name, way.median_s() * 1e9 / kNumPixels / prediction.num_instants());
  if (std::isnan(sink)) fmt::print("not a number\n");
}

}  // namespace
}  // namespace apriltrack

int main(int argc, char** argv) {
  const int repetitions = argc > 1 ? std::max(1, std::atoi(argv[1])) : 9;
  fmt::print("## Kernels, one core, medians of {}\n", repetitions);
  for (const bool has_pattern : {false, true})
    for (const double tag_px : {60.0, 120.0, 300.0})
      apriltrack::bench_patches(tag_px, has_pattern, repetitions);
  apriltrack::bench_limits(repetitions);
  apriltrack::bench_pixels(repetitions);
  return 0;
}
