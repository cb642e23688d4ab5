// Compiled once for each instruction set; Highway's foreach_target includes this file again and again.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "patch_kernels.cpp"
#include <hwy/foreach_target.h>  // IWYU pragma: keep
//
#include <hwy/highway.h>

#include <cstdint>

#include "patch_kernels.h"
#include "patch_projection-inl.h"
#include "vectors-inl.h"

HWY_BEFORE_NAMESPACE();
namespace apriltrack {
namespace HWY_NAMESPACE {
namespace {

/// Where samples are. Two blocks are under way at once: a processor has one's pixels to load while it
/// reckons where the next one's are.
struct Block {
  alignas(64) float fx[kPatchBlock];
  alignas(64) std::int32_t weights[kPatchBlock];  ///< Of the upper and the lower pixels.
  alignas(64) float is_seen[kPatchBlock];
  alignas(64) std::int32_t pair[kPatchBlock];
};

struct LaneSums {
  V count, a, b, aa, bb, ab;
};

/// Which samples there are: any, or blocks of them that have their v in common and have all to be seen.
enum class PatchKind { kAny, kWhole, kWholeRows };

template <LensKind kLens, PatchKind kKind>
class PatchSummation {
 public:
  PatchSummation(const PairedRows& image, const LensFactors& lens, const PatchPlacement& placement,
                 const SampleColumns& samples, const TemplateColumns& expected)
      : image_(image),
        lens_(lens),
        at_(placement),
        samples_(samples),
        expected_(expected),
        origin_(static_cast<float>(kWeightSteps) * image.code_of(placement.origin_light)) {}

  HWY_INLINE PatchSums run() {
    const std::size_t num_blocks = samples_.count / kPatchBlock;
    Block blocks[2];
    const SpreadMatrix H = spread(at_.from_plane.data());
    const V zero = hn::Zero(d);
    LaneSums sums = {zero, zero, zero, zero, zero, zero};
    for (std::size_t j = 0; j <= num_blocks; ++j) {
      if (j < num_blocks) locate(j * kPatchBlock, H, blocks[j % 2]);
      if (j > 0) add((j - 1) * kPatchBlock, blocks[(j - 1) % 2], sums);
    }
    const double unit = image_.step / kWeightSteps;
    const double a = unit * total(sums.a), aa = unit * unit * total(sums.aa), ab = unit * total(sums.ab);
    if constexpr (!kIsMasked)
      return {static_cast<double>(samples_.count), a, expected_.sum, aa, expected_.sum_squares, ab};
    return {total(sums.count), a, total(sums.b), aa, total(sums.bb), ab};
  }

 private:
  /// Where the samples are in the image.
  HWY_INLINE void locate(std::size_t first, const SpreadMatrix& H, Block& block) const {
    const V last_left = all(static_cast<float>(image_.width - 2 - at_.base_x));
    const V last_top = all(static_cast<float>(image_.height - 2 - at_.base_y));
    const V stride = all(static_cast<float>(image_.stride));
    const std::int32_t base = at_.base_y * image_.stride + at_.base_x;
    const bool is_small = static_cast<std::int64_t>(image_.stride) * image_.height < kMaxSmall;
    for (std::size_t i = 0; i < kPatchBlock; i += kLanes) {
      const V u = hn::LoadU(d, samples_.u + first + i);
      const V v =
          kKind == PatchKind::kWholeRows ? all(samples_.v[first]) : hn::LoadU(d, samples_.v + first + i);
      Pixel pixel = project<kLens>(lens_, at_, H, u, v);
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
      hn::Store(weight_pair(hn::Sub(pixel.y, top)), ints, block.weights + i);
      // By one number where it is small.
      const I pair = is_small ? small_int(hn::MulAdd(top, stride, left), base) : large_place(top, left);
      hn::Store(pair, ints, block.pair + i);
    }
  }

