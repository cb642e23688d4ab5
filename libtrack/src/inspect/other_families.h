#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "apriltrack/base/progress.h"
#include "apriltrack/base/should_stop.h"
#include "apriltrack/detect/detector.h"
#include "apriltrack/image/even_sample.h"
#include "apriltrack/image/image.h"
#include "apriltrack/inspect/recording_facts.h"

namespace apriltrack {

/// Small copies of the frames in which other families are looked for. A frame in which a tag asked for was
/// read is explained: of these two are looked at, for tags that hang beside; of the others, eight.
class FamilySample {
 public:
  /// Tags of 20 px in 1920 x 1080 have 10 px then, and are read.
  static constexpr std::int64_t kMostPixels = 1 << 20;
  static constexpr std::size_t kMostExplained = 2, kMostUnexplained = 8;

  /// asked: the tags that were read in `image`.
  void offer(const GrayView& image, std::span<const Detection> asked);
  std::vector<GrayImage> images() const;

 private:
  EvenSample explained_{kMostExplained, kMostPixels}, unexplained_{kMostUnexplained, kMostPixels};
};

/// As find_odd_pictures(), of all families: in two of the images, for three searches of each take a second.
std::optional<OddPictures> find_odd_pictures_of_any(std::span<const GrayImage> images,
                                                    const DetectorOptions& asked);

/// Looks for every family that `asked` does not name, all in one search of each image; what a family asked
/// for reads as well, or better, does not count. Returns those that were read, chance readings among them
/// (is_surely_there), in the order of their names. should_stop ends it early.
std::vector<FamilyReadings> read_other_families(std::span<const GrayImage> images,
                                                const DetectorOptions& asked, int num_threads,
                                                const ProgressSink& progress, const ShouldStop& should_stop);

}  // namespace apriltrack
