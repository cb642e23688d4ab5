#include "numerics/normal_distribution.h"

#include <cmath>

namespace apriltrack {

double student_place(double place, double degrees) {
  const double middle = degrees - 2.0 / 3.0 + 0.1 / degrees;
  return std::sqrt(degrees * std::expm1(place * place * (degrees - 5.0 / 6.0) / (middle * middle)));
}

}  // namespace apriltrack
