#include "one_image.h"

#include <algorithm>

#include "support/shared_data.h"

namespace apriltrack::test {

const char* const kGoodMap =
    "apriltrack_map: 1\nframe: world\ndefault_family: tag36h11\ntags:\n  - id: 0\n    size: 0.16\n    pose:\n"
    "      position: {x: 0.0, y: 0.0, z: 0.0}\n      orientation: {x: 0.0, y: 0.0, z: 0.0, w: 1.0}\n";
const char* const kGoodCamera =
    "cam0:\n  camera_model: pinhole\n  intrinsics: [500.0, 500.0, 79.5, 59.5]\n  distortion_model: none\n"
    "  distortion_coeffs: []\n  resolution: [160, 120]\n";

void OneImage::SetUp() {
  folder_ = temporary_folder();
  write_text(path("camera.yaml"), kGoodCamera);
  write_text(path("map.yaml"), kGoodMap);
  write_image(path("frames/1000000000.pgm"), 160, 120);
}

void OneImage::write_image(const std::string& file, int width, int height) {
  const std::size_t half = static_cast<std::size_t>(width) * (height / 2);  // a wall over a floor
  write_text(file, "P5\n" + std::to_string(width) + " " + std::to_string(height) + "\n255\n" +
                       std::string(half, '\x80') +
                       std::string(static_cast<std::size_t>(width) * height - half, '\x60'));
}

ProgramRun OneImage::run_with(std::vector<std::string> words, const std::vector<std::string>& changes) {
  for (std::size_t i = 0; i + 1 < changes.size(); i += 2) {
    const auto option = std::find(words.begin(), words.end(), changes[i]);
    if (option == words.end()) {
      words.insert(words.end(), {changes[i], changes[i + 1]});
    } else {
      option[1] = changes[i + 1];
    }
  }
  return run_program(words);
}

ProgramRun OneImage::track(const std::vector<std::string>& changes) const {
  return run_with({"track", path("frames"), "--camera", path("camera.yaml"), "--map", path("map.yaml"),
                   "--output", path("out.tum")},
                  changes);
}

ProgramRun OneImage::calibrate(const std::vector<std::string>& changes) const {
  return run_with({"calibrate", path("frames"), "--camera", path("camera.yaml"), "--tag-size", "0.16",
                   "--output", path("new_map.yaml")},
                  changes);
}

ProgramRun OneImage::detect(const std::vector<std::string>& changes) const {
  return run_with(
      {"detect", path("frames"), "--camera", path("camera.yaml"), "--output", path("corners.csv")}, changes);
}

std::string replaced(std::string text, const std::string& find, const std::string& replace) {
  const std::size_t at = text.find(find);
  EXPECT_NE(at, std::string::npos);
  return text.replace(at, find.size(), replace);
}

}  // namespace apriltrack::test
