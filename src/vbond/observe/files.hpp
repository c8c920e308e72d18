#pragma once
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

/// The whole file as bytes. Throws IoError.
std::string read_all(const std::filesystem::path& path);

/// Removes a file, or a link to one; nothing if there is none. Throws IoError.
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

/// Replaces a file by this content as publish does.
void replace_file(const std::filesystem::path& path, std::string_view content, Sync sync = Sync::to_disk);

}  // namespace vbond
