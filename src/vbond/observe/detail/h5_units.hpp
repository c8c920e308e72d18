#pragma once
#include <hdf5.h>

#include "vbond/model/model.hpp"

namespace vbond {

/// Gives every data set of a checkpoint the attributes `unit` and `meaning` of its quantity. Throws IoError.
void write_units(hid_t file, UnitSystem units);

}  // namespace vbond
