#include "picture_scaling.h"

#include <fmt/format.h>

namespace apriltrack {

GrayImage PictureScaling::to_gray(const ImageValues& values, const std::string& where,
                                  const CountSample& count_sample) {
  if (!values.is_deep()) return gray_of(values, {});
  if (!range_) {
    if (bits_) {
      range_ = range_of_bits(*bits_);
    } else {
      const ValueCounts counts = count_sample();
      range_ = counts.is_empty() ? ValueRange{} : counts.range();
      report_range();
    }
  }
  check_range(values, where);
  return gray_of(values, *range_);
}

void PictureScaling::report_range() const {
  if (*range_ == ValueRange{}) return;
  log_(LogLevel::kInfo,
       fmt::format("{}: the 16-bit pictures use {} and are scaled by that (--bits N overrides)", name_,
                   description_of(*range_)));
}

void PictureScaling::check_range(const ImageValues& values, const std::string& where) {
  if (has_warned_ || *range_ == ValueRange{}) return;
  ValueCounts counts;
  counts.add(values.pixels);
  if (counts.lowest() >= range_->black && counts.highest() <= range_->white) return;
  has_warned_ = true;
  log_(LogLevel::kWarning,
       fmt::format("{} has values from {} to {}, but the pictures are scaled by {}: what lies beyond is "
                   "lost; give --bits N for the bits that count",
                   where, counts.lowest(), counts.highest(), description_of(*range_)));
}

}  // namespace apriltrack
