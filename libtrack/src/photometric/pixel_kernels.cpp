// Compiled once for each instruction set; Highway's foreach_target includes this file again and again.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "pixel_kernels.cpp"
#include <hwy/foreach_target.h>  // IWYU pragma: keep
//
#include <hwy/highway.h>

#include <cstdint>
#include <cstring>

#include "pixel_kernels.h"

HWY_BEFORE_NAMESPACE();
namespace apriltrack {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using Floats = hn::CappedTag<float, kPixelBlock>;
using Ints = hn::RebindToSigned<Floats>;
using Words = hn::RebindToUnsigned<Floats>;
using V = hn::Vec<Floats>;
using W = hn::Vec<Words>;

constexpr Floats d;
constexpr Ints ints;
constexpr Words words;

HWY_INLINE V all(float value) {
  return hn::Set(d, value);
}

/// The four texels around each of many places.
struct TexelQuads {
  W top_left, top_right, bottom_left, bottom_right;
};

/// Loads two neighbours at a time: quicker than gather instructions on all that was measured.
HWY_INLINE TexelQuads load_quads(const TexelGrid& grid, W index) {
  constexpr std::size_t kMaxLanes = kPixelBlock;
  HWY_ALIGN std::uint32_t at[kMaxLanes];
  hn::Store(index, words, at);
  const std::size_t lanes = hn::Lanes(words);
#if HWY_TARGET == HWY_SCALAR
  TexelQuads quads;
  std::uint32_t pair[2];
  std::memcpy(pair, grid.texels + at[0], sizeof pair);
  quads.top_left = hn::Set(words, pair[0]);
  quads.top_right = hn::Set(words, pair[1]);
  std::memcpy(pair, grid.texels + at[0] + grid.width, sizeof pair);
  quads.bottom_left = hn::Set(words, pair[0]);
  quads.bottom_right = hn::Set(words, pair[1]);
  static_cast<void>(lanes);
  return quads;
#else
  HWY_ALIGN std::uint64_t top[kMaxLanes], bottom[kMaxLanes];
  for (std::size_t i = 0; i < lanes; ++i) {
    const Texel* place = grid.texels + at[i];
    std::memcpy(top + i, place, sizeof top[0]);
    std::memcpy(bottom + i, place + grid.width, sizeof bottom[0]);
  }
  const auto load = [&](const std::uint64_t* pairs, std::size_t half) {
    return hn::BitCast(words, hn::Load(hn::Repartition<std::uint64_t, Words>(), pairs + half * lanes / 2));
  };
  const W top_low = load(top, 0), top_high = load(top, 1);
  const W bottom_low = load(bottom, 0), bottom_high = load(bottom, 1);
  return {hn::ConcatEven(words, top_high, top_low), hn::ConcatOdd(words, top_high, top_low),
          hn::ConcatEven(words, bottom_high, bottom_low), hn::ConcatOdd(words, bottom_high, bottom_low)};
#endif
}

HWY_INLINE V light_of(W texel) {
  return hn::ConvertTo(d, hn::BitCast(ints, hn::And(texel, hn::Set(words, 0xFFFFU))));
}
HWY_INLINE V presence_of(W texel) {
  return hn::ConvertTo(d, hn::BitCast(ints, hn::ShiftRight<16>(texel)));
}

/// Values at the corners of a cell of texels, as a + x dx + y (dy + x dxy).
struct Bilinear {
  V a, dx, dy, dxy;
  HWY_INLINE V at(V x, V y) const { return hn::MulAdd(y, hn::MulAdd(x, dxy, dy), hn::MulAdd(x, dx, a)); }
  HWY_INLINE V by_x(V y) const { return hn::MulAdd(y, dxy, dx); }
  HWY_INLINE V by_y(V x) const { return hn::MulAdd(x, dxy, dy); }
};

HWY_INLINE Bilinear bilinear(V top_left, V top_right, V bottom_left, V bottom_right) {
  const V dx = hn::Sub(top_right, top_left), dy = hn::Sub(bottom_left, top_left);
  return {top_left, dx, dy, hn::Sub(hn::Sub(bottom_right, bottom_left), dx)};
}

/// Where the rays meet the plane at one instant.
struct Meeting {
  V column, row, depth;  ///< Zero texels where they miss the texture.
  V fx, fy;              ///< Within the texel.
  hn::Mask<Floats> is_inside;
  Bilinear light, presence;
};

HWY_INLINE V row_of(const float* matrix, V x, V y) {
  return hn::MulAdd(all(matrix[0]), x, hn::MulAdd(all(matrix[1]), y, all(matrix[2])));
}

HWY_INLINE Meeting meet(const TexelGrid& grid, const TexelInstant& instant, V x, V y) {
  const float* N = instant.texel_from_ray.data();
  Meeting at;
  at.depth = hn::Div(all(1.0F), row_of(N + 6, x, y));
  const V column = hn::Mul(at.depth, row_of(N, x, y)), row = hn::Mul(at.depth, row_of(N + 3, x, y));
  const V zero = hn::Zero(d);
  at.is_inside = hn::And(hn::And(hn::And(hn::Ge(column, zero), hn::Ge(row, zero)), hn::Gt(at.depth, zero)),
                         hn::And(hn::Lt(column, all(grid.last_column)), hn::Lt(row, all(grid.last_row))));
  at.column = hn::IfThenElseZero(at.is_inside, column);
  at.row = hn::IfThenElseZero(at.is_inside, row);
  const V left = hn::Floor(at.column), top = hn::Floor(at.row);
  at.fx = hn::Sub(at.column, left);
  at.fy = hn::Sub(at.row, top);
  // Exact: textures have fewer than 2^24 texels.
  const auto index = hn::ConvertTo(ints, hn::MulAdd(top, all(static_cast<float>(grid.width)), left));
  const TexelQuads quads = load_quads(grid, hn::BitCast(words, index));
  at.light = bilinear(light_of(quads.top_left), light_of(quads.top_right), light_of(quads.bottom_left),
                      light_of(quads.bottom_right));
  at.presence = bilinear(presence_of(quads.top_left), presence_of(quads.top_right),
                         presence_of(quads.bottom_left), presence_of(quads.bottom_right));
  return at;
}

void PredictPixels(const TexelPath& path, const RayColumns& rays, float* light, float* presence) {
  const V share = all(1.0F / (Texel::kOne * static_cast<float>(path.instants.size())));
  for (std::size_t i = 0; i < rays.count; i += hn::Lanes(d)) {
    const V x = hn::LoadU(d, rays.x + i), y = hn::LoadU(d, rays.y + i);
    V sum_light = hn::Zero(d), sum_presence = hn::Zero(d);
    for (const TexelInstant& instant : path.instants) {
      const Meeting at = meet(path.grid, instant, x, y);
      sum_light = hn::Add(sum_light, hn::IfThenElseZero(at.is_inside, at.light.at(at.fx, at.fy)));
      sum_presence = hn::Add(sum_presence, hn::IfThenElseZero(at.is_inside, at.presence.at(at.fx, at.fy)));
    }
    hn::StoreU(hn::Mul(sum_light, share), d, light + i);
    hn::StoreU(hn::Mul(sum_presence, share), d, presence + i);
  }
}

HWY_INLINE double total(V sum) {
  return static_cast<double>(hn::GetLane(hn::SumOfLanes(d, sum)));
}

ColourSums SumColours(const SeenColumns& pixels, const float* weights) {
  V ll = hn::Zero(d), lp = ll, lb = ll, pp = ll, pb = ll, bb = ll, li = ll, pi = ll, bi = ll;
  for (std::size_t i = 0; i < pixels.count; i += hn::Lanes(d)) {
    const V light = hn::LoadU(d, pixels.light + i), presence = hn::LoadU(d, pixels.presence + i);
    const V image = hn::LoadU(d, pixels.image + i), inverse = hn::LoadU(d, pixels.inverse_sigma + i);
    const V beyond = hn::Sub(all(1.0F), presence);
    const V w = weights != nullptr ? hn::LoadU(d, weights + i) : hn::Mul(inverse, inverse);
    const V wl = hn::Mul(w, light), wp = hn::Mul(w, presence), wb = hn::Mul(w, beyond);
    ll = hn::MulAdd(wl, light, ll);
    lp = hn::MulAdd(wl, presence, lp);
    lb = hn::MulAdd(wl, beyond, lb);
    pp = hn::MulAdd(wp, presence, pp);
    pb = hn::MulAdd(wp, beyond, pb);
    bb = hn::MulAdd(wb, beyond, bb);
    li = hn::MulAdd(wl, image, li);
    pi = hn::MulAdd(wp, image, pi);
    bi = hn::MulAdd(wb, image, bi);
  }
  return {total(ll), total(lp), total(lb), total(pp), total(pb), total(bb), total(li), total(pi), total(bi)};
}

HWY_INLINE V residual(const ColourFactors& colours, V light, V presence, V image) {
  const V on_tag =
      hn::MulAdd(all(colours.gain), light, hn::Mul(all(colours.black - colours.background), presence));
  return hn::Sub(hn::Add(on_tag, all(colours.background)), image);
}

void ResidualSizes(const SeenColumns& pixels, const ColourFactors& colours, float* sizes) {
  for (std::size_t i = 0; i < pixels.count; i += hn::Lanes(d)) {
    const V r = residual(colours, hn::LoadU(d, pixels.light + i), hn::LoadU(d, pixels.presence + i),
                         hn::LoadU(d, pixels.image + i));
    hn::StoreU(hn::Abs(hn::Mul(r, hn::LoadU(d, pixels.inverse_sigma + i))), d, sizes + i);
  }
}

MisfitSums WeighResiduals(const SeenColumns& pixels, const ColourFactors& colours, float inverse_scale,
                          float reach, float* weights) {
  const V reach2 = all(reach * reach), middle = all(colours.black + 0.5F * colours.gain);
  V cost = hn::Zero(d), weight = cost, image1 = cost, image2 = cost, residual2 = cost;
  for (std::size_t i = 0; i < pixels.count; i += hn::Lanes(d)) {
    const V image = hn::LoadU(d, pixels.image + i), inverse = hn::LoadU(d, pixels.inverse_sigma + i);
    const V r = residual(colours, hn::LoadU(d, pixels.light + i), hn::LoadU(d, pixels.presence + i), image);
    const V scaled = hn::Mul(hn::Mul(r, inverse), all(inverse_scale));
    const V r2 = hn::Mul(scaled, scaled);
    const V share = hn::Div(reach2, hn::Add(reach2, r2));
    const V w = hn::Mul(hn::Mul(inverse, inverse), hn::Mul(share, share));
    hn::StoreU(w, d, weights + i);
    cost = hn::MulAdd(share, r2, cost);
    weight = hn::Add(weight, w);
    const V off = hn::Sub(image, middle);
    image1 = hn::MulAdd(w, off, image1);
    image2 = hn::MulAdd(hn::Mul(w, off), off, image2);
    residual2 = hn::MulAdd(hn::Mul(w, r), r, residual2);
  }
  return {0.5 * total(cost), total(weight), total(image1), total(image2), total(residual2)};
}

/// Of a pixel's light, by the pose and by its rate: the translation's part, and the part that stands for the
/// rotation once the ray is known.
struct Derivatives {
  V light, presence;
  V by_translation[3], by_depth[3];            // sums of s and of depth s, s = d light / d place
  V rate_by_translation[3], rate_by_depth[3];  // the same times the instant's time
};

HWY_INLINE Derivatives differentiate(const TexelPath& path, V x, V y, V by_light, V by_presence) {
  Derivatives sum;
  sum.light = sum.presence = hn::Zero(d);
  for (int k = 0; k < 3; ++k) {
    sum.by_translation[k] = sum.by_depth[k] = hn::Zero(d);
    sum.rate_by_translation[k] = sum.rate_by_depth[k] = hn::Zero(d);
  }
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
      for (std::size_t i = 0; i < count; i += hn::Lanes(d)) {
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
    for (std::size_t i = 0; i < count; i += hn::Lanes(d)) {
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

HWY_EXPORT(PredictPixels);
HWY_EXPORT(SumColours);
HWY_EXPORT(ResidualSizes);
HWY_EXPORT(WeighResiduals);
HWY_EXPORT(LinearisePixels);

void predict_pixels(const TexelPath& path, const RayColumns& rays, float* light, float* presence) {
  HWY_DYNAMIC_DISPATCH(PredictPixels)(path, rays, light, presence);
}

ColourSums sum_colours(const SeenColumns& pixels, const float* weights) {
  return HWY_DYNAMIC_DISPATCH(SumColours)(pixels, weights);
}

void residual_sizes(const SeenColumns& pixels, const ColourFactors& colours, float* sizes) {
  HWY_DYNAMIC_DISPATCH(ResidualSizes)(pixels, colours, sizes);
}

MisfitSums weigh_residuals(const SeenColumns& pixels, const ColourFactors& colours, float inverse_scale,
                           float reach, float* weights) {
  return HWY_DYNAMIC_DISPATCH(WeighResiduals)(pixels, colours, inverse_scale, reach, weights);
}

GramMatrix linearise_pixels(const TexelPath& path, const RayColumns& rays, const float* image,
                            const float* inverse_sigma, const ColourFactors& colours, float inverse_scale,
                            float reach) {
  return HWY_DYNAMIC_DISPATCH(LinearisePixels)(path, rays, image, inverse_sigma, colours, inverse_scale,
                                               reach);
}

}  // namespace apriltrack
#endif
