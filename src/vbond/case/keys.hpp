#pragma once
#include "vbond/case/case.hpp"
#include "vbond/case/key_table.hpp"

/// One function per table of the case file. Each names its keys once; see key_table.hpp.
namespace vbond::keys {

void describe(Table& t, Case& c);

/// A group that is not given is that of all particles.
void default_to_all(Placed<std::string>& group);

void describe(Table& t, CellSpec& c);
void describe(Table& t, CellServo& s);
/// What moves the cell in a stage of this kind.
void describe_drive(Table& t, CellDriveSpec& d, std::optional<StageKind> kind);

void describe(Table& t, SpecimenSpec& s);
void describe(Table& t, RodSpecimen& s);
void describe(Table& t, HemisphereSpecimen& s);
void describe(Table& t, BlockSpecimen& s);
void describe(Table& t, SheetSpecimen& s);
void describe(Table& t, RingSpecimen& s);
void describe(Table& t, HelixSpecimen& s);
void describe(Table& t, CsvSpecimen& s);
void describe(Table& t, LammpsSpecimen& s);
void describe(Table& t, ListedSpecimen& s);
void describe(Table& t, CylinderSpecimen& s);
void describe(Table& t, ConeSpecimen& s);
void describe(Table& t, SphereSpecimen& s);
void describe(Table& t, PackingSpecimen& s);
void describe(Table& t, VesselSpec& v);
void describe(Table& t, GrainSpec& g);
void describe(Table& t, EqualGrains& g);
void describe(Table& t, UniformGrains& g);
void describe(Table& t, NormalGrains& g);
void describe(Table& t, LognormalGrains& g);
void describe(Table& t, CurveGrains& g);
void describe(Table& t, FibresSpecimen& s);
/// How lengths are distributed; each in its own table.
void describe(Table& t, SizeSpec& s);
void describe(Table& t, UniformSizes& s);
void describe(Table& t, NormalSizes& s);
void describe(Table& t, LognormalSizes& s);
void describe(Table& t, SizeTable& s);
void describe(Table& t, SolidSpec& s);
void describe(Table& t, EllipsoidSolid& s);
void describe(Table& t, BoxSolid& s);
void describe(Table& t, CylinderSolid& s);
void describe(Table& t, CutSpec& c);
void describe(Table& t, TurnSpec& turn);
void describe(Table& t, CopiesSpec& c);

void describe(Table& t, GroupSpec& g);
void describe(Table& t, IndexList& indices);
void describe(Table& t, BoxRegion& r);
void describe(Table& t, SphereRegion& r);
void describe(Table& t, CylinderRegion& r);
void describe(Table& t, PlaneRegion& r);
void describe(Table& t, HalfSpaceRegion& r);
void describe(Table& t, MeshRegion& r);
void describe(Table& t, MaterialGroup& g);
void describe(Table& t, TypeGroup& g);
void describe(Table& t, FibreGroup& g);
void describe(Table& t, UnionGroup& g);
void describe(Table& t, IntersectionGroup& g);
void describe(Table& t, DifferenceGroup& g);
/// What a mesh file needs to become a surface of the case: the same for walls and regions.
void describe_mesh(Table& t, Placed<std::filesystem::path>& file, double& scale, Vec3d& shift);

void describe(Table& t, BondSpec& b);
/// Which pairs a set bonds, and when.
void describe_selection(Table& t, BondSpec& b);
/// What bonds at crossings of fibres cannot have; after all keys of the set.
void check_crossings(Table& t, const BondSpec& b);
void describe(Table& t, WithinDistance& s);
void describe(Table& t, WithinGap& s);
void describe(Table& t, WithinFactor& s);
void describe(Table& t, ListedPairs& s);
void describe(Table& t, PairsFile& s);
void describe(Table& t, SpecimenPairs& s);
void describe(Table& t, AtCrossings& s);
void describe(Table& t, BondStiffness<double>& p);
void describe(Table& t, TheoryParameters& p);
/// materials: the case has some.
void describe(Table& t, ContactModel& c, std::vector<ContactPairSpec>& between, bool materials);
void describe(Table& t, ContactPairSpec& p);
/// Stretching, damping and strength of a bond set: what makes its bonds more than harmonic.
void describe_rules(Table& t, BondSpec& b);
/// Yield, creep and softening, after the rules above.
void describe_flow(Table& t, BondSpec& b);
void describe_flat_joint(Table& t, BondSpec& b);
void check_flat_joint(Table& t, const BondSpec& b);
/// The theory of these bonds if it has a cross-section, else nullptr.
const TheoryParameters* theory_with_section(const BondRecipe& recipe);

/// A cross-section, in one of the forms that the file may name.
void describe_section(Table& t, Section& section);

void describe(Table& t, MaterialSpec& m);

void describe(Table& t, VelocitySpec& v);
void describe(Table& t, SourceSpec& s);
void describe(Table& t, SinkSpec& s);
void describe(Table& t, TimeSpec& s);
/// Kinds of stages in words, for keys that only these have.
inline constexpr const char* in_dynamics = "kind = \"dynamics\"";
inline constexpr const char* in_statics =
    "kind = \"equilibrium\", \"path\", \"buckling\", \"modes\" or \"fracture\"";
/// False if its kind could not be read; it is then taken for dynamics.
bool describe(Table& t, StageSpec& s);
/// No kind: it is misspelt, and keys of every kind are right.
void describe(Table& t, SupportSpec& s, std::optional<StageKind> kind);
void describe(Table& t, LoadSpec& s, std::optional<StageKind> kind);
void describe(Table& t, TimeFunctionSpec& f);
void describe(Table& t, DistanceStopSpec& s);
void describe(Table& t, PeakStopSpec& s);
void describe(Table& t, RestStopSpec& s);
void describe(Table& t, BreakStopSpec& s);
void describe(Table& t, BranchSwitch& b);
void describe(Table& t, OutputSpec& o, bool any_dynamics, bool periodic);
void describe(Table& t, WatchSpec& w);

}  // namespace vbond::keys
