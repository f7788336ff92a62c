// Every real LAS and PLY cloud builds, with the count and the box that its manifest states.

#include "pcm/build/builder.h"
#include "pcm/tree/verify.h"
#include "tests/clouds.h"
#include "tests/sanitizers.h"
#include "tests/support.h"

#include <cmath>
#include <sstream>

namespace {

using namespace pcm;
using namespace pcm::test;

struct Sample {
    std::string file;
    std::uint64_t points = 0;
    std::vector<std::string> box;  // as printed: six numbers, or none
};

std::vector<Sample> samples()
{
    std::vector<Sample> all;
    std::ifstream manifest(sample("MANIFEST.csv"));
    for (std::string line; std::getline(manifest, line);) {
        std::istringstream fields(line);
        std::string file, format, points, box;
        std::getline(fields, file, ',');
        std::getline(fields, format, ',');
        std::getline(fields, points, ',');
        std::getline(fields, box, ',');
        const bool las = file.rfind("las/", 0) == 0 && file.size() > 4 && file.substr(file.size() - 4) == ".las";
        if (!las && file.rfind("ply/", 0) != 0) continue;
        Sample s;
        s.file = file;
        s.points = std::stoull(points);
        std::istringstream numbers(box);
        for (std::string number; numbers >> number;) s.box.push_back(number);
        all.push_back(s);
    }
    return all;
}

// Half a unit of the last printed digit, and what doubles need at that size.
double tolerance(const std::string& printed)
{
    const double value = std::fabs(std::stod(printed));
    const auto point = printed.find('.');
    if (printed.find('e') != std::string::npos) return value * 1e-5;
    const double digits = point == std::string::npos ? 0 : static_cast<double>(printed.size() - point - 1);
    // The manifest prints single precision sources with six significant digits.
    return std::max(0.501 * std::pow(10, -digits), value * 1e-9) + value * 1e-14;
}

// Not under the thread sanitizer: its threads are those that other tests of the room watch.
TEST(Samples, PCM_NOT_UNDER_THREAD(EveryLasAndPlyBuildsWithItsCountAndBox))
{
    PCM_REQUIRE_SAMPLE("MANIFEST.csv");
    const std::vector<Sample> all = samples();
    ASSERT_GT(all.size(), 30u);
    const TemporaryFolder folder;
    BuildOptions options;
    options.chunk_points = 5000;
    options.overwrite = true;
    for (const Sample& s : all) {
        SCOPED_TRACE(s.file);
        const BuildReport report = build_tree({sample(s.file)}, folder / "out.pct", options);
        EXPECT_EQ(report.outcome.points_out, s.points);
        EXPECT_TRUE(verify_tree(folder / "out.pct").faults.empty());
        const auto tree = Tree::open(folder / "out.pct");
        if (s.file.rfind("las/", 0) == 0) EXPECT_EQ(tree->info().position_error, 0.0);
        if (s.points == 0) continue;
        ASSERT_EQ(s.box.size(), 6u);
        const Box3d bounds = tree->info().bounds();
        for (std::size_t a = 0; a < 3; ++a) {
            EXPECT_NEAR(bounds.min[a], std::stod(s.box[a]), tolerance(s.box[a]));
            EXPECT_NEAR(bounds.max[a], std::stod(s.box[3 + a]), tolerance(s.box[3 + a]));
        }
    }
}

}  // namespace
