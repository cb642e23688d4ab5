// Every kind of bag, by the door that recognises them.

#include "apriltrack/bag/bag_reader.h"
#include "fuzz_input.h"

namespace fuzz = apriltrack::fuzz;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto path = fuzz::file_of(fuzz::text_of(data, size));
  std::unique_ptr<apriltrack::BagReader> bag;
  if (!fuzz::reads([&] { bag = apriltrack::open_bag(path); })) return 0;
  std::set<std::size_t> all;
  for (std::size_t i = 0; i < bag->topics().size(); ++i) all.insert(i);
  bag->choose(all);
  bag->num_messages();
  for (int i = 0; i < 1000 && bag->next_time(); ++i) {
    if (i % 4 == 3) {
      bag->pass_over();
      continue;
    }
    const auto message = bag->next();
    if (!message) break;
    volatile char last = message->bytes.empty() ? char{} : message->bytes.back();
    static_cast<void>(last);
  }
  bag->damage();
  return 0;
}
