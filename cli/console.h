// What a person sees while a command runs. All of it goes to standard error; standard output carries only data.
#pragma once

#include <chrono>
#include <string>
#include <string_view>

namespace g3r::cli {

class Console {
 public:
  /// `progress`: draw a bar if standard error is a terminal. `verbosity` > 0: also details, and a line per stage without a terminal.
  Console(bool quiet, bool progress, int verbosity);
  ~Console() { clear_bar(); }
  Console(const Console&) = delete;
  Console& operator=(const Console&) = delete;

  void say(const std::string& line);     ///< unless quiet
  void detail(const std::string& line);  ///< only when verbose
  void warn(const std::string& line);    ///< unless quiet; control characters are escaped
  void fail(const std::string& line);    ///< why the exit code is not 0, also when quiet; control characters are escaped
  void progress(std::string_view stage, double fraction);
  void clear_bar();

 private:
  using Clock = std::chrono::steady_clock;
  void draw_bar(double fraction);

  bool quiet_;
  bool verbose_;
  bool bar_;  ///< a bar may be drawn
  bool bar_visible_ = false;
  std::string stage_;
  Clock::time_point stage_start_;
  Clock::time_point last_drawn_;
};

}  // namespace g3r::cli
