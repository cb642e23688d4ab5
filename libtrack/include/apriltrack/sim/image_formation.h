#pragma once

#include <cstdint>

#include "apriltrack/camera/camera.h"
#include "apriltrack/image/image.h"

namespace apriltrack {

/// From the light on the lens to the bytes of the file.
struct ImageFormation {
  /// Of a Gaussian, beside the mean over a pixel's area; 0 = none, else from 0.2 on.
  double lens_blur_sigma_px = 0.5;
  double vignetting = 0.24;    ///< Light lost in the farthest corner; falls with the square of the radius.
  double sensor_gain = 0.85;   ///< Image light, 1 = full scale, of a surface of radiance 1.
  double full_well = 9000.0;   ///< Electrons at full scale: shot noise.
  double read_noise = 9.0;     ///< Electrons.
  double noise = 1.0;          ///< Scales both kinds of noise; 0 = off.
  double amplification = 1.0;  ///< Of the electrons, their noise included, before full scale clips them.

  /// Throws MisuseError that names the field, its value and its range.
  void check() const;
};

/// Vignetting and gain: light on the sensor as a share of full scale, not yet clipped.
void expose_sensor(Image<float>& light, const ImageFormation& formation);

/// Shot and read noise, response and 8 bits. The shot noise is the Gaussian limit of Poisson's, which holds
/// where it matters: at full_well = 9000 the read noise covers the difference below some 20 electrons. Random
/// numbers are keyed by (seed, frame_index, row).
GrayImage develop(const Image<float>& sensor_light, const ResponseCurve& response,
                  const ImageFormation& formation, std::uint64_t seed, std::uint64_t frame_index);

}  // namespace apriltrack
