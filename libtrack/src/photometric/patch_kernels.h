#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "pixel_kernels.h"

namespace apriltrack {

/// What JointLikelihood does for every sample of a patch, many at a time: projection, bilinear sampling and
/// the sums of a correlation in one pass. `sample_patch` and `correlate` are the definition that the kernels
/// are held against.
///
/// Samples are taken in blocks of so many; columns are padded to whole blocks.
inline constexpr std::size_t kPatchBlock = 2 * kPixelBlock;

/// Of pixels that are too bright to tell their light.
inline constexpr std::int32_t kBlindingCode = 32767;

/// An image as the patch kernels read it: light in equal steps over the image's range, in 16 bits with sign,
/// rows interleaved with the ones below. Pair x of row y is pixel (x, y) in its lower half and (x, y + 1) in
/// its upper one, so that the four pixels around any place are 8 bytes that follow each other.
struct PairedRows {
  const std::int32_t* pairs = nullptr;
  int stride = 0;             ///< Pairs from one row to the next.
  int width = 0, height = 0;  ///< At least 2.
  float middle = 0.0F;        ///< The light of code 0,
  float codes_per_light = 0.0F;
  double step = 0.0;          ///< and that of code 1 above it.
  bool has_blinding = false;  ///< Places beside such a pixel are not seen.

  float code_of(float light) const { return (light - middle) * codes_per_light; }
};

enum class LensKind { kPinhole, kRadtan, kEquidistant };

/// A lens in single precision.
struct LensFactors {
  LensKind kind = LensKind::kPinhole;
  float fx = 0.0F, fy = 0.0F;
  std::array<float, 8> coefficients{};  ///< In their lens model's order.
  float limit = 0.0F;                   ///< Of the valid domain: squared radius, or angle.
};

/// Where a patch is seen. Pixels are counted from (base_x, base_y), a pixel near its centre: the numbers stay
/// small, and with them their rounding.
struct PatchPlacement {
  /// (u, v, 1), row by row, to a homogeneous pixel (pinhole) or to the camera frame (other lenses).
  std::array<float, 9> from_plane{};
  float offset_x = 0.0F, offset_y = 0.0F;  ///< The principal point; not for a pinhole, which has it above.
  int base_x = 0, base_y = 0;              ///< In [0, width - 2], [0, height - 2].
  float origin_light = 0.0F;               ///< Sums are about it.
  /// Every sample is in the image, off its last pixels. Only ever told of a pinhole's patches.
  bool is_inside = false;
};

/// Places in the tag's plane, NaN where they fill up a block.
struct SampleColumns {
  const float* u = nullptr;
  const float* v = nullptr;
  std::size_t count = 0;   ///< Padded.
  bool is_padded = false;  ///< Whether any fills up.
  bool has_rows = false;   ///< Whether each block has its v in common.
};

/// What to expect at the samples.
struct TemplateColumns {
  const float* light = nullptr;
  /// With it, the template is light + (1 - presence), white paper, and unknown below kLeastPresence.
  const float* presence = nullptr;
  double sum = 0.0, sum_squares = 0.0;  ///< Of `light`; read only for patches that are inside.

  static constexpr float kLeastPresence = 0.5F;  ///< Of the printed cells in a sample's light.
};

/// Over the samples that patch (a, about its origin) and template (b) both have.
struct PatchSums {
  double count = 0.0, a = 0.0, b = 0.0, aa = 0.0, bb = 0.0, ab = 0.0;

  void add(const PatchSums& more) {
    count += more.count;
    a += more.a;
    b += more.b;
    aa += more.aa;
    bb += more.bb;
    ab += more.ab;
  }
};

/// In single precision: call it for some thousand samples at a time.
PatchSums sum_patch(const PairedRows& image, const LensFactors& lens, const PatchPlacement& placement,
                    const SampleColumns& samples, const TemplateColumns& expected);

/// Rays (x / z, y / z) of the samples; NaN behind the camera. camera_from_plane: row by row.
void cast_patch(const std::array<float, 9>& camera_from_plane, const SampleColumns& samples, float* ray_x,
                float* ray_y);

}  // namespace apriltrack
