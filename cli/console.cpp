#include "console.h"

#include <g3r/io.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>

#include <unistd.h>

#include "text.h"

namespace g3r::cli {
namespace {

constexpr std::size_t kBarWidth = 32;
constexpr auto kRedrawInterval = std::chrono::milliseconds(100);
// A time left extrapolated from less than these is a guess that jumps about.
constexpr double kMinSecondsForEstimate = 1;
constexpr double kMinFractionForEstimate = 0.05;
constexpr const char* kClearLine = "\r\x1b[K";

void print(const std::string& text) { std::fputs(text.c_str(), stderr); }

bool is_capable_terminal() {
  const char* term = std::getenv("TERM");  // NOLINT(concurrency-mt-unsafe): no thread changes the environment
  return isatty(STDERR_FILENO) != 0 && term != nullptr && std::string_view(term) != "dumb";
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
  std::string line = kClearLine;
  line.append("  ").append(stage_);
  if (fraction > 0) {
    const auto filled = static_cast<std::size_t>(fraction * static_cast<double>(kBarWidth));
    line.resize(std::max(line.size(), std::size_t{14}), ' ');
    line.append("[").append(filled, '=').append(kBarWidth - filled, ' ').append("] ");
    line += std::to_string(static_cast<int>(100 * fraction)) + " %";
    const double elapsed = std::chrono::duration<double>(last_drawn_ - stage_start_).count();
    if (elapsed > kMinSecondsForEstimate && fraction > kMinFractionForEstimate) {
      line += ", " + duration(elapsed / fraction - elapsed) + " left";
    }
  } else {
    line += " ...";  // a stage that cannot tell how far it is
  }
  print(line);
  std::fflush(stderr);
}

void Console::clear_bar() {
  if (!bar_visible_) return;
  bar_visible_ = false;
  print(kClearLine);
  std::fflush(stderr);
}

}  // namespace g3r::cli
