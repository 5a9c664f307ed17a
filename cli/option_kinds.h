// Kinds of options that several commands have: numbers within a range, words, lengths, what may be repeated.
#pragma once

#include <charconv>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <type_traits>

#include <g3r/g3r.h>
#include <g3r/names.h>
#include <CLI/CLI.hpp>

#include "text.h"

namespace g3r::cli {

/// A number of type T from `low` to `high`. It says what it expects, and leaves the help text alone: the descriptions say the range.
template <class T>
CLI::Validator range(T low, T high = std::numeric_limits<T>::max()) {
  const auto check = [low, high](const std::string& text) -> std::string {
    T value{};
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error == std::errc() && end == text.data() + text.size() && value >= low && value <= high) return {};
    const auto number = [](T bound) { return short_number(static_cast<double>(bound), 10); };
    const std::string bounds =
        high == std::numeric_limits<T>::max() ? number(low) + " or more" : "from " + number(low) + " to " + number(high);
    return std::string("expected a ") + (std::is_integral_v<T> ? "whole number, " : "number, ") + bounds + ", found '" + text + "'";
  };
  return {check, ""};
}

/// Throws the UsageError of an option whose value is not what is expected.
[[noreturn]] void reject(const std::string& option, const std::string& text, const std::string& expected);

/// An option whose value is one of a few words: g3r/names.h.
template <class T>
void add_choice(CLI::App& app, const std::string& name, T& target, const std::string& help) {
  app.add_option_function<std::string>(
         name,
         [&target, name](const std::string& text) {
           const std::optional<T> value = parse<T>(text);
           if (!value) reject(name, text, "one of " + words<T>());
           target = *value;
         },
         help)
      ->type_name("NAME");
}

/// An option that is a length of some unit; auto too. `may_be_zero`: 0 is one.
void add_length(CLI::App& app, const std::string& name, Length& into, bool may_be_zero, const std::string& help);

/// An option that may be repeated and is handed to `take` word by word.
void add_repeated(CLI::App& app, const std::string& name, const std::function<void(const std::string&)>& take, const std::string& type,
                  const std::string& help);

}  // namespace g3r::cli
