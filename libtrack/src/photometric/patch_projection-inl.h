// Where the samples of a patch are in the image. Compiled once for each instruction set.
#if defined(APRILTRACK_PHOTOMETRIC_PATCH_PROJECTION_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef APRILTRACK_PHOTOMETRIC_PATCH_PROJECTION_INL_H_
#undef APRILTRACK_PHOTOMETRIC_PATCH_PROJECTION_INL_H_
#else
#define APRILTRACK_PHOTOMETRIC_PATCH_PROJECTION_INL_H_
#endif

#include <cstddef>

#include "patch_kernels.h"
#include "vectors-inl.h"

HWY_BEFORE_NAMESPACE();
namespace apriltrack {
namespace HWY_NAMESPACE {

/// factor[0] + s factor[1] + ... by Horner's rule.
template <std::size_t kCount>
static HWY_INLINE V polynomial(V s, const float (&factor)[kCount]) {
  V sum = all(factor[kCount - 1]);
  for (std::size_t k = kCount - 1; k-- > 0;) sum = hn::MulAdd(sum, s, all(factor[k]));
  return sum;
}

struct Pixel {
  V x, y;  ///< From the placement's base.
  M is_valid;
};

static HWY_INLINE Pixel project_radtan(const LensFactors& lens, const PatchPlacement& at, V X, V Y, V Z) {
  const auto& k = lens.coefficients;  // k1 k2 p1 p2 k3 k4 k5 k6
  const V inverse = reciprocal(Z);
  const V x = hn::Mul(X, inverse), y = hn::Mul(Y, inverse);
  const V xx = hn::Mul(x, x), yy = hn::Mul(y, y), xy2 = hn::Mul(all(2.0F), hn::Mul(x, y));
  const V s = hn::Add(xx, yy);
  V f = polynomial(s, {1.0F, k[0], k[1], k[4]});
  if (k[5] != 0.0F || k[6] != 0.0F || k[7] != 0.0F) f = hn::Div(f, polynomial(s, {1.0F, k[5], k[6], k[7]}));
  const V along_x = hn::MulAdd(all(2.0F), xx, s), along_y = hn::MulAdd(all(2.0F), yy, s);
  const V seen_x = hn::MulAdd(x, f, hn::MulAdd(all(k[2]), xy2, hn::Mul(all(k[3]), along_x)));
  const V seen_y = hn::MulAdd(y, f, hn::MulAdd(all(k[3]), xy2, hn::Mul(all(k[2]), along_y)));
  return {hn::MulAdd(all(lens.fx), seen_x, all(at.offset_x)),
          hn::MulAdd(all(lens.fy), seen_y, all(at.offset_y)),
          hn::And(hn::Gt(Z, hn::Zero(d)), hn::Lt(s, all(lens.limit)))};
}

/// atan2(y, x) of y >= 0, to 1e-7: the polynomial is atan(t) / t in t^2 at the Chebyshev nodes of [0, 1].
static HWY_INLINE V angle_of(V y, V x) {
  constexpr float kHalfPi = 1.57079633F, kPi = 3.14159265F;
  const V size = hn::Abs(x);
  const V t = hn::Div(hn::Min(y, size), hn::Max(y, size));
  V angle = hn::Mul(
      t, polynomial(hn::Mul(t, t), {0.999999984F, -0.333330668F, 0.199924836F, -0.142025705F, 0.106367541F,
                                    -0.0749544544F, 0.0425876075F, -0.0160050305F, 0.0028340643F}));
  angle = hn::IfThenElse(hn::Gt(y, size), hn::Sub(all(kHalfPi), angle), angle);
  return hn::IfThenElse(hn::Lt(x, hn::Zero(d)), hn::Sub(all(kPi), angle), angle);
}

static HWY_INLINE Pixel project_equidistant(const LensFactors& lens, const PatchPlacement& at, V X, V Y,
                                            V Z) {
  const auto& k = lens.coefficients;
  const V radius = hn::Sqrt(hn::MulAdd(X, X, hn::Mul(Y, Y)));
  const V angle = angle_of(radius, Z);
  const V seen = hn::Mul(angle, polynomial(hn::Mul(angle, angle), {1.0F, k[0], k[1], k[2], k[3]}));
  // On the axis X and Y are 0.
  const V scale = hn::IfThenElseZero(hn::Gt(radius, hn::Zero(d)), hn::Div(seen, radius));
  return {hn::MulAdd(all(lens.fx), hn::Mul(X, scale), all(at.offset_x)),
          hn::MulAdd(all(lens.fy), hn::Mul(Y, scale), all(at.offset_y)), hn::Lt(angle, all(lens.limit))};
}

/// A matrix that stays in registers where there are enough.
struct SpreadMatrix {
  V a, b, c, d, e, f, g, h, i;
};
static HWY_INLINE SpreadMatrix spread(const float* H) {
  return {all(H[0]), all(H[1]), all(H[2]), all(H[3]), all(H[4]), all(H[5]), all(H[6]), all(H[7]), all(H[8])};
}

template <LensKind kLens>
static HWY_INLINE Pixel project(const LensFactors& lens, const PatchPlacement& at, const SpreadMatrix& H, V u,
                                V v) {
  const V X = hn::MulAdd(H.a, u, hn::MulAdd(H.b, v, H.c));
  const V Y = hn::MulAdd(H.d, u, hn::MulAdd(H.e, v, H.f));
  const V Z = hn::MulAdd(H.g, u, hn::MulAdd(H.h, v, H.i));
  if constexpr (kLens == LensKind::kRadtan) return project_radtan(lens, at, X, Y, Z);
  if constexpr (kLens == LensKind::kEquidistant) return project_equidistant(lens, at, X, Y, Z);
  const V inverse = reciprocal(Z);
  return {hn::Mul(X, inverse), hn::Mul(Y, inverse), hn::Gt(Z, hn::Zero(d))};
}

}  // namespace HWY_NAMESPACE
}  // namespace apriltrack
HWY_AFTER_NAMESPACE();

#endif
