#pragma once
#include <filesystem>

#include "vbond/observe/detail/h5.hpp"
#include "vbond/observe/files.hpp"

namespace vbond {

/// Where HDF5 writes a new file: to the disk, but it is never told that the disk has failed, which it
/// survives badly. (With a full disk H5Fclose fails and leaves a file half closed, on which HDF5's exit
/// handler crashes.) Who writes asks for the failure in the end. Must live as long as HDF5 has the file.
class H5Stream {
 public:
  /// Of a file that is there, and may be read as well. Throws IoError.
  explicit H5Stream(std::filesystem::path path);

  /// How HDF5 opens it, with H5Fcreate.
  H5Handle access() const;
  /// Throws IoError with the system's reason if something could not be written.
  void require_written() const;

  struct Target {
    int file;
    int error = 0;  ///< errno of what failed first
  };

 private:
  std::filesystem::path path_;
  File file_;
  mutable Target target_;
};

}  // namespace vbond
