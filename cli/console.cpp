#include "console.h"

#include <g3r/io.h>

#include <algorithm>
#include <cstdio>

#include "terminal.h"
#include "text.h"

namespace g3r::cli {
namespace {

constexpr std::size_t kBarWidth = 32;     // The bar has so many characters where the terminal has room.
constexpr std::size_t kStageWidth = 10;   // The indented name of a stage has so many, so that bars stand below each other.
constexpr std::size_t kPercentWidth = 8;  // Brackets and " 100 %" take so many beside the bar.
constexpr std::size_t kLeastBar = 5;      // A shorter bar is no help: the share alone is shown then.
constexpr std::size_t kColumns = 80;      // Terminals that do not say how wide they are get so many columns.
constexpr auto kRedrawInterval = std::chrono::milliseconds(100);  // Faster is not seen, and costs time where the terminal is far away.
// A time left extrapolated from less than these is a guess that jumps about.
constexpr double kMinSecondsForEstimate = 1;
constexpr double kMinFractionForEstimate = 0.05;
constexpr const char* kClearLine = "\r\x1b[K";

void print(const std::string& text) { std::fputs(text.c_str(), stderr); }

// One less than the terminal has: a character in the last one makes some terminals begin another line, which nothing clears.
std::size_t usable_columns() {
  const std::size_t columns = terminal_columns();
  return (columns > 0 ? columns : kColumns) - 1;
}

}  // namespace

Console::Console(bool quiet, bool progress, int verbosity)
    : quiet_(quiet), verbose_(verbosity > 0 && !quiet), bar_(progress && !quiet && is_capable_terminal()) {}

void Console::say(const std::string& line) {
  if (quiet_) return;
  clear_bar();
  print(line + "\n");
}

void Console::detail(const std::string& line) {
  if (verbose_) say(line);
}

void Console::warn(const std::string& line) { say("g3r: warning: " + escape_text(line)); }

void Console::fail(const std::string& line) {
  clear_bar();
  print("g3r: " + escape_text(line) + "\n");
}

void Console::progress(std::string_view stage, double fraction) {
  const bool is_new = stage != stage_;
  if (is_new) {
    stage_ = stage;
    stage_start_ = Clock::now();
  }
  if (bar_) {
    if (is_new || Clock::now() - last_drawn_ >= kRedrawInterval) draw_bar(std::clamp(fraction, 0.0, 1.0));
  } else if (is_new) {
    detail("g3r: " + stage_);
  }
}

void Console::draw_bar(double fraction) {
  last_drawn_ = Clock::now();
  bar_visible_ = true;
  const std::size_t columns = usable_columns();
  std::string line("  ");
  line += stage_;
  if (fraction > 0) {
    const std::size_t taken = kStageWidth + kPercentWidth;
    const std::size_t width = columns < taken + kLeastBar ? 0 : std::min(kBarWidth, columns - taken);
    if (width > 0) {
      const auto filled = static_cast<std::size_t>(fraction * static_cast<double>(width));
      line.resize(std::max(line.size(), kStageWidth), ' ');
      line.append("[").append(filled, '=').append(width - filled, ' ').append("]");
    }
    line.append(" ").append(std::to_string(static_cast<int>(100 * fraction))).append(" %");
    const double elapsed = std::chrono::duration<double>(last_drawn_ - stage_start_).count();
    if (elapsed > kMinSecondsForEstimate && fraction > kMinFractionForEstimate) {
      line += ", " + duration(elapsed / fraction - elapsed) + " left";
    }
  } else {
    line += " ...";  // a stage that cannot tell how far it is
  }
  line.resize(std::min(line.size(), columns));
  print(kClearLine + line);
  std::fflush(stderr);
}

void Console::clear_bar() {
  if (!bar_visible_) return;
  bar_visible_ = false;
  print(kClearLine);
  std::fflush(stderr);
}

}  // namespace g3r::cli
