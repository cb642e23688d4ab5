#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "apriltrack/base/timestamp.h"
#include "apriltrack/detect/detector.h"
#include "apriltrack/photometric/photometric_world.h"
#include "tag_observation.h"

namespace apriltrack {

/// One frame, ready to be explained.
struct BlurFrame {
  Timestamp time;
  PhotometricFrame photometric;
  std::vector<Detection> detections;
  std::vector<LeftOutTag> left_out;          ///< When the whole image was searched.
  std::vector<TagObservation> read;          ///< Of them, those of mapped tags;
  std::vector<TagObservation> observations;  ///< of these, those that take part.
  double detection_s = 0.0;                  ///< Spent on reading tags.
  bool is_searched = false;          ///< Tags were looked for everywhere, not only where they are expected.
  std::uint64_t index = 0;           ///< In the recording: the key of its random numbers.
  std::optional<double> interval_s;  ///< Since the frame before that was explained.
  std::optional<double> step_s;      ///< The same; where a turn is seen, since the frame that it begins at.
  double sensitivity = 1.0;          ///< Light in the image for light in the scene: exposure times gain. > 0.
};

}  // namespace apriltrack
