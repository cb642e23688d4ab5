// Makes one random world and films it: a sequence folder with its truth.
//
//   bench_make_world --seed 7 [--fault moved] [--no-images] --output FOLDER
//
// Even seeds are kept for reports, and want --report: nobody is to look into them.
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <fstream>
#include <optional>
#include <string>

#include "apriltrack/io/numbers.h"
#include "write_world.h"

namespace {

using namespace apriltrack;

struct Arguments {
  std::uint64_t seed = 0;
  worlds::FaultKind fault = worlds::FaultKind::kNone;
  std::string output;
  bool has_images = true;
  bool is_report = false;
};

[[noreturn]] void refuse(const std::string& why) {
  std::fprintf(stderr, "bench_make_world: %s\n", why.c_str());
  std::exit(2);
}

Arguments parse(int argc, char** argv) {
  Arguments arguments;
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    if (word == "--no-images") {
      arguments.has_images = false;
    } else if (word == "--report") {
      arguments.is_report = true;
    } else if (i + 1 == argc) {
      refuse(word + " wants a value");
    } else if (word == "--seed") {
      arguments.seed = std::strtoull(argv[++i], nullptr, 10);
    } else if (word == "--output") {
      arguments.output = argv[++i];
    } else if (word == "--fault") {
      const auto fault = worlds::parse_fault(argv[++i]);
      if (!fault) refuse(std::string("there is no fault ") + argv[i]);
      arguments.fault = *fault;
    } else {
      refuse("there is no option " + word);
    }
  }
  if (arguments.output.empty()) refuse("--output is missing");
  if (arguments.seed % 2 == 0 && !arguments.is_report) refuse("even seeds are for reports only: --report");
  return arguments;
}

}  // namespace

int main(int argc, char** argv) try {
  const Arguments arguments = parse(argc, argv);
  const worlds::World world = worlds::make_world(arguments.seed, arguments.fault);
  if (arguments.has_images) {
    worlds::write_world(world, arguments.output);
  } else {
    worlds::write_without_pictures(world, arguments.output);
  }
} catch (const std::exception& error) {
  std::fprintf(stderr, "bench_make_world: %s\n", error.what());
  return 1;
}
