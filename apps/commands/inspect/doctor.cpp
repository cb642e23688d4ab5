#include <CLI/CLI.hpp>
#include <memory>
#include <nlohmann/json.hpp>

#include "apriltrack/base/error.h"
#include "apriltrack/inspect/findings.h"
#include "cli/command_help.h"
#include "cli/commands.h"
#include "cli/option_checks.h"
#include "doctor_look.h"
#include "doctor_report.h"
#include "files/inputs.h"
#include "files/topics.h"

namespace apriltrack::app {
namespace {

const CommandHelp kDoctorHelp = {
    "Says before anything is solved whether a recording will calibrate, and why not.",
    "apriltrack doctor video.mp4 --camera camera.yaml\n"
    "apriltrack doctor 'photos/*.jpg'\n"
    "apriltrack doctor cam0=left cam1=right --camera rig.yaml --family tag36h11b2",
    "It reads the images, their times and the camera file, finds tags, measures how far their edges are\n"
    "blurred, and says what is wrong and what to do. Of a long video, --step 10 is enough. No camera file "
    "is\n"
    "needed. Exit status: 0 = can be calibrated, warnings or not; 1 = cannot; 2 = a wrong option or file;\n"
    "3 = cannot be read."};

struct DoctorOptions {
  std::vector<std::string> inputs;
  LookOptions look;
  std::string config;
  bool no_other_families = false;
  Console console;
};

void check(DoctorOptions& options) {
  check_families(options.look.inspection.detector.families);
  options.look.inspection.detector.check();
  options.look.inspection.tries_other_families = !options.no_other_families;
  for (const std::string& input : options.inputs) {
    const Recording recording = split_input(input);
    refuse_pipe(recording.input);
    check_input(recording.input);
    if (recording.is_named && !options.look.camera_name.empty())
      throw invalid_input("--camera-name", "is given, but the input " + input +
                                               " names its camera: leave one "
                                               "out");
  }
}

bool has_tags(const InspectionFacts& facts) {
  return !facts.places.empty();
}

void run(DoctorOptions& options) {
  check(options);
  const Console& console = options.console;
  const InspectionFacts facts = look_at(options.inputs, options.look, console);
  const std::vector<RecordingFinding> findings = inspection_findings(facts);
  const CalibrationVerdict verdict = verdict_of(findings, has_tags(facts));
  const auto first_stop = findings.begin();  // the verdict tells it
  for (auto finding = findings.begin(); finding != findings.end(); ++finding) {
    const bool is_told_at_the_end = finding == first_stop && finding->severity == FindingSeverity::kStops;
    if (finding->severity != FindingSeverity::kNote && !is_told_at_the_end) console.warning(finding->text);
  }
  console.finish(json_of(facts, findings, verdict), told_facts(facts, findings, verdict));
  if (verdict.readiness != CalibrationReadiness::kNotReady) return;
  throw no_result("doctor", console.is_json() ? verdict.text : "the verdict above says why, and what to do");
}

}  // namespace

void add_doctor_command(CLI::App& app) {
  CLI::App& command = add_command(app, "doctor", kDoctorHelp);
  const auto options = std::make_shared<DoctorOptions>();
  LookOptions& look = options->look;
  command
      .add_option(
          "INPUT", options->inputs,
          "Sequence folder, folder of images, glob, EuRoC mav0 folder, video or bag; of several cameras: "
          "cam0=PATH cam1=PATH")
      ->required();
  command.add_option("--camera", look.camera,
                     "Camera file; by default a sequence folder's own, or what a bag says of its camera");
  command.add_option("--camera-name", look.camera_name,
                     "Which camera of the file, and of a EuRoC recording; else the first");
  command.add_option("--family", look.inspection.detector.families, "Tag family; may be given several times")
      ->allow_extra_args(false)
      ->check(known_family())
      ->capture_default_str();
  command.add_flag("--no-other-families", options->no_other_families,
                   "Do not look for the families that --family does not name in a sample of the frames");
  command
      .add_option("--decimate", look.inspection.detector.decimate,
                  "Search tags in an image this many times smaller")
      ->check(decimation())
      ->capture_default_str();
  add_frame_options(command, look.frames);
  add_config_option(command, options->config);
  command
      .add_option("--threads", look.inspection.num_threads,
                  "0 = as many as there are cores; changes no result")
      ->check(threads())
      ->capture_default_str();
  options->console.add_options(command);
  command.callback([options] { run(*options); });
}

}  // namespace apriltrack::app
