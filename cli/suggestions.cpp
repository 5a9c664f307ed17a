#include "suggestions.h"

#include <algorithm>
#include <numeric>
#include <utility>
#include <vector>

namespace g3r::cli {
namespace {

/// Letters to change, add or leave out to get from one word to the other (Levenshtein 1966). O(|a| |b|).
std::size_t edit_distance(const std::string& a, const std::string& b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t diagonal = std::exchange(row[0], i + 1);
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t change = diagonal + (a[i] == b[j] ? 0 : 1);
      diagonal = row[j + 1];
      row[j + 1] = std::min({change, row[j] + 1, row[j + 1] + 1});
    }
  }
  return row.back();
}

/// " of g3r orient: it belongs to g3r IN OUT, g3r mesh" if other commands have the option, else nothing.
std::string owners(const CLI::App& app, const CLI::App& command, const std::string& option) {
  std::string text;
  const auto add = [&](const CLI::App& other, const std::string& name) {
    if (&other != &command && other.get_option_no_throw(option) != nullptr) text += (text.empty() ? "" : ", ") + name;
  };
  add(app, "g3r IN OUT");
  for (const CLI::App* other : app.get_subcommands({})) add(*other, "g3r " + other->get_name());
  if (text.empty()) return "";
  return (&command == &app ? " here" : " of g3r " + command.get_name()) + ": it belongs to " + text;
}

}  // namespace

std::string suggestion(const std::string& found, const std::vector<std::string>& words) {
  constexpr std::size_t kNear = 2;       // Two letters are a slip; with more, words that mean something else are near.
  constexpr std::size_t kBeginning = 3;  // So many letters, of options with the dashes, are the beginning of a word.
  std::string nearest;
  std::size_t least = kNear + 1;
  for (const std::string& word : words) {
    const bool begins = found.size() >= kBeginning && word.compare(0, found.size(), found) == 0;
    const std::size_t distance = begins ? 0 : edit_distance(found, word);
    if (distance < std::min(least, word.size() - 1)) {
      least = distance;
      nearest = word;
    }
  }
  return nearest.empty() ? "" : "; did you mean " + nearest + "?";
}

const CLI::App& deepest_command(const CLI::App& app) {
  const CLI::App* command = &app;
  for (auto parsed = app.get_subcommands(); !parsed.empty(); parsed = command->get_subcommands()) command = parsed.front();
  return *command;
}

std::string about_extras(const CLI::App& app) {
  const std::string first = app.remaining(true).front();
  const CLI::App& command = deepest_command(app);
  if (first == "-o" || first == "--out" || first == "--output")
    return "unknown option " + first + ": the output stands after the input, without an option";
  if (first.size() > 1 && first.front() == '-') {
    std::vector<std::string> options;
    for (const CLI::Option* option : command.get_options()) {
      for (const std::string& name : option->get_lnames()) options.push_back("--" + name);
    }
    const std::string name = first.substr(0, first.find('='));
    return "unknown option " + first + owners(app, command, name) + suggestion(name, options);
  }
  if (&command != &app) return "one file too many for g3r " + command.get_name() + ": " + first;
  std::vector<std::string> names;
  std::string list;
  for (const CLI::App* other : app.get_subcommands({})) {
    names.push_back(other->get_name());
    list += (list.empty() ? "" : ", ") + other->get_name();
  }
  const std::string meant = suggestion(app.get_option("IN")->as<std::string>(), names);
  return "one file too many: " + first + "; expected IN and OUT, or one of the commands " + list + " first" + meant;
}

}  // namespace g3r::cli
