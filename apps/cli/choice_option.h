#pragma once

#include <CLI/CLI.hpp>
#include <algorithm>
#include <string>
#include <utility>
#include <vector>

namespace apriltrack::app {

/// An option that is one of some words, which `--help` and errors list as they are written. value: outlives
/// the parsing; what it holds is the default.
template <typename T>
CLI::Option* add_choice(CLI::App& command, const std::string& name, T& value,
                        const std::vector<std::pair<std::string, T>>& choices,
                        const std::string& description) {
  std::vector<std::string> words;
  std::string preset;
  for (const auto& [word, meaning] : choices) {
    words.push_back(word);
    if (meaning == value) preset = word;
  }
  const auto take = [&value, choices](const std::string& word) {
    const auto is_it = [&](const auto& choice) { return choice.first == word; };
    value = std::ranges::find_if(choices, is_it)->second;
  };
  return command.add_option_function<std::string>(name, take, description)
      ->transform(CLI::IsMember(words, CLI::ignore_case))
      ->default_str(preset);
}

/// Words that a shell offers for an option whose command says itself what is wrong with others. value: what
/// `--help` calls it, "FORMAT".
inline void offer_words(CLI::Option& option, const std::string& value,
                        const std::vector<std::string>& words) {
  std::string list;
  for (const std::string& word : words) list += (list.empty() ? "" : ",") + word;
  option.type_name(value + ":{" + list + "}");
}

}  // namespace apriltrack::app
