// Pipe runs in tables and drawings.
#include "pcm/cad/dxf_file.h"
#include "pcm/cad/primitive_files.h"
#include "tests/cad/written_files.h"
#include "tests/support.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace pcm {
namespace {

using test::lines_of;
using test::made;
using test::text_of_file;

class PipeRunFiles : public testing::Test {
protected:
    test::TemporaryFolder folder_;
};

// A pipe from (0, 0, 0) along x to (2, 0, 0), a quarter turn of radius 0.5 to (2.5, 0.5, 0), and 1 along y.
std::vector<Primitive> pipe_with_elbow()
{
    Primitive first = made("cylinder 0 0 0 1 0 0 0.1", "Pipe, first"),
              elbow = made("torus 2 0.5 0 0 0 1 0.5 0.1", "Elbow"),
              second = made("cylinder 2.5 0.5 0 0 1 0 0.1", "Pipe 2");
    first.bounds.to = 2;
    first.colour = {1, 2, 3};
    elbow.bounds.zero = {0, -1, 0};
    elbow.bounds.end = pi / 2;
    second.bounds.to = 1;
    second.fit.verdict = FitVerdict::doubtful;
    for (Primitive* part : {&first, &elbow, &second}) part->points = 100;
    return {first, elbow, second};
}

TEST_F(PipeRunFiles, ATableHasRowsForPipeRuns)
{
    const std::vector<Primitive> parts = pipe_with_elbow();
    const CadReport report = write_primitives(folder_ / "a.csv", parts);
    EXPECT_EQ(report.written, 3u);
    EXPECT_EQ(report.runs, 1u);
    const std::vector<std::string> lines = lines_of(folder_ / "a.csv");
    ASSERT_EQ(lines.size(), 5u);
    EXPECT_EQ(lines[0].substr(lines[0].rfind(",run,")), ",run,bends,parts");
    EXPECT_EQ(lines[2].substr(lines[2].rfind(',', lines[2].size() - 3)), ",Pipe run 1,,") << lines[2];
    EXPECT_EQ(lines[4].rfind("Pipe run 1,pipe run,#010203,,,,,,,0.1,", 0), 0u) << lines[4];
    EXPECT_NE(lines[4].find(",300,3.785398163397448"), std::string::npos) << lines[4];
    EXPECT_NE(lines[4].find(",0,0,0,2.5,1.5,0,"), std::string::npos) << lines[4];
    EXPECT_NE(lines[4].find(",doubtful,'Pipe 2' is doubtful,"), std::string::npos) << lines[4];
    const std::string end = ",1,\"Pipe, first, Elbow, Pipe 2\"";
    EXPECT_EQ(lines[4].substr(lines[4].size() - end.size()), end);
    EXPECT_EQ(std::count(lines[3].begin(), lines[3].end(), ','), std::count(lines[0].begin(), lines[0].end(), ','));
}

TEST_F(PipeRunFiles, ADrawingHasTheCentreLineOfAPipeRunOnALayerOfItsOwn)
{
    if (!writes_dxf()) GTEST_SKIP() << "built without dxflib";
    std::vector<Primitive> parts = pipe_with_elbow();
    const auto vertices = [&](const char* name, double chord) {
        CadOptions options;
        options.chord = chord;
        const CadReport report = write_primitives(folder_ / name, parts, options);
        const std::string text = text_of_file(folder_ / name);
        std::size_t count = 0, polylines = 0;
        const std::vector<std::string> lines = lines_of(folder_ / name);
        for (std::size_t i = 0; i + 6 < lines.size(); ++i) {
            if (lines[i] == "VERTEX" && lines[i + 6] == "Pipe run 1") ++count;
            if (lines[i] == "POLYLINE" && lines[i + 6] == "Pipe run 1") ++polylines;
        }
        EXPECT_EQ(polylines, report.runs);
        EXPECT_EQ(text.find("  2\nPipe run 1\n 70\n0\n 62\n") != std::string::npos, report.runs == 1);
        return count;
    };
    const std::size_t usual = vertices("a.dxf", 0);
    EXPECT_GT(usual, 6u);
    EXPECT_GT(vertices("b.dxf", 1e-5), 3 * usual);
    parts[1].hidden = parts[2].hidden = true;
    EXPECT_EQ(vertices("c.dxf", 0), 0u) << "hidden parts join nothing";
}

}  // namespace
}  // namespace pcm
