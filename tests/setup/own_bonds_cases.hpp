#pragma once

/// Cases whose bonds several processes set up together.
namespace vbond::test {

inline constexpr const char* block = R"(
[[specimen]]
kind = "block"
cells = [5, 3, 3]
radius = 0.4
mass = 1.0
[[bonds]]
distance = 1.1
stiffness = {c_A = 1.0, c_D = 0.3, c_B = 0.1, c_T = 0.1}
[[stage]]
duration = "3 T0"
)";

/// All at once that has an order, a draw or a memory: a second set, some of it by chance, of bonds that may
/// break, with a prestrain beyond what they bear without flowing; particles that touch where they are not
/// bonded.
inline constexpr const char* mixed = R"(
[[specimen]]
kind = "block"
cells = [6, 3, 2]
radius = 0.72
mass = 1.0
[[bonds]]
name = "edges"
distance = 1.1
theory = "bernoulli-euler"
E = 31.8
nu = 0.2
section = {shape = "circle", diameter = 0.2}
[[bonds]]
name = "diagonals"
distance = 1.5
share = 0.6
seed = 7
prestrain = 0.01
stiffness = {c_A = 3.0, c_D = 0.3, c_B = 0.1, c_T = 0.1}
yield = {axial_force = 0.01, isotropic = {axial = 0.5}}
strength = {criterion = "linear", axial_force = 0.05, shear_force = 0.05, bending_moment = 0.05, torque = 0.05, weibull = {modulus = 2, seed = 3}}
[contact]
law = "linear"
k = 0.5
pairs = "unbonded"
[[velocities]]
kind = "gaussian"
magnitude = 1e-3
[[stage]]
duration = "3 T0"
)";

inline constexpr const char* flat_joints = R"(
[[specimen]]
kind = "block"
cells = [4, 3, 2]
radius = 0.5
mass = 1.0
[[bonds]]
distance = 1.1
flat_joint = {radial = 2, around = 4}
theory = "parallel"
k_n = 30.0
k_s = 10.0
section = {shape = "circle", diameter = 0.8}
[[stage]]
duration = "3 T0"
)";

inline constexpr const char* listed = R"(
[[specimen]]
kind = "block"
cells = [4, 2, 2]
radius = 0.4
mass = 1.0
[[bonds]]
pairs = [[5, 4], [0, 1], [9, 8], [2, 6], [15, 14], [11, 10], [3, 7]]
stiffness = {c_A = 1.0, c_D = 0.3, c_B = 0.1, c_T = 0.1}
[[stage]]
duration = "3 T0"
)";

inline constexpr const char* periodic = R"(
[cell]
a = [4, 0, 0]
b = [0.3, 3, 0]
c = [0, 0, 3]
[[specimen]]
kind = "block"
cells = [4, 3, 3]
radius = 0.4
mass = 1.0
[[bonds]]
distance = 1.2
stiffness = {c_A = 1.0, c_D = 0.3, c_B = 0.1, c_T = 0.1}
[[stage]]
duration = "3 T0"
)";

/// Particles that turn so fast that they set the step, two of them as fast; the second specimen is turned,
/// too.
inline constexpr const char* turning = R"(
[[specimen]]
kind = "block"
cells = [4, 3, 2]
radius = 0.4
mass = 1.0
[[specimen]]
name = "turned"
kind = "block"
cells = [3, 2, 2]
radius = 0.4
mass = 1.0
origin = [0, 0, 9]
turn = {axis = [1, 2, 2], angle = 0.5}
[groups.fast]
indices = [7, 12, 20]
[[bonds]]
distance = 1.1
stiffness = {c_A = 1.0, c_D = 0.3, c_B = 0.1, c_T = 0.1}
[[velocities]]
kind = "ball"
magnitude = 1e-3
[[velocities]]
group = "fast"
velocity = [0.1, 0, 0.2]
angular_velocity = [0, 30, 40]
[[stage]]
duration = "3 T0"
)";

}  // namespace vbond::test
