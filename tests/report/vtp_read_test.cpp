#include "vbond/report/vtp_read.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "specimen.hpp"
#include "vbond/core/error.hpp"
#include "vbond/observe/frame_files.hpp"
#include "vbond/observe/frames.hpp"
#include "vbond/observe/vtp.hpp"

namespace vbond::vtp_read_test {
namespace {

using Per = VtpInput::Per;
using test::Chain;
using test::content_of;
using test::Folder;
using test::put_content;

TEST(VtpInput, GivesBackWhatVtpFileWrote) {
  const Folder folder;
  const std::vector<Vec3d> points{{1, 2, 3}, {-1.0 / 3.0, 0, 1e300}, {0, 0, 7}};
  VtpFile out = VtpFile::of_lines(points, {0, 1, 1, 2});
  out.add_point_data("radius", std::vector<double>{0.1, 0.2, 0.3});
  out.add_point_data("velocity", points);
  out.add_cell_data("range", std::vector<std::uint8_t>{2, 0});
  out.add_cell_data("set", std::vector<std::int64_t>{5, -6});
  out.write(folder / "a.vtp", 0.1, 42);
  const VtpInput in(folder / "a.vtp");
  EXPECT_EQ(in.time(), 0.1);
  EXPECT_EQ(in.step(), 42);
  EXPECT_FALSE(in.load_factor());
  EXPECT_EQ(in.points(), 3U);
  EXPECT_EQ(in.cells(), 2U);
  EXPECT_EQ(in.vectors(Per::point, "Points"), points);
  EXPECT_EQ(in.vectors(Per::point, "velocity"), points);
  EXPECT_EQ(in.scalars(Per::point, "radius"), (std::vector<double>{0.1, 0.2, 0.3}));
  EXPECT_EQ(in.bytes(Per::cell, "range"), (std::vector<std::uint8_t>{2, 0}));
  EXPECT_EQ(in.integers(Per::cell, "set"), (std::vector<std::int64_t>{5, -6}));
  EXPECT_EQ(in.integers(Per::end, "connectivity"), (std::vector<std::int64_t>{0, 1, 1, 2}));
}

TEST(VtpInput, KnowsTheLoadFactorOfABalance) {
  const Folder folder;
  const Chain chain;
  write_particles_vtp(folder / "p.vtp", chain.model, chain.state, 0.1);
  write_bonds_vtp(folder / "b.vtp", chain.state, UnitSystem::reduced, -1.0 / 3.0);
  EXPECT_EQ(VtpInput(folder / "p.vtp").load_factor(), 0.1);
  EXPECT_EQ(VtpInput(folder / "b.vtp").load_factor(), -1.0 / 3.0);
  EXPECT_EQ(VtpInput(folder / "b.vtp").step(), 1200);
}

TEST(VtpInput, ReadsFramesWithoutBonds) {
  const Folder folder;
  const Chain chain(1);
  write_bonds_vtp(folder / "b.vtp", chain.state, UnitSystem::reduced);
  const VtpInput in(folder / "b.vtp");
  EXPECT_EQ(in.cells(), 0U);
  EXPECT_TRUE(in.scalars(Per::cell, "bend").empty());
}

/// The message of the IoError that f throws.
template <class F>
std::string error_of(F f) {
  try {
    f();
  } catch (const IoError& e) {
    return e.what();
  }
  return "no IoError";
}

TEST(VtpInput, RefusesWhatVtpFileDidNotWrite) {
  const Folder folder;
  const Chain chain;
  for (const bool compressed : {true, false}) {
    write_particles_vtp(folder / "good.vtp", chain.model, chain.state, {}, {.compressed = compressed});
    const std::string good = content_of(folder / "good.vtp");
    const auto with = [&](const std::string& content) {
      put_content(folder / "bad.vtp", content);
      return error_of([&] {
        const VtpInput in(folder / "bad.vtp");
        in.vectors(Per::point, "velocity"), in.scalars(Per::point, "radius");
      });
    };
    const auto edited = [&](const std::string& from, const std::string& to) {
      std::string text = good;
      text.replace(text.find(from), from.size(), to);
      return with(text);
    };
    EXPECT_EQ(with(good), "no IoError");
    EXPECT_NE(with(good.substr(0, good.size() - 1)).find("bad.vtp: is cut short"), std::string::npos);
    EXPECT_NE(with(good + " ").find("cut short or damaged"), std::string::npos);
    EXPECT_NE(with("").find("bad.vtp: is not a .vtp file of vbond"), std::string::npos);
    EXPECT_NE(edited("PolyData", "ImageData").find("at \"<?xml"), std::string::npos);
    EXPECT_NE(edited("offset=\"0\"", "offset=\"8\"").find("bad.vtp"), std::string::npos);
    EXPECT_NE(edited("Float64\" Name=\"radius", "Float32\" Name=\"radius").find("bad.vtp"),
              std::string::npos);
    EXPECT_NE(edited("Name=\"velocity", "Name=\"velozity").find("no array \"velocity\""), std::string::npos);
    EXPECT_NE(error_of([&] { VtpInput(folder / "none.vtp"); }).find("none.vtp"), std::string::npos);
  }
}

// A zlib stream ends with a sum of what it holds, and sizes are held against one another.
TEST(VtpInput, NoChangedByteOfACompressedFilePassesForANumber) {
  const Folder folder;
  const Chain chain(20);
  write_bonds_vtp(folder / "good.vtp", chain.state, UnitSystem::si);
  const std::string good = content_of(folder / "good.vtp");
  const auto numbers = [](const VtpInput& in) {
    std::vector<double> all = in.scalars(Per::cell, "U_B");
    const auto add = [&all](const auto& values) { all.insert(all.end(), values.begin(), values.end()); };
    for (const char* name : {"elongation", "length_at_rest", "bend", "twist", "U_L", "U_T", "axial_force",
                             "shear_force", "moment_i", "moment_j"})
      add(in.scalars(Per::cell, name));
    for (const Vec3d& r : in.vectors(Per::point, "Points")) all.insert(all.end(), {r.x, r.y, r.z});
    add(in.integers(Per::end, "connectivity")), add(in.integers(Per::end, "offsets"));
    add(in.integers(Per::cell, "id")), add(in.integers(Per::cell, "set")), add(in.bytes(Per::cell, "range"));
    return all;
  };
  const std::vector<double> right = numbers(VtpInput(folder / "good.vtp"));
  const std::size_t begin = good.find("encoding=\"raw\"");
  std::size_t refused = 0;
  for (std::size_t at = begin; at < good.size(); ++at)
    for (const char change : {'\x01', '\x7f', '\xff'}) {
      std::string bad = good;
      bad[at] = static_cast<char>(bad[at] ^ change);
      put_content(folder / "bad.vtp", bad);
      try {
        EXPECT_EQ(numbers(VtpInput(folder / "bad.vtp")), right) << "byte " << at;
      } catch (const IoError&) {
        ++refused;
      }
    }
  // some bytes mean nothing: unused bits of the head of a stream, its level, the size of a block that is not
  // full
  EXPECT_GT(refused, 3 * (good.size() - begin) * 8 / 10);
}

TEST(VtpInput, ReadsFramesOfEarlierVersions) {
  const Folder folder;
  const auto number = [](auto x) { return std::string(reinterpret_cast<const char*>(&x), sizeof x); };
  const std::string head =
      "<?xml version=\"1.0\"?>\n"
      "<VTKFile type=\"PolyData\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">\n"
      "  <PolyData>\n    <FieldData>\n"
      "      <DataArray type=\"Float64\" Name=\"TimeValue\" NumberOfTuples=\"1\" "
      "format=\"ascii\">0.5</DataArray>\n"
      "      <DataArray type=\"Int64\" Name=\"Step\" NumberOfTuples=\"1\" format=\"ascii\">7</DataArray>\n"
      "    </FieldData>\n    <Piece NumberOfPoints=\"1\" NumberOfVerts=\"1\" NumberOfLines=\"0\" "
      "NumberOfStrips=\"0\" NumberOfPolys=\"0\">\n      <PointData>\n"
      "        <DataArray type=\"Float64\" Name=\"radius\" NumberOfComponents=\"1\" format=\"appended\" "
      "offset=\"0\"/>\n"
      "      </PointData>\n      <CellData>\n      </CellData>\n      <Points>\n"
      "        <DataArray type=\"Float64\" Name=\"Points\" NumberOfComponents=\"3\" format=\"appended\" "
      "offset=\"16\"/>\n"
      "      </Points>\n      <Verts>\n"
      "        <DataArray type=\"Int64\" Name=\"connectivity\" NumberOfComponents=\"1\" format=\"appended\" "
      "offset=\"48\"/>\n"
      "        <DataArray type=\"Int64\" Name=\"offsets\" NumberOfComponents=\"1\" format=\"appended\" "
      "offset=\"64\"/>\n"
      "      </Verts>\n    </Piece>\n  </PolyData>\n  <AppendedData encoding=\"raw\">\n   _";
  const std::uint64_t one = 8, three = 24;
  put_content(folder / "old.vtp", head + number(one) + number(0.25) + number(three) + number(1.0) +
                                      number(2.0) + number(3.0) + number(one) + number(std::int64_t{0}) +
                                      number(one) + number(std::int64_t{1}) +
                                      "\n  </AppendedData>\n</VTKFile>\n");
  const VtpInput in(folder / "old.vtp");
  EXPECT_EQ(in.step(), 7);
  EXPECT_EQ(in.scalars(Per::point, "radius"), (std::vector<double>{0.25}));
  EXPECT_EQ(in.vectors(Per::point, "Points"), (std::vector<Vec3d>{{1, 2, 3}}));
  EXPECT_EQ(in.integers(Per::end, "connectivity"), (std::vector<std::int64_t>{0}));
}

TEST(VtpInput, GivesUnitsAndSinglePrecision) {
  const Folder folder;
  const Chain chain;
  write_particles_vtp(folder / "p.vtp", chain.model, chain.state, {}, {.single_precision = true});
  const VtpInput in(folder / "p.vtp");
  EXPECT_EQ(in.unit("velocity"), "a sqrt(c_A/m)");
  EXPECT_EQ(in.unit("id"), "");
  EXPECT_EQ(in.vectors(Per::point, "velocity")[0].z, static_cast<double>(static_cast<float>(1.0 / 3.0)));
}

TEST(Pvd, ListComesBackWithItsFolder) {
  const Folder folder;
  put_content(folder / "a.pvd",
              pvd_list(pvd_entry(0.1, "frames/p_0.vtp") + pvd_entry(1e-9, "frames/p_1.vtp")));
  const std::vector<ListedFrame> frames = read_pvd(folder / "a.pvd");
  ASSERT_EQ(frames.size(), 2U);
  EXPECT_EQ(frames[1].time, 1e-9);
  EXPECT_EQ(frames[1].file, folder / "frames/p_1.vtp");
  put_content(folder / "b.pvd", pvd_list("").substr(0, 100));
  EXPECT_THROW(read_pvd(folder / "b.pvd"), IoError);
}

TEST(Pvd, FilesOutsideOfItsFolderAreRefused) {
  const Folder folder;
  const auto refused = [&](const std::string& entry) {
    put_content(folder / "a.pvd", pvd_list(entry));
    EXPECT_THROW(read_pvd(folder / "a.pvd"), IoError) << entry;
  };
  refused(pvd_entry(0.1, "/etc/p_0.vtp"));
  refused(pvd_entry(0.1, "../p_0.vtp"));
  refused(pvd_entry(0.1, "frames/../../p_0.vtp"));
  refused(pvd_entry(std::numeric_limits<double>::quiet_NaN(), "p_0.vtp"));
}

TEST(VtpInput, ArraysAreGivenForWhatTheyAreOf) {
  const Folder folder;
  VtpFile out = VtpFile::of_lines(std::vector<Vec3d>(4), {0, 1});
  out.add_point_data("radius", std::vector<double>(4));
  out.add_cell_data("bend", std::vector<double>(1));
  out.add_cell_data("twice", std::vector<double>(1));
  out.add_point_data("twice", std::vector<double>(4));
  out.write(folder / "a.vtp", 0.1, 42);
  const VtpInput in(folder / "a.vtp");
  EXPECT_TRUE(in.lines());
  EXPECT_EQ(in.scalars(Per::point, "radius").size(), 4U);
  EXPECT_EQ(in.scalars(Per::cell, "bend").size(), 1U);
  EXPECT_THROW(in.scalars(Per::cell, "radius"), IoError);
  EXPECT_THROW(in.scalars(Per::point, "bend"), IoError);
  EXPECT_THROW(in.scalars(Per::cell, "twice"), IoError);
  EXPECT_THROW(in.scalars(Per::point, "twice"), IoError);
}

}  // namespace
}  // namespace vbond::vtp_read_test
