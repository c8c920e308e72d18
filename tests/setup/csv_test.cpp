#include <chrono>
#include <initializer_list>
#include <string_view>

#include "cases.hpp"
#include "vbond/case/read.hpp"
#include "vbond/setup/csv_table.hpp"

namespace vbond::test {
namespace {

CsvTable table_of(const std::string& text, std::initializer_list<const char*> titles,
                  bool pass_over = false) {
  const TemporaryFile file("table.csv", text);
  std::vector<WantedColumn> wanted;
  for (const char* title : titles) wanted.push_back({title, true});
  return read_csv(file.path(), {"case.toml", 4, 8}, wanted, {pass_over, "remove it"});
}

std::string refusal_of(const std::string& text, std::initializer_list<const char*> titles) {
  try {
    table_of(text, titles);
  } catch (const CaseError& e) {
    return e.what();
  }
  return "";
}

using Fields = std::vector<std::string>;

TEST(CsvTable, IsReadAsSpreadsheetsRAndParaViewWriteIt) {
  for (const char* text :
       {"x,y\n1,2\n3,4\n", "\xEF\xBB\xBFx,y\r\n1,2\r\n3,4\r\n", "\"x\",\"y\"\n\"1\",\"2\"\n3,\"4\"",
        "x;y\n1;2\n3;4\n", "x\ty\n1\t2\n3\t4\n", "x,y\r1,2\r3,4\r",
        "# by hand\n\n  x , \"y\" \n1 , 2\n,\n3,4\n \n", "x,y\n1,2\n#3,5\n3,4"}) {
    const CsvTable table = table_of(text, {"y", "x"});
    EXPECT_EQ(table.fields, (std::vector<Fields>{{"2", "4"}, {"1", "3"}})) << text;
  }
}

TEST(CsvTable, TakesSeparatorsLineEndsAndQuotesInsideOfQuotes) {
  const CsvTable table =
      table_of("\"Points:0\",\"a \"\"b\"\", c\",n\n1,\"two\nlines, \"\"quoted\"\"\",5\r\n2,,6\n",
               {"Points:0", "a \"b\", c", "n"});
  EXPECT_EQ(table.fields, (std::vector<Fields>{{"1", "2"}, {"two\nlines, \"quoted\"", ""}, {"5", "6"}}));
  EXPECT_EQ(table.lines, (std::vector<std::uint32_t>{2, 4}));
}

TEST(CsvTable, PassesOverOtherColumnsOnlyWhereThatIsWanted) {
  const CsvTable table = table_of("\"\",x,id,id\n\"1\",0.5,a,b\n", {"x"}, true);
  EXPECT_EQ(table.fields, (std::vector<Fields>{{"0.5"}}));
  EXPECT_EQ(table.passed_over, (Fields{"", "id", "id"}));
  EXPECT_TRUE(contains(refusal_of("x,id\n1,2\n", {"x"}), "table.csv:1:1: unknown column \"id\""));
}

TEST(CsvTable, RefusesWhatCanBeReadInTwoWays) {
  const std::pair<const char*, const char*> cases[] = {
      {"x,x\n1,2\n", "column \"x\" appears twice"},
      {"x;y,z\n1;2\n", "the header has commas and semicolons"},
      {"x,y\n\"1\" 2,3\n", "table.csv:2:1: text after the field \"1\""},
      {"x,y\n1,\"2\n3,4\n", "table.csv:2:1: a field in quotes that does not end"},
      {"x,y\n1,2,3\n", "table.csv:2:1: 3 fields\n  the header has 2 columns: x, y"},
      {"\xFF\xFEx\0,\0", "text of 16 bits per character"},
      {"x y\n1 2\n", "there is no column \"x\""},
      {"", "the first line names the columns, among them x, y; here it has none"}};
  for (const auto& [text, part] : cases) {
    const std::string refusal = refusal_of(text, {"x", "y"});
    EXPECT_TRUE(contains(refusal, part)) << part << "\nnot in\n" << refusal;
  }
}

// Comparing each column with all before it would take more than 10 s, and three lines for each would be 20
// MB.
TEST(CsvTable, OfManyUnknownColumnsIsRefusedBriefly) {
  std::string header = "x,y";
  for (int k = 0; k < 100000; ++k) header += ",column" + std::to_string(k);
  const std::string refusal = refusal_of(header + "\n", {"x", "y"});
  EXPECT_TRUE(contains(refusal, "and 99980 more of this kind"));
  EXPECT_LT(refusal.size(), 5000U);
}

TEST(CsvTable, OfManyWrongRowsIsRefusedBriefly) {
  std::string text = "x,y\n";
  for (int k = 0; k < 100000; ++k) text += "1,2,3\n";
  const std::string refusal = refusal_of(text, {"x", "y"});
  EXPECT_TRUE(contains(refusal, "table.csv:21:1: 3 fields")) << refusal;
  EXPECT_TRUE(contains(refusal, "and 99980 more of this kind")) << refusal;
  EXPECT_LT(refusal.size(), 5000U);
}

// ---- specimens ----------------------------------------------------------------------------------------

/// A case in SI units with these keys of a specimen of kind csv in `file`.
Case si_case(const TemporaryFile& file, const std::string& keys, const std::string& more = "") {
  return parse_case("[units]\nsystem = \"SI\"\n[[specimen]]\nkind = \"csv\"\nfile = \"" +
                        file.path().string() + "\"\n" + keys + "\n" + more +
                        "[[stage]]\nduration = 1\n[time]\nstep = 0.1\n[output]\nhistory = { every = 1 }\n",
                    "case.toml");
}

const std::string four_stiffnesses = "stiffness = { c_A = 1, c_D = 0.3, c_B = 0.04, c_T = 0.03 }\n";

TEST(CsvSpecimen, HasNamesAndUnitsOfColumnsFromTheCase) {
  const TemporaryFile file("units.csv", "id,x_mm,y_mm,z_mm,d,w,n,m\n1,0,0,1,0.4,90,3,4\n2,1,0,2,0.8,0,2,5\n");
  const Built b =
      build(si_case(file,
                    "mass = 1\ncolumns = { x = \"x_mm\", y = \"y_mm\", z = \"z_mm\", radius = \"d\", wx = "
                    "\"w\", wy = \"n\", wz = \"m\" }\nunits = { x = \"mm\", y = \"mm\", z = \"mm\", radius "
                    "= \"cm\", wx = \"deg/s\" }"));
  EXPECT_EQ(b.model.r_0.values(), (std::vector<Vec3d>{{0, 0, 1e-3}, {1e-3, 0, 2e-3}}));
  EXPECT_EQ(b.model.radius.values(), (std::vector<double>{0.4 * 0.01, 0.8 * 0.01}));
  EXPECT_DOUBLE_EQ(b.state.omega[ParticleId{0}].x, std::numbers::pi / 2);
  EXPECT_EQ(b.state.omega[ParticleId{1}], (Vec3d{0, 2, 5}));
  EXPECT_EQ(b.state.v[ParticleId{1}], (Vec3d{0, 0, 0}));
  ASSERT_EQ(b.notes.size(), 2U);
  EXPECT_TRUE(contains(b.notes[0], "not read are the columns \"id\"")) << b.notes[0];
  EXPECT_TRUE(contains(b.notes[1], "its velocities are where the run begins")) << b.notes[1];
}

TEST(CsvSpecimen, TellsWhichColumnsItDoesNotRead) {
  const TemporaryFile file("more.csv", "\"\",x,y,z,radius,colour\n\"1\",0,0,0,7,red\n");
  const Built b =
      build(si_case(file, "mass = 1\nradius = 0.5\ncolumns = { x = \"x\", y = \"y\", z = \"z\" }"));
  EXPECT_EQ(b.model.radius[ParticleId{0}], 0.5);
  ASSERT_EQ(b.notes.size(), 1U);
  EXPECT_TRUE(contains(b.notes[0], "not read are the columns \"\", \"radius\", \"colour\"")) << b.notes[0];
}

// Powers of length: 1, 1 and 2.
TEST(CsvSpecimen, ScalesLengthsInPositionsVelocitiesAndMomentsOfInertia) {
  const TemporaryFile file("scaled.csv", "x,y,z,radius,mass,inertia,vx,vy,vz\n1,2,3,4,5,6,7,8,9\n");
  const Built b = build(si_case(file, "scale = 0.5"));
  const ParticleId p{0};
  EXPECT_EQ(b.model.r_0[p], (Vec3d{0.5, 1, 1.5}));
  EXPECT_EQ(b.model.radius[p], 2.0);
  EXPECT_EQ(b.model.mass[p], 5.0);
  EXPECT_EQ(b.model.inertia[p], 1.5);
  EXPECT_EQ(b.state.v[p], (Vec3d{3.5, 4, 4.5}));
}

TEST(CsvSpecimen, RefusesColumnsAndUnitsThatDoNotBelongTogether) {
  const TemporaryFile file("wrong.csv", "x,y,z,vx,n\n0,0,0,1,\"0,5\"\n");
  const auto refusal = [&](const std::string& keys) {
    try {
      build(si_case(file, "mass = 1\nradius = 1\n" + keys));
    } catch (const CaseError& e) {
      return std::string(e.what());
    }
    return std::string();
  };
  const std::pair<const char*, const char*> cases[] = {
      {"columns = { x = \"x\", y = \"y\" }", "specimen[0].columns.z is missing"},
      {"columns = { x = \"X\", y = \"y\", z = \"z\" }", "there is no column \"X\""},
      {"columns = { x = \"x\", y = \"y\", z = \"z\", vx = \"vx\" }", "columns vx, vy, vz are not all there"},
      {"columns = { x = \"x\", y = \"y\", z = \"z\" }\nunits = { radius = \"mm\" }", "units.radius = \"mm\""},
      {"columns = { x = \"x\", y = \"y\", z = \"n\" }",
       "wrong.csv:2:1: z = \"0,5\"\n  numbers have a decimal point"},
      {"columns = { x = \"x\", y = \"x\", z = \"z\" }", "no column of the file may be read as two"},
      {"scale = 2\nunits = { x = \"mm\" }", "only one of scale and units may be given"},
      {"units = { x = \"kg\" }", "must be a length (m); this is a mass (kg)"},
      {"", "columns = { x = \"...\", y = \"...\", z = \"...\" }"}};
  for (const auto& [keys, part] : cases)
    EXPECT_TRUE(contains(refusal(keys), part)) << part << "\nnot in\n" << refusal(keys);
}

// A quarter turn about z takes x to y; the specimen's turn about x then takes y to z.
TEST(CsvSpecimen, TurnsOrientationsOfItsFileWithTheSpecimen) {
  const TemporaryFile file("turned.csv",
                           "x,y,z,qw,qx,qy,qz\n0,0,0,0.7071,0,0,0.7071\n1,0,0,1,0,0,0\n2,0,0,1,0,0,0\n");
  const std::string turn =
      "mass = 1\nradius = 0.1\nturn = { axis = [1, 0, 0], angle = \"90 deg\" }\ncut = [{ box = { min = [0.5, "
      "-1, -1], "
      "max = [1.5, 1, 1] } }]\narray = [{ count = 2, step = [5, 0, 0] }]";
  const Built b = build(si_case(file, turn));
  ASSERT_EQ(b.model.particles(), 4U);
  for (const std::size_t k : {0U, 2U})
    EXPECT_LT(norm(rotate(b.state.q[ParticleId{k}], Vec3d{1, 0, 0}) - Vec3d{0, 0, 1}), 1e-15);
  EXPECT_LT(norm(rotate(b.state.q[ParticleId{1}], Vec3d{1, 0, 0}) - Vec3d{1, 0, 0}), 1e-15);
  const TemporaryFile longer("longer.csv", "x,y,z,qw,qx,qy,qz\n0,0,0,1,1,0,0\n");
  const std::string error = text_of_error(si_case(longer, "mass = 1\nradius = 0.1"));
  EXPECT_TRUE(contains(error, "longer.csv:2:1: the quaternion 1, 1, 0, 0 has the length 1.41421")) << error;
}

TEST(CsvSpecimen, NamesTheLineOfItsHeaderAndAWrongFieldOnce) {
  const TemporaryFile part("part.csv", "# made by hand\n\nx,y,z,vx\n0,0,0,1\n");
  const std::string keys = "mass = 1\nradius = 0.4";
  EXPECT_TRUE(
      contains(text_of_error(si_case(part, keys)), "part.csv:3:1: columns vx, vy, vz are not all there"));
  const TemporaryFile turned("turned.csv", "x,y,z,qw,qx,qy,qz\n0,0,0,a,0,0,0\n");
  const std::string error = text_of_error(si_case(turned, keys));
  EXPECT_TRUE(contains(error, "turned.csv:2:1: qw = \"a\"")) << error;
  EXPECT_FALSE(contains(error, "quaternion")) << error;
}

// Of the chain 0 - 1 - 2 - 3 the second particle goes: what is left is the bond 2 - 3, in each copy, and the
// rows count from 0 whatever specimens come before.
TEST(CsvSpecimen, TakesItsBondsThroughCutAndArray) {
  const TemporaryFile file("chain.csv", "x,y,z\n0,0,0\n1,0,0\n2,0,0\n3,0,0\n");
  const TemporaryFile pairs("bonds.csv", "type,i,j\n1,0,1\n1,1,2\n2,3,2\n");
  const std::string keys =
      "mass = 1\nradius = 0.4\nbonds_file = \"" + pairs.path().string() +
      "\"\ncut = [{ sphere = { centre = [1, 0, 0], radius = 0.5 } }]\narray = [{ count = 2, step = "
      "[0, 0, 3] }]\n[[specimen]]\nname = \"probe\"\nkind = \"list\"\npositions = [[9, 9, 9]]\nmass "
      "= 1\nradius = 0.1";
  Case c = si_case(file, keys, "[[bonds]]\nfrom_specimen = true\nbond_type = 2\n" + four_stiffnesses);
  const Built b = build(c);
  ASSERT_EQ(b.state.bonds.size(), 2U);
  EXPECT_EQ(b.state.bonds[BondId{0}].i.value, 1U);
  EXPECT_EQ(b.state.bonds[BondId{0}].j.value, 2U);
  EXPECT_EQ(b.state.bonds[BondId{1}].i.value, 4U);
  EXPECT_EQ(b.state.bonds[BondId{1}].j.value, 5U);
  std::get<SpecimenPairs>(c.bonds[0].select.value).bond_type = 1;
  EXPECT_TRUE(contains(text_of_error(c), "no bond of type 1"));
}

TEST(CsvSpecimen, BringsAPairOfTwoTypesForTwoSets) {
  const TemporaryFile file("two.csv", "x,y,z\n0,0,0\n1,0,0\n");
  const TemporaryFile pairs("bonds.csv", "i,j,type\n0,1,1\n0,1,2\n");
  const Case c = si_case(file, "mass = 1\nradius = 0.4\nbonds_file = \"" + pairs.path().string() + "\"",
                         "[[bonds]]\nfrom_specimen = true\nbond_type = 2\n" + four_stiffnesses);
  EXPECT_EQ(build(c).state.bonds.size(), 1U);
}

TEST(CsvSpecimen, RefusesBondsOfRowsThatItDoesNotHave) {
  const TemporaryFile file("two.csv", "x,y,z\n0,0,0\n1,0,0\n");
  const auto error = [&](const std::string& rows) {
    const TemporaryFile pairs("bonds.csv", "i,j\n" + rows);
    return text_of_error(si_case(file,
                                 "mass = 1\nradius = 0.4\nbonds_file = \"" + pairs.path().string() + "\"",
                                 "[[bonds]]\nfrom_specimen = true\n" + four_stiffnesses));
  };
  EXPECT_TRUE(contains(error("1,2\n"), "seem to count from 1: subtract 1")) << error("1,2\n");
  EXPECT_TRUE(contains(error("0,2\n"),
                       "bonds.csv:2:1: there is no particle 2\n  the specimen's file has particles 0 "
                       "to 1\n  correct the pair"))
      << error("0,2\n");
  EXPECT_TRUE(contains(error("0,0\n"), "a bond joins two different particles"));
  EXPECT_TRUE(contains(error("0,x\n"), "the row is not understood"));
  EXPECT_TRUE(
      contains(error("0,1\n\n1,0\n"), "bonds.csv:4:1: pair 0, 1\n  the pair is there already, in line 2"))
      << error("0,1\n\n1,0\n");
}

// Pairs of a [[bonds]] table are numbers of the body, after the cuts: what is told where they do not fit, and
// where they might have been meant otherwise.
TEST(Bonds, OfAFileOfPairsSayThatCutsRenumberParticles) {
  const TemporaryFile file("chain.csv", "x,y,z\n0,0,0\n1,0,0\n2,0,0\n3,0,0\n");
  const auto cut_case = [&](const TemporaryFile& pairs) {
    return si_case(file, "mass = 1\nradius = 0.4\ncut = [{ sphere = { centre = [0, 0, 0], radius = 0.5 } }]",
                   "[[bonds]]\nfile = \"" + pairs.path().string() + "\"\n" + four_stiffnesses);
  };
  const TemporaryFile outside("pairs.csv", "i,j\n1,2\n2,3\n");
  EXPECT_TRUE(contains(text_of_error(cut_case(outside)),
                       "bonds_file of the specimen, and from_specimen = true here"));
  const TemporaryFile inside("fitting.csv", "i,j\n0,1\n1,2\n");
  const Built b = build(cut_case(inside));
  EXPECT_TRUE(contains(b.notes.back(), "are numbers of particles after the cuts")) << b.notes.back();
}

TEST(Bonds, OfAFileThatCountsFromOneAreToldSo) {
  const TemporaryFile pairs("pairs.csv", "i,j\n1,2\n3,4\n");
  Case c = case_of(RodSpecimen{4, 1.0, {}, {1, 0, 0}});
  BondSpec bonds = bonds_within(1.0);
  bonds.select.value = PairsFile{pairs.path()};
  c.bonds = {bonds};
  EXPECT_TRUE(contains(text_of_error(c), "its numbers seem to count from 1: subtract 1 from all of them"));
}

}  // namespace
}  // namespace vbond::test
