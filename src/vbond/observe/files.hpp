#pragma once
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>

namespace vbond {

struct CloseFile {
  void operator()(std::FILE* f) const { std::fclose(f); }
};
using File = std::unique_ptr<std::FILE, CloseFile>;

/// Opens a file with the modes "rb", "wb", "ab" and "r+b" of std::fopen. What is written is never a link:
/// "wb" removes what has the name and makes a new file. Throws IoError with the system's reason.
File open_file(const std::filesystem::path& path, const char* mode);

/// Writes all bytes and hands them to the system. Throws IoError, as when the disk is full.
void write_all(std::FILE* f, std::string_view bytes, const std::filesystem::path& path);

/// Throws IoError with the system's reason if the last reading from `f` failed: what came short was not the
/// end.
void require_read(std::FILE* f, const std::filesystem::path& path);

/// A file without a name in the folder of this path, to write to its end and to read: it goes when it is
/// closed. Throws IoError.
File nameless_file(const std::filesystem::path& beside);

/// Reads so many bytes from this place on. Throws IoError, also if there are fewer.
void read_at(std::FILE* f, std::uint64_t at, char* to, std::size_t size, const std::filesystem::path& path);

/// The whole file as bytes. Throws IoError.
std::string read_all(const std::filesystem::path& path);

/// Removes a file, or a link to one; nothing if there is none. Throws IoError, for devices, pipes and sockets
/// too.
void remove_file(const std::filesystem::path& path);

/// Cuts a file to its first `size` bytes. Throws IoError.
void cut_file(const std::filesystem::path& path, std::uintmax_t size);

/// Makes the folder, and those above it, unless it is there. Throws IoError.
void make_folder(const std::filesystem::path& path);

/// The name under which a file is written before it takes its place.
std::filesystem::path temporary_name(const std::filesystem::path& path);

/// Whether a file's bytes must have reached the disk before it takes its place: some 10 ms each time.
enum class Sync { to_disk, none };

/// Puts the finished temporary file in its place: at every moment `path` is either the old file or the
/// new one, with Sync::to_disk also after a power cut. Throws IoError.
void publish(const std::filesystem::path& path, Sync sync = Sync::to_disk);

/// A file in the making: it is written under its temporary name and published when it is whole. One that is
/// not, as when the disk is full, is removed, so that it takes no room. All throw IoError.
class Replacement {
 public:
  explicit Replacement(std::filesystem::path path);
  ~Replacement();
  Replacement(const Replacement&) = delete;
  Replacement& operator=(const Replacement&) = delete;

  /// Where it lies until it is published.
  const std::filesystem::path& part() const { return part_; }
  void write(std::string_view bytes) { write_all(file_.get(), bytes, part_); }
  void publish(Sync sync);

 private:
  std::filesystem::path path_, part_;
  File file_;
  bool published_ = false;
};

/// Replaces a file by this content as publish does.
void replace_file(const std::filesystem::path& path, std::string_view content, Sync sync = Sync::to_disk);

/// A file that grows as a run goes, and that nobody else may touch meanwhile: what they take out of it or
/// put into it would pass for results.
class GrowingFile {
 public:
  enum class Begin : std::uint8_t { anew, at_end };
  /// Throws IoError.
  GrowingFile(std::filesystem::path path, Begin begin);
  /// Throws IoError, also if the file was removed, replaced or changed since the last time.
  void append(std::string_view bytes);

 private:
  void require_untouched() const;
  std::filesystem::path path_;
  File file_;
  std::uintmax_t size_ = 0;
};

}  // namespace vbond
