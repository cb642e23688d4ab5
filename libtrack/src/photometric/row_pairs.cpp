// Compiled once for each instruction set; Highway's foreach_target includes this file again and again.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "row_pairs.cpp"
#include <hwy/foreach_target.h>  // IWYU pragma: keep
//
#include <hwy/highway.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "row_pairs.h"
#include "vectors-inl.h"

HWY_BEFORE_NAMESPACE();
namespace apriltrack {
namespace HWY_NAMESPACE {
namespace {

void ExtendRange(const float* row, std::size_t count, LightRange* range) {
  V darkest = all(range->darkest), brightest = all(range->brightest);
  std::size_t x = 0;
  for (; x + 2 * kLanes <= count; x += 2 * kLanes) {
    const V here = hn::LoadU(d, row + x), next = hn::LoadU(d, row + x + kLanes);
    darkest = hn::Min(hn::Min(here, next), darkest);
    brightest = hn::Max(hn::Max(here, next), brightest);
  }
  for (; x < count; ++x) {
    darkest = hn::Min(all(row[x]), darkest);
    brightest = hn::Max(all(row[x]), brightest);
  }
  *range = {hn::GetLane(hn::MinOfLanes(d, darkest)), hn::GetLane(hn::MaxOfLanes(d, brightest))};
}

HWY_INLINE I codes_of(const PairedRows& rows, V light, V limit) {
  const I codes = hn::NearestInt(hn::Mul(hn::Sub(light, all(rows.middle)), all(rows.codes_per_light)));
  return hn::IfThenElse(hn::RebindMask(ints, hn::Gt(light, limit)), hn::Set(ints, kBlindingCode), codes);
}

void PairRow(const PairedRows& rows, const float* upper, const float* lower, std::size_t count,
             float max_light, std::int32_t* pairs) {
  const V limit = all(max_light);
  const auto pair_up = [&](const float* a, const float* b, std::int32_t* out) HWY_ATTR {
    const I first = codes_of(rows, hn::LoadU(d, a), limit), second = codes_of(rows, hn::LoadU(d, b), limit);
    hn::StoreU(hn::BitCast(ints, low_halves(hn::BitCast(words, first), hn::BitCast(words, second))), ints,
               out);
  };
  std::size_t x = 0;
  for (; x + kLanes <= count; x += kLanes) pair_up(upper + x, lower + x, pairs + x);
  if (x == count) return;
  float a[kLanes] = {}, b[kLanes] = {};
  std::int32_t out[kLanes];
  std::copy(upper + x, upper + count, a);
  std::copy(lower + x, lower + count, b);
  pair_up(a, b, out);
  std::copy(out, out + (count - x), pairs + x);
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace apriltrack
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace apriltrack {

HWY_EXPORT(ExtendRange);
HWY_EXPORT(PairRow);

namespace {

constexpr int kTileWidth = 64, kTileHeight = 16;  // pixels

/// The largest number of single precision that is not above.
float float_below(double value) {
  const float nearest = static_cast<float>(value);
  if (static_cast<double>(nearest) <= value) return nearest;
  return std::nextafter(nearest, -std::numeric_limits<float>::infinity());
}

}  // namespace

void PixelBox::add(const PixelBox& other) {
  if (other.is_empty()) return;
  if (is_empty()) {
    *this = other;
    return;
  }
  first_column = std::min(first_column, other.first_column);
  last_column = std::max(last_column, other.last_column);
  first_row = std::min(first_row, other.first_row);
  last_row = std::max(last_row, other.last_row);
}

void RowPairs::start(const ImageView<const float>& image, double max_light) {
  image_ = image;
  max_light_ = float_below(max_light);
  LightRange range;
  for (int y = 0; y < image.height(); ++y)
    HWY_DYNAMIC_DISPATCH(ExtendRange)(image.row(y), static_cast<std::size_t>(image.width()), &range);
  rows_.has_blinding = range.brightest > max_light_;
  const double darkest = std::min(range.darkest, max_light_),
               brightest = std::min(range.brightest, max_light_);
  constexpr double kMaxCode = kBlindingCode - 1;
  const double codes_per_light = 2.0 * kMaxCode / (brightest - darkest);
  const bool has_range = codes_per_light > 0.0 && codes_per_light < std::numeric_limits<float>::max();
  rows_.middle = static_cast<float>(0.5 * (darkest + brightest));
  rows_.codes_per_light = has_range ? static_cast<float>(codes_per_light) : 0.0F;
  rows_.step = has_range ? 1.0 / static_cast<double>(rows_.codes_per_light) : 0.0;
  rows_.width = image.width();
  rows_.height = image.height();
  // An odd number of cache lines: pixels below each other then fall into different sets of the cache.
  constexpr int kPairsPerLine = 16;
  rows_.stride = ((image.width() + kPairsPerLine - 1) / kPairsPerLine | 1) * kPairsPerLine;
  pairs_.resize(static_cast<std::size_t>(rows_.stride) * static_cast<std::size_t>(image.height()));
  rows_.pairs = pairs_.data();
  tiles_per_row_ = (image.width() + kTileWidth - 1) / kTileWidth;
  const int tiles_per_column = (image.height() + kTileHeight - 1) / kTileHeight;
  is_made_.assign(static_cast<std::size_t>(tiles_per_row_) * static_cast<std::size_t>(tiles_per_column),
                  false);
}

void RowPairs::make(const PixelBox& box) {
  if (box.is_empty()) return;
  for (int row = box.first_row / kTileHeight; row <= box.last_row / kTileHeight; ++row)
    for (int column = box.first_column / kTileWidth; column <= box.last_column / kTileWidth; ++column)
      make_tile(row, column);
}

void RowPairs::make_tile(int row, int column) {
  const std::size_t index = static_cast<std::size_t>(row) * static_cast<std::size_t>(tiles_per_row_) +
                            static_cast<std::size_t>(column);
  if (is_made_[index]) return;
  is_made_[index] = true;
  const int first = column * kTileWidth, width = std::min(kTileWidth, image_.width() - first);
  const int last_row = std::min((row + 1) * kTileHeight, image_.height() - 1);  // the last row has none below
  for (int y = row * kTileHeight; y < last_row; ++y) {
    HWY_DYNAMIC_DISPATCH(PairRow)
    (rows_, image_.row(y) + first, image_.row(y + 1) + first, static_cast<std::size_t>(width), max_light_,
     pairs_.data() + static_cast<std::ptrdiff_t>(y) * rows_.stride + first);
  }
}

}  // namespace apriltrack
#endif
