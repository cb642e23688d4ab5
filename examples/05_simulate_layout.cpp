// Will MY layout of tags work with MY lens, at MY speed? Before anything is printed: film it in memory, track
// it, and compare with the truth. Change the three functions; or read layout, lens and path from files, as
// `apriltrack simulate --map MAP --camera CAMERA --trajectory PATH` does.
#include <apriltrack/apriltrack.h>
#include <apriltrack/camera/radtan.h>
#include <apriltrack/eval/evaluate_trajectory.h>
#include <apriltrack/eval/statistics.h>
#include <apriltrack/sim/map_scene.h>
#include <apriltrack/sim/renderer.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <numbers>
#include <vector>

using apriltrack::Pose;

/// Six tags in two rows on a wall. World: x along the wall, y up, z out of the wall, towards the robot.
apriltrack::TagMap my_layout(double tag_size_m) {
  // A tag's own axes are x right, y down, z into the wall, as one looks at it: turned by half a turn about x.
  const Eigen::Quaterniond R_world_tag(Eigen::AngleAxisd(std::numbers::pi, Eigen::Vector3d::UnitX()));
  apriltrack::TagMap map;
  for (int id = 0; id < 6; ++id) {
    const Eigen::Vector3d centre_m(0.6 * (id % 3), 0.5 * (id / 3), 0.0);
    map.tags.push_back({{"tag36h11", id}, tag_size_m, Pose(R_world_tag, centre_m), {}, {}, {}});
  }
  return map;
}

/// A wide-angle lens, from its data sheet or a calibration.
apriltrack::Camera my_camera(double exposure_s) {
  const apriltrack::Pinhole pinhole{410.0, 410.0, 319.5, 239.5};
  apriltrack::Camera camera{.name = "cam0",
                            .model = {pinhole, apriltrack::RadtanDistortion({-0.20, 0.04, 0.0, 0.0})}};
  camera.width = 640;
  camera.height = 480;
  camera.exposure_s = exposure_s;
  return camera;
}

/// Past the wall at 1.5 m from it, swaying: T_world_camera at 30 Hz. The camera's axes are a tag's.
apriltrack::SampledPath my_path(double speed_m_per_s) {
  constexpr double kLength_m = 1.2, kStep_s = 1.0 / 30.0;
  std::vector<apriltrack::SampledPath::Sample> samples;
  for (double time_s = 0.0; samples.size() < 3 || speed_m_per_s * time_s < kLength_m; time_s += kStep_s) {
    const double yaw_rad = 0.15 * std::cos(2.0 * std::numbers::pi * 1.5 * time_s);
    const Eigen::Quaterniond R_world_camera(Eigen::AngleAxisd(std::numbers::pi, Eigen::Vector3d::UnitX()) *
                                            Eigen::AngleAxisd(yaw_rad, Eigen::Vector3d::UnitY()));
    samples.push_back({time_s, Pose(R_world_camera, {speed_m_per_s * time_s, 0.25, 1.5})});
  }
  return apriltrack::SampledPath(std::move(samples));
}

int main(int argc, char** argv) try {
  const double tag_size_m = argc == 4 ? std::atof(argv[1]) : 0.0;
  const double exposure_s = argc == 4 ? std::atof(argv[2]) : 0.0;
  const double speed_m_per_s = argc == 4 ? std::atof(argv[3]) : 0.0;
  if (!(tag_size_m > 0.0 && exposure_s > 0.0 && speed_m_per_s > 0.0)) {
    std::fprintf(stderr, "usage: %s TAG_SIZE_M EXPOSURE_S SPEED_M_PER_S    for instance 0.16 0.01 1\n",
                 argv[0]);
    return 2;
  }
  const apriltrack::TagMap map = my_layout(tag_size_m);
  const apriltrack::Camera camera = my_camera(exposure_s);
  const apriltrack::Scene scene = apriltrack::make_map_scene({map, camera, my_path(speed_m_per_s)});
  const apriltrack::Renderer renderer(
      scene);  // blur, lens and noise; scene.lighting, scene.formation: dark, ...
  apriltrack::BlurTracker tracker(camera, map);

  std::vector<double> errors_mm, sigmas_mm;
  for (std::size_t i = 0; i < scene.num_frames; ++i) {
    const apriltrack::RenderedFrame film = renderer.render(i);
    const apriltrack::TrackResult result = tracker.track(film.frame());
    // A prediction is no measurement: the layout has failed in such a frame.
    if (!result.pose || result.status == apriltrack::TrackStatus::kPredicted) continue;
    errors_mm.push_back(1e3 * apriltrack::pose_error(film.truth, *result.pose).position_m);
    sigmas_mm.push_back(1e3 * std::sqrt(result.covariance->topLeftCorner<3, 3>().trace()));
  }
  if (errors_mm.empty()) {
    std::printf("0 of %zu frames have a pose\n", scene.num_frames);
    return 1;
  }
  std::printf(
      "%zu of %zu frames have a pose; error: median %.2f mm, 95 %% within %.2f mm; claimed sigma: median "
      "%.2f mm\n",
      errors_mm.size(), scene.num_frames, apriltrack::median(errors_mm),
      apriltrack::percentile(errors_mm, 0.95), apriltrack::median(sigmas_mm));
  return errors_mm.size() >= 0.95 * static_cast<double>(scene.num_frames) ? 0 : 1;
} catch (const apriltrack::Error& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 2;
}
