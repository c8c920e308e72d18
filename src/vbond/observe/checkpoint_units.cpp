#include <algorithm>
#include <cstring>

#include "vbond/core/error.hpp"
#include "vbond/observe/detail/h5.hpp"
#include "vbond/observe/detail/h5_units.hpp"
#include "vbond/observe/quantities.hpp"

namespace vbond {
namespace {

void write_text(const H5Handle& set, const char* name, const char* text) {
  const H5Handle type(H5Tcopy(H5T_C_S1), H5Tclose), space(H5Screate(H5S_SCALAR), H5Sclose);
  const bool sized = H5Tset_size(type.get(), std::max<std::size_t>(1, std::strlen(text))) >= 0;
  const H5Handle attribute(H5Acreate2(set.get(), name, type.get(), space.get(), H5P_DEFAULT, H5P_DEFAULT),
                           H5Aclose);
  if (!sized || !attribute || H5Awrite(attribute.get(), type.get(), text) < 0)
    throw IoError("HDF5 could not lay out its units in memory; is there enough of it?");
}

}  // namespace

void write_units(hid_t file, UnitSystem units) {
  for (const CheckpointQuantity& q : checkpoint_quantities()) {
    if (H5Lexists(file, q.path, H5P_DEFAULT) <= 0) continue;  // few files have all of them
    const H5Handle set(H5Dopen2(file, q.path, H5P_DEFAULT), H5Dclose);
    write_text(set, "unit", q.unit.in(units));
    write_text(set, "meaning", q.meaning);
  }
}

}  // namespace vbond
