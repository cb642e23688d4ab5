#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>

#include "apriltrack/base/error.h"
#include "apriltrack/io/atomic_file.h"
#include "cli/command_help.h"
#include "cli/command_line.h"
#include "cli/commands.h"
#include "cli/console.h"
#include "cli/option_checks.h"
#include "demo_plan.h"
#include "demo_report.h"
#include "demo_scores.h"

namespace apriltrack::app {
namespace {
namespace fs = std::filesystem;

void run_step(DemoStep step, const Console& console) {
  console.info(fmt::format("\n== {}\n$ apriltrack {}", step.what, shell_line(step.words)));
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
  const DemoFiles files{folder};
  for (const DemoScene& scene : kDemoScenes) fs::remove(files.video(scene));  // no run replaces a video
  for (const DemoStep& step : demo_steps(options)) run_step(step, console);

  console.info("\n== Every pose against the exact truth");
  const std::vector<DemoScore> scores = score_demo(files);
  write_demo_report(options, files, scores);
  const DemoTable table = tabulate(scores);
  console.finish(
      {{"report", files.report().string()}, {"header", table.header}, {"rows", table.rows}},
      fmt::format("{}\n{}\nLook at {}", table.text(), explain_blur_columns(), files.report().string()));
}

}  // namespace

void add_demo_command(CLI::App& app) {
  auto options = std::make_shared<DemoOptions>();
  auto console = std::make_shared<Console>();
  CLI::App& command = add_command(
      app, "demo",
      {"The whole job on rendered recordings, with a page that shows it.",
       "apriltrack demo --output demo-output",
       "Calibrates a room from a gentle recording; tracks a violently blurred one through that map, a\n"
       "tumbling body and a single tag, by detection, by the seed paper and through the blur; compares\n"
       "with the truth. report.html has figures, pictures and videos."});
  command
      .add_option("--output", options->output,
                  "Folder for recordings, maps, trajectories, pictures and report.html")
      ->required();
  command.add_option("--seed", options->seed, "Of the rendered recordings")
      ->check(seed())
      ->capture_default_str();
  command
      .add_option("--frames", options->num_frames,
                  "Of the room's recording, 8 to 10000; the bodies' are half as long. Fewer: a quicker look")
      ->check(whole_number(8, 10'000))
      ->capture_default_str();
  command.add_option("--threads", options->threads, "0 = all cores; results do not depend on it")
      ->capture_default_str()
      ->check(threads());
  console->add_options(command);
  command.callback([options, console] { run_demo(*options, *console); });
}

}  // namespace apriltrack::app
