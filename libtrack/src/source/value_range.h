#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "apriltrack/source/frame_source.h"

namespace cv {
class Mat;
}

namespace apriltrack {

/// How often each number occurs in 16-bit pictures of one source.
class ValueCounts {
 public:
  /// picture: CV_16U, one channel.
  void add(const cv::Mat& picture);
  bool is_empty() const { return num_pixels_ == 0; }

  /// The range that the pictures use. Sensors of 8, 10, 12 and 14 bits that are written unscaled into 16 bits
  /// leave the upper ones empty: white is then the sensor's full scale, 2^bits - 1. That is a factor of
  /// light, which harms no response that is linear or a power. Where all numbers lie close together far from
  /// 0 (temperatures), a window twice as wide as they are is taken, in their middle.
  ValueRange range() const;

  /// All but dead and hot pixels lie between these.
  int lowest() const;
  int highest() const;

 private:
  using Histogram = std::vector<std::int64_t>;

  /// Values that may be odd all the same: 1 in 100,000, and eight of a small picture.
  std::int64_t num_odd() const;

  /// Of pixels, where one that stands out from all its four neighbours counts as the nearest of them: light
  /// falls on several pixels, for every lens blurs, but pixels are dead or hot by themselves. Of hot ones, a
  /// share p of all, 4 p have another such neighbour: 4 in a million pixels at p = 1/1000.
  Histogram dark_ = Histogram(65536), bright_ = Histogram(65536);
  std::int64_t num_pixels_ = 0;
};

/// Of so many significant bits, in [8, 16].
ValueRange range_of_bits(int bits);

/// "10 bits (0 to 1023)", "the range 6490 to 8530".
std::string description_of(const ValueRange& range);

}  // namespace apriltrack
