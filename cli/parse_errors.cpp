#include "parse_errors.h"

#include <vector>

#include "suggestions.h"

namespace g3r::cli {
namespace {

/// "g3r tiles plan"
std::string full_name(const CLI::App& app) { return "g3r" + named_command(app); }

/// How the command is typed: what its help has after "Usage: ".
std::string usage_of(const CLI::App& app, const CLI::App& command) {
  const std::string mark = "Usage: ";
  const std::string help = command.get_formatter()->make_help(&command, full_name(app), CLI::AppFormatMode::Normal);
  const std::size_t begin = help.find(mark) + mark.size();
  return help.substr(begin, help.find('\n', begin) - begin);
}

/// The option that a message of the parser begins with: "--box: At least 6 ...", "open was given ...".
const CLI::Option* named_option(const CLI::App& app, const CLI::App& command, const std::string& message) {
  const std::string name = message.substr(0, message.find_first_of(": "));
  for (const CLI::App* owner : {&command, &app}) {
    for (const std::string& form : {name, "--" + name}) {
      if (const CLI::Option* option = owner->get_option_no_throw(form)) return option;
    }
  }
  return nullptr;
}

std::string joined(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : ", ") + word;
  return text;
}

bool is_flag(const CLI::Option& option) { return option.get_items_expected_max() == 0; }

/// Something required is not there: a file, an option, a command.
std::string about_missing_part(const CLI::App& app, const CLI::App& command, const std::string& message) {
  if (!app.remaining(true).empty() && app.remaining(true).front().front() == '-') return about_extras(app);
  if (&command != &app && app.count("IN") > 0) return "expected the command '" + command.get_name() + "' before its files";
  const std::string name = message.substr(0, message.find(' '));
  if (command.get_option_no_throw(name) == nullptr) {
    std::vector<std::string> names;
    for (const CLI::App* step : command.get_subcommands({})) names.push_back(step->get_name());
    const std::vector<std::string> found = app.remaining(true);
    return "expected one of the commands " + joined(names) + ", found " +
           (found.empty() ? "none" : "'" + found.front() + "'" + suggestion(found.front(), names));
  }
  return name + " is missing: expected " + usage_of(app, command);
}

/// An option has more or fewer values than it takes.
std::string about_counts(const CLI::Option& option, const std::string& usage) {
  const std::string name = option.get_name(option.get_positional());
  const std::vector<std::string>& found = option.results();
  if (is_flag(option)) return name + " takes no value" + (found.empty() ? "" : ", found '" + joined(found) + "'");
  if (option.get_positional()) return std::to_string(found.size()) + (found.size() == 1 ? " file" : " files") + ": expected " + usage;
  const int most = option.get_items_expected_max();
  if (found.empty()) return name + ": expected a value, " + option.get_type_name() + ", after it";
  if (most == 1) return name + " is given " + std::to_string(found.size()) + " times: expected once";
  return name + ": expected " + option.get_type_name() + ", found " + std::to_string(found.size()) +
         (found.size() == 1 ? " value" : " values");
}

/// "--box = 1,2,x" of "Could not convert: --box = 1,2,x"
std::string about_conversion(const CLI::App& app, const CLI::App& command, const std::string& message) {
  const std::size_t at = message.find(": ");
  const std::string pair = at == std::string::npos ? message : message.substr(at + 2);
  const CLI::Option* option = named_option(app, command, pair);
  if (option == nullptr) return message;
  const std::string name = option->get_name();
  const std::size_t value = pair.find(" = ");
  const std::string found = value == std::string::npos ? "" : ", found '" + pair.substr(value + 3) + "'";
  return is_flag(*option) ? name + " takes no value" + found : name + ": expected " + option->get_type_name() + found;
}

}  // namespace

std::string named_command(const CLI::App& app) {
  std::string name;
  for (const CLI::App* command = &deepest_command(app); command != &app; command = command->get_parent()) {
    name = " " + command->get_name() + name;
  }
  return name;
}

std::string about_parse_error(const CLI::App& app, const CLI::ParseError& error) {
  const CLI::App& command = deepest_command(app);
  const std::string message = error.what();
  if (dynamic_cast<const CLI::ExtrasError*>(&error) != nullptr) return about_extras(app);
  if (dynamic_cast<const CLI::RequiredError*>(&error) != nullptr) return about_missing_part(app, command, message);
  if (dynamic_cast<const CLI::ConversionError*>(&error) != nullptr) return about_conversion(app, command, message);
  // "--a excludes --b", "--a requires --b"
  const auto about_pair = [&](const std::string& verb, const std::string& ours, const std::string& remedy) {
    const std::size_t at = message.find(verb);
    return at == std::string::npos ? message : message.substr(0, at) + ours + message.substr(at + verb.size()) + remedy;
  };
  if (dynamic_cast<const CLI::ExcludesError*>(&error) != nullptr) return about_pair(" excludes ", " excludes ", ": give one of the two");
  if (dynamic_cast<const CLI::RequiresError*>(&error) != nullptr) return about_pair(" requires ", " is of use only with ", ": give it too");
  const CLI::Option* option = named_option(app, command, message);
  if (dynamic_cast<const CLI::ArgumentMismatch*>(&error) != nullptr && option != nullptr)
    return about_counts(*option, usage_of(app, command));
  return message;
}

}  // namespace g3r::cli
