// Compiled once for each instruction set; Highway's foreach_target includes this file again and again.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "linearise_kernel.cpp"
#include <hwy/foreach_target.h>  // IWYU pragma: keep
//
#include <hwy/highway.h>

#include "pixel_kernels.h"
#include "residual-inl.h"
#include "texel_meeting-inl.h"
#include "vectors-inl.h"

HWY_BEFORE_NAMESPACE();
namespace apriltrack {
namespace HWY_NAMESPACE {
namespace {

/// Of a pixel's light, by the pose and by its rate: the translation's part, and the part that stands for the
/// rotation once the ray is known.
struct Derivatives {
  V light, presence;
  V by_translation[3], by_depth[3];            // sums of s and of depth s, s = d light / d place
  V rate_by_translation[3], rate_by_depth[3];  // the same times the instant's time
};

HWY_INLINE Derivatives differentiate(const TexelPath& path, V x, V y, V by_light, V by_presence) {
  const V zero = hn::Zero(d);
  Derivatives sum{zero, zero, {zero, zero, zero}, {zero, zero, zero}, {zero, zero, zero}, {zero, zero, zero}};
  for (const TexelInstant& instant : path.instants) {
    const Meeting at = meet(path.grid, instant, x, y);
    sum.light = hn::Add(sum.light, hn::IfThenElseZero(at.is_inside, at.light.at(at.fx, at.fy)));
    sum.presence = hn::Add(sum.presence, hn::IfThenElseZero(at.is_inside, at.presence.at(at.fx, at.fy)));
    const V by_column =
        hn::MulAdd(by_light, at.light.by_x(at.fy), hn::Mul(by_presence, at.presence.by_x(at.fy)));
    const V by_row =
        hn::MulAdd(by_light, at.light.by_y(at.fx), hn::Mul(by_presence, at.presence.by_y(at.fx)));
    const V a = hn::IfThenElseZero(at.is_inside, by_column), b = hn::IfThenElseZero(at.is_inside, by_row);
    const V along = hn::MulAdd(a, at.column, hn::Mul(b, at.row));
    const V depth = hn::IfThenElseZero(at.is_inside, at.depth), time = all(instant.time_s);
    const float* N = instant.texel_from_ray.data();
    for (int k = 0; k < 3; ++k) {
      // Moving the plane by dp where the ray meets it moves the texel met by (texel N_w - N_u) dp.
      const V step =
          hn::Sub(hn::Mul(along, all(N[6 + k])), hn::MulAdd(a, all(N[k]), hn::Mul(b, all(N[3 + k]))));
      const V timed = hn::Mul(time, step);
      sum.by_translation[k] = hn::Add(sum.by_translation[k], step);
      sum.by_depth[k] = hn::MulAdd(depth, step, sum.by_depth[k]);
      sum.rate_by_translation[k] = hn::Add(sum.rate_by_translation[k], timed);
      sum.rate_by_depth[k] = hn::MulAdd(depth, timed, sum.rate_by_depth[k]);
    }
  }
  return sum;
}

constexpr std::size_t kColumns = 16;
constexpr std::size_t kStrip = 8 * kPixelBlock;  // pixels whose rows are held at once

/// Three of [translation; rotation]: the rotation's are ray x (sum of depth s).
HWY_INLINE void store_motion(const V* by_translation, const V* by_depth, V x, V y, V factor, float* rows) {
  const V turn[3] = {hn::Sub(hn::Mul(y, by_depth[2]), by_depth[1]),
                     hn::Sub(by_depth[0], hn::Mul(x, by_depth[2])),
                     hn::Sub(hn::Mul(x, by_depth[1]), hn::Mul(y, by_depth[0]))};
  for (std::size_t k = 0; k < 3; ++k) {
    hn::StoreU(hn::Mul(factor, by_translation[k]), d, rows + k * kStrip);
    hn::StoreU(hn::Mul(factor, turn[k]), d, rows + (k + 3) * kStrip);
  }
}

/// Adds the products of all columns with each other, tile by tile of four: the upper triangle of tiles.
void add_gram(const float* rows, std::size_t count, GramMatrix* gram) {
  for (std::size_t p = 0; p < kColumns; p += 4) {
    for (std::size_t q = p; q < kColumns; q += 4) {
      V sums[4][4];
      for (auto& line : sums)
        for (V& sum : line) sum = hn::Zero(d);
      for (std::size_t i = 0; i < count; i += kLanes) {
        const V right[4] = {hn::LoadU(d, rows + q * kStrip + i), hn::LoadU(d, rows + (q + 1) * kStrip + i),
                            hn::LoadU(d, rows + (q + 2) * kStrip + i),
                            hn::LoadU(d, rows + (q + 3) * kStrip + i)};
        for (std::size_t a = 0; a < 4; ++a) {
          const V left = hn::LoadU(d, rows + (p + a) * kStrip + i);
          for (std::size_t b = 0; b < 4; ++b) sums[a][b] = hn::MulAdd(left, right[b], sums[a][b]);
        }
      }
      for (std::size_t a = 0; a < 4; ++a)
        for (std::size_t b = 0; b < 4; ++b) (*gram)[(p + a) * kColumns + q + b] += total(sums[a][b]);
    }
  }
}

GramMatrix LinearisePixels(const TexelPath& path, const RayColumns& rays, const float* image,
                           const float* inverse_sigma, const ColourFactors& colours, float inverse_scale,
                           float reach) {
  const V share = all(1.0F / (Texel::kOne * static_cast<float>(path.instants.size())));
  const V by_light = all(colours.gain), by_presence = all(colours.black - colours.background);
  const V reach2 = all(reach * reach);
  HWY_ALIGN float rows[kColumns * kStrip];
  GramMatrix gram{};
  for (std::size_t begin = 0; begin < rays.count; begin += kStrip) {
    const std::size_t count = rays.count - begin < kStrip ? rays.count - begin : kStrip;
    for (std::size_t i = 0; i < count; i += kLanes) {
      const V x = hn::LoadU(d, rays.x + begin + i), y = hn::LoadU(d, rays.y + begin + i);
      const Derivatives sum = differentiate(path, x, y, by_light, by_presence);
      const V light = hn::Mul(sum.light, share), presence = hn::Mul(sum.presence, share);
      const V inverse = hn::Mul(hn::LoadU(d, inverse_sigma + begin + i), all(inverse_scale));
      const V r = hn::Mul(residual(colours, light, presence, hn::LoadU(d, image + begin + i)), inverse);
      const V root = hn::Div(reach2, hn::MulAdd(r, r, reach2));  // of the weight
      const V factor = hn::Mul(inverse, root);
      const V of_motion = hn::Mul(factor, share);
      store_motion(sum.by_translation, sum.by_depth, x, y, of_motion, rows + i);
      store_motion(sum.rate_by_translation, sum.rate_by_depth, x, y, of_motion, rows + 6 * kStrip + i);
      hn::StoreU(hn::Mul(factor, light), d, rows + 12 * kStrip + i);
      hn::StoreU(hn::Mul(factor, presence), d, rows + 13 * kStrip + i);
      hn::StoreU(hn::Mul(factor, hn::Sub(all(1.0F), presence)), d, rows + 14 * kStrip + i);
      hn::StoreU(hn::Mul(root, r), d, rows + 15 * kStrip + i);
    }
    add_gram(rows, count, &gram);
  }
  for (std::size_t i = 0; i < kColumns; ++i)
    for (std::size_t k = 0; k < i; ++k) gram[i * kColumns + k] = gram[k * kColumns + i];
  return gram;
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace apriltrack
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace apriltrack {

HWY_EXPORT(LinearisePixels);

GramMatrix linearise_pixels(const TexelPath& path, const RayColumns& rays, const float* image,
                            const float* inverse_sigma, const ColourFactors& colours, float inverse_scale,
                            float reach) {
  return HWY_DYNAMIC_DISPATCH(LinearisePixels)(path, rays, image, inverse_sigma, colours, inverse_scale,
                                               reach);
}

}  // namespace apriltrack
#endif
