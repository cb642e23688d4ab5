// What the kernels have in common: their vectors, and steps that every one of them takes. Compiled once for
// each instruction set: included after hwy/foreach_target.h, again and again.
#if defined(APRILTRACK_PHOTOMETRIC_VECTORS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef APRILTRACK_PHOTOMETRIC_VECTORS_INL_H_
#undef APRILTRACK_PHOTOMETRIC_VECTORS_INL_H_
#else
#define APRILTRACK_PHOTOMETRIC_VECTORS_INL_H_
#endif

#include <hwy/highway.h>

#include <cstddef>
#include <cstdint>
#include <cstring>

#include "pixel_kernels.h"

HWY_BEFORE_NAMESPACE();
namespace apriltrack {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using Floats = hn::CappedTag<float, kPixelBlock>;
using Ints = hn::RebindToSigned<Floats>;
using Words = hn::RebindToUnsigned<Floats>;
using V = hn::Vec<Floats>;
using I = hn::Vec<Ints>;
using W = hn::Vec<Words>;
using M = hn::Mask<Floats>;
// A struct of vectors is made with values or {}: the constructor that GCC makes up otherwise is not of the
// instruction set at hand, and does not compile on ARM.

constexpr Floats d;
constexpr Ints ints;
constexpr Words words;
constexpr std::size_t kLanes = hn::MaxLanes(Floats());

static HWY_INLINE V all(float value) {
  return hn::Set(d, value);
}

static HWY_INLINE double total(V sum) {
  return static_cast<double>(hn::GetLane(hn::SumOfLanes(d, sum)));
}

/// A row of a matrix times (u, v, 1).
static HWY_INLINE V row_of(const float* matrix, V u, V v) {
  return hn::MulAdd(all(matrix[0]), u, hn::MulAdd(all(matrix[1]), v, all(matrix[2])));
}

/// 1 / x to single precision, by Newton's step where the first guess has 12 bits; NaN for 0.
static HWY_INLINE V reciprocal(V x) {
#if HWY_ARCH_X86 && HWY_TARGET != HWY_SCALAR && HWY_TARGET != HWY_EMU128
  const V guess = hn::ApproximateReciprocal(x);
  return hn::Mul(guess, hn::NegMulAdd(guess, x, all(2.0F)));
#else
  return hn::Div(all(1.0F), x);
#endif
}

/// Bilinear interpolation in whole numbers of 16 bits, two at a time: steps of a way from one value to the
/// next.
constexpr std::int32_t kWeightSteps = 1 << 14;

/// The sum of a whole number of less than kMaxSmall and another one; those larger become anything.
/// Conversions that see to all numbers take five instructions.
constexpr std::int32_t kMaxSmall = 1 << 22;
static HWY_INLINE I small_int(V x, std::int32_t more = 0) {
  constexpr float kUnitSteps = 12582912.0F;  // 1.5 * 2^23: numbers near it are 1 apart
  constexpr std::int32_t kBits = 0x4B400000;
  return hn::Add(hn::BitCast(ints, hn::Add(x, all(kUnitSteps))), hn::Set(ints, more - kBits));
}

/// (1 - f, f) in steps, side by side as pair_sum takes them. f: in [0, 1].
static HWY_INLINE I weight_pair(V f) {
  // Again by way of the bits; those beyond the number are shifted out, and taken off.
  constexpr float kUnitSteps = 8388608.0F;  // 2^23
  constexpr std::int32_t kBits = 0x4B000000;
  const I second = hn::BitCast(ints, hn::MulAdd(f, all(static_cast<float>(kWeightSteps)), all(kUnitSteps)));
  return hn::Sub(hn::Add(hn::ShiftLeft<16>(second), hn::Set(ints, kBits + kWeightSteps)), second);
}

/// Of the two whole numbers of 16 bits in each lane, the sum of their products with the others'.
static HWY_INLINE I pair_sum(I weights, I values) {
#if HWY_ARCH_X86 && HWY_TARGET != HWY_SCALAR && HWY_TARGET != HWY_EMU128
  const hn::Repartition<std::int16_t, Ints> halves;
  I unused = hn::Zero(ints);
  return hn::ReorderWidenMulAccumulate(ints, hn::BitCast(halves, weights), hn::BitCast(halves, values),
                                       hn::Zero(ints), unused);
#else
  const auto low = [](I x) HWY_ATTR { return hn::ShiftRight<16>(hn::ShiftLeft<16>(x)); };
  return hn::Add(hn::Mul(low(weights), low(values)),
                 hn::Mul(hn::ShiftRight<16>(weights), hn::ShiftRight<16>(values)));
#endif
}

/// Two words each from kLanes places.
struct WordPairs {
  W first, second;
};

#if HWY_TARGET != HWY_SCALAR
/// The 8 bytes at base[at[0]], base[at[kStep]] and so on. Going by way of memory is slower, and so were
/// gather instructions (docs/algorithms/paper_filter.md, section 7).
template <std::size_t kStep, std::size_t kFirst, class Word, class Longs>
HWY_INLINE hn::Vec<Longs> load_longs(Longs longs, const Word* base, const std::int32_t* at) {
  static_assert(sizeof(Word) == sizeof(std::uint32_t));
  constexpr std::size_t kCount = hn::MaxLanes(Longs());
  if constexpr (kCount == 1) {
    // Two places at a time: their loads are what there is most of.
    std::uint64_t two;
    std::memcpy(&two, at + kFirst / 2 * 2, sizeof two);
    const std::uint64_t place = kFirst % 2 == 0 ? two & 0xFFFFFFFFU : two >> 32;
    return hn::LoadU(longs, reinterpret_cast<const std::uint64_t*>(base + place));
  } else {
    const hn::Half<Longs> half;
    return hn::Combine(longs, load_longs<kStep, kFirst + kCount / 2 * kStep>(half, base, at),
                       load_longs<kStep, kFirst>(half, base, at));
  }
}
#endif

/// base[at[i]] and base[at[i] + 1] of kLanes places, none of them negative. Word: of 4 bytes.
template <class Word>
HWY_INLINE WordPairs load_pairs(const Word* base, const std::int32_t* at) {
#if HWY_TARGET == HWY_SCALAR
  std::uint32_t pair[2];
  std::memcpy(pair, base + at[0], sizeof pair);
  return {hn::Set(words, pair[0]), hn::Set(words, pair[1])};
#else
  const hn::Repartition<std::uint64_t, Words> longs;
  if constexpr (kLanes > 8) {  // two instructions where there are shuffles of all lanes
    const auto low = load_longs<1, 0>(longs, base, at), high = load_longs<1, kLanes / 2>(longs, base, at);
    const W left = hn::BitCast(words, low), right = hn::BitCast(words, high);
    return {hn::ConcatEven(words, right, left), hn::ConcatOdd(words, right, left)};
  } else {
    const auto even = load_longs<2, 0>(longs, base, at), odd = load_longs<2, 1>(longs, base, at);
    return {hn::OddEven(hn::BitCast(words, hn::ShiftLeft<32>(odd)), hn::BitCast(words, even)),
            hn::OddEven(hn::BitCast(words, odd), hn::BitCast(words, hn::ShiftRight<32>(even)))};
  }
#endif
}

/// Of the two numbers of 16 bits in each lane, the lower ones side by side, and the upper ones.
static HWY_INLINE W low_halves(W first, W second) {
#if HWY_TARGET == HWY_SCALAR
  return hn::Or(hn::And(first, hn::Set(words, 0xFFFFU)), hn::ShiftLeft<16>(second));
#else
  const hn::Repartition<std::uint16_t, Words> halves;
  return hn::BitCast(words,
                     hn::OddEven(hn::BitCast(halves, hn::ShiftLeft<16>(second)), hn::BitCast(halves, first)));
#endif
}
static HWY_INLINE W high_halves(W first, W second) {
#if HWY_TARGET == HWY_SCALAR
  return hn::Or(hn::ShiftRight<16>(first), hn::And(second, hn::Set(words, 0xFFFF0000U)));
#else
  const hn::Repartition<std::uint16_t, Words> halves;
  return hn::BitCast(
      words, hn::OddEven(hn::BitCast(halves, second), hn::BitCast(halves, hn::ShiftRight<16>(first))));
#endif
}

}  // namespace HWY_NAMESPACE
}  // namespace apriltrack
HWY_AFTER_NAMESPACE();

#endif
