#pragma once
#include <optional>
#include <string>
#include <vector>

#include "vbond/labtest/notch.hpp"
#include "vbond/labtest/test_body.hpp"

namespace vbond::labtest {

/// A strain that the history tells of the middle of the specimen: axial and two lateral ones, or one of
/// shear.
struct Gauge {
  std::string group;
  std::vector<std::string> columns;  ///< Green's strain
};

/// How a pressure all round is applied. The skin goes through the centres of the outer particles, inside of
/// the section that stresses refer to.
struct Confinement {
  double longest = 0;  ///< of the skin, as the case has it  [length]
  double applied =
      0;  ///< on the skin, so that the sides of the section bear what is asked for  [force/length^2]
  double axial = 0;  ///< what it puts on the section along the axis  [force/length^2]
};

/// A test of a body: the part of its case that makes it, and how its tables become stresses and strains.
struct MadeTest {
  Request request;
  std::string text;  ///< TOML of groups, stages and output, with comments
  std::string lower = "test_lower", upper = "test_upper";  ///< groups whose reactions are the force
  std::string way = "test_upper";  ///< group whose displacement against lower is the way
  int direction = 2;               ///< of force and way
  double sign = 1;                 ///< of the force on `upper` and of the way, for a positive stress
  double stress_per_force = 0;     ///< [1/length^2]
  double strain_per_way = 0;       ///< [1/length]
  std::optional<Gauge> gauge;
  std::optional<Section> section;          ///< normal to the axis; not of a disc
  std::optional<Notch> notch;              ///< bend3
  std::optional<Confinement> confinement;  ///< triaxial with a pressure > 0
  double length = 0;                       ///< between the ends; bend3: span; brazilian: diameter
  double height = 0;                       ///< bend3: of the beam; shear: width across; brazilian: thickness
  int across = 0, third = 1;               ///< directions normal to the axis
  Vec3d middle;                            ///< of the body  [length]
  double end_strain = 0;                   ///< at which the test ends unless it does so earlier
  double confining = 0;                    ///< in motion: how long the pressure comes on before  [time]
  double settling = 0;                     ///< in motion: how long ends slide before they move  [time]
  double rate = 0, duration = 0;           ///< in motion
  bool breaks = false;                     ///< bonds have strengths
  bool gives_way = false;                  ///< bonds soften, or their stretching is no straight line
  std::vector<std::string> notes;          ///< what is to be known of this test, a line each
};

/// The test of this body. Throws CaseError if the body does not fit it.
MadeTest make_test(const Body& body, const Request& request);

/// The whole case: the body and its bonds as the case has them, with all keys written out, and the test.
std::string case_text(const Case& body, const MadeTest& test, const std::string& title,
                      const std::string& command);

/// What the case has besides body and bonds, and the test has not: a note, or nothing.
std::optional<std::string> left_out(const Case& c);

}  // namespace vbond::labtest