  /// Where images are large.
  HWY_INLINE I large_place(V top, V left) const {
    const I row = hn::Add(hn::ConvertTo(ints, top), hn::Set(ints, at_.base_y));
    const I column = hn::Add(hn::ConvertTo(ints, left), hn::Set(ints, at_.base_x));
    return hn::Add(hn::Mul(row, hn::Set(ints, image_.stride)), column);
  }

  /// The light there, and what the template says.
  HWY_INLINE void add(std::size_t first, const Block& block, LaneSums& sums) const {
    HWY_UNROLL(8)
    for (std::size_t i = 0; i < kPatchBlock; i += kLanes) {
      const WordPairs pairs = load_pairs(image_.pairs, block.pair + i);
      const I left = hn::BitCast(ints, pairs.first), right = hn::BitCast(ints, pairs.second);
      const I weights = hn::Load(ints, block.weights + i);
      const V seen_left = hn::ConvertTo(d, pair_sum(weights, left));
      const V seen_right = hn::ConvertTo(d, pair_sum(weights, right));
      V a = hn::MulAdd(hn::Load(d, block.fx + i), hn::Sub(seen_right, seen_left),
                       hn::Sub(seen_left, all(origin_)));
      V b = hn::LoadU(d, expected_.light + first + i);
      if constexpr (kIsMasked) {
        M is_known =
            hn::AndNot(has_blinding(left, right), hn::Gt(hn::Load(d, block.is_seen + i), hn::Zero(d)));
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

  /// Whether any of the four pixels is too bright.
  static HWY_INLINE M has_blinding(I left, I right) {
    constexpr std::int32_t kAbove = kBlindingCode * (1 << 16) - 1;
    const I upper = hn::Max(hn::ShiftLeft<16>(left), hn::ShiftLeft<16>(right)), lower = hn::Max(left, right);
    return hn::RebindMask(d, hn::Gt(hn::Max(upper, lower), hn::Set(ints, kAbove)));
  }

  static constexpr bool kIsMasked = kKind == PatchKind::kAny;
  static constexpr float kMiddle = 0.5F;  ///< Taken off patterns, for the sums' sake.

  const PairedRows image_;  // copies: what is written elsewhere then cannot change them
  const LensFactors& lens_;
  const PatchPlacement at_;
  const SampleColumns samples_;
  const TemplateColumns expected_;
  const float origin_;
};

template <LensKind kLens, PatchKind kKind>
PatchSums sum_kind(const PairedRows& image, const LensFactors& lens, const PatchPlacement& placement,
                   const SampleColumns& samples, const TemplateColumns& expected) {
  return PatchSummation<kLens, kKind>(image, lens, placement, samples, expected).run();
}

PatchSums SumPatch(const PairedRows& image, const LensFactors& lens, const PatchPlacement& placement,
                   const SampleColumns& samples, const TemplateColumns& expected) {
  const bool is_whole = lens.kind == LensKind::kPinhole && placement.is_inside && !samples.is_padded &&
                        expected.presence == nullptr && !image.has_blinding;
  const auto sum = lens.kind == LensKind::kRadtan        ? sum_kind<LensKind::kRadtan, PatchKind::kAny>
                   : lens.kind == LensKind::kEquidistant ? sum_kind<LensKind::kEquidistant, PatchKind::kAny>
                   : !is_whole                           ? sum_kind<LensKind::kPinhole, PatchKind::kAny>
                   : !samples.has_rows                   ? sum_kind<LensKind::kPinhole, PatchKind::kWhole>
                                       : sum_kind<LensKind::kPinhole, PatchKind::kWholeRows>;
  return sum(image, lens, placement, samples, expected);
}

void CastPatch(const std::array<float, 9>& camera_from_plane, const SampleColumns& samples, float* ray_x,
               float* ray_y) {
  const float* H = camera_from_plane.data();
  for (std::size_t i = 0; i < samples.count; i += kLanes) {
    const V u = hn::LoadU(d, samples.u + i), v = hn::LoadU(d, samples.v + i);
    const V Z = row_of(H + 6, u, v);
    const V inverse = hn::IfThenElse(hn::Gt(Z, hn::Zero(d)), reciprocal(Z), hn::NaN(d));
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
