#include "apriltrack/calib/estimate_response.h"

#include <fmt/format.h>

#include <cmath>
#include <set>
#include <vector>

#include "apriltrack/base/error.h"
#include "response_fit.h"

namespace apriltrack {
namespace {

constexpr double kFirstExponent = 1.8;
constexpr std::size_t kLeastTagPictures = 12, kLeastFramesOfThem = 8;
constexpr int kHeldOutFrames = 4;  // of so many frames, one
constexpr double kMostSigma = 0.3;
constexpr double kWrong = 5.0;         // sigmas of the exponent
constexpr double kBeyondChance = 3.0;  // standard errors
constexpr double kSameInSigmas = 3.0;  // of a curve that has a name
constexpr double kWrittenDigits = 100.0;

std::size_t frames_of(const std::vector<ResponseView>& views) {
  std::set<int> frames;
  for (const ResponseView& view : views) frames.insert(view.frame);
  return frames.size();
}

std::vector<ResponseView> views_where(const std::vector<ResponseView>& views, bool is_held_out) {
  std::vector<ResponseView> chosen;
  for (const ResponseView& view : views) {
    if ((view.frame % kHeldOutFrames == kHeldOutFrames - 1) == is_held_out) chosen.push_back(view);
  }
  return chosen;
}

/// The curve with a name that pictures cannot tell from the exponent, or the exponent's.
ResponseCurve simplest(const std::vector<ResponseView>& views, const FittedExponent& fit,
                       const ParallelFor& parallel) {
  const CodeCurve found = CodeCurve::gamma(fit.exponent);
  for (const ResponseCurve& named : {ResponseCurve::srgb(), ResponseCurve::linear()}) {
    if (std::abs(fit.exponent - nearest_exponent(named)) > kSameInSigmas * fit.sigma) continue;
    if (sigmas_worse(views, CodeCurve(named), found, parallel) < kBeyondChance) return named;
  }
  return ResponseCurve::gamma(std::round(kWrittenDigits * fit.exponent) / kWrittenDigits);
}

}  // namespace

ResponseEstimate estimate_response(std::span<const FrameDetections> frames, const Camera& camera,
                                   const TagSizes& sizes, int num_threads, std::size_t most_pictures) {
  if (num_threads < 0)
    throw invalid_input("num_threads", fmt::format("must be 0 (all cores) or more (is {})", num_threads));
  const ParallelFor parallel = parallel_for(num_threads);
  ResponseEstimate result;
  result.response = camera.response;
  result.assumed_exponent = nearest_exponent(camera.response);
  std::vector<ResponseView> views =
      response_views(frames, camera, sizes, CodeCurve::gamma(kFirstExponent), most_pictures, parallel);
  if (views.size() < kLeastTagPictures || frames_of(views) < kLeastFramesOfThem) {
    result.reason = fmt::format(
        "too few sharp pictures of tags: {} in {} of the frames looked at; {} in {} are needed, of tags over "
        "some 20 px, unsmeared and not overexposed",
        views.size(), frames_of(views), kLeastTagPictures, kLeastFramesOfThem);
    return result;
  }
  const auto fit = fit_exponent(views, kFirstExponent, parallel);
  std::vector<ResponseView> others = views_where(views, false);
  const auto of_others = fit ? fit_exponent(others, fit->exponent, parallel) : std::nullopt;
  if (!fit || !of_others) {
    result.reason = "no curve light = code ^ exponent explains the tags' pictures";
    return result;
  }
  result.exponent = fit->exponent;
  result.sigma = fit->sigma;
  result.views_used = static_cast<int>(views.size());
  result.frames_used = static_cast<int>(frames_of(views));
  if (fit->sigma > kMostSigma) {
    result.reason = fmt::format("the tags' pictures tell it too poorly: {}", words_of(result));
    return result;
  }
  result.is_found = true;
  result.response = simplest(views, *fit, parallel);
  result.held_out_sigmas = sigmas_worse(views_where(views, true), CodeCurve(camera.response),
                                        CodeCurve::gamma(of_others->exponent), parallel);
  result.contradicts_assumed = std::abs(fit->exponent - result.assumed_exponent) > kWrong * fit->sigma &&
                               result.held_out_sigmas > kBeyondChance;
  return result;
}

std::string words_of(const ResponseEstimate& estimate) {
  return fmt::format("gamma {:.2f} (sigma {:.2f})", estimate.exponent, estimate.sigma);
}

}  // namespace apriltrack
