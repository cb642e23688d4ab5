#pragma once

#include <optional>
#include <span>
#include <vector>

#include "apriltrack/detect/detector.h"
#include "apriltrack/photometric/photometric_world.h"
#include "apriltrack/tags/tag_map.h"
#include "blur_frame.h"

namespace apriltrack {

/// Reads tags in images, and tells which of them the map has. map, world: must outlive it. corner_sigma_px:
/// of corners without a covariance.
class TagReader {
 public:
  TagReader(const DetectorOptions& options, const TagMap& map, const PhotometricWorld& world,
            double corner_sigma_px)
      : options_(options), map_(map), world_(world), corner_sigma_px_(corner_sigma_px) {}

  const DetectorOptions& options() const { return options_; }
  /// Makes the detector, where there is none yet: up to seconds.
  void prepare();

  /// In the whole image. Here as below the frame takes what is read, and the time that it took.
  void read(const GrayView& image, BlurFrame& frame);
  /// As Detector::detect_in().
  void read_in(const GrayView& image, std::span<const TagRegion> regions, double decimate, BlurFrame& frame);
  /// What was read elsewhere.
  void take(std::vector<Detection> detections, BlurFrame& frame) const;

 private:
  template <class Detect>
  void read_timed(const Detect& detect, BlurFrame& frame);

  DetectorOptions options_;
  const TagMap& map_;
  const PhotometricWorld& world_;
  const double corner_sigma_px_;
  std::optional<Detector> detector_;  ///< Made when it is needed: who brings detections needs none.
};

}  // namespace apriltrack
