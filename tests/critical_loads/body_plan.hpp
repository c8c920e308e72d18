#pragma once
#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "dynamics/rods.hpp"
#include "vbond/model/static_stage.hpp"

/// Bodies of the campaign as they are drawn up: bare numbers, from which a specimen and a case file are made.
namespace vbond::campaign {

using Particles = std::vector<std::size_t>;

/// Bonds with the same four stiffnesses, fastened at the centres.
struct BondSet {
  const BondLaw* law = &bond_law<VModel>;
  BondStiffness<double> stiffness{};
  std::optional<Vec3d> n_2;
  std::vector<std::array<std::size_t, 2>> pairs;
};

struct PlannedSupport {
  Particles particles;
  HeldDofs held{};
  Vec3d displacement, rotation;  ///< at load factor 1
};

struct PlannedLoad {
  Particles particles;
  Vec3d force, moment;
  bool constant = false;
};

/// How a body may be turned in space without a change of what its supports hold.
enum class Turning : std::uint8_t { by_right_angles, about_z, any };

/// A body, its supports and its loads. All particles have mass 1.
struct BodyPlan {
  std::string kind;  ///< e.g. "column"
  std::string what;  ///< its parameters in words
  std::vector<Vec3d> r;
  std::vector<Vec3d> offset;  ///< imperfection of r; empty: none
  double imperfection = 0;    ///< largest offset over the thickness sqrt(EI / EA)
  double radius = 0.1;        ///< of particles
  std::vector<BondSet> sets;
  std::vector<PlannedSupport> supports;
  std::vector<PlannedLoad> loads;
  Vec3d gravity;
  Turning turning = Turning::by_right_angles;
  bool must_be_straight = false;      ///< else a moment acts that has no potential
  bool in_plane = false;              ///< all particles stay in the x-y plane
  std::optional<double> closed_form;  ///< first critical load factor
};

Particles everybody(const BodyPlan& plan);
/// The same body as it would be without its imperfection.
BodyPlan perfect(BodyPlan plan);
/// Lengths times `length`, forces times `force`.
void change_units(BodyPlan& plan, double length, double force);
/// x becomes y, y becomes z, z becomes x.
void permute_axes(BodyPlan& plan);
void turn(BodyPlan& plan, const Quatd& by);

testing::Specimen specimen_of(const BodyPlan& plan);
/// Supports and loads; all settings as they are by default.
StaticStage stage_of(const BodyPlan& plan, StageKind kind);
/// The same as a case file, to the last bit.
std::string to_toml(const BodyPlan& plan, const StaticStage& stage);

}  // namespace vbond::campaign
