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

  bool lines() const { return lines_; }  ///< cells join two points each; else each is a point

  /// What an array has a value for: so many values come back. Ends of cells: two for each line.
  enum class Per : std::uint8_t { point, cell, end };

  /// The array of this name; it must be there once, with this type and for each of these.
  std::vector<double> scalars(Per per, const std::string& name) const;
  std::vector<Vec3d> vectors(Per per, const std::string& name) const;
  std::vector<std::int64_t> integers(Per per, const std::string& name) const;
  std::vector<std::uint8_t> bytes(Per per, const std::string& name) const;

 private:
  struct Array {
    Per per = Per::point;
    std::string type, name;
    std::size_t components = 0, size = 0;  ///< size in bytes
    std::size_t offset = 0;                ///< into the file
  };
  class Head;

  template <class T>
  std::vector<T> read(Per per, const std::string& name, const char* type, std::size_t components) const;
  [[noreturn]] void refuse_size() const;

  std::filesystem::path path_;
  File file_;
  std::size_t size_ = 0;  ///< of the file in bytes
  double time_ = 0;
  std::int64_t step_ = 0;
  std::optional<double> load_factor_;
  std::size_t points_ = 0, cells_ = 0;
  bool lines_ = false;
  std::vector<Array> arrays_;
};

/// An entry of a .pvd list.
struct ListedFrame {
  double time = 0;             ///< [time]
  std::filesystem::path file;  ///< with the folder of the list
};

/// The entries of a list that pvd_list() has made; its files stand below its folder. Throws IoError.
std::vector<ListedFrame> read_pvd(const std::filesystem::path& path);

}  // namespace vbond
