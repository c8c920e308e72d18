#pragma once
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "vbond/core/vec3.hpp"
#include "vbond/observe/files.hpp"
#include "vbond/observe/in_cell.hpp"

namespace vbond {

/// A .vtp file that VtpFile has written, now or in an earlier version, its arrays read one by one; in between
/// it is not open. Anything else is refused: every function throws IoError naming the file.
class VtpInput {
 public:
  explicit VtpInput(const std::filesystem::path& path);

  double time() const { return time_; }
  std::int64_t step() const { return step_; }
  std::optional<double> load_factor() const { return load_factor_; }  ///< of a balance
  const std::optional<FrameCell>& cell() const { return cell_; }      ///< of a periodic body
  /// Of a part: how many points all parts of its frame have together; absent in frames of earlier versions.
  std::optional<std::size_t> points_of_all_parts() const { return points_of_all_parts_; }
  std::size_t points() const { return points_; }
  std::size_t cells() const { return cells_; }

  bool lines() const { return corners_ == 2; }      ///< cells join two points each
  bool triangles() const { return corners_ == 3; }  ///< or three; else each is a point

  /// What an array has a value for: so many values come back. Ends of cells: two for each line, three for
  /// each triangle.
  enum class Per : std::uint8_t { point, cell, end };

  bool has(Per per, const std::string& name) const;
  /// The array of this name; it must be there once, for each of these, as numbers of this kind: reals and
  /// integers may take 32 or 64 bits.
  std::vector<double> scalars(Per per, const std::string& name) const;
  std::vector<Vec3d> vectors(Per per, const std::string& name) const;
  /// Three whole numbers of 32 bits each.
  std::vector<Image> images(Per per, const std::string& name) const;
  std::vector<std::int64_t> integers(Per per, const std::string& name) const;
  std::vector<std::uint8_t> bytes(Per per, const std::string& name) const;
  /// The label of its unit; empty if it has none, or if there is no such array.
  std::string unit(const std::string& name) const;

 private:
  struct Array {
    Per per = Per::point;
    std::string type, name, unit;
    std::size_t components = 0, size = 0;  ///< size in bytes, of the numbers
    std::size_t offset = 0;                ///< into the file
    std::size_t stored = 0;                ///< bytes that it takes there
  };
  class Head;

  const Array* find(Per per, const std::string& name, std::size_t components) const;
  [[noreturn]] void refuse_array(Per per, const std::string& name, const char* type) const;
  template <class T, class Stored>
  std::vector<T> values_of(const Array& a) const;
  std::vector<double> reals(Per per, const std::string& name, std::size_t components) const;
  void read_plain(std::FILE* f, const Array& a, std::vector<char>& to) const;
  void read_blocks(std::FILE* f, const Array& a, std::vector<char>& to) const;
  std::string bytes_at(std::FILE* f, const Array& a, std::size_t from, std::size_t size) const;
  [[noreturn]] void refuse_damaged(const Array& a) const;
  [[noreturn]] void refuse_size() const;

  std::filesystem::path path_;
  std::size_t size_ = 0;     ///< of the file in bytes
  bool compressed_ = false;  ///< arrays stand in blocks
  double time_ = 0;
  std::int64_t step_ = 0;
  std::optional<double> load_factor_;
  std::optional<FrameCell> cell_;
  std::optional<std::size_t> points_of_all_parts_;
  std::size_t points_ = 0, cells_ = 0;
  std::size_t corners_ = 1;  ///< of each cell
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
