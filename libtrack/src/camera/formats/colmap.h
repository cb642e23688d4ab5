#pragma once

#include <array>
#include <string_view>

namespace apriltrack {

/// COLMAP puts (0, 0) at the outer corner of the top-left pixel, we at its centre
/// (colmap/colmap: src/colmap/sensor/models.h).
inline constexpr double kColmapPixelOffset_px = 0.5;

/// A camera model of COLMAP that is one of ours.
struct ColmapModel {
  std::string_view name;
  int num_focal_lengths;  ///< 1: f is fx and fy.
  int num_coefficients;   ///< After the focal lengths and cx, cy.
  bool is_fisheye;        ///< The coefficients are k1 .. k4 of equidistant, those that are missing 0.
};

/// Coefficients of the others are OpenCV's, those that are missing 0.
inline constexpr std::array<ColmapModel, 9> kColmapModels = {{{"SIMPLE_PINHOLE", 1, 0, false},
                                                              {"PINHOLE", 2, 0, false},
                                                              {"SIMPLE_RADIAL", 1, 1, false},
                                                              {"RADIAL", 1, 2, false},
                                                              {"OPENCV", 2, 4, false},
                                                              {"FULL_OPENCV", 2, 8, false},
                                                              {"SIMPLE_RADIAL_FISHEYE", 1, 1, true},
                                                              {"RADIAL_FISHEYE", 1, 2, true},
                                                              {"OPENCV_FISHEYE", 2, 4, true}}};

}  // namespace apriltrack
