#include "blurred_picture.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace apriltrack {
namespace {

/// Beyond so many sigmas a Gaussian weighs less than 1e-6.
constexpr double kBlurReach = 5.0;
/// Under a blur that reaches farther, cells cannot be told apart: what is cut off then hardly matters.
constexpr int kMaxCells = 16;

/// How much of a one-dimensional Gaussian falls on each of the cells about its centre.
struct CellShares {
  int first = 0;
  int count = 0;
  std::array<double, kMaxCells> share, by_place, by_place2, by_log_sigma;
};

struct Step {
  double share, by_place, by_place2, by_log_sigma;
};

/// Of a Gaussian about `distance` beyond an edge: what lies beyond the edge.
Step beyond(const PrintedAxis& axis, double distance) {
  const double z = distance * axis.per_sigma;
  const auto [below, density] = axis.normal->at(z);
  const double by_place = density * axis.per_sigma, by_log_sigma = -z * density;
  return {below, by_place, by_log_sigma * axis.per_sigma * axis.per_sigma, by_log_sigma};
}

CellShares cell_shares(const PrintedAxis& axis, double place) {
  const double from_begin = place - axis.begin, centre = from_begin * axis.per_cell;
  int first =
      static_cast<int>(std::clamp(std::floor(centre - axis.reach), 0.0, static_cast<double>(axis.num_cells)));
  int last = static_cast<int>(std::clamp(std::floor(centre + axis.reach), -1.0, axis.num_cells - 1.0));
  if (last - first >= kMaxCells) {
    first = std::clamp(static_cast<int>(centre) - kMaxCells / 2, 0, axis.num_cells - kMaxCells);
    last = first + kMaxCells - 1;
  }
  CellShares shares;
  shares.first = first;
  Step left = beyond(axis, from_begin - first * axis.cell);
  for (int k = first; k <= last; ++k) {
    const Step right = beyond(axis, from_begin - (k + 1) * axis.cell);
    const auto i = static_cast<std::size_t>(shares.count++);
    shares.share[i] = left.share - right.share;
    shares.by_place[i] = left.by_place - right.by_place;
    shares.by_place2[i] = left.by_place2 - right.by_place2;
    shares.by_log_sigma[i] = left.by_log_sigma - right.by_log_sigma;
    left = right;
  }
  return shares;
}

PrintedAxis printed_axis(const TagPattern& pattern, double sigma) {
  const double cell = pattern.cell_size();
  return {&NormalTable::get(), -pattern.half_extent(),   cell, pattern.cells().width(), 1.0 / cell,
          1.0 / sigma,         kBlurReach * sigma / cell};
}

}  // namespace

BlurredPicture::BlurredPicture(const TagPattern& pattern, const PictureBlur& blur)
    : pattern_(pattern),
      blur_(blur),
      u_(printed_axis(pattern, blur.sigma_u)),
      v_(printed_axis(pattern, blur.sigma_v)) {}

PictureSample BlurredPicture::at(double u, double v) const {
  const CellShares columns = cell_shares(u_, u), rows = cell_shares(v_, v);
  const double first = blur_.covariance_uv, second = 0.5 * first * first;
  PictureSample sample;
  for (std::size_t r = 0; r < static_cast<std::size_t>(rows.count); ++r) {
    const float* cells = pattern_.cells().row(rows.first + static_cast<int>(r)) + columns.first;
    double light = 0.0, by_u = 0.0, by_u2 = 0.0, by_log_sigma = 0.0, known = 0.0;
    for (std::size_t c = 0; c < static_cast<std::size_t>(columns.count); ++c) {
      const auto cell = static_cast<double>(cells[c]);
      if (std::isnan(cell)) continue;
      known += columns.share[c];
      light += cell * columns.share[c];
      by_u += cell * columns.by_place[c];
      by_u2 += cell * columns.by_place2[c];
      by_log_sigma += cell * columns.by_log_sigma[c];
    }
    sample.known += rows.share[r] * known;
    sample.light +=
        rows.share[r] * light + first * rows.by_place[r] * by_u + second * rows.by_place2[r] * by_u2;
    sample.by_u += rows.share[r] * by_u;
    sample.by_v += rows.by_place[r] * light;
    sample.by_log_sigma_u += rows.share[r] * by_log_sigma;
    sample.by_log_sigma_v += rows.by_log_sigma[r] * light;
  }
  return sample;
}

}  // namespace apriltrack
