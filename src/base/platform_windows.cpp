// Windows 10 and newer.
#include "base/platform.h"

#include <algorithm>
#include <cerrno>
#include <system_error>

// clang-format off
#include <windows.h>  // before the others, which need it
#include <fcntl.h>
#include <io.h>
#include <psapi.h>
#include <share.h>
#include <sys/stat.h>
// clang-format on

namespace g3r::platform {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMostAtOnce = std::size_t{1} << 30;  // bytes: the C library counts in int

// Sets errno as the C library would; false, for callers to return.
bool fail(DWORD error) {
  switch (error) {
    case ERROR_FILE_NOT_FOUND:
    case ERROR_PATH_NOT_FOUND:
    case ERROR_INVALID_NAME:
    case ERROR_BAD_PATHNAME:
      errno = ENOENT;
      break;
    case ERROR_FILE_EXISTS:
    case ERROR_ALREADY_EXISTS:
      errno = EEXIST;
      break;
    case ERROR_ACCESS_DENIED:
    case ERROR_SHARING_VIOLATION:
    case ERROR_LOCK_VIOLATION:
    case ERROR_WRITE_PROTECT:
      errno = EACCES;
      break;
    case ERROR_DISK_FULL:
    case ERROR_HANDLE_DISK_FULL:
      errno = ENOSPC;
      break;
    case ERROR_NOT_ENOUGH_MEMORY:
    case ERROR_OUTOFMEMORY:
      errno = ENOMEM;
      break;
    default:
      errno = EIO;
  }
  return false;
}

std::wstring wide(const std::string& name) {
  const int size = ::MultiByteToWideChar(CP_UTF8, 0, name.data(), static_cast<int>(name.size()), nullptr, 0);
  std::wstring text(static_cast<std::size_t>(size), L'\0');
  ::MultiByteToWideChar(CP_UTF8, 0, name.data(), static_cast<int>(name.size()), text.data(), size);
  return text;
}

std::string narrow(const std::wstring& text) {
  const int size = ::WideCharToMultiByte(CP_UTF8, 0, text.data(), static_cast<int>(text.size()), nullptr, 0, nullptr, nullptr);
  std::string name(static_cast<std::size_t>(size), '\0');
  ::WideCharToMultiByte(CP_UTF8, 0, text.data(), static_cast<int>(text.size()), name.data(), size, nullptr, nullptr);
  return name;
}

HANDLE handle_of(int file) { return reinterpret_cast<HANDLE>(::_get_osfhandle(file)); }

bool get_status(HANDLE handle, FileStatus& status) {
  using Kind = FileStatus::Kind;
  BY_HANDLE_FILE_INFORMATION found{};
  status = {};
  if (::GetFileType(handle) != FILE_TYPE_DISK) return handle != INVALID_HANDLE_VALUE || fail(ERROR_INVALID_HANDLE);
  if (::GetFileInformationByHandle(handle, &found) == 0) return fail(::GetLastError());
  status.kind = (found.dwFileAttributes & FILE_ATTRIBUTE_DIRECTORY) != 0 ? Kind::kFolder : Kind::kRegular;
  status.bytes = std::uint64_t{found.nFileSizeHigh} << 32U | found.nFileSizeLow;
  status.permissions = (found.dwFileAttributes & FILE_ATTRIBUTE_READONLY) != 0 ? 0444U : 0666U;
  status.device = found.dwVolumeSerialNumber;
  status.index = std::uint64_t{found.nFileIndexHigh} << 32U | found.nFileIndexLow;
  return true;
}

HANDLE open_for_status(const std::string& name) {
  return ::CreateFileW(wide(name).c_str(), 0, FILE_SHARE_READ | FILE_SHARE_WRITE | FILE_SHARE_DELETE, nullptr, OPEN_EXISTING,
                       FILE_FLAG_BACKUP_SEMANTICS, nullptr);
}

int without_translation(int file) {
  ::_setmode(file, _O_BINARY);
  return file;
}

// A file for the C library, of a handle.
int file_of(HANDLE handle, int flags) {
  if (handle == INVALID_HANDLE_VALUE) {
    fail(::GetLastError());
    return -1;
  }
  const int file = ::_open_osfhandle(reinterpret_cast<std::intptr_t>(handle), flags | _O_BINARY | _O_NOINHERIT);
  if (file < 0) ::CloseHandle(handle);
  return file;
}

// The bytes of a file from `offset` on, by ReadFile or WriteFile.
template <class Transfer, class Bytes>
std::ptrdiff_t transfer_at(const Transfer& transfer, int file, std::uint64_t offset, Bytes* bytes, std::size_t count) {
  OVERLAPPED place{};
  place.Offset = static_cast<DWORD>(offset);
  place.OffsetHigh = static_cast<DWORD>(offset >> 32U);
  DWORD done = 0;
  if (transfer(handle_of(file), bytes, static_cast<DWORD>(std::min(count, kMostAtOnce)), &done, &place) == 0) {
    if (::GetLastError() == ERROR_HANDLE_EOF) return 0;
    fail(::GetLastError());
    return -1;
  }
  return static_cast<std::ptrdiff_t>(done);
}

// Whether a name matches a pattern of * and ?, in whatever case. Sources: R. Salz's wildmat; the last star takes one character more.
bool matches(const std::wstring& name, const std::wstring& pattern) {
  const auto lower = [](wchar_t c) {
    return reinterpret_cast<std::uintptr_t>(::CharLowerW(reinterpret_cast<wchar_t*>(std::uintptr_t{c})));
  };
  std::size_t n = 0;
  std::size_t p = 0;
  std::size_t star = std::wstring::npos;
  std::size_t after = 0;
  while (n < name.size()) {
    if (p < pattern.size() && pattern[p] == L'*') {
      star = p++;
      after = n;
    } else if (p < pattern.size() && (pattern[p] == L'?' || lower(pattern[p]) == lower(name[n]))) {
      ++n;
      ++p;
    } else if (star != std::wstring::npos) {
      p = star + 1;
      n = ++after;
    } else {
      return false;
    }
  }
  return pattern.find_first_not_of(L'*', p) == std::wstring::npos;
}

// What matches the parts of a pattern from `part` on, below `folder`.
void add_matching(const fs::path& folder, fs::path::const_iterator part, fs::path::const_iterator end, std::vector<std::string>& names) {
  if (part == end) {
    names.push_back(name_of(folder));
    return;
  }
  const std::wstring pattern = part->wstring();
  const auto rest = std::next(part);
  std::error_code error;
  if (pattern.find_first_of(L"*?") == std::wstring::npos) {
    if (fs::exists(folder / *part, error)) add_matching(folder / *part, rest, end, names);
    return;
  }
  fs::directory_iterator entry(folder.empty() ? fs::path(L".") : folder, error);
  for (; !error && entry != fs::directory_iterator(); entry.increment(error)) {
    const fs::path name = entry->path().filename();
    const bool hidden = name.wstring()[0] == L'.' && pattern[0] != L'.';
    if (!hidden && matches(name.wstring(), pattern)) add_matching(folder / name, rest, end, names);
  }
}

}  // namespace

