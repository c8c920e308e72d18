#include "vbond/observe/detail/h5_stream.hpp"

#include <hdf5.h>
#if H5_VERSION_GE(1, 13, 0)
#include <H5FDdevelop.h>
#endif
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <limits>
#include <utility>

#include "vbond/core/error.hpp"

namespace vbond {
namespace {

using Target = H5Stream::Target;

/// A file as HDF5's drivers have them: first what HDF5 keeps in it.
struct Open {
  H5FD_t of_hdf5{};
  Target* target = nullptr;
  haddr_t end_of_room = 0, end_of_bytes = 0;
};

Open& opened(H5FD_t* f) {
  return *reinterpret_cast<Open*>(f);
}
const Open& opened(const H5FD_t* f) {
  return *reinterpret_cast<const Open*>(f);
}

H5FD_t* open_stream(const char*, unsigned, hid_t access, haddr_t) {
  const auto* target = static_cast<Target* const*>(H5Pget_driver_info(access));
  if (target == nullptr) return nullptr;
  return &(new Open{.target = *target})->of_hdf5;
}
herr_t close_stream(H5FD_t* f) {
  return delete &opened(f), 0;
}
herr_t features(const H5FD_t*, unsigned long* flags) {
  *flags = H5FD_FEAT_AGGREGATE_METADATA | H5FD_FEAT_ACCUMULATE_METADATA | H5FD_FEAT_DATA_SIEVE |
           H5FD_FEAT_AGGREGATE_SMALLDATA | H5FD_FEAT_DEFAULT_VFD_COMPATIBLE;
  return 0;
}
haddr_t end_of_room(const H5FD_t* f, H5FD_mem_t) {
  return opened(f).end_of_room;
}
herr_t set_end_of_room(H5FD_t* f, H5FD_mem_t, haddr_t end) {
  return opened(f).end_of_room = end, 0;
}
haddr_t end_of_bytes(const H5FD_t* f, H5FD_mem_t) {
  return opened(f).end_of_bytes;
}

/// What was never written is zero.
herr_t read_stream(H5FD_t* f, H5FD_mem_t, hid_t, haddr_t from, std::size_t size, void* bytes) {
  auto* to = static_cast<char*>(bytes);
  while (size > 0) {
    const ssize_t n = ::pread(opened(f).target->file, to, size, static_cast<off_t>(from));
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) break;
    to += n, from += static_cast<haddr_t>(n), size -= static_cast<std::size_t>(n);
  }
  std::memset(to, 0, size);
  return 0;
}
herr_t write_stream(H5FD_t* f, H5FD_mem_t, hid_t, haddr_t to, std::size_t size, const void* bytes) {
  Open& file = opened(f);
  const auto* from = static_cast<const char*>(bytes);
  while (size > 0 && file.target->error == 0) {
    const ssize_t n = ::pwrite(file.target->file, from, size, static_cast<off_t>(to));
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) {
      file.target->error = n < 0 ? errno : ENOSPC;
      break;
    }
    from += n, to += static_cast<haddr_t>(n), size -= static_cast<std::size_t>(n);
  }
  file.end_of_bytes = std::max(file.end_of_bytes, to + size);
  return 0;
}
herr_t fill_up(H5FD_t* f, hid_t, hbool_t) {
  Open& file = opened(f);
  if (file.end_of_bytes >= file.end_of_room || file.target->error != 0) return 0;
  if (::ftruncate(file.target->file, static_cast<off_t>(file.end_of_room)) != 0) file.target->error = errno;
  file.end_of_bytes = file.end_of_room;
  return 0;
}

hid_t driver() {
  static const H5FD_class_t stream = [] {
    H5FD_class_t c{};
#if H5_VERSION_GE(1, 13, 0)
    c.version = H5FD_CLASS_VERSION;
    c.value = static_cast<H5FD_class_value_t>(510);  // of those that HDF5 leaves to programs
#endif
    c.name = "vbond";
    c.maxaddr = static_cast<haddr_t>(std::numeric_limits<off_t>::max());
    c.fc_degree = H5F_CLOSE_WEAK;
    c.fapl_size = sizeof(Target*);
    c.open = open_stream, c.close = close_stream, c.query = features;
    c.get_eoa = end_of_room, c.set_eoa = set_end_of_room, c.get_eof = end_of_bytes;
    c.read = read_stream, c.write = write_stream, c.truncate = fill_up;
    constexpr H5FD_mem_t map[] = H5FD_FLMAP_DICHOTOMY;
    std::copy(std::begin(map), std::end(map), c.fl_map);
    return c;
  }();
  static const hid_t id = H5FDregister(&stream);
  return id;
}

}  // namespace

H5Stream::H5Stream(std::filesystem::path path)
    : path_(std::move(path)), file_(open_file(path_, "r+b")), target_{::fileno(file_.get())} {}

H5Handle H5Stream::access() const {
  H5Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  const Target* const target = &target_;
  if (!access || H5Pset_driver(access.get(), driver(), &target) < 0)
    throw IoError("HDF5 does not take its driver");
  return access;
}

void H5Stream::require_written() const {
  if (target_.error != 0)
    throw IoError("cannot write " + path_.string() + ": " + std::strerror(target_.error));
}

}  // namespace vbond
