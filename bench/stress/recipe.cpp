#include "recipe.h"

#include <g3r/error.h>

#include <array>
#include <charconv>
#include <sstream>

namespace g3r::stress {

Recipe::Recipe(const std::string& line) {
  std::istringstream in(line);
  for (std::string word; in >> word;) {
    const std::size_t equals = word.find('=');
    if (equals == std::string::npos) throw InvalidInput("a recipe has words key=value, not " + word);
    words_[word.substr(0, equals)] = word.substr(equals + 1);
  }
}

std::string Recipe::line() const {
  std::string out;
  for (const auto& [key, value] : words_) {
    if (!out.empty()) out += ' ';
    out += key;
    out += '=';
    out += value;
  }
  return out;
}

std::string Recipe::text(const std::string& key, const std::string& otherwise) const {
  const auto found = words_.find(key);
  return found == words_.end() ? otherwise : found->second;
}

double Recipe::number(const std::string& key, double otherwise) const {
  const auto found = words_.find(key);
  if (found == words_.end()) return otherwise;
  const std::string& value = found->second;
  double out = 0;
  const auto [end, error] = std::from_chars(value.data(), value.data() + value.size(), out);
  if (error != std::errc() || end != value.data() + value.size()) throw InvalidInput(key + " is not a number: " + value);
  return out;
}

void Recipe::set(const std::string& key, double value) {
  std::array<char, 32> text{};
  words_[key] = std::string(text.data(), std::to_chars(text.data(), text.data() + text.size(), value).ptr);
}

}  // namespace g3r::stress