fs::path path_of(const std::string& name) { return wide(name); }
std::string name_of(const fs::path& path) { return narrow(path.wstring()); }

bool get_status(const std::string& name, FileStatus& status) {
  const HANDLE handle = open_for_status(name);
  if (handle == INVALID_HANDLE_VALUE) return fail(::GetLastError());
  const bool told = get_status(handle, status);
  ::CloseHandle(handle);
  return told;
}

bool get_status(int file, FileStatus& status) { return get_status(handle_of(file), status); }

bool exists(const std::string& name) { return ::_waccess(wide(name).c_str(), 0) == 0; }
bool may_read(const std::string& name) { return ::_waccess(wide(name).c_str(), 4) == 0; }
bool may_write(const std::string& name) { return ::_waccess(wide(name).c_str(), 2) == 0; }

// Read-only folders take files all the same.
bool may_create_in(const std::string& folder) {
  FileStatus status;
  if (!get_status(folder, status)) return false;
  errno = ENOTDIR;
  return status.kind == FileStatus::Kind::kFolder;
}

std::string resolve(const std::string& name) {
  const DWORD attributes = ::GetFileAttributesW(wide(name).c_str());
  if (attributes == INVALID_FILE_ATTRIBUTES || (attributes & FILE_ATTRIBUTE_REPARSE_POINT) == 0) return name;
  const HANDLE handle = open_for_status(name);
  if (handle == INVALID_HANDLE_VALUE) return name;
  std::wstring text(32768, L'\0');  // characters that a name has at most
  const DWORD size = ::GetFinalPathNameByHandleW(handle, text.data(), static_cast<DWORD>(text.size()), 0);
  ::CloseHandle(handle);
  if (size == 0 || size >= text.size()) return name;
  text.resize(size);
  return narrow(text);
}

std::vector<std::string> matching(const std::string& pattern) {
  std::vector<std::string> names;
  const fs::path path = path_of(pattern);
  const fs::path parts = path.relative_path();
  add_matching(path.root_path(), parts.begin(), parts.end(), names);
  return names;
}

int open_to_read(const std::string& name) {
  const DWORD share = FILE_SHARE_READ | FILE_SHARE_WRITE | FILE_SHARE_DELETE;
  // With FILE_FLAG_BACKUP_SEMANTICS folders too, so that the caller can say what they are.
  return file_of(::CreateFileW(wide(name).c_str(), GENERIC_READ, share, nullptr, OPEN_EXISTING, FILE_FLAG_BACKUP_SEMANTICS, nullptr),
                 _O_RDONLY);
}

