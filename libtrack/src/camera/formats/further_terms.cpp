#include <fmt/format.h>

#include <algorithm>

#include "formats.h"
#include "opencv_lens.h"

namespace apriltrack {
namespace {

/// What the corners of a good calibration are off by themselves (0.2 to 0.5 px RMS).
constexpr double kMaxFitError_px = 0.5;

std::string words_of_terms(std::size_t num_coefficients) {
  return fmt::format(
      "has {} coefficients, and those after the eighth (thin prism s1..s4, tilted sensor tau_x tau_y) are "
      "not zero",
      num_coefficients);
}

std::string words_of_fit(double max_error_px, double rms_error_px) {
  return fmt::format("off by up to {:.3g} px, {:.3g} px RMS over the picture", max_error_px, rms_error_px);
}

}  // namespace

bool has_further_terms(const std::vector<double>& coefficients) {
  return (coefficients.size() == 12 || coefficients.size() == 14) &&
         std::any_of(coefficients.begin() + 8, coefficients.end(), [](double value) { return value != 0.0; });
}

CameraModel lens_of_further_terms(const Pinhole& pinhole, const std::vector<double>& coefficients,
                                  const YamlNode& node, const Resolution& size, BeyondOurLenses beyond,
                                  std::vector<ConversionLoss>& lost) {
  const std::string what = words_of_terms(coefficients.size());
  if (beyond == BeyondOurLenses::kRefuse) {
    node.fail(
        fmt::format("{}; supported are k1 k2 p1 p2 [k3 [k4 k5 k6]]: fit these by `apriltrack camera convert "
                    "--fit`, or calibrate without the others (OpenCV: CALIB_RATIONAL_MODEL alone)",
                    what));
  }
  if (size.width == 0)
    node.fail(fmt::format("{}, and a fit of eight needs the resolution, which is not told", what));
  const RadtanFit fit = fit_radtan(OpenCvLens(pinhole, coefficients), size.width, size.height);
  if (!(fit.max_error_px <= kMaxFitError_px)) {
    node.fail(
        fmt::format("{}, and the nearest lens of eight is {}, more than {} px: calibrate without these terms",
                    what, words_of_fit(fit.max_error_px, fit.rms_error_px), kMaxFitError_px));
  }
  lost.push_back({.kind = LossKind::kLensTerms,
                  .how = LossHow::kConverted,
                  .value = node.where() + ": " + node.key_path(),
                  .numbers = {static_cast<double>(coefficients.size()), fit.max_error_px, fit.rms_error_px}});
  return fit.model;
}

std::string sentence_of_lens_terms(const ConversionLoss& loss) {
  return fmt::format("{}: {}; the nearest lens of eight is taken, {}", loss.value,
                     words_of_terms(static_cast<std::size_t>(loss.numbers.at(0))),
                     words_of_fit(loss.numbers.at(1), loss.numbers.at(2)));
}

}  // namespace apriltrack
