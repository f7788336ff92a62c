// The filters as MeshLab has them: through the plugin, with documents of MeshLab but without its window.
#include "pcm/build/builder.h"
#include "pcm/system/error.h"
#include "pcm/system/text.h"
#include "tests/plugin/filter_call.h"
#include "tests/plugin/met_document.h"
#include "tests/plugin/scenes.h"

#include <fstream>
#include <memory>
#include <set>

namespace pcm::host {
namespace {

const char* const build_name = "Build Point Cloud Tree";

TEST(Filters, HaveNamesOfTheirOwnHelpAndTooltips)
{
    std::set<QString> names;
    for (QAction* action : plugin().actions()) {
        EXPECT_TRUE(names.insert(action->text()).second) << action->text().toStdString();
        EXPECT_FALSE(plugin().filterInfo(plugin().ID(action)).isEmpty());
        MetDocument document;
        const RichParameterList parameters = plugin().parameters_for(action, document);
        EXPECT_FALSE(parameters.isEmpty());
        for (const RichParameter& parameter : parameters)
            EXPECT_TRUE(parameter.toolTip().contains("default", Qt::CaseInsensitive))
                << action->text().toStdString() << ": " << parameter.name().toStdString();
    }
    // Scripts call filters by name.
    for (const char* name :
         {build_name, "Append to Point Cloud Tree", "Delete Points of Point Cloud Tree", "Compact Point Cloud Tree",
          "Point Cloud Tree Information", "Voxel Grid of Point Cloud Tree", "Subsample Point Cloud Tree",
          "Merge Point Cloud Trees", "Transform Point Cloud Tree", "Align Point Clouds by Pairs",
          "Estimate Radii of Point Cloud Tree", "Estimate Normals of Point Cloud Tree",
          "Remove Outliers of Point Cloud Tree", "Measure", "Cross-Section Profile", "Cut Volume"})
        EXPECT_TRUE(names.count(name)) << name;
}

// A tooltip that names a number as the default names the one that the dialog has.
TEST(Filters, DefaultsOfRadiiAreThoseOfTheCommandLine)
{
    FilterCall run("Estimate Normals of Point Cloud Tree");
    EXPECT_EQ(run.parameters().getInt(script_name_of("RadiusNeighbours")), 6);
    EXPECT_FLOAT_EQ(run.parameters().getFloat(script_name_of("RadiusLimit")), 2.5f);
}

// The plugin refuses what the library would refuse, by the parameter's label, and nothing else.
TEST(Filters, RangesAreTheLibrarys)
{
    struct Range {
        const char* name;
        const char* label;
        int least, most;
        void (*set)(BuildOptions& options, int value);
    };
    const Range ranges[] = {
        {"ChunkPoints", "Points per chunk", least_chunk_points, most_chunk_points,
         [](BuildOptions& options, int value) { options.chunk_points = static_cast<std::uint32_t>(value); }},
        {"Threads", "Threads", 0, most_build_threads,
         [](BuildOptions& options, int value) { options.threads = static_cast<unsigned>(value); }},
        {"MemoryMB", "memory", least_build_memory >> 20, 1 << 24,
         [](BuildOptions& options, int value) { options.memory_bytes = std::uint64_t(value) << 20; }}};
    const test::TemporaryFolder folder;
    for (const Range& range : ranges) {
        for (const int value : {range.least, range.most}) {
            BuildOptions options;
            range.set(options, value);
            EXPECT_NO_THROW(check_build_options(options)) << range.name << " = " << value;
            FilterCall run(build_name);
            run.set("Inputs", folder / "none.las").set(range.name, value);
            EXPECT_FALSE(run.apply());
            EXPECT_NE(run.log().find("none.las"), std::string::npos) << run.log();  // the value was accepted
        }
        for (const int value : {range.least - 1, range.most + 1}) {
            if (value == (1 << 24) + 1) continue;  // there is no upper bound of memory
            if (value > 0) {
                BuildOptions options;
                range.set(options, value);
                EXPECT_THROW(check_build_options(options), Error) << range.name << " = " << value;
            }
            FilterCall run(build_name);
            run.set("Inputs", folder / "none.las").set(range.name, value);
            EXPECT_FALSE(run.apply());
            EXPECT_NE(run.log().find(range.label), std::string::npos) << run.log();
            EXPECT_EQ(run.log().find("none.las"), std::string::npos) << run.log();
        }
    }
}

TEST(Filters, InformationHasAllDigits)
{
    const test::TemporaryFolder folder;
    const fs::path path = tree_of(scene(folder, "a.las", 60000, far_away));
    FilterCall run("Point Cloud Tree Information");
    ASSERT_TRUE(run.set("Tree", path).apply()) << run.log();
    const Box3d bounds = Tree::open(path)->info().bounds();
    const auto row = [](const Vec3d& v) { return exact(v[0]) + "  " + exact(v[1]) + "  " + exact(v[2]); };
    for (const std::string& expected :
         {std::string("a.las"), std::string("60,000"), row(bounds.min), row(bounds.max), std::string("rgb:u16x3"),
          std::string("points to here"), std::string("largest error 0")})
        EXPECT_NE(run.log().find(expected), std::string::npos) << expected << " is not in\n" << run.log();
}

TEST(Filters, AnUpdateGoesIntoACopyOrInPlaceButNotIntoNeither)
{
    const test::TemporaryFolder folder;
    const fs::path tree = tree_of(scene(folder, "a.las", 20000, far_away)), copy = folder / "copy.pct";
    const auto points = [](const fs::path& path) { return Tree::open(path)->info().points; };
    const auto erase = [&] {
        auto run = std::make_unique<FilterCall>("Delete Points of Point Cloud Tree");
        run->set("Tree", tree).set("Where", fs::path("x < 500005"));
        return run;
    };

    auto neither = erase();
    EXPECT_FALSE(neither->apply());
    EXPECT_NE(neither->log().find("'In place'"), std::string::npos) << neither->log();
    EXPECT_EQ(points(tree), 20000u);

    auto into_copy = erase();
    ASSERT_TRUE(into_copy->set("Output", folder / "copy").apply()) << into_copy->log();  // .pct is added
    EXPECT_EQ(points(tree), 20000u);
    const std::uint64_t left = points(copy);
    EXPECT_LT(left, 20000u);
    EXPECT_EQ(models_of(into_copy->document).size(), 1u);  // a layer shows the copy

    auto in_place = erase();
    ASSERT_TRUE(in_place->set("Output", folder / "ignored.pct").set("InPlace", true).apply()) << in_place->log();
    EXPECT_EQ(points(tree), left);
    EXPECT_FALSE(fs::exists(folder / "ignored.pct"));
    EXPECT_TRUE(models_of(in_place->document).empty());
}

TEST(Filters, BadLinesAndFilesAreSkippedWhereTheParametersSaySo)
{
    const test::TemporaryFolder folder;
    fs::create_directories(folder / "tiles" / "inner");
    std::ofstream(folder / "tiles" / "a.xyz") << "1 2 3\n4 oops 6\n7 8 9\n";
    std::ofstream(folder / "tiles" / "inner" / "b.xyz") << "10 20 30\n";
    std::ofstream(folder / "tiles" / "c.las") << "no LAS";
    const fs::path tree = folder / "tiles.pct";
    const auto points = [&] { return Tree::open(tree)->info().points; };

    FilterCall strict(build_name);
    EXPECT_FALSE(strict.set("Inputs", folder / "tiles").set("Open", false).apply());
    FilterCall build(build_name);
    build.set("Inputs", folder / "tiles").set("Open", false).set("SkipBadLines", true).set("SkipBadFiles", true);
    ASSERT_TRUE(build.apply()) << build.log();
    EXPECT_EQ(points(), 3u);
    for (const char* part : {"1 bad line was skipped", "line 2: found 'oops'", "left out: c.las"})
        EXPECT_NE(build.log().find(part), std::string::npos) << part << " is not in\n" << build.log();

    const char* const append_name = "Append to Point Cloud Tree";
    FilterCall refused(append_name);
    EXPECT_FALSE(refused.set("Tree", tree).set("Inputs", folder / "tiles").set("InPlace", true).apply());
    FilterCall append(append_name);
    append.set("Tree", tree).set("Inputs", folder / "tiles").set("InPlace", true);
    ASSERT_TRUE(append.set("SkipBadLines", true).set("SkipBadFiles", true).apply()) << append.log();
    EXPECT_EQ(points(), 6u);
    EXPECT_NE(append.log().find("1 bad line was skipped"), std::string::npos) << append.log();
}

}  // namespace
}  // namespace pcm::host
