#pragma once

#include <cstddef>
#include <span>
#include <string>

#include "apriltrack/camera/camera.h"
#include "apriltrack/detect/detection.h"
#include "apriltrack/tags/tag_sizes.h"

namespace apriltrack {

/// A camera's response as the pictures of tags tell it.
struct ResponseEstimate {
  bool is_found = false;
  std::string reason;  ///< Why not.
  /// Of light = code ^ exponent. sigma: of noise, of what tags and stretches of the film keep, and of ink
  /// that may run by 0.05 mm.
  double exponent = 0.0, sigma = 0.0;
  /// What to use: "linear" or "srgb" where the pictures cannot tell it from that, else "gamma:G".
  ResponseCurve response = ResponseCurve::srgb();
  double assumed_exponent = 0.0;  ///< The nearest to the camera's response as given.
  /// How much worse pictures that were held out are explained by the response as given than by the exponent
  /// of the others, in standard errors of the mean over frames.
  double held_out_sigmas = 0.0;
  /// The response as given is wrong: over 5 sigma away, and held-out pictures say so as well.
  bool contradicts_assumed = false;
  int views_used = 0, frames_used = 0;
};

/// So many pictures of tags tell a response well; so few, spread over the film, that one is wrong.
inline constexpr std::size_t kPicturesToEstimate = 80, kPicturesToCheck = 32;

/// Estimates a camera's response from the grey levels across the edges of tags
/// (docs/algorithms/response.md).
///
/// frames: of this camera those with patches take part; corners right to a pixel suffice, so that it does not
/// matter by which response they were localised. camera.response: as assumed so far. sizes: tags without
/// a size do not take part. num_threads: 0 = as many as the machine has cores; changes no result.
/// most_pictures: to look at, evenly chosen; time is proportional to them.
ResponseEstimate estimate_response(std::span<const FrameDetections> frames, const Camera& camera,
                                   const TagSizes& sizes, int num_threads = 1,
                                   std::size_t most_pictures = kPicturesToEstimate);

/// "gamma 1.05 (sigma 0.04)".
std::string words_of(const ResponseEstimate& estimate);

}  // namespace apriltrack
