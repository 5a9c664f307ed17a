#include "help.h"

#include <sstream>
#include <utility>

namespace g3r::cli {
namespace {

constexpr std::size_t kLineWidth = 80;  // The narrowest terminals in use have so many columns.
constexpr std::size_t kNameWidth = 29;  // "  --epsilon auto|X[%|h|n]" and some space have room in it.

/// The words in lines short enough for the right column.
std::string wrapped(const std::string& text) {
  std::istringstream words(text);
  std::string lines, word;
  for (std::size_t length = 0; words >> word; length += word.size()) {
    if (length > 0 && kNameWidth + length + 1 + word.size() > kLineWidth) {
      lines += '\n';
      length = 0;
    } else if (length > 0) {
      lines += ' ';
      ++length;
    }
    lines += word;
  }
  return lines;
}

/// "IN...", "IN... DIR", "[OUT]", "--truth GT"
std::string typed(const CLI::Option& option) {
  std::string name = option.get_name(option.get_positional());
  if (!option.get_positional()) return option.get_name() + " " + option.get_type_name();
  if (option.get_items_expected_max() > 1) name += "...";
  if (!option.get_type_name().empty()) name += " " + option.get_type_name();
  return option.get_required() ? name : "[" + name + "]";
}

}  // namespace

HelpFormatter::HelpFormatter() { column_width(kNameWidth); }

std::string HelpFormatter::make_usage(const CLI::App* app, std::string name) const {
  std::string line = "Usage: " + name;
  for (const CLI::Option* option : app->get_options([](const CLI::Option* o) { return o->get_positional(); })) line += " " + typed(*option);
  for (const CLI::Option* option : app->get_options([](const CLI::Option* o) { return !o->get_positional() && o->get_required(); })) {
    line += " " + typed(*option);
  }
  line += " [options]\n";
  if (!app->get_subcommands({}).empty()) line += "       " + name + " COMMAND --help\n";
  return line;
}

std::string HelpFormatter::make_help(const CLI::App* app, std::string name, CLI::AppFormatMode mode) const {
  return CLI::detail::find_and_replace(CLI::Formatter::make_help(app, std::move(name), mode), "\n\n\n", "\n\n");
}

std::string HelpFormatter::make_option_opts(const CLI::Option* option) const {
  return option->get_type_name().empty() ? "" : " " + option->get_type_name();
}

std::string HelpFormatter::make_option_desc(const CLI::Option* option) const { return wrapped(option->get_description()); }

std::string HelpFormatter::make_subcommand(const CLI::App* command) const {
  std::ostringstream out;
  CLI::detail::format_help(out, command->get_name(), wrapped(command->get_description()), column_width_);
  return out.str();
}

}  // namespace g3r::cli
