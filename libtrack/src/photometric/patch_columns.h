#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "apriltrack/photometric/patch.h"
#include "patch_kernels.h"

namespace apriltrack {

/// Samples of a patch as the kernels take them, with the template's light there.
struct PatchColumns {
  std::vector<float> u, v, light;
  std::size_t num_samples = 0;     ///< Without what fills up the last block.
  double sum_squares = 0.0;        ///< Of the light; its mean is 0.
  double reference_squares = 0.0;  ///< Of the reference itself, about its mean.
  bool has_rows = false;           ///< Whether each of the kernels' blocks has its v in common.

  SampleColumns samples(std::size_t first, std::size_t count) const {
    return {u.data() + first, v.data() + first, count, num_samples < u.size(), has_rows};
  }
  std::size_t size() const { return u.size(); }
};

/// Every cell of the grid.
std::vector<std::size_t> all_cells(const PatchGrid& grid);
/// Every other cell of every other row.
std::vector<std::size_t> quarter_of_cells(const PatchGrid& grid);
/// One cell in each of 8 x 8 equal blocks of the grid, always the same: 64 samples that are spread over the
/// patch but lie on no lattice, which a tag's own cells might be in step with.
std::vector<std::size_t> stratified_cells(const PatchGrid& grid);

/// reference: values of all the grid's cells, NaN where unknown: such cells are left out. The others are made
/// zero mean and unit variance, a constant patch all 0. Empty: without a template.
void fill_columns(const PatchGrid& grid, std::span<const std::size_t> cells,
                  std::span<const double> reference, PatchColumns* columns);

/// What the correlation c of a patch can be at most when a part of its samples has correlation c1, and the
/// squares of the template about its mean are in that part a share q of those in all, or more. What the best
/// gain g >= 0 and offset leave of the template's squares is (1 - c^2) of all for c > 0; on the part it is
/// no less than what gain and offset of the part's own leave there, (1 - max(c1, 0)^2) q:
///   c^2 <= 1 - q (1 - max(c1, 0)^2)
double max_correlation(double part_correlation, double part_share);

/// The correlation that the sums tell, as `correlate` defines it, in single precision.
PatchMatch match_of(const PatchSums& sums);

}  // namespace apriltrack
