#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "apriltrack/image/image.h"
#include "apriltrack/image/reduced.h"

namespace apriltrack::app {

/// Small copies of a few images of many, evenly spread, though nobody knows beforehand how many there will
/// be: whenever there are too many, every other one goes, and from then on only half as many are taken.
class EvenSample {
 public:
  /// Enough to see which tags are there, if not the smallest: 1920 x 1080 is kept, 4000 x 3000 becomes
  /// 1000 x 750.
  static constexpr std::int64_t kMostPixels = 1 << 21;

  /// most: even, and at least 2. most_pixels: of a copy.
  explicit EvenSample(std::size_t most, std::int64_t most_pixels = kMostPixels)
      : most_(most), most_pixels_(most_pixels) {}

  void offer(const GrayView& image) {
    if (num_offered_++ % step_ != 0) return;
    if (images_.size() == most_) {
      halve();
      if ((num_offered_ - 1) % step_ != 0) return;
    }
    images_.push_back(reduced_copy(image, most_pixels_));
  }

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

}  // namespace apriltrack::app
