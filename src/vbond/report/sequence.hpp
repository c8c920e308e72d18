#pragma once
#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "vbond/report/block.hpp"
#include "vbond/report/contact_lines.hpp"
#include "vbond/report/listed.hpp"
#include "vbond/terms/walls/page_wall_shapes.hpp"

/// Moving pictures of the report page: frames of a run or of a mode, read back from .vtp files and quantised.
namespace vbond::page {

enum class SequenceKind : std::uint8_t { run, mode };

struct SequenceFiles {
  SequenceKind kind = SequenceKind::run;
  std::string name, note;
  std::string stage;  ///< of a mode
  std::vector<FrameFiles> frames;
};

/// Every stride-th of n frames, the last one as well.  Numbers in increasing order.
std::vector<std::size_t> thinned(std::size_t n, std::size_t stride);

/// What a bond feels, as the page shows it. Of a broken bond it is 0.
struct BondField {
  const char *key, *label, *array;  ///< array: in the bonds' file
  double scale;                     ///< from the file's unit to the page's
  bool is_signed;
  const char* unit;  ///< in SI, of the page; angles have theirs in reduced units too
};
/// Those of all runs, then those of runs whose bonds may break, then those of runs whose bonds flow.
constexpr std::size_t fields_of_all_runs = 6, fields_with_breaks = 11, bond_field_count = 20;
extern const std::array<BondField, bond_field_count> bond_fields;

/// A frame as the page holds it. Bonds that do not exist yet are not in it.
struct QuantisedFrame {
  std::int64_t step = 0;
  double time = 0;
  std::vector<std::uint16_t> displacement;  ///< [component][particle]
  std::vector<std::uint8_t> speed;          ///< empty if nothing moves
  std::array<std::vector<std::uint8_t>, bond_field_count> fields;
  std::vector<std::uint8_t> range;   ///< 0 good, 1 strained, 2 snapped
  std::vector<std::uint8_t> broken;  ///< 0 whole, else by what; empty where bonds cannot break
  std::vector<std::uint8_t>
      there;  ///< of each particle, 0: it has not come in yet or is gone; empty: all are
  std::vector<std::uint16_t> fragment;  ///< of each particle, the last number for all above; empty likewise
  std::size_t bonds() const { return range.size(); }
};

struct Sequence {
  SequenceKind kind = SequenceKind::run;
  std::string name, note;
  std::string stage{};             ///< of a mode
  std::array<double, 3> origin{};  ///< middle of the box about the first positions  [length]
  std::vector<float> reference;    ///< from there: x0, y0, z0, x1, ...  [length]
  std::array<Range, 3> displacement;
  Range speed;
  std::array<Range, bond_field_count> fields;
  bool may_break = false;  ///< every frame tells of breaks
  std::vector<QuantisedFrame> frames;
  Walls walls{};
  Contacts contacts{};
  std::vector<float> cell{};  ///< of each frame: a, b, c and the corner from the origin; empty: none [length]
  std::array<bool, 3> periodic{};  ///< along which edges
  bool flows = false;              ///< every frame tells of flow
  /// Whether the frames have this one of bond_fields. That a mode uses up strength, carries loads or has
  /// flowed means nothing.
  bool has_field(std::size_t k) const {
    if (k < fields_of_all_runs) return true;
    return kind == SequenceKind::run && (k < fields_with_breaks ? may_break : flows);
  }
};

/// A bond's first sight in the state given.
struct BondSighting {
  std::int64_t bond = -1;  ///< -1: none
  std::uint32_t i = 0, j = 0;
  double time = 0;
};

/// What all sequences share.
struct Body {
  std::vector<float> radius;         ///< [length]
  std::vector<std::uint32_t> bonds;  ///< i0, j0, i1, j1, ...
  std::vector<float> capsules;  ///< radius of each bond as it touches, 0: not; empty if none does  [length]
  std::vector<float> images;    ///< which image of j each bond joins, three numbers; empty if none joins one
  BondSighting first_strained, first_snapped;
  std::size_t bonds_without_length = 0;  ///< at rest; their relative elongation is given as 0
};

/// Reads the frames twice, for ranges and for numbers, one at a time; adds what is new to the body. A mode is
/// shown about its first frame, a run about its start. Throws IoError, also for frames of another body.
Sequence read_sequence(const SequenceFiles& files, Body& body);

/// Bytes that a frame of these files takes in the block, before it is compressed. Throws IoError.
std::size_t bytes_of_frame(const FrameFiles& files);

}  // namespace vbond::page
