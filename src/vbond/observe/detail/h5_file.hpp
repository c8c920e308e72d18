#pragma once
#include <fmt/format.h>
#include <hdf5.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "vbond/core/error.hpp"
#include "vbond/model/units.hpp"
#include "vbond/observe/detail/h5.hpp"
#include "vbond/observe/detail/h5_stream.hpp"
#include "vbond/observe/seal.hpp"

/// A checkpoint's HDF5 file as it is written and read, data set by data set.
namespace vbond {

/// Columns are written and read so many rows at a time.
inline constexpr std::size_t h5_rows_at_once = std::size_t{1} << 16;

/// A data set: where it stands, and its attributes.
struct DataSet {
  std::string path;
  Unit unit;
  const char* meaning;
};

// ---- writing ------------------------------------------------------------------------------------------

/// Writes the file piece by piece: it is never in memory as a whole. Throws IoError.
class H5Writer {
 public:
  /// The file is there already, and empty.
  H5Writer(const std::filesystem::path& path, UnitSystem units)
      : units_(units),
        stream_(path),
        file_(create(stream_)),
        make_groups_(H5Pcreate(H5P_LINK_CREATE), H5Pclose),
        no_times_(H5Pcreate(H5P_DATASET_CREATE), H5Pclose) {
    must(H5Pset_create_intermediate_group(make_groups_.get(), 1));
    must(H5Pset_obj_track_times(no_times_.get(), false));  // the same state gives the same bytes
    must(H5Pset_fill_time(no_times_.get(), H5D_FILL_TIME_NEVER));
  }

  /// Paths are within this group from now on; "": all of the file.
  void go_into(const std::string& group) { group_ = group; }

  template <class T>
  void operator()(const DataSet& set, const T& value) {
    std::array<typename Stored<T>::Number, Stored<T>::count> numbers;
    Stored<T>::put(value, numbers.data());
    const hsize_t size = numbers.size();
    const H5Handle space(size > 1 ? H5Screate_simple(1, &size, nullptr) : H5Screate(H5S_SCALAR), H5Sclose);
    const H5Handle data = make<typename Stored<T>::Number>(set, space);
    must(H5Dwrite(data.get(), file_type<typename Stored<T>::Number>(), H5S_ALL, H5S_ALL, H5P_DEFAULT,
                  numbers.data()));
  }

  static constexpr std::size_t rows_at_once = h5_rows_at_once;

  /// A column of so many rows, each of the numbers of a T, that is written some rows at a time.
  template <class T>
  class Column {
   public:
    using Number = typename Stored<T>::Number;
    static constexpr std::size_t count = Stored<T>::count;

    Column(H5Writer& file, const DataSet& set, std::size_t rows)
        : space_(space_of(rows)), data_(file.make<Number>(set, space_)) {}
    /// The numbers of the rows from `first` on.
    void write(std::size_t first, std::span<const Number> numbers) {
      const std::array<hsize_t, 2> from{first, 0}, piece{numbers.size() / count, count};
      const H5Handle here = space_of(piece[0]);
      must(H5Sselect_hyperslab(space_.get(), H5S_SELECT_SET, from.data(), nullptr, piece.data(), nullptr));
      must(H5Dwrite(data_.get(), file_type<Number>(), here.get(), space_.get(), H5P_DEFAULT, numbers.data()));
    }

   private:
    static H5Handle space_of(hsize_t rows) {
      const std::array<hsize_t, 2> size{rows, count};
      return {H5Screate_simple(count > 1 ? 2 : 1, size.data(), nullptr), H5Sclose};
    }
    H5Handle space_, data_;
  };

  /// member: a pointer to a member of the rows, or what gives a value of one; its numbers are a column.
  template <class Rows, class Member>
  void of_each(const DataSet& set, const Rows& rows, Member member) {
    using T = std::remove_cvref_t<std::invoke_result_t<Member, decltype(*rows.begin())>>;
    Column<T> column(*this, set, rows.size());
    std::vector<typename Column<T>::Number> numbers;
    auto row = rows.begin();
    for (std::size_t first = 0; first < rows.size(); first += rows_at_once) {
      const std::size_t here = std::min(rows_at_once, rows.size() - first);
      numbers.resize(here * Column<T>::count);
      for (std::size_t k = 0; k < here; ++k, ++row)
        Stored<T>::put(std::invoke(member, *row), &numbers[k * Column<T>::count]);
      column.write(first, numbers);
    }
  }

