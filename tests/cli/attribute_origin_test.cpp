// Attributes that a cloud has from elsewhere are not overwritten unasked; lengths among them grow with the cloud.
#include "tests/cli/command.h"
#include "tests/sanitizers.h"

#include <algorithm>

namespace pcm::test {
namespace {

class Origin : public CommandTest {
protected:
    Origin()
    {
        EXPECT_EQ(pcmlab("generate -q -n 5000 --no-truth --origin 0 0 0 " + path("scene.las")).code, 0);
        EXPECT_EQ(pcmlab("build -q " + path("scene.las") + " -o " + path("t.pct")).code, 0);
    }
    void done(const std::string& arguments)
    {
        const Result result = pcmlab(arguments);
        EXPECT_EQ(result.code, 0) << arguments << "\n" << result.err;
    }
    void refused(const std::string& arguments, const std::string& reason)
    {
        const Result result = pcmlab(arguments);
        EXPECT_EQ(result.code, 1) << arguments << "\n" << result.out;
        EXPECT_NE(result.err.find(reason), std::string::npos) << arguments << "\n" << result.err;
    }
    // Smallest, largest and mean of an attribute.
    std::array<double, 3> range(const std::string& cloud, const std::string& name)
    {
        const Result result = pcmlab("info --json --statistics " + path(cloud));
        EXPECT_EQ(result.code, 0) << result.err;
        const Json json = Json::parse(result.out);
        const Json& attributes = json["statistics"]["attributes"];
        if (!attributes.contains(name)) {
            ADD_FAILURE() << cloud << " has no " << name;
            return {};
        }
        const Json& values = attributes[name][0];
        return {values["min"], values["max"], values["mean"]};
    }
};

constexpr const char* not_made = "was not made by this operation";

TEST_F(Origin, ASelectionDoesNotReplaceClasses)
{
    const std::string save = "select " + path("t.pct") + " --where 'z > 0' --in-place --save-attribute ";
    const auto before = range("t.pct", "classification");
    refused(save + "classification", not_made);
    refused(save + "intensity", "another type");
    refused("select " + path("t.pct") + " --where 'z > 0' -o " + path("copy.pct") + " --save-attribute classification",
            not_made);
    EXPECT_FALSE(std::filesystem::exists(folder_ / "copy.pct"));
    EXPECT_EQ(range("t.pct", "classification"), before);
    refused(save + "nir", "standard name");
    done(save + "nir --overwrite");
    refused(save + "intensity --overwrite", "another type");
    done(save + "classification --overwrite");
    EXPECT_EQ(range("t.pct", "classification")[1], 1);

    // Its own it replaces, also when they have been in another file.
    done(save + "mine");
    done(save + "mine");
    for (const std::string extension : {".las", ".ply"}) {
        done("convert -q " + path("t.pct") + " " + path("c" + extension));
        done("build -q " + path("c" + extension) + " -o " + path("c.pct") + " --overwrite");
        done("select " + path("c.pct") + " --where 'z > 1' --in-place --save-attribute mine");
    }
    done("set " + path("t.pct") + " --new theirs:u8");
    refused(save + "theirs", not_made);
    const Result twice = pcmlab("set " + path("t.pct") + " --new theirs:f32");
    EXPECT_EQ(twice.code, 1) << twice.out;
}

TEST_F(Origin, LabelsDoNotReplaceOthers)
{
    const std::string outliers = "outliers " + path("t.pct") + " --label --in-place";
    done(outliers);
    done(outliers);
    done("build -q --overwrite " + path("scene.las") + " -o " + path("t.pct"));
    done("set " + path("t.pct") + " --new outlier:u8 --new shape:u32 outlier=7");
    refused(outliers, not_made);
    EXPECT_EQ(range("t.pct", "outlier")[0], 7);
    done(outliers + " --overwrite");
    EXPECT_LE(range("t.pct", "outlier")[1], 1);

    const std::string detect = "detect " + path("t.pct") + " --shape plane --in-place --label ";
    refused(detect + "shape --out " + path("found.json"), not_made);
    EXPECT_FALSE(std::filesystem::exists(folder_ / "found.json")) << "refused after the search";
    done(detect + "mine");
    done(detect + "mine");
    done(detect + "shape --overwrite");
}

TEST_F(Origin, ComputedAttributesDoNotReplaceOthers)
{
    done("set " + path("t.pct") + " --new curvature:f32 --new mean_distance:f32 curvature=7 mean_distance=7");
    refused("normals " + path("t.pct") + " --curvature --in-place", not_made);
    refused("radii " + path("t.pct") + " --mean-distance --in-place", not_made);
    EXPECT_EQ(range("t.pct", "curvature")[0], 7);
    const std::string all = "normals " + path("t.pct") + " --radii --curvature --mean-distance --in-place";
    done(all + " --overwrite");
    EXPECT_LT(range("t.pct", "curvature")[1], 1);
    done("build -q --overwrite " + path("scene.las") + " -o " + path("t.pct"));
    done(all);
    done(all);
    done("convert -q " + path("t.pct") + " " + path("c.las"));
    done("build -q " + path("c.las") + " -o " + path("c.pct"));
    done("normals " + path("c.pct") + " --radii --curvature --mean-distance --in-place");
}

// Not under the address sanitizer: starts many commands, whose work other tests check.
TEST_F(Origin, PCM_NOT_UNDER_ADDRESS(LengthsGrowWithTheCloud))
{
    done("normals " + path("t.pct") + " --radii --mean-distance --curvature --in-place");
    done("set " + path("t.pct") +
         " --new gap:f64:length --new area:f32:length^2 --new density:f32:length^-3 --new plain:f32 "
         "gap=3 area=5 density=8 plain=11");
    // The marks stay in all that a tree becomes.
    done("convert -q " + path("t.pct") + " " + path("c.las"));
    done("convert -q " + path("t.pct") + " " + path("c.ply"));
    done("build -q " + path("c.las") + " -o " + path("las.pct"));
    done("build -q " + path("c.ply") + " -o " + path("ply.pct"));
    done("voxel -q " + path("t.pct") + " --size 0.01 -o " + path("voxel.pct"));
    done("merge -q " + path("merged.pct") + " " + path("t.pct") + " " + path("las.pct"));
    done("subsample -q " + path("t.pct") + " -n 1000 -o " + path("few.pct"));
    for (const std::string tree : {"t.pct", "las.pct", "ply.pct", "voxel.pct", "merged.pct", "few.pct"}) {
        SCOPED_TRACE(tree);
        done("transform --overwrite -q " + path(tree) + " " + path("big.pct") + " --scale 2");
        for (const auto& [name, factor] : {std::pair<std::string, double>{"radius", 2},
                                           {"mean_distance", 2},
                                           {"gap", 2},
                                           {"area", 4},
                                           {"density", 0.125},
                                           {"curvature", 1},
                                           {"plain", 1}}) {
            const auto before = range(tree, name), after = range("big.pct", name);
            for (std::size_t k = 0; k < 3; ++k)
                EXPECT_NEAR(after[k], factor * before[k], 1e-6 * std::fabs(after[k])) << name;
        }
    }
    const Result wrong = pcmlab("set " + path("t.pct") + " --new gap2:f64:length^x");
    EXPECT_EQ(wrong.code, 1) << wrong.out;
}

TEST_F(Origin, AlignedClouds)
{
    done("radii " + path("t.pct") + " --mean-distance --in-place");
    done("transform -q " + path("t.pct") + " " + path("big.pct") + " --scale 3");
    done("align " + path("t.pct") + " " + path("big.pct") +
         " --scale --pair 0 0 0 0 0 0 --pair 9 0 0 27 0 0 --pair 0 9 0 0 27 0 --pair 0 0 5 0 0 15 -o " + path("a.pct"));
    const auto before = range("t.pct", "mean_distance"), after = range("a.pct", "mean_distance");
    for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(after[k], 3 * before[k], 1e-5 * after[k]);
}

}  // namespace
}  // namespace pcm::test
