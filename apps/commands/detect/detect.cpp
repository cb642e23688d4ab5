#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <nlohmann/json.hpp>
#include <set>
#include <span>

#include "apriltrack/base/error.h"
#include "apriltrack/detect/detections_csv.h"
#include "apriltrack/detect/odd_picture_watch.h"
#include "apriltrack/detect/patch_keeper.h"
#include "apriltrack/io/numbers.h"
#include "apriltrack/source/bag_input.h"
#include "cli/command_help.h"
#include "cli/commands.h"
#include "cli/option_checks.h"
#include "files/blank_images.h"
#include "files/camera_response.h"
#include "files/frame_loop.h"
#include "files/frame_options.h"
#include "files/inputs.h"
#include "files/left_out_words.h"
#include "files/outputs.h"
#include "files/topics.h"

namespace apriltrack::app {
namespace {

const CommandHelp kDetectHelp = {
    "Finds tags and writes their corners, for --detections of other commands.",
    "apriltrack detect recording --camera camera.yaml --output detections.csv\n"
    "apriltrack detect recording.bag --topic /camera/image_raw --output detections.csv\n"
    "apriltrack detect 'photos/*.jpg' --rate 1 --family tag36h11 --family tag25h9 --output detections.csv",
    "--family may be given several times; Kalibr's printed grids are tag36h11b2. Images whose names are no\n"
    "times need --rate."};

struct DetectArguments {
  std::string input;
  std::string camera;
  std::string camera_name;
  std::string response;
  std::string output;
  DetectorOptions detector;
  bool no_refine = false;
  std::string config;
  FrameOptions frames;
  int num_threads = 0;
  Console console;
};

/// What a run found.
struct Record {
  FrameCounts counts;
  std::vector<FrameDetections> frames;  ///< Those with tags.
  std::set<TagKey> tags;
  std::size_t num_detections = 0;
  LeftOutTags left_out;
  std::optional<std::string> odd_pictures;  ///< What is wrong with pictures in which hardly a tag is read.
  ResponseFinding response;

