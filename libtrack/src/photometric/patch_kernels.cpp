// Compiled once for each instruction set; Highway's foreach_target includes this file again and again.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "patch_kernels.cpp"
#include <hwy/foreach_target.h>  // IWYU pragma: keep
//
#include <hwy/highway.h>

#include <cstdint>
#include <cstring>

#include "patch_kernels.h"

HWY_BEFORE_NAMESPACE();
namespace apriltrack {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using Floats = hn::CappedTag<float, kPixelBlock>;
using Ints = hn::RebindToSigned<Floats>;
using V = hn::Vec<Floats>;
using M = hn::Mask<Floats>;

constexpr Floats d;
constexpr Ints ints;

HWY_INLINE V all(float value) {
  return hn::Set(d, value);
}

/// factor[0] + s factor[1] + ... by Horner's rule.
template <std::size_t kCount>
HWY_INLINE V polynomial(V s, const float (&factor)[kCount]) {
  V sum = all(factor[kCount - 1]);
  for (std::size_t k = kCount - 1; k-- > 0;) sum = hn::MulAdd(sum, s, all(factor[k]));
  return sum;
}

struct Pixel {
  V x, y;  ///< From the placement's base.
  M is_valid;
};

HWY_INLINE Pixel project_radtan(const LensFactors& lens, const PatchPlacement& at, V X, V Y, V Z) {
  const auto& k = lens.coefficients;  // k1 k2 p1 p2 k3 k4 k5 k6
  const V inverse = hn::Div(all(1.0F), Z);
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
HWY_INLINE V angle_of(V y, V x) {
  constexpr float kHalfPi = 1.57079633F, kPi = 3.14159265F;
  const V size = hn::Abs(x);
  const V t = hn::Div(hn::Min(y, size), hn::Max(y, size));
  V angle = hn::Mul(
      t, polynomial(hn::Mul(t, t), {0.999999984F, -0.333330668F, 0.199924836F, -0.142025705F, 0.106367541F,
                                    -0.0749544544F, 0.0425876075F, -0.0160050305F, 0.0028340643F}));
  angle = hn::IfThenElse(hn::Gt(y, size), hn::Sub(all(kHalfPi), angle), angle);
  return hn::IfThenElse(hn::Lt(x, hn::Zero(d)), hn::Sub(all(kPi), angle), angle);
}

HWY_INLINE Pixel project_equidistant(const LensFactors& lens, const PatchPlacement& at, V X, V Y, V Z) {
  const auto& k = lens.coefficients;
  const V radius = hn::Sqrt(hn::MulAdd(X, X, hn::Mul(Y, Y)));
  const V angle = angle_of(radius, Z);
  const V seen = hn::Mul(angle, polynomial(hn::Mul(angle, angle), {1.0F, k[0], k[1], k[2], k[3]}));
  // On the axis X and Y are 0.
  const V scale = hn::IfThenElseZero(hn::Gt(radius, hn::Zero(d)), hn::Div(seen, radius));
  return {hn::MulAdd(all(lens.fx), hn::Mul(X, scale), all(at.offset_x)),
          hn::MulAdd(all(lens.fy), hn::Mul(Y, scale), all(at.offset_y)), hn::Lt(angle, all(lens.limit))};
}

HWY_INLINE V row_of(const float* matrix, V u, V v) {
  return hn::MulAdd(all(matrix[0]), u, hn::MulAdd(all(matrix[1]), v, all(matrix[2])));
}

/// A matrix that stays in registers where there are enough.
struct SpreadMatrix {
  V a, b, c, d, e, f, g, h, i;
};
HWY_INLINE SpreadMatrix spread(const float* H) {
  return {all(H[0]), all(H[1]), all(H[2]), all(H[3]), all(H[4]), all(H[5]), all(H[6]), all(H[7]), all(H[8])};
}

template <LensKind kLens>
HWY_INLINE Pixel project(const LensFactors& lens, const PatchPlacement& at, const SpreadMatrix& H, V u, V v) {
  const V X = hn::MulAdd(H.a, u, hn::MulAdd(H.b, v, H.c));
  const V Y = hn::MulAdd(H.d, u, hn::MulAdd(H.e, v, H.f));
  const V Z = hn::MulAdd(H.g, u, hn::MulAdd(H.h, v, H.i));
  if constexpr (kLens == LensKind::kRadtan) return project_radtan(lens, at, X, Y, Z);
  if constexpr (kLens == LensKind::kEquidistant) return project_equidistant(lens, at, X, Y, Z);
  const V inverse = hn::Div(all(1.0F), Z);
  return {hn::Mul(X, inverse), hn::Mul(Y, inverse), hn::Gt(Z, hn::Zero(d))};
}

/// Samples on their way through the three steps below. Three blocks are under way at once: what a step
/// writes in small pieces, the next reads in large ones, and a processor waits for its own writes to arrive
/// when it reads them so soon.
struct Block {
  alignas(64) float fx[kPatchBlock];
  alignas(64) float fy[kPatchBlock];
  alignas(64) float is_seen[kPatchBlock];
  alignas(64) std::int32_t pair[kPatchBlock];
  alignas(64) float quads[4 * kPatchBlock];
};

struct LaneSums {
  V count, a, b, aa, bb, ab;
};

template <LensKind kLens, bool kIsMasked>
class PatchSummation {
 public:
  PatchSummation(const PairedRows& image, const LensFactors& lens, const PatchPlacement& placement,
                 const SampleColumns& samples, const TemplateColumns& expected)
      : image_(image), lens_(lens), at_(placement), samples_(samples), expected_(expected) {}

  HWY_INLINE PatchSums run() {
    const std::size_t num_blocks = samples_.count / kPatchBlock;
    Block blocks[4];  // the fourth only so that their number is a power of two
    const SpreadMatrix H = spread(at_.from_plane.data());
    const V zero = hn::Zero(d);
    LaneSums sums = {zero, zero, zero, zero, zero, zero};
    const auto locate_block = [&](std::size_t j) HWY_ATTR { locate(j * kPatchBlock, H, blocks[j % 4]); };
    const auto fetch_block = [&](std::size_t j) HWY_ATTR { fetch(blocks[j % 4]); };
    const auto add_block = [&](std::size_t j) HWY_ATTR { add(j * kPatchBlock, blocks[j % 4], sums); };
    for (std::size_t j = 0; j < num_blocks + 2; ++j) {
      if (j < num_blocks) locate_block(j);
      if (j >= 1 && j <= num_blocks) fetch_block(j - 1);
      if (j >= 2) add_block(j - 2);
    }
    if constexpr (!kIsMasked) {
      return {static_cast<double>(samples_.count),
              total(sums.a),
              expected_.sum,
              total(sums.aa),
              expected_.sum_squares,
              total(sums.ab)};
    }
    return {total(sums.count), total(sums.a), total(sums.b), total(sums.aa), total(sums.bb), total(sums.ab)};
  }

 private:
  /// Where the samples are in the image.
  HWY_INLINE void locate(std::size_t first, const SpreadMatrix& H, Block& block) const {
    const V last_left = all(static_cast<float>(image_.width - 2 - at_.base_x));
    const V last_top = all(static_cast<float>(image_.height - 2 - at_.base_y));
    const V stride = all(static_cast<float>(image_.stride));
    const bool is_small = static_cast<std::int64_t>(image_.stride) * image_.height < (1 << 24);
    for (std::size_t i = 0; i < kPatchBlock; i += hn::Lanes(d)) {
      Pixel pixel = project<kLens>(lens_, at_, H, hn::LoadU(d, samples_.u + first + i),
                                   hn::LoadU(d, samples_.v + first + i));
      if constexpr (kIsMasked) {
        const V one = all(1.0F);
        const M in_x = hn::And(hn::Ge(pixel.x, all(static_cast<float>(-at_.base_x))),
                               hn::Le(pixel.x, hn::Add(last_left, one)));
        const M in_y = hn::And(hn::Ge(pixel.y, all(static_cast<float>(-at_.base_y))),
                               hn::Le(pixel.y, hn::Add(last_top, one)));
        const M is_seen = hn::And(pixel.is_valid, hn::And(in_x, in_y));
        hn::Store(hn::IfThenElseZero(is_seen, one), d, block.is_seen + i);
        pixel.x = hn::IfThenElseZero(is_seen, pixel.x);
        pixel.y = hn::IfThenElseZero(is_seen, pixel.y);
      }
      // On the last row and column the pixel beyond has no weight, the one before neither.
      V left = hn::Floor(pixel.x), top = hn::Floor(pixel.y);
      if constexpr (kIsMasked) {
        left = hn::Min(left, last_left);
        top = hn::Min(top, last_top);
      }
      hn::Store(hn::Sub(pixel.x, left), d, block.fx + i);
      hn::Store(hn::Sub(pixel.y, top), d, block.fy + i);
      // One conversion where the number fits a float's 24 bits.
      const auto pair = is_small ? hn::ConvertTo(ints, hn::MulAdd(top, stride, left))
                                 : hn::Add(hn::Mul(hn::ConvertTo(ints, top), hn::Set(ints, image_.stride)),
                                           hn::ConvertTo(ints, left));
      hn::Store(pair, ints, block.pair + i);
    }
  }

  /// The pixels around them, in an order that add() makes columns of. One load for each beats gather
  /// instructions, and 8 bytes from each of two rows (docs/algorithms/paper_filter.md, section 7).
  HWY_INLINE void fetch(Block& block) const {
    const std::size_t lanes = hn::Lanes(d);
    const float* base =
        image_.pairs + 2 * (static_cast<std::ptrdiff_t>(at_.base_y) * image_.stride + at_.base_x);
    HWY_UNROLL(32)
    for (std::size_t i = 0; i < kPatchBlock; ++i) {
      const std::size_t lane = i % lanes;
      const std::size_t slot = lanes < 4 ? i : i - lane + lane % 4 * (lanes / 4) + lane / 4;
      std::memcpy(block.quads + 4 * slot, base + 2 * static_cast<std::ptrdiff_t>(block.pair[i]),
                  4 * sizeof(float));
    }
  }

  struct Corners {
    V top_left, bottom_left, top_right, bottom_right;
  };
  HWY_INLINE Corners corners(const float* quads) const {
#if HWY_TARGET == HWY_SCALAR
    return {all(quads[0]), all(quads[1]), all(quads[2]), all(quads[3])};
#else
    const std::size_t lanes = hn::Lanes(d);
    const V q0 = hn::Load(d, quads), q1 = hn::Load(d, quads + lanes);
    const V q2 = hn::Load(d, quads + 2 * lanes), q3 = hn::Load(d, quads + 3 * lanes);
    const hn::Repartition<std::uint64_t, Floats> twos;
    const auto two = [&](V x) HWY_ATTR { return hn::BitCast(twos, x); };
    const auto left01 = two(hn::InterleaveLower(d, q0, q1)), left23 = two(hn::InterleaveLower(d, q2, q3));
    const auto right01 = two(hn::InterleaveUpper(d, q0, q1)), right23 = two(hn::InterleaveUpper(d, q2, q3));
    return {hn::BitCast(d, hn::InterleaveLower(twos, left01, left23)),
            hn::BitCast(d, hn::InterleaveUpper(twos, left01, left23)),
            hn::BitCast(d, hn::InterleaveLower(twos, right01, right23)),
            hn::BitCast(d, hn::InterleaveUpper(twos, right01, right23))};
#endif
  }

  HWY_INLINE void add(std::size_t first, const Block& block, LaneSums& sums) const {
    for (std::size_t i = 0; i < kPatchBlock; i += hn::Lanes(d)) {
      const Corners at = corners(block.quads + 4 * i);
      const V fx = hn::Load(d, block.fx + i), fy = hn::Load(d, block.fy + i);
      const V top = hn::MulAdd(fx, hn::Sub(at.top_right, at.top_left), at.top_left);
      const V bottom = hn::MulAdd(fx, hn::Sub(at.bottom_right, at.bottom_left), at.bottom_left);
      V a = hn::Sub(hn::MulAdd(fy, hn::Sub(bottom, top), top), all(at_.origin_light));
      V b = hn::LoadU(d, expected_.light + first + i);
      if constexpr (kIsMasked) {
        const V brightest =
            hn::Max(hn::Max(at.top_left, at.top_right), hn::Max(at.bottom_left, at.bottom_right));
        M is_known = hn::And(hn::Gt(hn::Load(d, block.is_seen + i), hn::Zero(d)),
                             hn::Le(brightest, all(image_.max_light)));
        if (expected_.presence != nullptr) {
          const V presence = hn::LoadU(d, expected_.presence + first + i);
          is_known = hn::And(is_known, hn::Ge(presence, all(TemplateColumns::kLeastPresence)));
          b = hn::Add(b, hn::Sub(all(1.0F - kMiddle), presence));
        }
        a = hn::IfThenElseZero(is_known, a);
        b = hn::IfThenElseZero(is_known, b);
        sums.count = hn::Add(sums.count, hn::IfThenElseZero(is_known, all(1.0F)));
        sums.b = hn::Add(sums.b, b);
        sums.bb = hn::MulAdd(b, b, sums.bb);
      }
      sums.a = hn::Add(sums.a, a);
      sums.aa = hn::MulAdd(a, a, sums.aa);
      sums.ab = hn::MulAdd(a, b, sums.ab);
    }
  }

  static HWY_INLINE double total(V sum) {
    return static_cast<double>(hn::GetLane(hn::SumOfLanes(d, sum)));
  }

  static constexpr float kMiddle = 0.5F;  ///< Taken off patterns, for the sums' sake.

  const PairedRows image_;  // copies: what is written elsewhere then cannot change them
  const LensFactors& lens_;
  const PatchPlacement at_;
  const SampleColumns samples_;
  const TemplateColumns expected_;
};

PatchSums SumPatch(const PairedRows& image, const LensFactors& lens, const PatchPlacement& placement,
                   const SampleColumns& samples, const TemplateColumns& expected) {
  const bool is_whole = placement.is_inside && !samples.is_padded && expected.presence == nullptr &&
                        !(image.max_light < hwy::HighestValue<float>());
  switch (lens.kind) {
    case LensKind::kRadtan:
      return PatchSummation<LensKind::kRadtan, true>(image, lens, placement, samples, expected).run();
    case LensKind::kEquidistant:
      return PatchSummation<LensKind::kEquidistant, true>(image, lens, placement, samples, expected).run();
    case LensKind::kPinhole:
      break;
  }
  if (is_whole)
    return PatchSummation<LensKind::kPinhole, false>(image, lens, placement, samples, expected).run();
  return PatchSummation<LensKind::kPinhole, true>(image, lens, placement, samples, expected).run();
}

void CastPatch(const std::array<float, 9>& camera_from_plane, const SampleColumns& samples, float* ray_x,
               float* ray_y) {
  const float* H = camera_from_plane.data();
  for (std::size_t i = 0; i < samples.count; i += hn::Lanes(d)) {
    const V u = hn::LoadU(d, samples.u + i), v = hn::LoadU(d, samples.v + i);
    const V Z = row_of(H + 6, u, v);
    const V inverse = hn::IfThenElse(hn::Gt(Z, hn::Zero(d)), hn::Div(all(1.0F), Z), hn::NaN(d));
    hn::StoreU(hn::Mul(row_of(H, u, v), inverse), d, ray_x + i);
    hn::StoreU(hn::Mul(row_of(H + 3, u, v), inverse), d, ray_y + i);
  }
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace apriltrack
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace apriltrack {

HWY_EXPORT(SumPatch);
HWY_EXPORT(CastPatch);

PatchSums sum_patch(const PairedRows& image, const LensFactors& lens, const PatchPlacement& placement,
                    const SampleColumns& samples, const TemplateColumns& expected) {
  return HWY_DYNAMIC_DISPATCH(SumPatch)(image, lens, placement, samples, expected);
}

void cast_patch(const std::array<float, 9>& camera_from_plane, const SampleColumns& samples, float* ray_x,
                float* ray_y) {
  HWY_DYNAMIC_DISPATCH(CastPatch)(camera_from_plane, samples, ray_x, ray_y);
}

}  // namespace apriltrack
#endif
