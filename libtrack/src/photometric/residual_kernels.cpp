// Compiled once for each instruction set; Highway's foreach_target includes this file again and again.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "residual_kernels.cpp"
#include <hwy/foreach_target.h>  // IWYU pragma: keep
//
#include <hwy/highway.h>

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
HWY_EXPORT(WeighResiduals);

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

}  // namespace apriltrack
#endif
