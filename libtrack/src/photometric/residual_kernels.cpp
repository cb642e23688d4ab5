// Compiled once for each instruction set; Highway's foreach_target includes this file again and again.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "residual_kernels.cpp"
#include <hwy/foreach_target.h>  // IWYU pragma: keep
//
#include <hwy/highway.h>

#include <cstdint>
#include <cstring>

#include "pixel_kernels.h"
#include "residual-inl.h"
#include "vectors-inl.h"

HWY_BEFORE_NAMESPACE();
namespace apriltrack {
namespace HWY_NAMESPACE {
namespace {

ColourSums SumColours(const SeenColumns& pixels, const float* weights) {
  V ll = hn::Zero(d), lp = ll, lb = ll, pp = ll, pb = ll, bb = ll, li = ll, pi = ll, bi = ll;
  for (std::size_t i = 0; i < pixels.count; i += kLanes) {
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

void ResidualSizes(const SeenColumns& pixels, const ColourFactors& colours, float* sizes) {
  for (std::size_t i = 0; i < pixels.count; i += kLanes) {
    const V r = residual(colours, hn::LoadU(d, pixels.light + i), hn::LoadU(d, pixels.presence + i),
                         hn::LoadU(d, pixels.image + i));
    hn::StoreU(hn::Abs(hn::Mul(r, hn::LoadU(d, pixels.inverse_sigma + i))), d, sizes + i);
  }
}

/// Bisects the bits: those of numbers that are not negative are in their order.
float SizeOfRank(const float* sizes, std::size_t count, std::size_t rank) {
  std::int32_t found = 0;
  for (std::int32_t bit = 1 << 30; bit > 0; bit >>= 1) {
    const I limit = hn::Set(ints, found | bit);
    I below = hn::Zero(ints);  // minus their number
    for (std::size_t i = 0; i < count; i += kLanes) {
      const I bits = hn::BitCast(ints, hn::LoadU(d, sizes + i));
      below = hn::Add(below, hn::VecFromMask(ints, hn::Lt(bits, limit)));
    }
    if (static_cast<std::size_t>(-hn::GetLane(hn::SumOfLanes(ints, below))) <= rank) found |= bit;
  }
  float size;
  std::memcpy(&size, &found, sizeof size);
  return size;
}

HWY_INLINE V residual_at(const SeenColumns& pixels, const ColourFactors& colours, std::size_t i) {
  return residual(colours, hn::LoadU(d, pixels.light + i), hn::LoadU(d, pixels.presence + i),
                  hn::LoadU(d, pixels.image + i));
}

double NoisePower(const SeenColumns& pixels, const ColourFactors& colours, const float* weights) {
  if (pixels.count == 0) return 0.0;
  // The first block by itself: nothing lies before it.
  HWY_ALIGN float first[kLanes];
  hn::Store(residual_at(pixels, colours, 0), d, first);
  float of_first = 0.0F;
  for (std::size_t i = 1; i < kLanes; ++i) {
    const float step = first[i] - first[i - 1];
    of_first += (weights[i] < weights[i - 1] ? weights[i] : weights[i - 1]) * step * step;
  }
  V sum = hn::Zero(d);
  for (std::size_t i = kLanes; i < pixels.count; i += kLanes) {
    const V step = hn::Sub(residual_at(pixels, colours, i), residual_at(pixels, colours, i - 1));
    const V weight = hn::Min(hn::LoadU(d, weights + i), hn::LoadU(d, weights + i - 1));
    sum = hn::MulAdd(hn::Mul(weight, step), step, sum);
  }
  return 0.5 * (static_cast<double>(of_first) + total(sum));
}

MisfitSums WeighResiduals(const SeenColumns& pixels, const ColourFactors& colours, float inverse_scale,
                          float reach, float* weights) {
  const V reach2 = all(reach * reach), middle = all(colours.black + 0.5F * colours.gain);
  V cost = hn::Zero(d), weight = cost, image1 = cost, image2 = cost, residual2 = cost;
  for (std::size_t i = 0; i < pixels.count; i += kLanes) {
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

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace apriltrack
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace apriltrack {

HWY_EXPORT(SumColours);
HWY_EXPORT(ResidualSizes);
HWY_EXPORT(SizeOfRank);
HWY_EXPORT(NoisePower);
HWY_EXPORT(WeighResiduals);

ColourSums sum_colours(const SeenColumns& pixels, const float* weights) {
  return HWY_DYNAMIC_DISPATCH(SumColours)(pixels, weights);
}

void residual_sizes(const SeenColumns& pixels, const ColourFactors& colours, float* sizes) {
  HWY_DYNAMIC_DISPATCH(ResidualSizes)(pixels, colours, sizes);
}

float size_of_rank(const float* sizes, std::size_t count, std::size_t rank) {
  return HWY_DYNAMIC_DISPATCH(SizeOfRank)(sizes, count, rank);
}

double noise_power(const SeenColumns& pixels, const ColourFactors& colours, const float* weights) {
  return HWY_DYNAMIC_DISPATCH(NoisePower)(pixels, colours, weights);
}

MisfitSums weigh_residuals(const SeenColumns& pixels, const ColourFactors& colours, float inverse_scale,
                           float reach, float* weights) {
  return HWY_DYNAMIC_DISPATCH(WeighResiduals)(pixels, colours, inverse_scale, reach, weights);
}

}  // namespace apriltrack
#endif