int open_to_write(const std::string& name) {
  const DWORD share = FILE_SHARE_READ | FILE_SHARE_WRITE;
  return file_of(::CreateFileW(wide(name).c_str(), GENERIC_WRITE, share, nullptr, OPEN_EXISTING, 0, nullptr), _O_WRONLY);
}

int standard_input() { return without_translation(kStandardInput); }
int standard_output() { return without_translation(kStandardOutput); }
bool close_file(int file) { return ::_close(file) == 0; }

std::ptrdiff_t read_some(int file, void* bytes, std::size_t count) {
  const std::ptrdiff_t got = ::_read(file, bytes, static_cast<unsigned>(std::min(count, kMostAtOnce)));
  return got < 0 && errno == EPIPE ? 0 : got;  // the other end of the pipe was closed
}

std::ptrdiff_t write_some(int file, const void* bytes, std::size_t count) {
  return ::_write(file, bytes, static_cast<unsigned>(std::min(count, kMostAtOnce)));
}

std::ptrdiff_t read_at(int file, std::uint64_t offset, void* bytes, std::size_t count) {
  return transfer_at(::ReadFile, file, offset, bytes, count);
}

std::ptrdiff_t write_at(int file, std::uint64_t offset, const void* bytes, std::size_t count) {
  LARGE_INTEGER before{};  // Windows moves the place of the file along
  const bool kept = ::SetFilePointerEx(handle_of(file), {}, &before, FILE_CURRENT) != 0;
  const std::ptrdiff_t done = transfer_at(::WriteFile, file, offset, bytes, count);
  if (kept) ::SetFilePointerEx(handle_of(file), before, nullptr, FILE_BEGIN);
  return done;
}

// Nobody else may write, rename or remove it while it is open: that marks it as in use.
int create_file(const std::string& name, unsigned /*permissions*/) {
  return file_of(::CreateFileW(wide(name).c_str(), GENERIC_WRITE, FILE_SHARE_READ, nullptr, CREATE_NEW, FILE_ATTRIBUTE_NORMAL, nullptr),
                 _O_WRONLY);
}

bool mark_in_use(int /*file*/, const std::string& /*name*/) { return true; }

bool remove_if_left_behind(const std::string& name) {
  FileStatus status;
  return get_status(name, status) && status.kind == FileStatus::Kind::kRegular && remove_file(name);
}

// Of a read-only file nothing is replaced.
bool set_permissions(int /*file*/, unsigned /*permissions*/) { return true; }
bool remove_file(const std::string& name) { return ::DeleteFileW(wide(name).c_str()) != 0 || fail(::GetLastError()); }

bool sync(int file) { return ::_commit(file) == 0; }

bool replace(int& file, const std::string& from, const std::string& to) {
  const bool closed = ::_close(file) == 0;
  file = -1;
  if (!closed) return false;
  constexpr DWORD kPause = 10;   // milliseconds
  constexpr int kAttempts = 50;  // a virus scanner or an indexer lets a new file go within half a second
  const std::wstring source = wide(from);
  const std::wstring target = wide(to);
  DWORD error = 0;
  for (int attempt = 0; attempt < kAttempts; ++attempt) {
    if (::MoveFileExW(source.c_str(), target.c_str(), MOVEFILE_REPLACE_EXISTING | MOVEFILE_WRITE_THROUGH) != 0) return true;
    error = ::GetLastError();
    if (error != ERROR_SHARING_VIOLATION && error != ERROR_ACCESS_DENIED) break;
    ::Sleep(kPause);
  }
  return fail(error);
}

bool sync_folder(const std::string& /*folder*/) { return true; }  // replace() has waited for that

std::size_t peak_memory() {
  PROCESS_MEMORY_COUNTERS counters{};
  if (::GetProcessMemoryInfo(::GetCurrentProcess(), &counters, sizeof counters) == 0) return 0;
  return counters.PeakWorkingSetSize;
}

void give_back_freed_blocks() {}

void give_back_holes() {}

double free_memory() {
  MEMORYSTATUSEX memory{};
  memory.dwLength = sizeof memory;
  if (::GlobalMemoryStatusEx(&memory) == 0) return 0;
  return static_cast<double>(std::min(memory.ullAvailPhys, memory.ullAvailPageFile));  // the second: what may still be committed
}

std::uint64_t process() { return ::GetCurrentProcessId(); }

fs::path cache_folder() {
  std::wstring text(32768, L'\0');  // characters that a variable has at most
  const DWORD size = ::GetEnvironmentVariableW(L"LOCALAPPDATA", text.data(), static_cast<DWORD>(text.size()));
  if (size == 0 || size >= text.size()) return {};
  text.resize(size);
  return fs::path(text).is_absolute() ? fs::path(text) : fs::path();
}

}  // namespace g3r::platform
