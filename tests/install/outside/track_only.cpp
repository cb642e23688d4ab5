// A stranger's program: localises a camera from the corners that it must see, and gets its pose back.
#include <apriltrack/apriltrack.h>

#include <cstdio>

int main(int argc, char** argv) {
  if (argc != 2) return 2;
  const apriltrack::TagMap map = apriltrack::read_tag_map(argv[1]);
  apriltrack::Camera camera{
      .name = "cam0",
      .model = apriltrack::CameraModel({600.0, 600.0, 320.0, 240.0}, apriltrack::NoDistortion{})};
  camera.width = 640;
  camera.height = 480;

  apriltrack::Vector6d xi;
  xi << 0.1, -0.05, -1.5, 0.1, 0.2, -0.05;
  const apriltrack::Pose T_world_camera = apriltrack::Pose::exp(xi);
  apriltrack::FrameDetections seen;
  for (const apriltrack::MapTag& tag : map.tags) {
    apriltrack::Detection detection;
    detection.tag = tag.key;
    for (std::size_t i = 0; i < 4; ++i) {
      const auto pixel = camera.model.project(T_world_camera.inverse() * apriltrack::corners_in_map(tag)[i]);
      if (!pixel) return 1;
      detection.corners_px[i] = *pixel;
    }
    seen.detections.push_back(detection);
  }

  apriltrack::Localizer localizer(camera, map);
  const apriltrack::TrackResult result = localizer.localize(seen);
  if (!result.pose) return 1;
  const double error_m = (result.pose->translation() - T_world_camera.translation()).norm();
  std::printf("localised from %d tags, %.2g mm off\n", result.tags_tracked, 1e3 * error_m);
  return error_m < 1e-6 && result.tags_tracked == 2 ? 0 : 1;
}
