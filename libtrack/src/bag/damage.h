#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace apriltrack {

/// What could not be read of one file, gathered while it is read.
class Damage {
 public:
  /// A chunk of which nothing is given. offset: of its record in the file; a chunk is counted once.
  void lost_chunk(std::uint64_t offset, std::string_view why) { chunks_.add(offset, why); }
  /// A chunk of which messages are missing.
  void hurt_chunk(std::uint64_t offset, std::string_view why) { hurt_.add(offset, why); }
  /// A chunk that is whole, whatever its header says.
  void wrong_header(std::uint64_t offset, std::string_view why) { headers_.add(offset, why); }
  void lost_message(std::uint64_t offset, std::string_view why) { messages_.add(offset, why); }
  /// Bytes that are no records.
  void lost_bytes(std::uint64_t offset, std::uint64_t count) {
    places_.add(offset, "");
    num_bytes_ += count;
  }
  /// The file ends within a record that begins here.
  void is_cut(std::uint64_t offset) {
    is_cut_ = true;
    cut_ = offset;
  }
  /// Messages were found without it, so that this alone loses nothing.
  void has_no_index() { has_no_index_ = true; }

  /// Empty where all is well.
  std::string summary() const;

 private:
  struct Kind {
    std::size_t count = 0;
    std::uint64_t first = 0;
    std::string why;
    void add(std::uint64_t offset, std::string_view reason);
  };

  Kind chunks_, hurt_, headers_, messages_, places_;
  std::uint64_t num_bytes_ = 0;
  bool is_cut_ = false;
  std::uint64_t cut_ = 0;
  bool has_no_index_ = false;
};

}  // namespace apriltrack
