#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>

#include "apriltrack/base/error.h"
#include "apriltrack/io/atomic_file.h"
#include "command_help.h"
#include "commands.h"
#include "console.h"
#include "demo_picture.h"
#include "option_checks.h"

namespace apriltrack::app {
namespace {
namespace fs = std::filesystem;

struct DemoOptions {
  std::string output;
  std::uint64_t seed = 1;
  int threads = 0;
};

struct Step {
  std::string what;
  std::vector<std::string> words;  ///< As a user would type them.
};

std::vector<Step> steps(const DemoOptions& options) {
  const auto path = [&](const char* name) { return (fs::path(options.output) / name).string(); };
  const std::string seed = std::to_string(options.seed);
  const std::string threads = std::to_string(options.threads);
  return {{"A gentle recording of a room of tags, to calibrate from",
           {"simulate", "--scene", "room-gentle", "--frames", "150", "--speed", "2", "--exposure", "0.003",
            "--output", path("gentle"), "--seed", seed, "--threads", threads, "--force"}},
          {"The same room, filmed by a hand in a hurry",
           {"simulate", "--scene", "room", "--frames", "240", "--output", path("blurred"), "--seed", seed,
            "--threads", threads, "--force"}},
          {"Where are the tags? A map from the gentle recording's images",
           {"calibrate", path("gentle"), "--tag-size", "0.16", "--output", path("map.yaml"), "--threads",
            threads}},
          {"The map against the truth", {"map", "diff", path("gentle/map.yaml"), path("map.yaml")}},
          {"The map into the truth's frame, to compare trajectories",
           {"map", "align", path("gentle/map.yaml"), path("map.yaml"), "--output", path("map_aligned.yaml")}},
          {"Where is the camera? By detection alone, in the blurred recording",
           {"track", path("blurred"), "--map", path("map_aligned.yaml"), "--method", "pnp", "--output",
            path("pnp.tum"), "--frames-csv", path("pnp_frames.csv"), "--threads", threads}},
          {"The trajectory against the truth",
           {"evaluate", "--truth", path("blurred"), "--estimate", path("pnp.tum"), "--frames-csv",
            path("pnp_frames.csv")}}};
}

void run_step(Step step, const Console& console) {
  console.info(fmt::format("\n== {}\n$ apriltrack {}", step.what, fmt::join(step.words, " ")));
  if (console.is_quiet()) step.words.emplace_back("--quiet");
  {
    const AnswersAsTalk talk(console);
    run_command(std::move(step.words));
  }
  if (is_interrupted()) throw no_result("demo", "interrupted; what was made until then is kept");
}

/// What the demo writes has names that people use as well: it works in a folder of its own.
void claim(const fs::path& folder) {
  const fs::path mark = folder / "made_by_apriltrack_demo.txt";
  if (!fs::exists(mark) && !fs::is_empty(folder))
    throw invalid_input(
        "--output", fmt::format("'{}' holds files that no demo made: name a new folder", folder.string()));
  write_file_atomically(mark,
                        "What lies here was made by `apriltrack demo`, which replaces it when run again.\n");
}

void run_demo(const DemoOptions& options, const Console& console) {
  const fs::path folder = options.output;
  std::error_code failure;
  fs::create_directories(folder, failure);
  if (failure) throw io_error(folder.string(), fmt::format("cannot be made: {}", failure.message()));
  claim(folder);
  for (const Step& step : steps(options)) run_step(step, console);

  const fs::path picture = folder / "blindness.png";
  const BlindnessFigures figures = draw_blindness_picture(folder / "blurred", folder / "pnp.tum", picture);
  console.finish({{"picture", picture.string()},
                  {"frames", figures.frames},
                  {"blind", figures.blind},
                  {"within_5px", figures.right}},
                 fmt::format("\nDetection alone gives a pose within 5 px in {} of {} frames, and is blind in "
                             "{} in which tags are in view.\n"
                             "Look at {}",
                             figures.right, figures.frames, figures.blind, picture.string()));
}

}  // namespace

void add_demo_command(CLI::App& app) {
  auto options = std::make_shared<DemoOptions>();
  auto console = std::make_shared<Console>();
  CLI::App& command =
      add_command(app, "demo",
                  {"The whole job on rendered recordings of a room, with a picture at the end.",
                   "apriltrack demo --output demo-output",
                   "Calibrates from a gentle recording, localises in a violently blurred one, "
                   "and compares with the truth."});
  command
      .add_option("--output", options->output, "Folder for recordings, maps, trajectories and the picture")
      ->required();
  command.add_option("--seed", options->seed, "Of the rendered recordings")
      ->check(whole_number(0))
      ->capture_default_str();
  command.add_option("--threads", options->threads, "0 = all cores; results do not depend on it")
      ->capture_default_str()
      ->check(threads());
  console->add_options(command);
  command.callback([options, console] { run_demo(*options, *console); });
}

}  // namespace apriltrack::app
