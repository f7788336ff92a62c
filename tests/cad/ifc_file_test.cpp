// IFC files: what tests/independent/ifc.py does not read back.
#include "pcm/cad/iso_text.h"
#include "pcm/cad/primitive_files.h"
#include "tests/cad/written_files.h"
#include "tests/support.h"

#include <algorithm>
#include <set>

namespace pcm {
namespace {

using test::made;
using test::text_of_file;

// A pipe, an elbow and a pipe that continue each other, and a tank.
std::vector<Primitive> plant()
{
    std::vector<Primitive> all{made("cylinder 500050 4800000 100 1 0 0 0.1", "In"),
                               made("torus 500055 4800001 100 0 0 1 1 0.1", "Elbow"),
                               made("cylinder 500056 4800001 100 0 1 0 0.1", "Out"),
                               made("cylinder 500010 4800002 100 0 0 1 2.5", "Tank 'ä'")};
    const double ends[][2] = {{0, 5}, {0, 0}, {0, 4}, {-1, 3}};
    for (std::size_t i = 0; i < all.size(); ++i) {
        all[i].bounds.from = ends[i][0];
        all[i].bounds.to = ends[i][1];
    }
    all[1].bounds.zero = {0, -1, 0};
    all[1].bounds.begin = 0;
    all[1].bounds.end = pi / 2;
    all[3].fit.errors.radius = 0.25;
    return all;
}

std::size_t count_of(const std::string& text, const std::string& what)
{
    std::size_t count = 0;
    for (std::size_t at = 0; (at = text.find(what, at)) != std::string::npos; ++at) ++count;
    return count;
}

TEST(IfcFile, APipeRunIsOneElementAndItsPartsAreNotWrittenAgain)
{
    const test::TemporaryFolder folder;
    CadOptions options;
    options.unit = CadUnit::metres;
    const CadReport report = write_primitives(folder / "a.ifc", plant(), options);
    EXPECT_EQ(report.runs, 1u);
    ASSERT_EQ(report.notes.size(), 1u);
    EXPECT_EQ(report.notes[0], "3 primitives are in the pipe runs, as parts of them");
    const std::string text = text_of_file(folder / "a.ifc");
    EXPECT_EQ(count_of(text, "=IFCPIPESEGMENT("), 1u);
    EXPECT_EQ(count_of(text, "=IFCBUILDINGELEMENTPROXY("), 1u);
    EXPECT_NE(text.find("IFCCARTESIANPOINTLIST3D(((0.,0.,0.),(5.,0.,0.),(5.707106781"), std::string::npos)
        << "about the place of the first shape";
    EXPECT_NE(text.find("(IFCLINEINDEX((1,2)),IFCARCINDEX((2,3,4)),IFCLINEINDEX((4,5)))"), std::string::npos);
    EXPECT_NE(text.find("IFCCARTESIANPOINT((500050.,4800000.,100.))"), std::string::npos);
    EXPECT_NE(text.find("'Tank ''\\X2\\00E4\\X0\\'''"), std::string::npos);
    EXPECT_NE(text.find("'radius, standard deviation',$,IFCLENGTHMEASURE(0.25)"), std::string::npos);
    EXPECT_NE(text.find("'part 3',$,IFCLABEL('Out')"), std::string::npos);
    EXPECT_EQ(text.find("'part 4'"), std::string::npos);
    EXPECT_EQ(text.find("'points'"), std::string::npos) << "none are known";
    options.overwrite = true;
    write_primitives(folder / "a.ifc", plant(), options);
    EXPECT_EQ(text_of_file(folder / "a.ifc"), text) << "the same bytes";
}

TEST(IfcFile, IdsDifferAndHave128Bits)
{
    const test::TemporaryFolder folder;
    std::vector<Primitive> same(40, plant()[3]);
    write_primitives(folder / "a.ifc", same, {});
    std::set<std::string> ids;
    std::size_t roots = 0;
    for (const std::string& line : test::lines_of(folder / "a.ifc"))
        if (const std::size_t at = line.find("('"); at != std::string::npos && line.find("',$,", at) == at + 24) {
            const std::string id = line.substr(at + 2, 22);
            EXPECT_LT(id[0], '4') << id;
            ids.insert(id);
            ++roots;
        }
    EXPECT_EQ(roots, 6 + 3 * same.size());
    EXPECT_EQ(ids.size(), roots);
}

TEST(IfcFile, LengthsHaveAUnitAlways)
{
    const test::TemporaryFolder folder;
    const CadReport report = write_primitives(folder / "a.ifc", {plant()[3]}, {});
    ASSERT_EQ(report.notes.size(), 1u);
    EXPECT_NE(report.notes[0].find("taken for metres"), std::string::npos);
    EXPECT_NE(text_of_file(folder / "a.ifc").find("IFCSIUNIT(*,.LENGTHUNIT.,$,.METRE.)"), std::string::npos);
    CadOptions inches;
    inches.unit = CadUnit::inches;
    write_primitives(folder / "b.ifc", {plant()[3]}, inches);
    EXPECT_NE(text_of_file(folder / "b.ifc").find("IFCLENGTHMEASURE(0.0254)"), std::string::npos);
}

TEST(IsoText, LabelsAreCutBetweenCharacters)
{
    std::string umlauts;
    for (int i = 0; i < 300; ++i) umlauts += "ü";
    EXPECT_EQ(count_of(iso_label(umlauts), "00FC"), 255u);
    EXPECT_EQ(iso_label("short"), "'short'");
    EXPECT_EQ(iso_string("a'b\\c\n"), "'a''b\\\\c'");
}

TEST(IsoText, NumbersHaveAPoint)
{
    EXPECT_EQ(iso_real(1), "1.");
    EXPECT_EQ(iso_real(-0.25), "-0.25");
    EXPECT_EQ(iso_real(1e-20), "1.E-20");
    EXPECT_EQ(iso_real(1.5e300), "1.5E+300");
}

}  // namespace
}  // namespace pcm
