#pragma once

#include <Eigen/Core>
#include <optional>

#include "code_curve.h"
#include "photometric_view.h"

namespace apriltrack {

/// One picture of one tag in the camera's own grey levels, and all that explains it but the camera's
/// response: the tag's pose, the lens blur, contrast, its slopes and the black level
/// (docs/algorithms/response.md, equation 1).
class CodedView {
 public:
  /// pixels: as read_pixels() gives them of a camera with a linear response, that is grey levels of full
  /// scale 1. camera: must outlive this.
  CodedView(PhotometricView pixels, const CameraModel& camera, const PrintedTag& tag,
            const Pose& T_camera_tag);

  /// What the pixels say of the curve, all else eliminated; in variances of a pixel's noise.
  struct Equation {
    double h = 0.0, g = 0.0;  ///< Gauss and Newton's, of the exponent of gamma().
    double by_print = 0.0;    ///< Of g, by a metre that white cells are printed too wide on each side.
    double cost = 0.0;        ///< Half the robust squares of the residuals.
  };
  /// Starts over with the colours that the curve makes of black and white. False where there is not enough
  /// of both.
  bool begin(const CodeCurve& curve);
  /// All but the curve follows the pixels; nullopt where the tag is not seen as it should be.
  std::optional<Equation> settle(const CodeCurve& curve);
  /// Of the residuals of settle(), from here on.
  void measure_noise();

  double psf_sigma_px() const { return psf_sigma_px_; }
  double noise() const { return noise_; }  ///< Standard deviation of a pixel, full scale 1.
  /// sqrt of the share of the pixels' variance that is explained.
  double correlation() const;

 private:
  static constexpr int kNumColours = 4;
  static constexpr int kNumUnknowns = 7 + kNumColours;  ///< Pose, blur, colours.
  using Unknowns = Eigen::Matrix<double, kNumUnknowns, 1>;

  struct Rows {
    Eigen::Matrix<double, Eigen::Dynamic, kNumUnknowns> by_unknowns;
    Eigen::VectorXd by_exponent, by_print, weights;
    double cost = 0.0;
  };
  /// By place, blur and print: of the picture, black 0 and white 1; and the colours' factors.
  bool predict_picture(Rows& rows) const;
  void predict_codes(const CodeCurve& curve, Rows& rows);
  struct Step {
    Equation equation;
    Unknowns unknowns = Unknowns::Zero();
    double worth = 0.0;  ///< In squared standard deviations.
  };
  Step eliminate(const Rows& rows) const;
  void move(const Unknowns& step);

  PhotometricView pixels_;
  const CameraModel* camera_;
  PrintedTag tag_;
  Pose T_camera_tag_;
  double psf_sigma_px_ = 0.6;
  Eigen::Matrix<double, kNumColours, 1> colours_ = Eigen::Matrix<double, kNumColours, 1>::Zero();
  double noise_;
  Eigen::VectorXd residuals_;
};

}  // namespace apriltrack
