#include "tag_reader.h"

#include <chrono>
#include <utility>

namespace apriltrack {

void TagReader::prepare() {
  if (!detector_) detector_.emplace(options_);
}

void TagReader::read(const GrayView& image, BlurFrame& frame) {
  read_timed(
      [&](Detector& detector) {
        FoundTags found = detector.find(image);
        frame.left_out = std::move(found.left_out);
        return std::move(found.detections);
      },
      frame);
}

void TagReader::read_in(const GrayView& image, std::span<const TagRegion> regions, double decimate,
                        BlurFrame& frame) {
  read_timed([&](Detector& detector) { return detector.detect_in(image, regions, decimate); }, frame);
}

void TagReader::take(std::vector<Detection> detections, BlurFrame& frame) const {
  frame.detections = std::move(detections);
  frame.read = observe_mapped_tags(map_, world_.index, world_.model, frame.detections, corner_sigma_px_);
}

template <class Detect>
void TagReader::read_timed(const Detect& detect, BlurFrame& frame) {
  prepare();
  const auto start = std::chrono::steady_clock::now();
  std::vector<Detection> found = detect(*detector_);
  frame.detection_s += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  take(std::move(found), frame);
}

}  // namespace apriltrack
