// Images from one's own driver, without an apriltrack source: several cameras at once, a thread and a tracker
// for each, and the poses of all of them in the order of time.
#include <apriltrack/apriltrack.h>
#include <apriltrack/source/frame_source.h>

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <exception>
#include <string>
#include <thread>
#include <vector>

/// An image as a driver may hand it out: bytes, with rows that are longer than the picture is wide.
struct DriverImage {
  std::vector<std::uint8_t> bytes;
  int width = 0, height = 0, bytes_per_row = 0;
  std::int64_t time_ns = 0;  ///< Middle of the exposure. A stamp of its start needs half the exposure added.
};

/// Stands for the driver, and is the only part that reads files.
std::vector<DriverImage> grab(const std::string& recording) {
  std::vector<DriverImage> images;
  const auto source = apriltrack::open_source(recording);
  while (const auto frame = source->next()) {
    const apriltrack::GrayView pixels = frame->pixels.view();
    DriverImage image{
        {}, pixels.width(), pixels.height(), (pixels.width() + 63) / 64 * 64 + 64, frame->timestamp.ns};
    image.bytes.resize(static_cast<std::size_t>(image.bytes_per_row) *
                       static_cast<std::size_t>(image.height));
    for (int y = 0; y < image.height; ++y)
      std::memcpy(image.bytes.data() + y * image.bytes_per_row, pixels.row(y),
                  static_cast<std::size_t>(image.width));
    images.push_back(std::move(image));
  }
  return images;
}

/// No copy is made: the view and the bytes behind it must live until track() returns, and no longer.
apriltrack::Frame frame_of(const DriverImage& image) {
  apriltrack::Frame frame;
  frame.image = {image.bytes.data(), image.width, image.height, image.bytes_per_row};
  frame.timestamp = {image.time_ns};
  return frame;  // exposure_s is left to the camera file; where the driver tells each frame's, give it here
}

/// What one camera's thread does. Frames of one tracker come in the order of time: each is looked for near
/// the last.
void track_all(const apriltrack::Camera& camera, const apriltrack::TagMap& map, const std::string& recording,
               std::vector<apriltrack::TrackResult>& results, std::exception_ptr& failure) try {
  apriltrack::BlurTracker tracker(camera, map);  // not shared: a tracker serves one thread
  tracker.prepare();  // builds tables now, so that the first frame is as quick as others
  for (const DriverImage& image : grab(recording)) results.push_back(tracker.track(frame_of(image)));
} catch (...) {
  failure = std::current_exception();  // an exception that left its thread would end the program
}

int main(int argc, char** argv) try {
  if (argc < 4) {
    std::fprintf(stderr, "usage: %s CAMERA.yaml MAP.yaml RECORDING...    (a thread for each recording)\n",
                 argv[0]);
    return 2;
  }
  const auto camera = apriltrack::read_cameras(argv[1]).cameras.front();
  const auto map = apriltrack::read_tag_map(argv[2]);  // read by all threads, changed by none
  const std::vector<std::string> recordings(argv + 3, argv + argc);

  std::vector<std::vector<apriltrack::TrackResult>> results(recordings.size());
  std::vector<std::exception_ptr> failures(recordings.size());
  std::vector<std::thread> threads;
  for (std::size_t i = 0; i < recordings.size(); ++i)
    threads.emplace_back([&, i] {
      track_all(camera, map, recordings[i], results[i], failures[i]);
    });  // each writes its own place
  for (std::thread& thread : threads) thread.join();
  for (const std::exception_ptr& failure : failures)
    if (failure) std::rethrow_exception(failure);

  struct Answer {
    std::size_t recording;
    const apriltrack::TrackResult* result;
  };
  std::vector<Answer> answers;
  for (std::size_t i = 0; i < results.size(); ++i)
    for (const apriltrack::TrackResult& result : results[i])
      if (result.pose) answers.push_back({i, &result});
  std::ranges::stable_sort(answers, {}, [](const Answer& answer) { return answer.result->timestamp; });
  for (const Answer& answer : answers) {
    const auto& p = answer.result->pose->translation();
    std::printf("%s s, camera %zu: %.3f %.3f %.3f m\n", format_seconds(answer.result->timestamp).c_str(),
                answer.recording, p.x(), p.y(), p.z());
  }
  return answers.empty() ? 1 : 0;
} catch (const apriltrack::Error& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 2;
}
