#include <fmt/format.h>

#include <array>
#include <cstring>
#include <span>

#include "bench_setting.h"
#include "patch_columns.h"
#include "patch_placement.h"

namespace apriltrack::bench {
namespace {

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

}  // namespace

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

}  // namespace apriltrack::bench
