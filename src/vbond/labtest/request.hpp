#pragma once
#include <cstdint>
#include <optional>
#include <string>

/// Tests of a laboratory on the body of a case: docs/laboratory-tests.md.
namespace vbond::labtest {

enum class Kind : std::uint8_t { tension, compression, shear, bend3, brazilian, triaxial };

/// The name that commands and files have for it.
const char* to_text(Kind kind);

/// Whether ends may slide sideways, or are held as rigid bodies.
enum class Ends : std::uint8_t { slide, grip };

/// How deep a notch is, > 0.
struct NotchDepth {
  double value = 0;        ///< [length], or a share
  bool of_height = false;  ///< it is a share of the height
};

/// What is asked for. Lengths and times are in the units of the case.
struct Request {
  Kind kind = Kind::tension;
  int axis = 2;  ///< 0, 1, 2 = x, y, z: along the specimen; of a disc its own axis
  std::optional<int>
      across;           ///< shear, bend3, brazilian: along which it is loaded; absent: z, or x if axis is z
  bool at_rest = true;  ///< a sequence of equilibria, or motion
  Ends ends = Ends::slide;       ///< tension, compression
  std::optional<double> strain;  ///< at which the test ends, > 0; absent: see default_strain
  std::optional<double>
      rate;  ///< of that strain, in motion, > 0  [1/time]; absent: by waves, see default_rate
  std::optional<double> damping;    ///< Cundall's local damping, in motion, >= 0, < 1; absent: 0.7
  std::optional<double> area;       ///< of the section, > 0  [length^2]; absent: measured
  std::optional<double> depth;      ///< of the ends, from the face, > 0  [length]; absent: grains at the face
  std::optional<double> span;       ///< bend3, > 0  [length]; absent: as far as the beam goes
  std::optional<NotchDepth> notch;  ///< bend3: in the middle of the span, at the stretched side
  std::optional<double> modulus;    ///< with a notch: E of the body, > 0  [force/length^2]
  double pressure = 0;              ///< triaxial: all round, >= 0  [force/length^2]
  double drop = 0.5;                ///< the test ends when this part of the peak is lost, > 0, < 1
  bool frames = false;
};

/// Strain at which a test of a body ends that can break, unless another is asked for.
inline constexpr double default_strain = 0.02;
/// Strain of the stage that measures moduli at rest: so small that they are those of the undeformed body to
/// some 1e-7 of themselves.
inline constexpr double elastic_strain = 1e-7;

}  // namespace vbond::labtest
