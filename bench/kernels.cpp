// What the photometric kernels cost on one core of this machine, instruction set by instruction set, and how
// far they are from their definitions in double precision: Markdown on stdout.
//
//   bench_kernels [REPETITIONS]
//
// Medians of the repetitions (default 9), in which all ways take turns.

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>

#include "bench_setting.h"

int main(int argc, char** argv) {
  const int repetitions = argc > 1 ? std::max(1, std::atoi(argv[1])) : 9;
  fmt::print("## Kernels, one core, medians of {}\n", repetitions);
  for (const bool has_pattern : {false, true})
    for (const double tag_px : {60.0, 120.0, 300.0})
      apriltrack::bench::bench_patches(tag_px, has_pattern, repetitions);
  apriltrack::bench::bench_limits(repetitions);
  apriltrack::bench::bench_pixels(repetitions);
  return 0;
}