  /// All is in the file, with room for the seal in front. Nothing may be written afterwards.
  void finish() {
    const bool closed = file_.reset();
    stream_.require_written();
    if (!closed) must(-1);
  }

 private:
  static H5Handle create(const H5Stream& stream) {
    const H5Handle room_for_seal(H5Pcreate(H5P_FILE_CREATE), H5Pclose);
    must(H5Pset_userblock(room_for_seal.get(), seal_size));
    H5Handle file(H5Fcreate("checkpoint", H5F_ACC_TRUNC, room_for_seal.get(), stream.access().get()),
                  H5Fclose);
    must(file.get());
    return file;
  }
  /// An empty data set with its attributes.
  template <class N>
  H5Handle make(const DataSet& of, const H5Handle& space) {
    H5Handle set(H5Dcreate2(file_.get(), (group_ + of.path).c_str(), file_type<N>(), space.get(),
                            make_groups_.get(), no_times_.get(), H5P_DEFAULT),
                 H5Dclose);
    must(set.get());
    write_text(set, "unit", of.unit.in(units_));
    write_text(set, "meaning", of.meaning);
    return set;
  }
  static void write_text(const H5Handle& set, const char* name, const char* text) {
    const H5Handle type(H5Tcopy(H5T_C_S1), H5Tclose), space(H5Screate(H5S_SCALAR), H5Sclose);
    must(H5Tset_size(type.get(), std::max<std::size_t>(1, std::strlen(text))));
    const H5Handle attribute(H5Acreate2(set.get(), name, type.get(), space.get(), H5P_DEFAULT, H5P_DEFAULT),
                             H5Aclose);
    must(attribute.get());
    must(H5Awrite(attribute.get(), type.get(), text));
  }
  static void must(std::int64_t result) {
    if (result < 0) throw IoError("HDF5 could not lay it out; is there enough memory?");
  }

  UnitSystem units_;
  std::string group_;
  H5Stream stream_;
  H5Handle file_, make_groups_, no_times_;
};

// ---- reading ------------------------------------------------------------------------------------------

/// Reads what H5Writer lays out, and refuses anything else. Throws IoError.
class H5Reader {
 public:
  explicit H5Reader(const std::filesystem::path& path)
      : file_(H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose) {
    if (!file_) throw IoError("is damaged: HDF5 cannot open it");
  }
  /// As H5Writer::go_into().
  void go_into(const std::string& group) { group_ = group; }

  /// Of several numbers the file may have fewer: those that came later stand at the end.
  template <class T>
  void operator()(const std::string& path, T& value) {
    std::array<typename Stored<T>::Number, Stored<T>::count> numbers{};
    std::vector<hsize_t> size;
    if (numbers.size() > 1) size = {std::min(numbers.size(), rows(path))};
    read(path, size, numbers.data());
    Stored<T>::take(numbers.data(), value);
  }

