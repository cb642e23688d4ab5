// From images of tags to a map of them: where each tag is, how sure that is, and what to know of the result.
#include <apriltrack/apriltrack.h>
#include <apriltrack/calib/calibrate_map.h>
#include <apriltrack/detect/estimate_response.h>
#include <apriltrack/source/frame_source.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <vector>

int main(int argc, char** argv) try {
  if (argc != 5) {
    std::fprintf(stderr, "usage: %s CAMERA.yaml INPUT TAG_SIZE_M MAP-TO-WRITE.yaml\n", argv[0]);
    return 2;
  }
  const apriltrack::CameraRig rig = apriltrack::read_cameras(argv[1]);
  const apriltrack::Camera& camera = rig.cameras.front();

  // The detector localises corners in linear light, along edges that the lens bends: it wants both from the
  // camera.
  apriltrack::DetectorOptions detector_options;
  detector_options.response = camera.response;
  // Of a camera file that tells no response: its corners' covariances count that it may be another than sRGB.
  detector_options.rival_response = apriltrack::rival_response(camera.response, camera.response_origin);
  detector_options.camera_model = camera.model;
  apriltrack::Detector detector(detector_options);

  std::vector<apriltrack::FrameDetections> frames;
  const auto source = apriltrack::open_source(argv[2]);
  while (const auto image = source->next()) {
    if (!image->is_readable()) continue;  // a calibration does not need every frame
    apriltrack::check_resolution(camera, image->pixels.width(), image->pixels.height(), image->name);
    frames.push_back({image->timestamp, camera.name, detector.detect(image->pixels.view())});
    frames.back().exposure_s = image->exposure_s;
  }

  // The edge of the square whose corners are detected. Images cannot tell it: measure a printed tag.
  const apriltrack::TagSizes sizes(std::atof(argv[3]));
  const apriltrack::CalibrationResult result = apriltrack::calibrate_map(frames, rig, sizes, {});
  apriltrack::write_tag_map(argv[4], result.map);

  std::printf("%zu tags from %d frames, residuals of %.3f px\n", result.map.tags.size(), result.frames_used,
              result.residual_rms_px);
  for (const apriltrack::MapTag& tag : result.map.tags) {
    // Relative to the tag that is held at the origin, which has no uncertainty of its own.
    const auto& p = tag.T_map_tag.translation();
    const double sigma_mm =
        tag.covariance ? 1e3 * std::sqrt(tag.covariance->topLeftCorner<3, 3>().trace()) : NAN;
    std::printf("%s: %.4f %.4f %.4f m, sigma %.2f mm, %d views\n", to_string(tag.key).c_str(), p.x(), p.y(),
                p.z(), sigma_mm, tag.statistics ? tag.statistics->views : 0);
  }
  for (const apriltrack::TagKey& tag : result.left_out)
    std::printf("%s: in no map\n", to_string(tag).c_str());
  for (const apriltrack::CalibrationFinding& finding : result.findings)
    std::printf("note: %s\n", finding.message.c_str());
} catch (const apriltrack::Error& error) {
  // Nothing connected, say, is status 1; a file or a value that is wrong, 2.
  std::fprintf(stderr, "%s\n", error.what());
  return error.kind() == apriltrack::ErrorKind::kNoResult ? 1 : 2;
}
