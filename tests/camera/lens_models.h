#pragma once

#include <cmath>
#include <numbers>
#include <ostream>
#include <string>
#include <vector>

#include "apriltrack/camera/camera_model.h"

namespace apriltrack::test {

/// One lens of the property suite.
struct Lens {
  std::string name;
  CameraModel model;
  double max_angle_rad;  ///< The tests walk over the angles below; beyond the model's own limit they expect
                         ///< nullopt.
};

inline void PrintTo(const Lens& lens, std::ostream* out) {
  *out << lens.name;
}

/// Largest angle from the axis that the model itself claims to see.
struct MaxAngle {
  double operator()(const NoDistortion&) const { return 0.5 * std::numbers::pi; }
  double operator()(const RadtanDistortion& lens) const { return std::atan(lens.max_radius()); }
  double operator()(const EquidistantDistortion& lens) const { return lens.max_angle_rad(); }
};

inline Lens make_lens(const std::string& name, const Pinhole& pinhole, const Distortion& distortion) {
  const double limit = std::visit(MaxAngle{}, distortion);
  return {name, CameraModel(pinhole, distortion), limit};
}

/// Focal lengths and principal points differ in x and y, so that a transpose shows.
inline std::vector<Lens> all_lenses() {
  return {
      make_lens("none", {520.6, 497.4, 322.4, 237.3}, NoDistortion()),
      make_lens("radtan_room", {520.6, 519.4, 322.4, 237.3},
                RadtanDistortion({-0.28, 0.09, 0.0005, -0.0003})),
      make_lens("radtan_euroc", {458.654, 457.296, 367.215, 248.375},
                RadtanDistortion({-0.28340811, 0.07395907, 0.00019359, 1.76187114e-05})),
      make_lens("radtan_folds_early", {300.0, 310.0, 322.4, 237.3}, RadtanDistortion({-0.4, 0.02, 0.0, 0.0})),
      make_lens(
          "radtan_phone", {621.7, 611.2, 242.5, 340.7},
          RadtanDistortion({0.12574925533818154, -0.29469338336037687, 0.006697021989197616, 5.35e-05})),
      make_lens("radtan_tangential", {400.0, 420.0, 310.0, 250.0},
                RadtanDistortion({-0.1, 0.01, 0.02, -0.03})),
      make_lens("radtan_strongly_tangential", {400.0, 420.0, 310.0, 250.0},
                RadtanDistortion({-0.1, 0.01, 0.06, -0.08})),
      make_lens("radtan_five", {1506.9, 1506.28, 641.176, 524.495},
                RadtanDistortion({-0.233024, 0.217972, 0.000104351, -9.65731e-05, -0.0913426})),
      make_lens("radtan_rational", {1706.9, 1700.1, 960.5, 554.3},
                RadtanDistortion({0.8293548413467797, -1.563453123079522, -0.0021809305730306383,
                                  0.0010316589079369717, 3.2612294894659852, 0.5712738259830856,
                                  0.16056556701700878, -0.11542135306858661})),
      make_lens("radtan_pole", {500.0, 510.0, 320.0, 240.0},
                RadtanDistortion({0.1, 0.0, 0.001, -0.0005, 0.0, -0.8, 0.0, 0.0})),
      make_lens("equidistant_ideal", {310.0, 305.0, 630.0, 512.0},
                EquidistantDistortion({0.0, 0.0, 0.0, 0.0})),
      make_lens("equidistant_wide", {465.609, 465.632, 622.637, 513.902},
                EquidistantDistortion({-0.0229515, 0.01625, -0.00961832, 0.00176252})),
      make_lens("equidistant_folds", {470.338, 461.1, 620.702, 534.861},
                EquidistantDistortion({-0.0177484, -0.00281825, 0.00696388, -0.0030704})),
      make_lens("equidistant_narrow", {470.338, 461.1, 620.702, 534.861},
                EquidistantDistortion({-0.3, -0.05, 0.02, -0.01})),
  };
}

}  // namespace apriltrack::test
