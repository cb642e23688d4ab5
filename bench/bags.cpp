// How fast bags are read, and with how much memory (bench/bags.py writes some of each format):
//
//   bench_bags BAG...            messages, as BagReader gives them
//   bench_bags --frames BAG...   frames, as open_source() gives them
//
// One line a bag: MB of messages (of pixels), seconds, MB/s, and the peak of the process's own memory so far.

#include <fmt/format.h>
#include <sys/resource.h>

#include <chrono>
#include <cstdio>
#include <exception>
#include <string>
#include <vector>

#include "apriltrack/bag/bag_reader.h"
#include "apriltrack/source/frame_source.h"

namespace {

using namespace apriltrack;

struct Amount {
  double bytes = 0.0;
  std::size_t count = 0;
  std::string damage;
};

Amount read_messages(const std::string& path) {
  const auto bag = open_bag(path);
  std::set<std::size_t> all;
  for (std::size_t i = 0; i < bag->topics().size(); ++i) all.insert(i);
  bag->choose(all);
  Amount amount;
  while (const auto message = bag->next()) {
    amount.bytes += static_cast<double>(message->bytes.size());
    ++amount.count;
  }
  amount.damage = bag->damage();
  return amount;
}

Amount read_frames(const std::string& path) {
  const auto source = open_source(path);
  Amount amount;
  while (const auto frame = source->next()) {
    amount.bytes += static_cast<double>(frame->pixels.width()) * frame->pixels.height();
    ++amount.count;
  }
  return amount;
}

double peak_mb() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024.0;
}

}  // namespace

int main(int argc, char** argv) try {
  std::vector<std::string> bags(argv + 1, argv + argc);
  const bool as_frames = !bags.empty() && bags.front() == "--frames";
  if (as_frames) bags.erase(bags.begin());
  for (const std::string& bag : bags) {
    const auto start = std::chrono::steady_clock::now();
    const Amount amount = as_frames ? read_frames(bag) : read_messages(bag);
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    fmt::print("{}: {} {}, {:.0f} MB in {:.2f} s, {:.0f} MB/s, peak {:.0f} MB {}\n", bag, amount.count,
               as_frames ? "frames" : "messages", 1e-6 * amount.bytes, seconds, 1e-6 * amount.bytes / seconds,
               peak_mb(), amount.damage);
  }
  return 0;
} catch (const std::exception& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