  /// Calls visit(row, value) for each of the so many rows that the file must have, some at a time. Rows of an
  /// array may be shorter in the file: what came later stands at their end, and is zero.
  template <class T, class Visit>
  void visit_rows(const std::string& path, std::size_t rows, Visit visit) {
    constexpr std::size_t count = Stored<T>::count;
    using Number = typename Stored<T>::Number;
    std::size_t width = count;
    if constexpr (requires(T x) { x.max_size(); } || std::is_same_v<T, KeptCoefficients>)
      if (const std::vector<hsize_t> size = size_of(open(path)); size.size() == 2 && size[1] > 0)
        width = std::min<std::size_t>(count, size[1]);
    std::vector<hsize_t> size{rows};
    if (count > 1) size.push_back(width);
    const H5Handle set = open_plain<Number>(path, size);
    const H5Handle space(H5Dget_space(set.get()), H5Sclose);
    std::vector<Number> numbers;
    for (std::size_t first = 0; first < rows; first += h5_rows_at_once) {
      size[0] = std::min(h5_rows_at_once, rows - first);
      numbers.resize(size[0] * width);
      const std::array<hsize_t, 2> from{first, 0};
      const H5Handle here(H5Screate_simple(static_cast<int>(size.size()), size.data(), nullptr), H5Sclose);
      if (H5Sselect_hyperslab(space.get(), H5S_SELECT_SET, from.data(), nullptr, size.data(), nullptr) < 0 ||
          H5Dread(set.get(), file_type<Number>(), here.get(), space.get(), H5P_DEFAULT, numbers.data()) < 0)
        damaged(path);
      for (std::size_t k = 0; k < size[0]; ++k) {
        std::array<Number, count> of_row{};
        std::copy_n(&numbers[k * width], width, of_row.begin());
        T value{};
        Stored<T>::take(of_row.data(), value);
        visit(first + k, value);
      }
    }
  }
  /// The column has its size already; the file must agree.
  template <class Rows, class Member>
  void of_each(const std::string& path, Rows& column, Member member) {
    using T = std::remove_cvref_t<std::invoke_result_t<Member, decltype(*column.begin())>>;
    auto row = column.begin();
    visit_rows<T>(path, column.size(), [&](std::size_t, const T& value) {
      std::invoke(member, *row) = value;
      ++row;
    });
  }
  /// Calls visit(k, value) for some of so many rows: the k-th of these ids, which are in increasing order.
  template <class T, class IdType, class Visit>
  void visit_some(const std::string& path, std::size_t rows, const std::vector<IdType>& some, Visit visit) {
    std::size_t k = 0;
    visit_rows<T>(path, rows, [&](std::size_t row, const T& value) {
      if (k == some.size() || some[k].value != row) return;
      visit(k, value);
      ++k;
    });
  }

  /// The group that it is in is there.
  bool has(const std::string& path) const {
    return H5Lexists(file_.get(), (group_ + path).c_str(), H5P_DEFAULT) > 0;
  }

  /// Length of a column of bytes per row at least, so that a forged length cannot ask for more memory
  /// than the file has data.
  std::size_t rows(const std::string& path) {
    const H5Handle set = open(path);
    const std::vector<hsize_t> size = size_of(set);
    if (size.empty() || H5Dget_storage_size(set.get()) < size[0]) damaged(path);
    return static_cast<std::size_t>(size[0]);
  }

 private:
  [[noreturn]] static void damaged(const std::string& path) {
    throw IoError(fmt::format("is damaged: {} is missing or not as expected", path));
  }
  H5Handle open(const std::string& path) {
    H5Handle set(H5Dopen2(file_.get(), (group_ + path).c_str(), H5P_DEFAULT), H5Dclose);
    if (!set) damaged(group_ + path);
    return set;
  }
  static std::vector<hsize_t> size_of(const H5Handle& set) {
    const H5Handle space(H5Dget_space(set.get()), H5Sclose);
    const int rank = H5Sget_simple_extent_ndims(space.get());
    std::vector<hsize_t> size(static_cast<std::size_t>(rank > 0 ? rank : 0));
    if (rank > 0) H5Sget_simple_extent_dims(space.get(), size.data(), nullptr);
    return size;
  }
  /// As the writer makes them: not unpacked by a filter, and in this file.
  bool is_plain(const H5Handle& set) const {
    const H5Handle made(H5Dget_create_plist(set.get()), H5Pclose);
    H5O_info_t here, there;  // another number of the file: behind a link that leads out of it
    return made && H5Oget_info2(file_.get(), &here, H5O_INFO_BASIC) >= 0 &&
           H5Oget_info2(set.get(), &there, H5O_INFO_BASIC) >= 0 && here.fileno == there.fileno &&
           H5Pget_layout(made.get()) == H5D_CONTIGUOUS && H5Pget_nfilters(made.get()) == 0 &&
           H5Pget_external_count(made.get()) == 0;
  }
  template <class N>
  H5Handle open_plain(const std::string& path, const std::vector<hsize_t>& size) {
    H5Handle set = open(path);
    const H5Handle type(H5Dget_type(set.get()), H5Tclose);
    if (!type || H5Tequal(type.get(), file_type<N>()) <= 0 || size_of(set) != size || !is_plain(set))
      damaged(path);
    return set;
  }
  template <class N>
  void read(const std::string& path, const std::vector<hsize_t>& size, N* numbers) {
    const H5Handle set = open_plain<N>(path, size);
    if (H5Dread(set.get(), file_type<N>(), H5S_ALL, H5S_ALL, H5P_DEFAULT, numbers) < 0) damaged(path);
  }

  H5Handle file_;
  std::string group_;
};

}  // namespace vbond
