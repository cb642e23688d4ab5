#pragma once

#include "apriltrack/image/response.h"

namespace apriltrack {

/// A camera's response the other way round: the grey level that some light comes out as. Grey levels and
/// light have full scale 1.
class CodeCurve {
 public:
  explicit CodeCurve(const ResponseCurve& response) : response_(response) {}
  /// light = code ^ exponent; exponent in [0.2, 5].
  static CodeCurve gamma(double exponent);

  struct Sample {
    double code = 0.0;
    double by_light = 0.0;
    double by_exponent = 0.0;  ///< Of gamma() only.
  };
  /// Beyond the darkest and the brightest grey levels the curve goes on straight.
  Sample at(double light) const;
  /// Light of a grey level in [0, 1].
  double light(double code) const;

 private:
  ResponseCurve response_;
  double exponent_ = 0.0;  ///< 0: none.
};

/// Of the gamma curve that comes nearest to a response, contrast and black level free: all that pictures of
/// tags tell.
double nearest_exponent(const ResponseCurve& response);

}  // namespace apriltrack
