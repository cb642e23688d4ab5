// Which tag is wrong, in what, by how much, and how sure is that? As data, for a program that acts on it.
#include <apriltrack/apriltrack.h>
#include <apriltrack/calib/calibrate_map.h>
#include <apriltrack/detect/detections_csv.h>

#include <cstdio>
#include <optional>
#include <string>

using Kind = apriltrack::CalibrationFinding::Kind;

/// What a robot's software may do about it, without reading a sentence.
std::string remedy(const apriltrack::CalibrationFinding& finding) {
  // In doubt: another tag may be at fault as well, and nobody should act on this one alone.
  if (finding.is_in_doubt) return "look at it, and at the others that may be at fault";
  switch (finding.kind) {
    case Kind::kWrongSize:
      return "measure the tag and state its size";
    case Kind::kMoved:
      return "use only what was filmed after it moved";
    case Kind::kDuplicateId:
      return "print one of the two with another id";
    case Kind::kBent:
    case Kind::kLoose:
      return "fix the tag on something flat and stiff";
    default:
      return "";  // further kinds may come with any version
  }
}

int main(int argc, char** argv) try {
  if (argc != 4) {
    std::fprintf(stderr, "usage: %s DETECTIONS.csv CAMERA.yaml TAG_SIZES.yaml\n", argv[0]);
    return 2;
  }
  const auto frames = apriltrack::read_detections_csv(argv[1]);
  const auto rig = apriltrack::read_cameras(argv[2]);
  const auto sizes = apriltrack::read_tag_sizes(argv[3], std::nullopt);
  const auto result = apriltrack::calibrate_map(frames, rig, sizes, {});

  bool has_fault = false;
  for (const apriltrack::CalibrationFinding& finding : result.findings) {
    std::printf("%s:", std::string(to_string(finding.kind)).c_str());
    for (const apriltrack::TagKey& tag : finding.tags) std::printf(" %s", to_string(tag).c_str());
    // Of kWrongSize the value is a factor, of kMoved metres: docs/file_formats.md has the table. Not all have
    // one.
    if (finding.value) std::printf(", %.4f", *finding.value);
    if (finding.sigma) std::printf(" +- %.4f", *finding.sigma);
    if (finding.value) std::printf(" %s", std::string(finding.unit).c_str());
    if (finding.timestamp) std::printf(", from %s s on", format_seconds(*finding.timestamp).c_str());
    // Natural logarithm of the odds that it is so over that nothing is wrong: 3 is twenty to one.
    if (finding.log_odds) std::printf(", log odds %.1f", *finding.log_odds);
    if (finding.is_left_out) std::printf(", left out of the map");
    const std::string what_to_do = remedy(finding);
    if (!what_to_do.empty()) std::printf("; %s", what_to_do.c_str());
    std::printf("\n");
    has_fault = has_fault || !what_to_do.empty();
  }
  std::printf("%zu tags in the map, %zu left out\n", result.map.tags.size(), result.left_out.size());
  return has_fault ? 1 : 0;
} catch (const apriltrack::Error& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return error.kind() == apriltrack::ErrorKind::kNoResult ? 1 : 2;
}
