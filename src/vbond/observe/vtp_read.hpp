#pragma once
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "vbond/core/vec3.hpp"
#include "vbond/observe/files.hpp"

namespace vbond {

/// A .vtp file that VtpFile has written, its arrays read one by one. Anything else is refused: every function
/// throws IoError naming the file.
class VtpInput {
 public:
  explicit VtpInput(const std::filesystem::path& path);

  double time() const { return time_; }
  std::int64_t step() const { return step_; }
  std::optional<double> load_factor() const { return load_factor_; }  ///< of a balance
  std::size_t points() const { return points_; }
  std::size_t cells() const { return cells_; }

  /// The array of this name; it must be there with this type.
  std::vector<double> scalars(const std::string& name) const;
  std::vector<Vec3d> vectors(const std::string& name) const;
  std::vector<std::int64_t> integers(const std::string& name) const;
  std::vector<std::uint8_t> bytes(const std::string& name) const;

 private:
  struct Array {
    std::string type, name;
    std::size_t components = 0, size = 0;  ///< size in bytes
    std::size_t offset = 0;                ///< into the file
  };
  class Head;

  template <class T>
  std::vector<T> read(const std::string& name, const char* type, std::size_t components) const;
  void check_size(std::size_t end_of_arrays) const;

  std::filesystem::path path_;
  File file_;
  double time_ = 0;
  std::int64_t step_ = 0;
  std::optional<double> load_factor_;
  std::size_t points_ = 0, cells_ = 0;
  std::vector<Array> arrays_;
};

/// An entry of a .pvd list.
struct ListedFrame {
  double time = 0;             ///< [time]
  std::filesystem::path file;  ///< with the folder of the list
};

/// The entries of a list that pvd_list() has made. Throws IoError.
std::vector<ListedFrame> read_pvd(const std::filesystem::path& path);

}  // namespace vbond
