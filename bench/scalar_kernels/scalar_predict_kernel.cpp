// The kernel that predicts once more, by Highway's scalar target, which the library itself leaves out.
#define HWY_COMPILE_ONLY_SCALAR
#include "pixel_kernels.h"

namespace apriltrack_scalar {
using namespace apriltrack;
}
#define apriltrack apriltrack_scalar
#include "predict_kernel.cpp"
