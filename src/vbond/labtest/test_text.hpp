#pragma once
#include <string>
#include <vector>

#include "vbond/labtest/made_test.hpp"

/// Parts of the text of a test: TOML as a person would write it.
namespace vbond::labtest {

/// What a support is while the pressure of a triaxial test comes on.
enum class Confining {
  as_ever,
  guided,   ///< a rigid body that is free along the axis of the test, and held otherwise
  left_out  ///< guided ends bar rigid motions already
};

/// A support of every stage: what it holds, and how far it goes per strain of the test.
struct Hold {
  std::string group;
  std::vector<int> fix;  ///< translations; empty: all of a rigid body
  Vec3d way{};           ///< [length]
  Confining confining = Confining::as_ever;
};

class TestText {
 public:
  explicit TestText(const Body& body) : body_(body) {}

  void comment(const std::string& words) { groups_ += "\n# " + words; }
  void side(const Side& side);
  /// Particles within a distance of the middle plane normal to the direction.
  void middle(const std::string& group, int direction, double within);
  void box(const std::string& group, const Vec3d& low, const Vec3d& high);
  void both(const std::string& group, const std::string& one, const std::string& other);
  void hold(Hold h) { holds_.push_back(std::move(h)); }
  /// Single degrees of freedom, as groups of one particle each.
  void point_holds(const std::vector<PointHold>& holds, Confining confining);

  /// Groups, stages and output. `displacements`: groups whose way is written; gauge_volume: 0: no strain.
  std::string text(const MadeTest& test, const std::vector<std::string>& displacements,
                   double gauge_volume) const;

 private:
  /// In motion the ends move; while the pressure comes on they do not.
  std::string supports(const MadeTest& test, double strain, bool moves, bool confining = false) const;
  std::string drag() const;
  std::string pressure(const MadeTest& test, const std::string& how = "") const;
  std::string stages_in_motion(const MadeTest& test) const;
  std::string stages_at_rest(const MadeTest& test) const;

  const Body& body_;
  std::string groups_;
  std::vector<Hold> holds_;
};

}  // namespace vbond::labtest
