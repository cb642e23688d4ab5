// What a pixel shows beyond what is predicted. Compiled once for each instruction set.
#if defined(APRILTRACK_PHOTOMETRIC_RESIDUAL_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef APRILTRACK_PHOTOMETRIC_RESIDUAL_INL_H_
#undef APRILTRACK_PHOTOMETRIC_RESIDUAL_INL_H_
#else
#define APRILTRACK_PHOTOMETRIC_RESIDUAL_INL_H_
#endif

#include "pixel_kernels.h"
#include "vectors-inl.h"

HWY_BEFORE_NAMESPACE();
namespace apriltrack {
namespace HWY_NAMESPACE {

static HWY_INLINE V residual(const ColourFactors& colours, V light, V presence, V image) {
  const V on_tag =
      hn::MulAdd(all(colours.gain), light, hn::Mul(all(colours.black - colours.background), presence));
  return hn::Sub(hn::Add(on_tag, all(colours.background)), image);
}

}  // namespace HWY_NAMESPACE
}  // namespace apriltrack
HWY_AFTER_NAMESPACE();

#endif
