// From images to camera poses, each with its uncertainty.
#include <apriltrack/apriltrack.h>
#include <apriltrack/source/frame_source.h>

#include <cmath>
#include <cstdio>

int main(int argc, char** argv) try {
  if (argc != 4) {
    std::fprintf(stderr, "usage: %s CAMERA.yaml MAP.yaml INPUT    (a video, a folder of images, camera:0)\n",
                 argv[0]);
    return 2;
  }
  const auto camera = apriltrack::read_cameras(argv[1]).cameras.front();
  const auto map = apriltrack::read_tag_map(argv[2]);
  apriltrack::BlurTracker tracker(camera, map);

  int num_poses = 0;
  const auto source = apriltrack::open_source(argv[3]);
  while (const auto image = source->next()) {
    const apriltrack::TrackResult result = tracker.track(image->frame());
    if (result.pose) {  // T_world_camera, with its covariance
      const auto& p = result.pose->translation();
      const double sigma_mm = 1e3 * std::sqrt(result.covariance->topLeftCorner<3, 3>().trace());
      std::printf("%s: %.3f %.3f %.3f m, sigma %.1f mm, %d tags\n", to_string(result.status).c_str(), p.x(),
                  p.y(), p.z(), sigma_mm, result.tags_tracked);
      ++num_poses;
    } else {
      std::printf("lost: %s\n", result.reason.c_str());
    }
  }
  return num_poses > 0 ? 0 : 1;
} catch (const apriltrack::Error& error) {  // what all readers throw: the file, what is wrong, the way out
  std::fprintf(stderr, "%s\n", error.what());
  return 2;
}
