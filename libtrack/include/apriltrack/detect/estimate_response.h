#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>

#include "apriltrack/camera/camera.h"
#include "apriltrack/detect/detection.h"
#include "apriltrack/image/response.h"
#include "apriltrack/tags/tag_sizes.h"

namespace apriltrack {

/// Whose pictures are to tell the response.
struct ResponseCamera {
  std::string name = "cam0";                        ///< Frames of other cameras take no part.
  std::optional<CameraModel> model = std::nullopt;  ///< None: the lens is not known.
  ResponseCurve assumed = ResponseCurve::srgb();    ///< So far.
};

/// Why pictures tell no response.
enum class ResponseDoubt {
  kNone,            ///< They do.
  kTooFewPictures,  ///< Sharp ones of tags.
  kNotExplained,    ///< No curve light = code ^ exponent explains them.
  kCannotTell,      ///< sRGB and linear are both within 3 sigma.
};

/// A camera's response as the pictures of tags tell it.
struct ResponseEstimate {
  ResponseDoubt doubt = ResponseDoubt::kTooFewPictures;
  /// Of light = code ^ exponent. sigma: of noise, of what tags and stretches of the film keep, and of ink
  /// that may run by 0.05 mm; not less than what the exponent lies beyond those that cameras have, 1 to 2.8.
  /// 0 where none could be fitted.
  double exponent = 0.0, sigma = 0.0;
  /// What to use: "linear" or "srgb" where the pictures cannot tell it from that, else "gamma:G"; as assumed
  /// where they are in doubt.
  ResponseCurve response = ResponseCurve::srgb();
  double assumed_exponent = 0.0;  ///< The nearest to the response as assumed.
  /// How much worse the response as assumed explains the pictures than the exponent does, in standard errors
  /// of the mean over frames.
  double assumed_worse_sigmas = 0.0;
  /// The response as assumed is wrong: over 4 sigma away, and explains the pictures worse.
  bool contradicts_assumed = false;
  int views_used = 0, frames_used = 0;

  bool is_found() const { return doubt == ResponseDoubt::kNone; }
};

/// So many pictures of tags tell a response well; so few, spread over the film, that one is wrong.
inline constexpr std::size_t kPicturesToEstimate = 48, kPicturesToCheck = 32;

/// Estimates a camera's response from the grey levels across the edges of tags
/// (docs/algorithms/response.md).
///
/// frames: of this camera those with patches take part; corners right to half a cell suffice, so that it does
/// not matter by which response they were localised. sizes: how much ink that runs counts; a tag without one
/// is taken for 0.075 m. num_threads: 0 = as many as the machine has cores; changes no result.
/// most_pictures: to look at, evenly chosen; time is proportional to them.
ResponseEstimate estimate_response(std::span<const FrameDetections> frames, const ResponseCamera& camera,
                                   const TagSizes& sizes, int num_threads = 1,
                                   std::size_t most_pictures = kPicturesToEstimate);

/// What the response may be as well: linear in place of what is assumed, or sRGB in place of linear. nullopt
/// where it is stated, or estimated.
std::optional<ResponseCurve> rival_response(const ResponseCurve& used, ResponseOrigin origin);

/// "gamma 1.05 (sigma 0.04)".
std::string words_of(const ResponseEstimate& estimate);
/// Why the pictures tell no response; empty where they do.
std::string words_of_doubt(const ResponseEstimate& estimate);

}  // namespace apriltrack
