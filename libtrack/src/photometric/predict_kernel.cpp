// Compiled once for each instruction set; Highway's foreach_target includes this file again and again.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "predict_kernel.cpp"
#include <hwy/foreach_target.h>  // IWYU pragma: keep
//
#include <hwy/highway.h>

#include <cstdint>

#include "pixel_kernels.h"
#include "vectors-inl.h"

HWY_BEFORE_NAMESPACE();
namespace apriltrack {
namespace HWY_NAMESPACE {
namespace {

/// Where rays meet a tag's plane at an instant. Two are under way at once, as in the patch kernels.
struct TexelStep {
  HWY_ALIGN std::int32_t index[kPixelBlock];
  HWY_ALIGN std::int32_t weights[kPixelBlock];  ///< Of left and right; none beside the texture.
  HWY_ALIGN float fy[kPixelBlock];
};

HWY_INLINE void locate(const TexelGrid& grid, const TexelInstant& instant, const RayColumns& rays,
                       std::size_t first, TexelStep& step) {
  const float* N = instant.texel_from_ray.data();
  const V zero = hn::Zero(d), width = all(static_cast<float>(grid.width));
  for (std::size_t i = 0; i < kPixelBlock; i += kLanes) {
    const V x = hn::LoadU(d, rays.x + first + i), y = hn::LoadU(d, rays.y + first + i);
    const V depth = reciprocal(row_of(N + 6, x, y));
    const V column = hn::Mul(depth, row_of(N, x, y)), row = hn::Mul(depth, row_of(N + 3, x, y));
    const M is_inside =
        hn::And(hn::And(hn::And(hn::Ge(column, zero), hn::Ge(row, zero)), hn::Gt(depth, zero)),
                hn::And(hn::Lt(column, all(grid.last_column)), hn::Lt(row, all(grid.last_row))));
    const V left = hn::Floor(column), top = hn::Floor(row);
    const V index = hn::IfThenElseZero(is_inside, hn::MulAdd(top, width, left));
    hn::Store(small_int(index), ints, step.index + i);
    hn::Store(hn::IfThenElseZero(is_inside, hn::Sub(row, top)), d, step.fy + i);
    hn::Store(hn::IfThenElseZero(hn::RebindMask(ints, is_inside), weight_pair(hn::Sub(column, left))), ints,
              step.weights + i);
  }
}

/// Light and presence of two neighbours in a row of texels, weighed.
struct RowSums {
  V light, presence;
};
HWY_INLINE RowSums row_sums(const Texel* texels, const std::int32_t* index, I weights) {
  const WordPairs pairs = load_pairs(texels, index);
  const I light = hn::BitCast(ints, low_halves(pairs.first, pairs.second));
  const I presence = hn::BitCast(ints, high_halves(pairs.first, pairs.second));
  return {hn::ConvertTo(d, pair_sum(weights, light)), hn::ConvertTo(d, pair_sum(weights, presence))};
}

/// Of all instants so far.
struct TexelSums {
  V light[kPixelBlock / kLanes], presence[kPixelBlock / kLanes];

  HWY_INLINE void clear() {
    for (std::size_t k = 0; k < kPixelBlock / kLanes; ++k) light[k] = presence[k] = hn::Zero(d);
  }
  HWY_INLINE void add(const TexelGrid& grid, const TexelStep& step) {
    for (std::size_t k = 0; k < kPixelBlock / kLanes; ++k) {
      const I weights = hn::Load(ints, step.weights + k * kLanes);
      const V fy = hn::Load(d, step.fy + k * kLanes);
      const std::int32_t* index = step.index + k * kLanes;
      const RowSums top = row_sums(grid.texels, index, weights);
      const RowSums bottom = row_sums(grid.texels + grid.width, index, weights);
      light[k] = hn::Add(light[k], hn::MulAdd(fy, hn::Sub(bottom.light, top.light), top.light));
      presence[k] =
          hn::Add(presence[k], hn::MulAdd(fy, hn::Sub(bottom.presence, top.presence), top.presence));
    }
  }
  HWY_INLINE void store(V share, float* light_out, float* presence_out) const {
    for (std::size_t k = 0; k < kPixelBlock / kLanes; ++k) {
      hn::StoreU(hn::Mul(light[k], share), d, light_out + k * kLanes);
      hn::StoreU(hn::Mul(presence[k], share), d, presence_out + k * kLanes);
    }
  }
};

void PredictPixels(const TexelPath& path, const RayColumns& rays, float* light, float* presence) {
  const std::size_t num_instants = path.instants.size();
  const V share = all(1.0F / (Texel::kOne * static_cast<float>(kWeightSteps * num_instants)));
  const TexelGrid grid = path.grid;
  TexelStep steps[2];
  TexelSums sums{};
  sums.clear();
  std::size_t t = 0;  // steps so far
  locate(grid, path.instants[0], rays, 0, steps[0]);
  for (std::size_t first = 0; first < rays.count; first += kPixelBlock) {
    for (std::size_t k = 0; k < num_instants; ++k, ++t) {
      const bool is_last = k + 1 == num_instants;
      const std::size_t next = is_last ? first + kPixelBlock : first;
      if (next < rays.count) locate(grid, path.instants[is_last ? 0 : k + 1], rays, next, steps[(t + 1) % 2]);
      sums.add(grid, steps[t % 2]);
    }
    sums.store(share, light + first, presence + first);
    sums.clear();
  }
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace apriltrack
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace apriltrack {

HWY_EXPORT(PredictPixels);

void predict_pixels(const TexelPath& path, const RayColumns& rays, float* light, float* presence) {
  HWY_DYNAMIC_DISPATCH(PredictPixels)(path, rays, light, presence);
}

}  // namespace apriltrack
#endif
