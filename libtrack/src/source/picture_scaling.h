#pragma once

#include <functional>
#include <optional>
#include <string>

#include "apriltrack/source/frame_source.h"
#include "image_values.h"
#include "value_range.h"

namespace apriltrack {

/// Turns a source's pictures of 16 bits into 8, all by one range: that which is asked for, or the one that a
/// sample of the pictures uses, looked at before the first of them.
class PictureScaling {
 public:
  /// name: of the source. Of the options: bits and log.
  PictureScaling(std::string name, const SourceOptions& options)
      : name_(std::move(name)), bits_(options.bits), log_(options.log) {}

  /// Called at most once, for pictures spread evenly over the source; empty where there are none of 16 bits.
  using CountSample = std::function<ValueCounts()>;
  /// where: what messages call the picture. One that goes beyond the range is warned of, once.
  GrayImage to_gray(const ImageValues& values, const std::string& where, const CountSample& count_sample);

  /// nullopt until there was a picture of 16 bits.
  std::optional<ValueRange> range() const { return range_; }

  static constexpr std::size_t kMostInSample = 9;
  /// Which of `count` pictures the i-th of a sample of `size` is.
  static std::size_t place_in_sample(std::size_t i, std::size_t size, std::size_t count) {
    return size <= 1 ? 0 : i * (count - 1) / (size - 1);
  }

 private:
  void report_range() const;
  void check_range(const ImageValues& values, const std::string& where);

  std::string name_;
  std::optional<int> bits_;
  LogSink log_;
  std::optional<ValueRange> range_;
  bool has_warned_ = false;
};

}  // namespace apriltrack
