#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "apriltrack/image/image.h"
#include "apriltrack/image/reduced.h"

namespace apriltrack {

/// Keeps small copies of a few images of a stream, evenly spread over it, without knowing its length
/// beforehand: when the sample is full, every other copy is dropped and the step between kept images doubles.
class EvenSample {
 public:
  /// Default size limit of a copy in pixels: 1920 x 1080 is kept as it is, 4000 x 3000 becomes 1000 x 750.
  /// Enough to read all but the smallest tags.
  static constexpr std::int64_t kMostPixels = 1 << 21;

  /// most: number of copies kept at most; even, and at least 2. most_pixels: size limit of a copy.
  explicit EvenSample(std::size_t most, std::int64_t most_pixels = kMostPixels)
      : most_(most), most_pixels_(most_pixels) {}

  /// The next image of the stream.
  void offer(const GrayView& image) {
    if (num_offered_++ % step_ != 0) return;
    if (images_.size() == most_) {
      halve();
      if ((num_offered_ - 1) % step_ != 0) return;
    }
    images_.push_back(reduced_copy(image, most_pixels_));
  }

  /// In the order of the stream.
  const std::vector<GrayImage>& images() const { return images_; }

 private:
  void halve() {
    for (std::size_t i = 1; 2 * i < images_.size(); ++i) images_[i] = std::move(images_[2 * i]);
    images_.resize((images_.size() + 1) / 2);
    step_ *= 2;
  }

  std::size_t most_;
  std::int64_t most_pixels_;
  std::vector<GrayImage> images_;
  std::size_t num_offered_ = 0;
  std::size_t step_ = 1;
};

}  // namespace apriltrack
