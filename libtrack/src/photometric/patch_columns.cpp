#include "patch_columns.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "apriltrack/base/random.h"

namespace apriltrack {
namespace {

constexpr int kStrata = 8;  // a side

/// Zero mean and unit variance; all 0 for what `correlate` calls constant.
void standardise(std::span<const double> reference, std::span<const std::size_t> cells,
                 PatchColumns* columns) {
  double mean = 0.0, variance = 0.0;
  for (const std::size_t cell : cells) mean += std::isnan(reference[cell]) ? 0.0 : reference[cell];
  const double count = static_cast<double>(columns->num_samples);
  mean /= count;
  const auto off_mean = [&](std::size_t cell) {
    return std::isnan(reference[cell]) ? 0.0 : reference[cell] - mean;
  };
  for (const std::size_t cell : cells) variance += off_mean(cell) * off_mean(cell) / count;
  const bool is_constant = !(variance > 1e-12 * mean * mean);
  const double factor = is_constant ? 0.0 : 1.0 / std::sqrt(variance);
  for (const std::size_t cell : cells) {
    if (!std::isnan(reference[cell])) columns->light.push_back(static_cast<float>(factor * off_mean(cell)));
  }
  columns->sum_squares = is_constant ? 0.0 : count;
  columns->reference_squares = variance * count;
}

}  // namespace

std::vector<std::size_t> all_cells(const PatchGrid& grid) {
  std::vector<std::size_t> cells(grid.num_samples());
  std::iota(cells.begin(), cells.end(), std::size_t{0});
  return cells;
}

std::vector<std::size_t> quarter_of_cells(const PatchGrid& grid) {
  std::vector<std::size_t> cells;
  for (int row = 0; row < grid.size; row += 2)
    for (int column = row / 2 % 2; column < grid.size; column += 2)
      cells.push_back(static_cast<std::size_t>(row * grid.size + column));
  return cells;
}

double max_correlation(double part_correlation, double part_share) {
  const double positive = std::max(part_correlation, 0.0);
  const double unexplained = part_share * (1.0 - positive * positive);
  return unexplained > 0.0 ? std::sqrt(std::max(1.0 - unexplained, 0.0)) : 1.0;
}

std::vector<std::size_t> stratified_cells(const PatchGrid& grid) {
  constexpr std::uint64_t kSeed = 64;
  RandomStream random(kSeed);
  const int strata = std::min(kStrata, grid.size);
  const auto within = [&](int stratum) {
    const int first = stratum * grid.size / strata, last = (stratum + 1) * grid.size / strata;
    return first + static_cast<int>(random.uniform() * (last - first));
  };
  std::vector<std::size_t> cells;
  for (int i = 0; i < strata; ++i) {
    for (int k = 0; k < strata; ++k) {
      const int row = within(i), column = within(k);
      cells.push_back(static_cast<std::size_t>(row * grid.size + column));
    }
  }
  return cells;
}

void fill_columns(const PatchGrid& grid, std::span<const std::size_t> cells,
                  std::span<const double> reference, PatchColumns* columns) {
  *columns = {};
  for (const std::size_t cell : cells) {
    if (!reference.empty() && std::isnan(reference[cell])) continue;
    const int index = static_cast<int>(cell);
    columns->u.push_back(static_cast<float>(grid.coordinate(index % grid.size)));
    columns->v.push_back(static_cast<float>(grid.coordinate(index / grid.size)));
  }
  columns->num_samples = columns->u.size();
  if (!reference.empty()) standardise(reference, cells, columns);
  const std::size_t size = (columns->num_samples + kPatchBlock - 1) / kPatchBlock * kPatchBlock;
  constexpr float kNowhere = std::numeric_limits<float>::quiet_NaN();
  columns->u.resize(size, kNowhere);
  columns->v.resize(size, kNowhere);
  columns->light.resize(size, 0.0F);
  columns->has_rows = columns->num_samples == size;
  for (std::size_t i = 0; i < size; ++i)
    columns->has_rows = columns->has_rows && columns->v[i] == columns->v[i / kPatchBlock * kPatchBlock];
}

PatchMatch match_of(const PatchSums& sums) {
  PatchMatch match;
  match.num_samples = static_cast<int>(sums.count);
  if (match.num_samples < PatchMatch::kMinSamples) return match;
  const double aa = sums.aa - sums.a * sums.a / sums.count;
  const double bb = sums.bb - sums.b * sums.b / sums.count;
  const double ab = sums.ab - sums.a * sums.b / sums.count;
  // What rounding leaves of a constant patch is no picture.
  constexpr double kRounding = 1e-5;
  const bool is_constant = !(aa > kRounding * sums.aa && bb > kRounding * sums.bb);
  if (!is_constant) match.correlation = std::clamp(ab / std::sqrt(aa * bb), -1.0, 1.0);
  return match;
}

}  // namespace apriltrack
