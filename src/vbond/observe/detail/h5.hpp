#pragma once
#include <hdf5.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <limits>
#include <string>
#include <string_view>
#include <utility>

#include "vbond/core/column.hpp"
#include "vbond/core/error.hpp"
#include "vbond/core/quat.hpp"
#include "vbond/core/vec3.hpp"
#include "vbond/model/bond.hpp"
#include "vbond/model/losses.hpp"
#include "vbond/model/model.hpp"
#include "vbond/physics/range.hpp"

/// What checkpoints need of HDF5: its handles, its silence, and how each type lies in a file.
namespace vbond {

/// Owns one HDF5 handle of any kind and closes it with the function of its kind.
class H5Handle {
 public:
  H5Handle(hid_t id, herr_t (*close)(hid_t)) : id_(id), close_(close) {}
  ~H5Handle() { reset(); }
  H5Handle(H5Handle&& o) noexcept : id_(std::exchange(o.id_, H5I_INVALID_HID)), close_(o.close_) {}
  H5Handle(const H5Handle&) = delete;
  H5Handle& operator=(const H5Handle&) = delete;
  H5Handle& operator=(H5Handle&&) = delete;

  hid_t get() const { return id_; }
  explicit operator bool() const { return id_ >= 0; }

  /// Closes now and says if that worked: closing a file writes what is still buffered.
  bool reset() { return id_ < 0 || close_(std::exchange(id_, H5I_INVALID_HID)) >= 0; }

 private:
  hid_t id_;
  herr_t (*close_)(hid_t);
};

/// Keeps HDF5 from printing its error stack while it lives: errors are thrown, never printed.
class H5Silence {
 public:
  H5Silence() {
    H5Eget_auto2(H5E_DEFAULT, &function_, &data_);
    H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  }
  ~H5Silence() { H5Eset_auto2(H5E_DEFAULT, function_, data_); }
  H5Silence(const H5Silence&) = delete;
  H5Silence& operator=(const H5Silence&) = delete;

 private:
  H5E_auto2_t function_ = nullptr;
  void* data_ = nullptr;
};

// ---- how each type lies in the file: `count` numbers of one type ------------------------------------

static_assert(std::endian::native == std::endian::little,
              "numbers are passed to HDF5 as they lie in the file");

template <class N>
hid_t file_type();
template <>
inline hid_t file_type<double>() {
  return H5T_IEEE_F64LE;
}
template <>
inline hid_t file_type<std::int64_t>() {
  return H5T_STD_I64LE;
}
template <>
inline hid_t file_type<std::int32_t>() {
  return H5T_STD_I32LE;
}
template <>
inline hid_t file_type<std::uint32_t>() {
  return H5T_STD_U32LE;
}
template <>
inline hid_t file_type<std::uint8_t>() {
  return H5T_STD_U8LE;
}

template <class T>
struct Stored {
  using Number = T;
  static constexpr std::size_t count = 1;
  static void put(const T& x, Number* to) { *to = x; }
  static void take(const Number* from, T& x) { x = *from; }
};
template <>
struct Stored<Vec3d> {
  using Number = double;
  static constexpr std::size_t count = 3;
  static void put(const Vec3d& x, double* to) { to[0] = x.x, to[1] = x.y, to[2] = x.z; }
  static void take(const double* from, Vec3d& x) { x = {from[0], from[1], from[2]}; }
};
template <>
struct Stored<Image> {
  using Number = std::int32_t;
  static constexpr std::size_t count = 3;
  static void put(const Image& n, Number* to) { to[0] = n.a, to[1] = n.b, to[2] = n.c; }
  static void take(const Number* from, Image& n) { n = {from[0], from[1], from[2]}; }
};
template <>
struct Stored<Quatd> {
  using Number = double;
  static constexpr std::size_t count = 4;
  static void put(const Quatd& x, double* to) { to[0] = x.w, to[1] = x.x, to[2] = x.y, to[3] = x.z; }
  static void take(const double* from, Quatd& x) { x = {from[0], from[1], from[2], from[3]}; }
};
template <class Tag>
struct Stored<Id<Tag>> {
  using Number = std::uint32_t;
  static constexpr std::size_t count = 1;
  static void put(const Id<Tag>& x, Number* to) { *to = x.value; }
  static void take(const Number* from, Id<Tag>& x) { x = Id<Tag>{*from}; }
};
/// Bond sets: their numbers took four bytes once, and still do in files.
template <>
struct Stored<std::uint16_t> {
  using Number = std::uint32_t;
  static constexpr std::size_t count = 1;
  static void put(std::uint16_t x, Number* to) { *to = x; }
  static void take(const Number* from, std::uint16_t& x) {
    if (*from > std::numeric_limits<std::uint16_t>::max()) throw IoError("has more than 65,536 bond sets");
    x = static_cast<std::uint16_t>(*from);
  }
};
/// Enumerations and bool: one byte, checked against the largest valid value.
template <class E, std::uint8_t largest>
struct StoredByte {
  using Number = std::uint8_t;
  static constexpr std::size_t count = 1;
  static void put(const E& x, Number* to) { *to = static_cast<Number>(x); }
  static void take(const Number* from, E& x) {
    if (*from > largest) throw IoError("holds an unknown option");
    x = static_cast<E>(*from);
  }
};
template <>
struct Stored<bool> : StoredByte<bool, 1> {};
template <>
struct Stored<UnitSystem> : StoredByte<UnitSystem, static_cast<std::uint8_t>(UnitSystem::si)> {};
template <std::size_t N>
struct Stored<std::array<double, N>> {
  using Number = double;
  static constexpr std::size_t count = N;
  static void put(const std::array<double, N>& x, double* to) { std::copy(x.begin(), x.end(), to); }
  static void take(const double* from, std::array<double, N>& x) { std::copy_n(from, N, x.begin()); }
};

template <>
struct Stored<KeptCoefficients> : Stored<Coefficients> {
  static void put(const KeptCoefficients& x, double* to) { Stored<Coefficients>::put(x, to); }
  static void take(const double* from, KeptCoefficients& x) {
    Coefficients all;
    Stored<Coefficients>::take(from, all);
    x = all;
  }
};

template <>
struct Stored<Losses> : Stored<decltype(Losses::of)> {
  static void put(const Losses& x, double* to) { Stored<decltype(Losses::of)>::put(x.of, to); }
  static void take(const double* from, Losses& x) { Stored<decltype(Losses::of)>::take(from, x.of); }
};

/// The name of a bond law, filled up with zeros.
using LawName = std::array<char, 48>;
inline LawName law_name(std::string_view name) {
  LawName n{};
  if (name.size() >= n.size()) throw IoError("has a bond law whose name is too long");
  std::copy(name.begin(), name.end(), n.begin());
  return n;
}
inline std::string text_of(const LawName& name) {
  return {name.begin(), std::find(name.begin(), name.end(), '\0')};
}
template <>
struct Stored<LawName> {
  using Number = std::uint8_t;
  static constexpr std::size_t count = std::tuple_size_v<LawName>;
  static void put(const LawName& n, Number* to) { std::copy(n.begin(), n.end(), to); }
  static void take(const Number* from, LawName& n) {
    std::transform(from, from + count, n.begin(), [](Number c) { return static_cast<char>(c); });
  }
};
template <>
struct Stored<BondRange> : StoredByte<BondRange, static_cast<std::uint8_t>(BondRange::snapped)> {};
template <>
struct Stored<BreakMode> : StoredByte<BreakMode, static_cast<std::uint8_t>(BreakMode::other)> {};

}  // namespace vbond
