#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <memory>
#include <optional>
#include <vector>

#include "apriltrack/camera/camera_model.h"
#include "apriltrack/detect/tag_patch.h"
#include "apriltrack/tags/blurred_pattern.h"
#include "code_curve.h"
#include "edge_frame.h"
#include "pattern_texture.h"

namespace apriltrack {

/// One picture of one tag in the camera's own grey levels, and all that explains it but the camera's
/// response: where the tag is, its blur, contrast, slopes of light and the black level
/// (docs/algorithms/response.md, equation 1).
class CodedTag {
 public:
  /// corners_px: right to half a cell. camera: whose lens bends the edges; null: not known, and a bend of the
  /// size that lenses have is fitted. nullopt where too few pixels show the print, or these are overexposed.
  static std::optional<CodedTag> of(const TagPatch& patch, const Quad& corners_px, const CameraModel* camera);

  /// What the pixels say of the curve, all else eliminated; in variances of a pixel's noise.
  struct Equation {
    double h = 0.0, g = 0.0;  ///< Gauss and Newton's, of the exponent of gamma().
    double by_print = 0.0;    ///< Of g, by white cells that are printed wider on each side by half a tag.
    double cost = 0.0;        ///< Half the robust squares of the residuals.
  };
  /// Starts over with the colours that the curve makes of black and white. False where there is not enough
  /// of both.
  bool begin(const CodeCurve& curve);
  /// Normal equations about the present state; nullopt where they have no solution.
  std::optional<Equation> linearise(const CodeCurve& curve);
  /// Moves to their solution where the exponent changes by so much. False where that is no tag's picture.
  bool advance(double exponent_step);
  /// Both in turn until the picture is explained as well as it can be; nullopt where it cannot.
  std::optional<Equation> settle(const CodeCurve& curve);
  /// Of the residuals of linearise(), from here on.
  void measure_noise();

  double widest_blur_px() const;           ///< Along its longer axis.
  double noise() const { return noise_; }  ///< Standard deviation of a pixel, full scale 1.
  /// sqrt of the share of the pixels' variance that is explained.
  double correlation() const;

 private:
  struct Pixel {
    Eigen::Vector2d straight;  ///< From the middle of the tag, straightened by the lens where it is known.
    double code = 0.0;
  };
  static constexpr int kNumColours = 4;
  /// Place 8, blur 3, bend 3, colours.
  static constexpr int kNumUnknowns = 14 + kNumColours;
  using Unknowns = Eigen::Matrix<double, kNumUnknowns, 1>;
  using Information = Eigen::Matrix<double, kNumUnknowns, kNumUnknowns>;

  CodedTag() = default;
  void predict_picture();
  void predict_codes(const CodeCurve& curve);
  void hold(Information& information, Unknowns& gradient) const;

  std::shared_ptr<const BlurredPattern> pattern_;
  std::shared_ptr<const std::vector<Pixel>> pixels_;
  std::optional<PatternTexture> texture_;
  Eigen::Matrix2d straight_by_pixel_;
  bool is_straightened_ = false;

  Eigen::Matrix3d tag_from_straight_;
  Eigen::Matrix2d blur_px2_;
  Eigen::Vector3d bend_ = Eigen::Vector3d::Zero();
  Eigen::Matrix<double, kNumColours, 1> colours_ = Eigen::Matrix<double, kNumColours, 1>::Zero();
  double noise_;

  // As linearised last, by pixels.
  Eigen::Matrix<double, kNumUnknowns, Eigen::Dynamic> rows_;
  Eigen::VectorXd residuals_, by_exponent_, by_print_, weights_;
  double cost_ = 0.0;
  Unknowns step_, step_by_exponent_;
  double worth_ = 0.0;  ///< Of the step, in squared standard deviations.
  double moved_ = 0.0;  ///< Of the corners since the beginning, in half tag sizes.
};

}  // namespace apriltrack
