// Memory and latency of the blur tracker over a very long run: a clip is read once and shown again and again,
// its time stamps going on, as from a camera that is never switched off.
//
//   bench_endurance CLIP [--frames 100000] [--mode ego|joint] [--shrink 2]
//
// CLIP is a sequence folder whose end meets its beginning (`simulate --scene room --frames 1800`: five rounds
// of 12 s). Prints a line for every tenth of the frames: resident memory, latency, statuses. Detection is
// part of the latency.

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <fstream>
#include <string>
#include <vector>

#include "apriltrack/base/error.h"
#include "apriltrack/source/frame_source.h"
#include "apriltrack/tags/tag_map.h"
#include "apriltrack/tracker/blur_tracker.h"

namespace apriltrack {
namespace {

struct EnduranceOptions {
  std::string clip;
  std::size_t num_frames = 100'000;
  TrackMode mode = TrackMode::kEgo;
  int shrink = 2;
};

/// Mean of shrink x shrink codes: small images are quick to search, and the run is about memory.
GrayImage shrunk(const GrayImage& image, int shrink) {
  GrayImage small(image.width() / shrink, image.height() / shrink);
  for (int y = 0; y < small.height(); ++y) {
    for (int x = 0; x < small.width(); ++x) {
      int sum = 0;
      for (int v = 0; v < shrink; ++v) {
        for (int u = 0; u < shrink; ++u) sum += image(x * shrink + u, y * shrink + v);
      }
      small(x, y) = static_cast<std::uint8_t>((sum + shrink * shrink / 2) / (shrink * shrink));
    }
  }
  return small;
}

/// Pixel (0, 0) is a pixel's centre, so that centres move by half of what a pixel grows.
Camera shrunk(const Camera& camera, int shrink) {
  const Pinhole& lens = camera.model.pinhole();
  const double scale = 1.0 / shrink;
  Camera small = camera;
  small.model = CameraModel(
      Pinhole{scale * lens.fx, scale * lens.fy, scale * (lens.cx + 0.5) - 0.5, scale * (lens.cy + 0.5) - 0.5},
      camera.model.distortion());
  small.width = camera.width / shrink;
  small.height = camera.height / shrink;
  return small;
}

std::vector<SourceFrame> load(const EnduranceOptions& options) {
  std::vector<SourceFrame> clip;
  const auto source = open_source(options.clip);
  while (auto frame = source->next()) {
    if (!frame->is_readable()) throw io_error(frame->name, frame->error);
    frame->pixels = shrunk(frame->pixels, options.shrink);
    clip.push_back(std::move(*frame));
  }
  if (clip.size() < 2) throw invalid_input("CLIP", "needs two frames or more");
  return clip;
}

/// Resident now, from /proc/self/statm.
double resident_mb() {
  std::ifstream file("/proc/self/statm");
  long long size = 0;
  long long resident = 0;
  file >> size >> resident;
  return 1e-6 * static_cast<double>(resident) * static_cast<double>(sysconf(_SC_PAGESIZE));
}

struct Block {
  std::vector<double> latency_ms;
  std::array<std::size_t, 5> statuses{};

  void print(std::size_t num_done) {
    std::sort(latency_ms.begin(), latency_ms.end());
    const auto quantile = [&](double share) {
      return latency_ms[static_cast<std::size_t>(share * static_cast<double>(latency_ms.size() - 1))];
    };
    std::string counts;
    for (std::size_t i = 0; i < statuses.size(); ++i) {
      if (statuses[i] > 0)
        counts += fmt::format(" {} {}", statuses[i], to_string(static_cast<TrackStatus>(i)));
    }
    fmt::print("frames {} resident_mb {:.1f} median_ms {:.3f} p99_ms {:.3f}{}\n", num_done, resident_mb(),
               quantile(0.5), quantile(0.99), counts);
    std::fflush(stdout);
    *this = {};
  }
};

void endure(const EnduranceOptions& options) {
  const Camera camera =
      shrunk(read_cameras(*sequence_camera_file(options.clip)).cameras.front(), options.shrink);
  const std::vector<SourceFrame> clip = load(options);
  BlurTrackerOptions tracker_options;
  tracker_options.mode = options.mode;
  BlurTracker tracker(camera, read_tag_map(*sequence_map_file(options.clip)), tracker_options);
  tracker.prepare();
  const std::int64_t interval_ns = clip[1].timestamp.ns - clip[0].timestamp.ns;
  const std::int64_t round_ns = clip.back().timestamp.ns - clip.front().timestamp.ns + interval_ns;
  fmt::print("clip of {} frames {} x {}, resident with the clip {:.1f} MB\n", clip.size(), camera.width,
             camera.height, resident_mb());
  Block block;
  const std::size_t block_size = std::max<std::size_t>(options.num_frames / 10, 1);
  for (std::size_t i = 0; i < options.num_frames; ++i) {
    Frame frame = clip[i % clip.size()].frame();
    frame.timestamp.ns += static_cast<std::int64_t>(i / clip.size()) * round_ns;
    const auto start = std::chrono::steady_clock::now();
    const TrackResult result = tracker.track(frame);
    block.latency_ms.push_back(
        std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count());
    ++block.statuses[static_cast<std::size_t>(result.status)];
    if ((i + 1) % block_size == 0) block.print(i + 1);
  }
}

EnduranceOptions parse(int argc, char** argv) {
  EnduranceOptions options;
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    const bool has_value = i + 1 < argc;
    if (word == "--frames" && has_value) {
      options.num_frames = std::stoul(argv[++i]);
    } else if (word == "--mode" && has_value) {
      options.mode = std::string(argv[++i]) == "joint" ? TrackMode::kJoint : TrackMode::kEgo;
    } else if (word == "--shrink" && has_value) {
      options.shrink = std::stoi(argv[++i]);
    } else if (word.starts_with("--") || !options.clip.empty()) {
      throw invalid_input(word,
                          "is not known; usage: bench_endurance CLIP [--frames N] [--mode M] [--shrink N]");
    } else {
      options.clip = word;
    }
  }
  if (!sequence_camera_file(options.clip) || !sequence_map_file(options.clip))
    throw invalid_input("CLIP", "must be a sequence folder with a camera and a map");
  if (options.num_frames == 0 || options.shrink < 1)
    throw invalid_input("--frames, --shrink", "must be 1 or more");
  return options;
}

}  // namespace
}  // namespace apriltrack

int main(int argc, char** argv) {
  try {
    apriltrack::endure(apriltrack::parse(argc, argv));
  } catch (const apriltrack::Error& error) {
    fmt::print(stderr, "error: {}\n", error.what());
    return static_cast<int>(error.kind());
  }
  return 0;
}
