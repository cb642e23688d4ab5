#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <deque>
#include <set>
#include <thread>

#include "apriltrack/base/error.h"
#include "apriltrack/base/parallel.h"
#include "apriltrack/camera/camera.h"
#include "apriltrack/detect/detections_csv.h"
#include "apriltrack/detect/detector.h"
#include "apriltrack/io/numbers.h"
#include "apriltrack/source/frame_source.h"
#include "commands.h"
#include "console.h"

namespace apriltrack::app {
namespace {

constexpr const char* kDescription =
    "Finds tags and writes their corners, for calibrate --detections and track --detections.\n"
    "Example:\n"
    "  apriltrack detect recording --camera camera.yaml --output detections.csv\n"
    "Several families, images without times in their names:\n"
    "  apriltrack detect 'photos/*.jpg' --rate 1 --family tag36h11 --family tag25h9 --output detections.csv\n"
    "Kalibr's printed grids: --family tag36h11b2.";

struct Arguments {
  std::string input;
  std::string camera;
  std::string camera_name;
  std::string response;
  std::string output;
  DetectorOptions detector;
  bool no_refine = false;
  std::optional<double> rate_hz;
  int num_threads = 0;
  Console console;
};

/// What a run found.
struct Record {
  std::vector<FrameDetections> frames;  ///< Those with tags.
  std::set<TagKey> tags;
  int num_frames = 0;
  int unreadable = 0;
  std::string first_unreadable;
  bool is_interrupted = false;

  std::size_t num_detections() const {
    std::size_t count = 0;
    for (const FrameDetections& frame : frames) count += frame.detections.size();
    return count;
  }
};

std::optional<Camera> load_camera(const Arguments& arguments) {
  std::optional<std::filesystem::path> path = sequence_camera_file(arguments.input);
  if (!arguments.camera.empty()) path = arguments.camera;
  if (!path) return std::nullopt;
  const CameraRig rig = read_cameras(*path);
  return arguments.camera_name.empty() ? rig.cameras.front() : rig.find(arguments.camera_name);
}

ResponseCurve parse_response(const std::string& text) {
  if (text == "srgb") return ResponseCurve::srgb();
  if (text == "linear") return ResponseCurve::linear();
  if (text.starts_with("gamma:")) {
    const std::optional<double> exponent = parse_double(text.substr(6));
    if (exponent && *exponent >= 0.2 && *exponent <= 5.0) return ResponseCurve::gamma(*exponent);
  }
  throw invalid_input("--response",
                      fmt::format("must be srgb, linear, or gamma:G with G in [0.2, 5] (is '{}')", text));
}

DetectorOptions detector_options(const Arguments& arguments, const std::optional<Camera>& camera) {
  DetectorOptions options = arguments.detector;
  options.refine_edges = !arguments.no_refine;
  if (camera) options.response = camera->response;
  if (!arguments.response.empty()) options.response = parse_response(arguments.response);
  options.check();
  return options;
}

/// Several frames at a time, each thread with a detector of its own; frames keep their order, so that the
/// number of threads changes nothing.
class FrameDetector {
 public:
  FrameDetector(const DetectorOptions& options, std::string camera_name, const std::optional<Camera>& camera,
                int num_threads)
      : camera_name_(std::move(camera_name)), camera_(camera), parallel_for_(parallel_for(num_threads)) {
    for (int i = 0; i < num_threads; ++i) detectors_.emplace_back(options);
  }

  void run(FrameSource& source, const Console& console, Record& record) {
    Progress progress(console, "detect", source.num_frames());
    while (!is_interrupted()) {
      const std::vector<SourceFrame> batch = read(source);
      if (batch.empty()) return;
      detect(batch, record);
      progress.advance(batch.size());
    }
    record.is_interrupted = true;
  }

 private:
  static constexpr std::size_t kFramesPerThread = 4;  // evens out slow frames

  std::vector<SourceFrame> read(FrameSource& source) const {
    std::vector<SourceFrame> batch;
    while (batch.size() < kFramesPerThread * detectors_.size()) {
      std::optional<SourceFrame> frame = source.next();
      if (!frame) break;
      if (camera_ && frame->is_readable())
        check_resolution(*camera_, frame->pixels.width(), frame->pixels.height(), frame->name);
      batch.push_back(std::move(*frame));
    }
    return batch;
  }

  void detect(const std::vector<SourceFrame>& batch, Record& record) {
    std::vector<std::vector<Detection>> found(batch.size());
    parallel_for_(detectors_.size(), [&](std::size_t thread) {
      for (std::size_t i = thread; i < batch.size(); i += detectors_.size())
        if (batch[i].is_readable()) found[i] = detectors_[thread].detect(batch[i].pixels.view());
    });
    for (std::size_t i = 0; i < batch.size(); ++i) add(batch[i], std::move(found[i]), record);
  }

