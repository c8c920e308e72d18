#pragma once
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "vbond/report/vtp_read.hpp"

namespace vbond {

/// A frame of particles or bonds: one .vtp file, or the parts that a list of parts (.pvtp) names, put
/// together as if one process had written them: in the order of their numbers, which the arrays "id" tell,
/// and "particle" for the ends of bonds, or "point" where these may be images. Particles that have not come
/// in yet, or are gone, are in no file of particles. Every function throws IoError naming the file, as those
/// of VtpInput of the same name do.
class FrameInput {
 public:
  using Per = VtpInput::Per;

  explicit FrameInput(const std::filesystem::path& path);

  double time() const { return files_[0].time(); }
  std::int64_t step() const { return files_[0].step(); }
  std::optional<double> load_factor() const { return files_[0].load_factor(); }
  const std::optional<FrameCell>& cell() const { return files_[0].cell(); }
  std::size_t points() const { return points_ ? points_->count : files_[0].points(); }
  std::size_t cells() const { return cells_ ? cells_->count : files_[0].cells(); }
  bool lines() const { return files_[0].lines(); }
  bool triangles() const { return files_[0].triangles(); }

  /// Whether all parts have it.
  bool has(Per per, const std::string& name) const;
  std::vector<double> scalars(Per per, const std::string& name) const;
  std::vector<Vec3d> vectors(Per per, const std::string& name) const;
  std::vector<Image> images(Per per, const std::string& name) const;
  /// Of the ends of cells only "connectivity", which is numbers of particles.
  std::vector<std::int64_t> integers(Per per, const std::string& name) const;
  std::vector<std::uint8_t> bytes(Per per, const std::string& name) const;
  std::string unit(const std::string& name) const { return files_[0].unit(name); }

 private:
  /// Where the values of each part stand in the whole.
  struct Places {
    std::size_t count = 0;
    std::vector<std::vector<std::size_t>> of;
  };
  Places places(Per per, const char* numbers, bool once) const;
  template <class Get>
  auto put_together(Per per, const Get& get) const;
  [[noreturn]] void refuse(const std::string& what) const;

  std::filesystem::path path_;
  std::vector<VtpInput> files_;
  std::optional<Places> points_, cells_;  // of parts
};

}  // namespace vbond
