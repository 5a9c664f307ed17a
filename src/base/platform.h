// What operating systems differ in: files, memory, folders. One source per kind of system, platform_posix.cpp and platform_windows.cpp; no
// other source of the library includes a header of a system.
//
// Names of files are UTF-8 on Windows, and the bytes that the user gave elsewhere. Files are the small numbers of POSIX, which Windows' C
// library has too. Where a function fails it sets errno; calls that a signal has interrupted are repeated.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace g3r::platform {

inline constexpr int kStandardInput = 0;
inline constexpr int kStandardOutput = 1;

/// The characters that may stand between folders.
#ifdef _WIN32
inline constexpr std::string_view kSeparators = "/\\";
#else
inline constexpr std::string_view kSeparators = "/";
#endif

/// A name of a file for the standard library, and back.
[[nodiscard]] std::filesystem::path path_of(const std::string& name);
[[nodiscard]] std::string name_of(const std::filesystem::path& path);

struct FileStatus {
  enum class Kind { kRegular, kFolder, kOther } kind = Kind::kOther;
  std::uint64_t bytes = 0;
  unsigned permissions = 0;
  std::uint64_t device = 0;  ///< the same two numbers: the same file
  std::uint64_t index = 0;
};
/// False if there is none.
bool get_status(const std::string& name, FileStatus& status);
bool get_status(int file, FileStatus& status);

/// What access() says: whether this user may read or write a file that exists, or create files in a folder.
[[nodiscard]] bool exists(const std::string& name);
[[nodiscard]] bool may_read(const std::string& name);
[[nodiscard]] bool may_write(const std::string& name);
[[nodiscard]] bool may_create_in(const std::string& folder);

/// The name with links resolved, or the name itself where that fails.
[[nodiscard]] std::string resolve(const std::string& name);
/// Files and folders whose names match a pattern with * and ? in any of its parts; in no order.
[[nodiscard]] std::vector<std::string> matching(const std::string& pattern);

/// Files without translation of line ends, closed in child processes. Below 0 if it fails.
[[nodiscard]] int open_to_read(const std::string& name);
[[nodiscard]] int open_to_write(const std::string& name);  ///< an existing one, as it is
/// Standard input without translation of line ends.
[[nodiscard]] int standard_input();
/// The same of standard output.
[[nodiscard]] int standard_output();
bool close_file(int file);

/// The number of bytes, 0 at the end of the file, below 0 if it fails. May be fewer than asked for.
[[nodiscard]] std::ptrdiff_t read_some(int file, void* bytes, std::size_t count);
[[nodiscard]] std::ptrdiff_t write_some(int file, const void* bytes, std::size_t count);
/// The same at a place of the file, from any thread; where the file is read or written next is undefined afterwards on Windows.
[[nodiscard]] std::ptrdiff_t read_at(int file, std::uint64_t offset, void* bytes, std::size_t count);
[[nodiscard]] std::ptrdiff_t write_at(int file, std::uint64_t offset, const void* bytes, std::size_t count);

/// A new file that other processes see is in use; EEXIST if there is one, maybe of another process.
[[nodiscard]] int create_file(const std::string& name, unsigned permissions);
/// Marks the file, just created under this name, as in use. False if another process took it for left behind before.
[[nodiscard]] bool mark_in_use(int file, const std::string& name);
/// Removes a file that create_file() made in a process that is no more. False if the file is in use, or no regular file.
bool remove_if_left_behind(const std::string& name);
bool set_permissions(int file, unsigned permissions);
bool remove_file(const std::string& name);

/// Waits until what was written is on the disk.
bool sync(int file);
/// Puts the file, which create_file() made under the name `from`, in the place of `to`, at once. Where a system cannot do so with an open
/// file, it is closed, and `file` is -1 then.
bool replace(int& file, const std::string& from, const std::string& to);
/// Waits until the names in a folder are on the disk, as far as the system lets one. False if that failed.
bool sync_folder(const std::string& folder);

/// The most memory that this process has had, in bytes; 0 if the system does not say.
[[nodiscard]] std::size_t peak_memory();
/// From now on, large blocks are the system's again once they are freed. For programs: it is a setting of the whole process.
void give_back_freed_blocks();
/// What small blocks have left free becomes the system's again. Takes milliseconds.
void give_back_holes();
/// Memory that nobody uses and that this process may have, in bytes: in a container, what its limit leaves.
[[nodiscard]] double free_memory();
/// The number of this process.
[[nodiscard]] std::uint64_t process();
/// Where programs keep what they can make anew; empty if this user has no such folder.
[[nodiscard]] std::filesystem::path cache_folder();

}  // namespace g3r::platform
