# Every outside library, from Debian's packages (scripts/setup installs them).
# Imported targets are SYSTEM, so that their headers do not meet our warnings.

find_package(Threads REQUIRED)
find_package(Eigen3 3.4 REQUIRED NO_MODULE)
find_package(fmt REQUIRED)
find_package(yaml-cpp REQUIRED)
find_package(nlohmann_json REQUIRED)
find_package(apriltag REQUIRED)
find_package(hwy REQUIRED)
# The kernels keep vectors in structs, which types without a size known to the compiler forbid: scalable vectors of ARM (its
# processors have NEON as well) and of RISC-V.
set_property(TARGET hwy::hwy APPEND PROPERTY INTERFACE_COMPILE_DEFINITIONS
  "HWY_DISABLED_TARGETS=(HWY_SVE|HWY_SVE2|HWY_SVE_256|HWY_SVE2_128|HWY_RVV)")
find_package(Ceres REQUIRED)
find_package(OpenCV REQUIRED COMPONENTS core imgproc imgcodecs videoio)
# For the times of video frames, which OpenCV tells wrongly, and to write videos, where OpenCV does not tell of a full
# disk; Debian's libopencv-dev brings it.
find_package(PkgConfig REQUIRED)
pkg_check_modules(FFMPEG REQUIRED IMPORTED_TARGET libavformat libavcodec libswscale libavutil)
# For grey JPEG pictures and word of their damage, which OpenCV does not tell.
pkg_check_modules(JPEG REQUIRED IMPORTED_TARGET libjpeg)
# Of bags: how their chunks are packed, and the files that rosbag2 writes by default.
pkg_check_modules(LZ4 REQUIRED IMPORTED_TARGET liblz4)
pkg_check_modules(ZSTD REQUIRED IMPORTED_TARGET libzstd)
find_package(BZip2 REQUIRED)  # without a pkg-config file on Debian 12
pkg_check_modules(SQLITE3 REQUIRED IMPORTED_TARGET sqlite3)
find_package(CLI11 REQUIRED)
