#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "apriltrack/camera/camera_model.h"

namespace apriltrack {

/// One line of a text file that has something in it, for messages and for reading.
struct TextLine {
  std::string where;  ///< "cameras.txt:3"
  std::string text;   ///< Without blanks at its ends and without a comment.
};

/// Lines that are neither empty nor comments (#).
std::vector<TextLine> content_lines(const std::string& text, const std::string& name);

std::vector<std::string> words_of(std::string_view text);

/// Finite; throws Error(kInvalidInput) with the line and `what` the number is.
double number_of(const std::string& word, const TextLine& line, std::string_view what);
/// 1 to 100,000 pixels.
int side_of(const std::string& word, const TextLine& line, std::string_view what);

/// What is wrong with a lens is told with the place where it stands.
CameraModel model_at(const std::string& where, const Pinhole& pinhole, const Distortion& distortion);

}  // namespace apriltrack
