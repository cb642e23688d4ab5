#include "apriltrack/detect/estimate_response.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <vector>

#include "apriltrack/base/error.h"
#include "response_fit.h"

namespace apriltrack {
namespace {

constexpr double kFirstExponent = 1.8;
constexpr std::size_t kLeastTagPictures = 6;
constexpr double kWrong = 4.0;         // sigmas of the exponent
constexpr double kBeyondChance = 3.0;  // standard errors
constexpr double kSameInSigmas = 3.0;  // of a curve that has a name
/// From sensors as they are to PAL's 2.8, the steepest that a standard has.
constexpr double kLeastOfCameras = 1.0, kMostOfCameras = 2.8;

double nearest_of_cameras(double exponent) {
  return std::clamp(exponent, kLeastOfCameras, kMostOfCameras);
}

/// What lies beyond all cameras is a sample of errors that the sigma does not know: much ink, veiling glare,
/// sharpening.
FittedExponent with_errors_beyond_cameras(FittedExponent fit) {
  fit.sigma = std::max(fit.sigma, std::abs(fit.exponent - nearest_of_cameras(fit.exponent)));
  return fit;
}

constexpr double kWrittenDigits = 100.0;

std::size_t frames_of(const std::vector<ResponseView>& views) {
  std::set<int> frames;
  for (const ResponseView& view : views) frames.insert(view.frame);
  return frames.size();
}

double sigmas_off(const FittedExponent& fit, double exponent) {
  return std::abs(fit.exponent - exponent) / fit.sigma;
}

ResponseDoubt doubt_of(const FittedExponent& fit) {
  const bool may_be_srgb = sigmas_off(fit, nearest_exponent(ResponseCurve::srgb())) < kSameInSigmas;
  const bool may_be_linear = sigmas_off(fit, 1.0) < kSameInSigmas;
  return may_be_srgb && may_be_linear ? ResponseDoubt::kCannotTell : ResponseDoubt::kNone;
}

/// The curve with a name that pictures cannot tell from the exponent, or the exponent's.
ResponseCurve simplest(const std::vector<ResponseView>& views, const FittedExponent& fit,
                       const ParallelFor& parallel) {
  const double exponent = nearest_of_cameras(fit.exponent);
  const bool is_of_cameras = exponent == fit.exponent;
  const CodeCurve found = CodeCurve::gamma(exponent);
  for (const ResponseCurve& named : {ResponseCurve::srgb(), ResponseCurve::linear()}) {
    if (sigmas_off(fit, nearest_exponent(named)) > kSameInSigmas) continue;
    if (!is_of_cameras || sigmas_worse(views, CodeCurve(named), found, parallel) < kBeyondChance)
      return named;
  }
  return ResponseCurve::gamma(std::round(kWrittenDigits * exponent) / kWrittenDigits);
}

}  // namespace

ResponseEstimate estimate_response(std::span<const FrameDetections> frames, const ResponseCamera& camera,
                                   const TagSizes& sizes, int num_threads, std::size_t most_pictures) {
  if (num_threads < 0)
    throw invalid_input("num_threads", fmt::format("must be 0 (all cores) or more (is {})", num_threads));
  const ParallelFor parallel = parallel_for(num_threads);
  ResponseEstimate result;
  result.response = camera.assumed;
  result.assumed_exponent = nearest_exponent(camera.assumed);
  std::vector<ResponseView> views =
      response_views(frames, camera, sizes, CodeCurve::gamma(kFirstExponent), most_pictures, parallel);
  std::optional<FittedExponent> fit;
  const auto enough = [&] { return views.size() >= kLeastTagPictures; };
  if (enough()) fit = fit_exponent(views, kFirstExponent, parallel);
  result.views_used = static_cast<int>(views.size());
  result.frames_used = static_cast<int>(frames_of(views));
  result.doubt = enough() ? ResponseDoubt::kNotExplained : ResponseDoubt::kTooFewPictures;
  if (!fit || !enough()) return result;
  fit = with_errors_beyond_cameras(*fit);
  result.exponent = fit->exponent;
  result.sigma = fit->sigma;
  result.doubt = doubt_of(*fit);
  if (!result.is_found()) return result;
  result.response = simplest(views, *fit, parallel);
  result.assumed_worse_sigmas =
      sigmas_worse(views, CodeCurve(camera.assumed), CodeCurve::gamma(fit->exponent), parallel);
  result.contradicts_assumed =
      sigmas_off(*fit, result.assumed_exponent) > kWrong && result.assumed_worse_sigmas > kBeyondChance;
  return result;
}

std::optional<ResponseCurve> rival_response(const ResponseCurve& used, ResponseOrigin origin) {
  if (origin != ResponseOrigin::kAssumed) return std::nullopt;
  return used.is_linear() ? ResponseCurve::srgb() : ResponseCurve::linear();
}

std::string words_of(const ResponseEstimate& estimate) {
  return fmt::format("gamma {:.2f} (sigma {:.2f})", estimate.exponent, estimate.sigma);
}

std::string words_of_doubt(const ResponseEstimate& estimate) {
  switch (estimate.doubt) {
    case ResponseDoubt::kNone:
      return "";
    case ResponseDoubt::kTooFewPictures:
      return fmt::format(
          "too few sharp pictures of tags: {}; {} are needed, of tags over some 20 px, unsmeared and not "
          "overexposed",
          estimate.views_used, kLeastTagPictures);
    case ResponseDoubt::kNotExplained:
      return "no curve light = code ^ exponent explains the tags' pictures";
    case ResponseDoubt::kCannotTell:
      return fmt::format("the tags' pictures tell it too poorly: {}", words_of(estimate));
  }
  return "";
}

}  // namespace apriltrack
