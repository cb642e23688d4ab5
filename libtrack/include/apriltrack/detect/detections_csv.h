#pragma once

#include <filesystem>
#include <span>
#include <vector>

#include "apriltrack/detect/detection.h"

namespace apriltrack {

/// Reads `timestamp_ns,camera,family,id,c0x,...,c3y[,hamming,margin][,cov_00,...,cov_77]`, grouped by frame
/// (same time and camera), in the file's order; cov_ij: the upper triangle of Detection::covariance_px2.
/// Throws Error(kIo) when unreadable; Error(kInvalidInput) with file, line, column and value when a number is
/// missing, not finite, or time runs backwards within a camera.
std::vector<FrameDetections> read_detections_csv(const std::filesystem::path& path);

/// Corners with six decimals, covariances with six digits where any detection has one. Throws Error(kIo); an
/// existing file is replaced only when the new one is complete.
void write_detections_csv(const std::filesystem::path& path, std::span<const FrameDetections> frames);

}  // namespace apriltrack
