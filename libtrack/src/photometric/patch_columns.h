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
  std::size_t num_samples = 0;  ///< Without what fills up the last block.
  double sum_squares = 0.0;     ///< Of the light; its mean is 0.
  bool has_rows = false;        ///< Whether each of the kernels' blocks has its v in common.

  SampleColumns samples(std::size_t first, std::size_t count) const {
    return {u.data() + first, v.data() + first, count, num_samples < u.size(), has_rows};
  }
  std::size_t size() const { return u.size(); }
};

/// Every cell of the grid.
std::vector<std::size_t> all_cells(const PatchGrid& grid);
/// One cell in each of 8 x 8 equal blocks of the grid, always the same: 64 samples that are spread over the
/// patch but lie on no lattice, which a tag's own cells might be in step with.
std::vector<std::size_t> stratified_cells(const PatchGrid& grid);

/// reference: values of all the grid's cells, NaN where unknown: such cells are left out. The others are made
/// zero mean and unit variance, a constant patch all 0. Empty: without a template.
void fill_columns(const PatchGrid& grid, std::span<const std::size_t> cells,
                  std::span<const double> reference, PatchColumns* columns);

/// The correlation that the sums tell, as `correlate` defines it, in single precision.
PatchMatch match_of(const PatchSums& sums);

}  // namespace apriltrack
