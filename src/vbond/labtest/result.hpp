#pragma once
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "vbond/labtest/made_test.hpp"

namespace vbond::labtest {

/// A point of the curve: stress, and strain between the ends (of a beam: of its outer fibre).
struct CurvePoint {
  double stress = 0;  ///< [force/length^2]
  double strain = 0;
  double force = 0;  ///< [force]
};

/// How far a test in motion is from a sequence of equilibria, until the peak.
struct Inertia {
  double at_peak = 0;      ///< kinetic energy over the work of the platens, at the peak
  double largest = 0;      ///< the same, the most from a tenth of the peak on
  double ends_differ = 0;  ///< sum of the forces on both ends over the peak, the most from half of it on
  static constexpr double most_at_peak = 0.01, most_before = 0.05, most_of_ends = 0.05;
  bool quasi_static() const {
    return at_peak <= most_at_peak && largest <= most_before && ends_differ <= most_of_ends;
  }
};

/// The first bond that broke.
struct FirstBreak {
  Vec3d place;       ///< [length]
  std::string mode;  ///< as breaks.csv has it
};

/// How a disc has split. Distances over its radius.
struct Splitting {
  double first_from_plane = 0;   ///< of the first break from the loaded diameter
  double first_from_middle = 0;  ///< the same along the loaded diameter, from the middle
  double mean_from_plane = 0;    ///< of all breaks; 0.42 if they were all over the disc
  double in_tension = 0;         ///< part of the breaks
};

/// What a notched beam tells.
struct Toughness {
  double compliance = 0;       ///< way of the load over its force, before any bond breaks  [length/force]
  std::optional<double> K_Ic;  ///< at the peak  [force/length^1.5]
  std::optional<double> G_Ic;  ///< K_Ic^2/E, if E was given  [force/length]
  /// Work of the load over the ligament, if the test went on until hardly any force was left.  [force/length]
  std::optional<double> work_of_fracture;
};
/// What a test says. Absent: it does not tell; `notes` says why.
struct TestResult {
  /// E, or G of shear, by the strain of the gauge; bend3: E of the formula for slender beams.
  /// [force/length^2]
  std::optional<double> modulus;
  std::optional<double> modulus_by_ends;  ///< by the way of the ends  [force/length^2]
  std::optional<double> nu;               ///< mean of the two lateral directions
  std::optional<double> nu_across, nu_third;
  double stress_before = 0;  ///< that the body bears before the test  [force/length^2]
  /// The strength: of a disc where it splits, else the largest stress. Absent: not reached, or it is none.
  std::optional<CurvePoint> peak;
  CurvePoint largest;  ///< the most there was, after the body has come to rest
  std::optional<CurvePoint> first_break, one_percent;  ///< crack initiation
  std::int64_t breaks_before_peak = 0, breaks = 0;
  std::optional<double> fragments, largest_fragment;  ///< at the end
  std::optional<Inertia> inertia;                     ///< in motion
  std::optional<FirstBreak> first_break_at;
  std::optional<Splitting> splitting;  ///< brazilian
  std::optional<Toughness> toughness;  ///< bend3 with a notch
  std::string ended;                   ///< how the last stage ended, as in run.json
  std::string no_peak;                 ///< why there is none, which is one of the notes; empty: there is
  bool peak_in_doubt = false;          ///< of a disc: the peak is no tensile strength; notes say why
  std::vector<std::string> notes;      ///< what is to be known, a line each
};

/// Why the result has no strength to rely on: it has no peak, or the test in motion was too fast. Empty: it
/// has.
std::string why_no_strength(const TestResult& result);

/// Reads the tables of a run of the made case. Throws IoError if they are not there or damaged.
TestResult result_of(const MadeTest& test, const std::filesystem::path& folder);

}  // namespace vbond::labtest
