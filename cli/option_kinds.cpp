#include "option_kinds.h"

#include <vector>

#include "exit_code.h"

namespace g3r::cli {

void reject(const std::string& option, const std::string& text, const std::string& expected) {
  throw UsageError(option + ": expected " + expected + ", found '" + text + "'");
}

void add_length(CLI::App& app, const std::string& name, Length& into, bool may_be_zero, const std::string& help) {
  app.add_option_function<std::string>(
         name,
         [&into, name, may_be_zero](const std::string& text) {
           const auto length = parse_length(text);
           const bool good = length && (length->value > 0 || may_be_zero || length->unit == Length::Unit::kAuto);
           if (!good) reject(name, text, "auto, X, X%, Xh or Xn with X " + std::string(may_be_zero ? ">= 0" : "> 0"));
           into = *length;
         },
         help)
      ->type_name("auto|X[%|h|n]");
}

void add_repeated(CLI::App& app, const std::string& name, const std::function<void(const std::string&)>& take, const std::string& type,
                  const std::string& help) {
  app.add_option_function<std::vector<std::string>>(
         name,
         [take](const std::vector<std::string>& words) {
           for (const std::string& word : words) take(word);
         },
         help)
      ->type_name(type)
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll)
      ->allow_extra_args(false);
}

}  // namespace g3r::cli