  void add(const SourceFrame& frame, std::vector<Detection> detections, Record& record) const {
    if (!frame.is_readable()) {
      if (record.unreadable++ == 0) record.first_unreadable = frame.name + ": " + frame.error;
      return;
    }
    ++record.num_frames;
    if (detections.empty()) return;
    for (const Detection& detection : detections) record.tags.insert(detection.tag);
    record.frames.push_back({frame.timestamp, camera_name_, std::move(detections)});
  }

  std::string camera_name_;
  const std::optional<Camera>& camera_;
  ParallelFor parallel_for_;
  std::deque<Detector> detectors_;
};

int resolved_threads(int num_threads) {
  if (num_threads > 0) return num_threads;
  constexpr int kMaxDefaultThreads = 8;  // every detector holds decoding tables of 38 MB (tag36h11)
  return std::clamp(static_cast<int>(std::thread::hardware_concurrency()), 1, kMaxDefaultThreads);
}

void check_result(const Arguments& arguments, const Record& record) {
  if (record.num_frames == 0 && record.unreadable > 0)
    throw io_error(arguments.input, fmt::format("none of its {} frames can be read; the first: {}",
                                                record.unreadable, record.first_unreadable));
  if (record.frames.empty())
    throw no_result(
        arguments.input,
        fmt::format("no tag of family {} in any of {} frames; try the family that is printed (--family), "
                    "--decimate 1, a lower --min-margin; tags need a white margin and about 12 px of width",
                    fmt::join(arguments.detector.families, ", "), record.num_frames));
}

void finish(const Arguments& arguments, const Record& record) {
  if (record.unreadable > 0)
    arguments.console.warning(
        fmt::format("{} frames cannot be read; the first: {}", record.unreadable, record.first_unreadable));
  if (record.is_interrupted) arguments.console.warning("interrupted: what was found until then is kept");
  nlohmann::json tags = nlohmann::json::array();
  for (const TagKey& tag : record.tags) tags.push_back(to_string(tag));
  const nlohmann::json summary = {{"frames", record.num_frames},
                                  {"frames_with_tags", record.frames.size()},
                                  {"unreadable", record.unreadable},
                                  {"detections", record.num_detections()},
                                  {"tags", tags},
                                  {"interrupted", record.is_interrupted},
                                  {"output", arguments.output}};
  arguments.console.finish(
      summary,
      fmt::format("{} of {} frames with tags, {} unreadable; {} detections of {} tags\ndetections: {}",
                  record.frames.size(), record.num_frames, record.unreadable, record.num_detections(),
                  record.tags.size(), arguments.output));
}

void run(const Arguments& arguments) {
  const std::optional<Camera> camera = load_camera(arguments);
  const DetectorOptions options = detector_options(arguments, camera);
  std::string name = camera ? camera->name : "cam0";
  if (!arguments.camera_name.empty()) name = arguments.camera_name;
  SourceOptions source_options;
  source_options.rate_hz = arguments.rate_hz;
  const std::unique_ptr<FrameSource> source = open_source(arguments.input, source_options);
  FrameDetector detector(options, name, camera, resolved_threads(arguments.num_threads));
  Record record;
  detector.run(*source, arguments.console, record);
  check_result(arguments, record);
  write_detections_csv(arguments.output, record.frames);
  finish(arguments, record);
}

}  // namespace

void add_detect_command(CLI::App& app) {
  CLI::App* command = app.add_subcommand("detect", kDescription);
  const auto arguments = std::make_shared<Arguments>();
  command
      ->add_option("INPUT", arguments->input,
                   "Sequence folder, images, glob, EuRoC folder, video or camera:N")
      ->required();
  command->add_option("--camera", arguments->camera,
                      "Camera file, for its response and resolution; a sequence folder brings its own");
  command->add_option("--camera-name", arguments->camera_name, "Which camera of the file; else its first");
  command->add_option("--response", arguments->response,
                      "srgb, linear or gamma:G: what the grey levels stand for; wins over the camera file's");
  command->add_option("--output", arguments->output, "detections.csv")->required();
  command->add_option("--family", arguments->detector.families, "Tag family; may be given several times")
      ->capture_default_str();
  command->add_option("--decimate", arguments->detector.decimate, "Search in an image so many times smaller")
      ->capture_default_str();
  command
      ->add_option("--min-margin", arguments->detector.min_decision_margin,
                   "Grey levels between bits and their threshold; lower finds more and errs more")
      ->capture_default_str();
  command
      ->add_option("--max-hamming", arguments->detector.max_hamming,
                   "Wrong bits that may be corrected, 0 to 2")
      ->capture_default_str();
  command->add_flag("--no-refine", arguments->no_refine, "Leave the corners where the library found them");
  command->add_option("--rate", arguments->rate_hz, "Frames per second, for images without times")
      ->check(CLI::PositiveNumber);
  command->add_option("--threads", arguments->num_threads, "Threads; 0 = one per core, up to 8")
      ->check(CLI::NonNegativeNumber);
  arguments->console.add_options(*command);
  command->callback([arguments] { run(*arguments); });
}

}  // namespace apriltrack::app
