#pragma once

#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

#include "apriltrack/image/image.h"

namespace apriltrack::app {

/// A few images of many, evenly spread, though nobody knows beforehand how many there will be: whenever there
/// are too many, every other one goes, and from then on only half as many are taken.
class EvenSample {
 public:
  static constexpr std::size_t kMost = 20;

  void offer(const GrayView& image) {
    if (num_offered_++ % step_ != 0) return;
    if (images_.size() == kMost) {
      halve();
      if ((num_offered_ - 1) % step_ != 0) return;
    }
    images_.push_back(copy_of(image));
  }

  const std::vector<GrayImage>& images() const { return images_; }

 private:
  void halve() {
    for (std::size_t i = 1; 2 * i < images_.size(); ++i) images_[i] = std::move(images_[2 * i]);
    images_.resize((images_.size() + 1) / 2);
    step_ *= 2;
  }

  static GrayImage copy_of(const GrayView& image) {
    GrayImage copy(image.width(), image.height());
    for (int y = 0; y < image.height(); ++y) std::copy_n(image.row(y), image.width(), copy.row(y));
    return copy;
  }

  std::vector<GrayImage> images_;
  std::size_t num_offered_ = 0;
  std::size_t step_ = 1;
};

}  // namespace apriltrack::app
