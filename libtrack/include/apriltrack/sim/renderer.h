#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>

#include "apriltrack/image/frame.h"
#include "apriltrack/sim/scene.h"

namespace apriltrack {

struct RenderOptions {
  std::uint64_t seed = 1;
  /// Instants of the exposure per pixel of the longest path seen, rounded up to a multiple of the lens's
  /// looks, which share them: 13, or 32 of a lens sharper than 0.35 px. The light between them is carried by
  /// the area of the pixels and the lens blur; twice as many change the named scenes by less than 0.5 grey
  /// levels RMS (measured).
  double instants_per_px = 1.0;
  int min_instants = 8;
  int max_instants = 2000;
  /// Multiplies the number of instants that the motion asks for: 2 shows what the choice above costs.
  int instants_factor = 1;
};

/// A frame with its truth.
struct RenderedFrame {
  GrayImage pixels;
  Timestamp timestamp;  ///< Middle of the exposure.
  double exposure_s = 0.0;
  double light = 1.0;  ///< Mean of the lamps' flicker over the exposure.
  Pose truth;          ///< T_map_camera (ego) or T_camera_body (joint) at the time stamp.
  int num_instants = 0;

  /// gain: relative to the first frame of the recording.
  Frame frame(double gain = 1.0) const;
};

/// Films a scene. What a pixel shows is the mean of the scene's light over the pixel's area and over the
/// exposure, blurred by the lens between the pixels, in linear light; then comes the rest of the image
/// formation.
///
/// Tags are integrated over the pixel's area from their exact cells, not from sampled pictures. Nothing here
/// is shared with what tracks: warping, sampling and exposure integral are the simulator's own
/// (docs/algorithms/).
class Renderer {
 public:
  /// Throws MisuseError when the scene cannot be filmed: no resolution, rolling shutter, exposure not above
  /// 0.
  explicit Renderer(Scene scene, const RenderOptions& options = {});
  ~Renderer();
  Renderer(Renderer&&) noexcept;
  Renderer& operator=(Renderer&&) noexcept;

  const Scene& scene() const;

  /// Threads may render different frames at once; the same index gives the same bytes always.
  RenderedFrame render(std::size_t index) const;

  /// Radiance on the pixels before the lens blur: mean over area and exposure, noise-free, flicker included.
  /// exposure_s = 0: one instant.
  Image<float> radiance(Timestamp middle, double exposure_s) const;
  /// Light on the sensor, 1 = full scale: radiance after lens blur, vignetting and gain. Noise-free,
  /// unclipped.
  Image<float> sensor_light(Timestamp middle, double exposure_s) const;

 private:
  struct State;
  std::unique_ptr<const State> state_;
};

}  // namespace apriltrack
