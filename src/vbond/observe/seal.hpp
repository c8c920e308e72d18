#pragma once
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>

namespace vbond {

/// The first bytes of a checkpoint: what it is, and a checksum of all bytes that follow. HDF5 leaves
/// them to the user (its "user block"), so that its own tools still read the file. With the checksum
/// no damaged file ever reaches HDF5, whose own checks do not cover the numbers.
constexpr std::size_t seal_size = 512;  ///< bytes; the smallest user block of HDF5

/// Writes the seal into a file that is complete but for it. Throws IoError.
void write_seal(const std::filesystem::path& path, std::int32_t format, const std::string& program_version);

/// Throws IoError, with a text that goes on after the file's name, unless the file is a checkpoint of
/// vbond in a format from `oldest` to `newest` and undamaged.
void check_seal(const std::filesystem::path& path, std::int32_t oldest, std::int32_t newest);

}  // namespace vbond