  void add(FrameDetections frame) {
    if (frame.detections.empty()) return;
    for (const Detection& detection : frame.detections) tags.insert(detection.tag);
    num_detections += frame.detections.size();
    frames.push_back(std::move(frame));
  }
};

std::optional<Camera> load_camera(const DetectArguments& arguments) {
  const auto source = camera_source(arguments.camera, arguments.input, arguments.camera_name);
  if (!source) return std::nullopt;
  if (is_bag_input(source->path.string()))
    return bag_camera(arguments.input, topic_without_camera(arguments.frames.topics),
                      arguments.console.log());
  const std::string name = camera_name_of(arguments.input, arguments.frames.topics, arguments.camera_name,
                                          source->path, arguments.console);
  return read_camera(*source, name, arguments.console);
}

ResponseCurve parse_response(const std::string& text) {
  if (text == "srgb") return ResponseCurve::srgb();
  if (text == "linear") return ResponseCurve::linear();
  if (text.starts_with("gamma:")) {
    const std::optional<double> exponent = parse_double(text.substr(6));
    if (exponent && *exponent >= 0.2 && *exponent <= 5.0) return ResponseCurve::gamma(*exponent);
  }
  throw invalid_input(
      "--response", fmt::format("must be srgb, linear, auto, or gamma:G with G in [0.2, 5] (is '{}')", text));
}

DetectorOptions detector_options(const DetectArguments& arguments, const std::optional<Camera>& camera) {
  DetectorOptions options = arguments.detector;
  options.refine_edges = !arguments.no_refine;
  if (camera) options.camera_model = camera->model;
  options.check();
  return options;
}

SourceOptions source_options(const DetectArguments& arguments, const std::optional<Camera>& camera) {
  SourceOptions options = arguments.frames.source;
  options.camera_name = arguments.camera_name;
  const auto of_camera = camera_source(arguments.camera, arguments.input, arguments.camera_name);
  options.topic = topic_of(arguments.input, arguments.frames.topics, camera ? camera->name : "cam0",
                           of_camera.value_or(CameraSource()).path, arguments.console);
  if (camera) set_shutter(options, *camera);
  options.log = arguments.console.log();
  return options;
}

/// What is said to be the response, by the option before the camera file; nullopt where it is to be told by
/// the tags.
std::optional<ResponseCurve> stated_response(const DetectArguments& arguments,
                                             const std::optional<Camera>& camera) {
  if (arguments.response == "auto") return std::nullopt;
  if (!arguments.response.empty()) return parse_response(arguments.response);
  if (camera && camera->response_origin == ResponseOrigin::kStated) return camera->response;
  return std::nullopt;
}

Record detect_with(const DetectArguments& arguments, const SourceOptions& source_options,
                   const std::optional<Camera>& camera, const std::string& name,
                   const ResponseCurve& response, const std::optional<ResponseCurve>& rival) {
  DetectFramesOptions options = {detector_options(arguments, camera), camera ? &*camera : nullptr,
                                 arguments.num_threads, source_options.skip, "detect"};
  options.detector->response = response;
  options.detector->rival_response = rival;
  const std::unique_ptr<FrameSource> source = open_source(arguments.input, source_options);
  Record record;
  OddPictureWatch watch;
  PatchKeeper keeper;
  record.counts = detect_frames(*source, options, arguments.console, [&](DetectedFrame frame) {
    if (frame.source.is_readable()) watch.add(frame.source.pixels.view(), frame.detections);
    record.left_out.add(frame.left_out);
    FrameDetections tags{frame.source.timestamp, name, std::move(frame.detections)};
    if (frame.source.is_readable()) keeper.keep(frame.source.pixels.view(), tags);
    record.add(std::move(tags));
  });
  if (!is_interrupted()) record.odd_pictures = watch.message(*options.detector);
  return record;
}

Record detect(const DetectArguments& arguments) {
  const std::optional<Camera> camera = load_camera(arguments);
  ResponseCamera asked;
  if (camera) asked = to_ask_of(*camera);
  if (!arguments.camera_name.empty()) asked.name = arguments.camera_name;
  const auto stated = stated_response(arguments, camera);
  if (stated) asked.assumed = *stated;
  const SourceOptions of_source = source_options(arguments, camera);
  Record record;
  ResponseFinding response = run_with_response(
      asked, stated ? ResponseOrigin::kStated : ResponseOrigin::kAssumed, {arguments.input, of_source},
      detector_options(arguments, camera), arguments.num_threads,
      [&](const ResponseCurve& curve, const std::optional<ResponseCurve>& rival) {
        record = detect_with(arguments, of_source, camera, asked.name, curve, rival);
        return std::span<const FrameDetections>(record.frames);
      },
      is_interrupted);
  record.response = std::move(response);
  return record;
}

void check_result(const DetectArguments& arguments, const Record& record) {
  if (!record.frames.empty()) {
    if (record.odd_pictures) arguments.console.warning(*record.odd_pictures);
    tell(record.response, arguments.console);
    return;
  }
  if (record.counts.are_all_blank())
    throw no_result(arguments.input, told_of_blank_images(record.counts.readable));
  if (record.odd_pictures) throw no_result(arguments.input, *record.odd_pictures);
  throw no_result(
      arguments.input,
      fmt::format("no tag of family {} in any of {} frames{}; try the family that is printed (--family), "
                  "--decimate 1, a lower --min-margin; tags need a white margin and about 12 px of width",
                  fmt::join(arguments.detector.families, ", "), record.counts.readable,
                  told_after(record.left_out)));
}

void finish(const DetectArguments& arguments, const Record& record) {
  nlohmann::json tags = nlohmann::json::array();
  for (const TagKey& tag : record.tags) tags.push_back(to_string(tag));
  const nlohmann::json summary = {{"frames", record.counts.readable},
                                  {"frames_with_tags", record.frames.size()},
                                  {"unreadable", record.counts.unreadable},
                                  {"detections", record.num_detections},
                                  {"tags", tags},
                                  {"readings_left_out", json_of(record.left_out)},
                                  {"response", json_of(record.response)},
                                  {"value_range", value_range_json(record.counts.value_range)},
                                  {"interrupted", record.counts.is_interrupted},
                                  {"output", arguments.output}};
  arguments.console.finish(
      summary, fmt::format("{} of {} frames with tags, {} unreadable; {} detections of {} tags{}\n"
                           "response: {}\ndetections: {}",
                           record.frames.size(), record.counts.readable, record.counts.unreadable,
                           record.num_detections, record.tags.size(), told_after(record.left_out),
                           words_of(record.response), arguments.output));
}

void run(const DetectArguments& arguments) {
  check_families(arguments.detector.families);
  std::vector<std::string> read = camera_inputs(arguments.camera, {arguments.input});
  read.push_back(arguments.input);
  check_output(arguments.output, "--output", read);
  const Record record = detect(arguments);
  check_result(arguments, record);
  write_detections_csv(arguments.output, record.frames);
  finish(arguments, record);
}

}  // namespace

void add_detect_command(CLI::App& app) {
  CLI::App& command = add_command(app, "detect", kDetectHelp);
  const auto arguments = std::make_shared<DetectArguments>();
  command
      .add_option("INPUT", arguments->input,
                  "Sequence folder, images, glob, EuRoC folder, video, bag, camera:N, or - for a pipe")
      ->required();
  command.add_option(
      "--camera", arguments->camera,
      "Camera file, for its lens, response and resolution; a sequence folder or a bag brings its own");
  command.add_option("--camera-name", arguments->camera_name,
                     "Which camera of the file, and of a EuRoC recording; else the first");
  command.add_option(
      "--response", arguments->response,
      "srgb, linear, gamma:G or auto: what the grey levels stand for; wins over the camera "
      "file's. Where neither states it, it is estimated from the pictures of tags, as with auto");
  command.add_option("--output", arguments->output, "detections.csv")->required();
  command.add_option("--family", arguments->detector.families, "Tag family; may be given several times")
      ->check(known_family())
      ->capture_default_str();
  command.add_option("--decimate", arguments->detector.decimate, "Search in an image so many times smaller")
      ->check(decimation())
      ->capture_default_str();
  command
      .add_option("--min-margin", arguments->detector.min_decision_margin,
                  "Grey levels between bits and their threshold; lower finds more and errs more")
      ->check(decision_margin())
      ->capture_default_str();
  command
      .add_option("--max-hamming", arguments->detector.max_hamming,
                  "Wrong bits that may be corrected, 0 to 2; default: by how often chance reads the family's "
                  "codes (2 for tag36h11, 0 for tag16h5)")
      ->check(corrected_bits());
  command.add_flag("--no-refine", arguments->no_refine, "Leave the corners where the library found them");
  add_frame_options(command, arguments->frames);
  add_config_option(command, arguments->config);
  command.add_option("--threads", arguments->num_threads, "Threads; 0 = one per core, up to 8")
      ->check(threads());
  arguments->console.add_options(command);
  command.callback([arguments] { run(*arguments); });
}

}  // namespace apriltrack::app
