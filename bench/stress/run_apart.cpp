#include "run_apart.h"

#include <g3r/error.h>

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <functional>
#include <sstream>
#include <string>

#include "sanitized.h"

namespace g3r::stress {
namespace {

constexpr int kThrown = 3;  // exit code of a child that saw an exception that nobody should see

std::string one_line(std::string text) {
  for (char& c : text) {
    if (c == '\n' || c == '\t') c = ' ';
  }
  return text;
}

std::string packed(const Outcome& outcome) {
  std::ostringstream out;
  out.precision(9);
  out << outcome.cpu_seconds << ' ' << outcome.refused << ' ' << outcome.warned << ' ' << outcome.wrong << ' ' << outcome.wrong_and_sure
      << ' ' << outcome.touches << '\n';
  for (const Finding& f : outcome.findings) out << f.kind << '\t' << one_line(f.what) << '\n';
  return out.str();
}

Outcome crash(const std::string& what) {
  Outcome out;
  out.findings.push_back({"crash", one_line(what)});
  return out;
}

Outcome unpacked(const std::string& text) {
  std::istringstream in(text);
  Outcome out;
  in >> out.cpu_seconds >> out.refused >> out.warned >> out.wrong >> out.wrong_and_sure >> out.touches;
  if (!in) return crash("the process ended without its result");
  std::string line;
  std::getline(in, line);
  while (std::getline(in, line)) {
    const std::size_t tab = line.find('\t');
    out.findings.push_back({line.substr(0, tab), tab == std::string::npos ? "" : line.substr(tab + 1)});
  }
  return out;
}

void write_all(int to, const std::string& text) {
  for (std::size_t done = 0; done < text.size();) {
    const ssize_t n = write(to, text.data() + done, text.size() - done);
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) return;
    done += static_cast<std::size_t>(n);
  }
}

std::string read_all(int from) {
  std::string out;
  std::array<char, 4096> block{};
  for (;;) {
    const ssize_t n = read(from, block.data(), block.size());
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return out;
    out.append(block.data(), static_cast<std::size_t>(n));
  }
}

void limit(int what, rlim_t to) {
  const rlimit both{to, to};
  setrlimit(static_cast<__rlimit_resource_t>(what), &both);
}

[[noreturn]] void be_child(int to, const std::function<Outcome()>& work, const Limits& limits) {
  alarm(limits.wall_seconds);
  limit(RLIMIT_CPU, limits.cpu_seconds);
  limit(RLIMIT_CORE, 0);
  if (!kSanitized) limit(RLIMIT_AS, limits.address_bytes);
  int code = 0;
  try {
    write_all(to, packed(work()));
  } catch (const std::exception& error) {
    write_all(to, std::string("thrown: ") + error.what());
    code = kThrown;
  }
  _exit(code);
}

Outcome apart(const std::function<Outcome()>& work, const Limits& limits) {
  std::array<int, 2> ends{};
  if (pipe2(ends.data(), O_CLOEXEC) != 0) throw IoError(IoError::Kind::kFailed, "no pipe to another process");
  const pid_t child = fork();
  if (child < 0) throw IoError(IoError::Kind::kFailed, "no other process can be started");
  if (child == 0) {
    close(ends[0]);
    be_child(ends[1], work, limits);
  }
  close(ends[1]);
  const std::string said = read_all(ends[0]);
  close(ends[0]);
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  if (WIFSIGNALED(status)) return crash(std::string("signal: ") + strsignal(WTERMSIG(status)));
  if (WEXITSTATUS(status) == kThrown) return crash(said);
  if (WEXITSTATUS(status) != 0) return crash("exit code " + std::to_string(WEXITSTATUS(status)));
  return unpacked(said);
}

}  // namespace

Outcome hold_apart(const Case& tested, const Demands& demands, const Limits& limits) {
  return apart([&] { return hold(tested, demands); }, limits);
}

Outcome hold_apart(const Recipe& recipe, const Demands& demands, const Limits& limits) {
  return apart([&] { return hold({recipe, make_scene(recipe)}, demands); }, limits);
}

}  // namespace g3r::stress
