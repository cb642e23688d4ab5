// A stranger's program that reads images, inspects and calibrates: what it shows is that all link and run.
#include <apriltrack/base/error.h>
#include <apriltrack/calib/calibrate_map.h>
#include <apriltrack/inspect/findings.h>
#include <apriltrack/source/frame_source.h>

#include <cstdio>

int main(int argc, char** argv) {
  if (argc != 2) return 2;
  const auto source = apriltrack::open_source(argv[1]);
  const auto frame = source->next();
  if (!frame || !frame->is_readable() || frame->pixels.width() != 2 || frame->pixels(1, 0) != 'B') return 1;
  if (apriltrack::inspection_findings({}).empty()) return 1;
  try {
    apriltrack::calibrate_map({}, apriltrack::CameraRig{}, apriltrack::TagSizes(0.16), {});
  } catch (const apriltrack::Error& error) {
    std::printf("read %s; calibrating nothing says: %s\n", frame->name.c_str(), error.what());
    return 0;
  }
  return 1;
}
