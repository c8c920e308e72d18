#pragma once
#include <array>
#include <cstddef>

#include "vbond/case/dimension.hpp"

namespace vbond {

/// A column that a CSV specimen may have.
struct CsvColumn {
  const char* name;
  keys::Dimension dimension;
  const char* meaning;
};

inline constexpr std::array<CsvColumn, 19> csv_columns{{
    {"x", keys::length, "position"},
    {"y", keys::length, "position"},
    {"z", keys::length, "position"},
    {"radius", keys::length, "instead of the specimen's radius"},
    {"mass", keys::mass, "instead of the specimen's mass"},
    {"inertia", keys::inertia, "moment of inertia, the same about all axes"},
    {"inertia_x", keys::inertia, "moment of inertia about the particle's x axis; all three or none"},
    {"inertia_y", keys::inertia, "about its y axis"},
    {"inertia_z", keys::inertia, "about its z axis"},
    {"vx", keys::velocity, "velocity at the beginning; all three or none"},
    {"vy", keys::velocity, "velocity at the beginning"},
    {"vz", keys::velocity, "velocity at the beginning"},
    {"wx", keys::angular_velocity, "angular velocity at the beginning; all three or none"},
    {"wy", keys::angular_velocity, "angular velocity at the beginning"},
    {"wz", keys::angular_velocity, "angular velocity at the beginning"},
    {"qw", keys::pure, "orientation, a quaternion of length 1 with its real part first; all four or none"},
    {"qx", keys::pure, "orientation"},
    {"qy", keys::pure, "orientation"},
    {"qz", keys::pure, "orientation"},
}};

}  // namespace vbond
