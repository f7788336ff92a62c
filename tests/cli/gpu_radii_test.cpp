// pcmlab radii --device gpu as a user meets it.
#ifdef PCM_HAVE_RENDER

#include "tests/answer_faults.h"
#include "tests/cli/command.h"

#include "pcm/point_cloud.h"

#include <vector>

namespace {

using namespace pcm;
using namespace pcm::test;

class GpuRadiiCommand : public CommandTest {
protected:
    void SetUp() override
    {
        write_las(folder_ / "in.las", records(Shape::surface, 3000, 4), {{0.01, 0.01, 0.01}, {500000, 4800000, 0}});
        ASSERT_EQ(pcmlab("build --chunk-points 1000 " + path("in.las")).code, 0);
    }

    // Skips the test where there are no compute shaders.
    Result radii(const std::string& arguments)
    {
        Result result = pcmlab("radii --device gpu -k 6 " + arguments);
        no_gpu_ = result.err.find("no OpenGL context") != std::string::npos ||
                  result.err.find("compute shaders need") != std::string::npos;
        return result;
    }

    // In the order of the tree's points; none where the tree has no radii.
    std::vector<double> radii_of(const std::string& tree) const
    {
        const auto cloud = PointCloud::open(folder_ / tree);
        std::vector<double> radii;
        if (!cloud->info().schema.find("radius")) return radii;
        Query query;
        query.attributes = {"radius"};
        auto cursor = cloud->points(query);
        for (PointView view; cursor.getNextData(view);)
            for (std::size_t i = 0; i < view.size(); ++i) radii.push_back(view.value(i, 0));
        return radii;
    }

    bool no_gpu_ = false;
};

#define PCM_REQUIRE_COMPUTE(result) \
    if (no_gpu_) GTEST_SKIP() << (result).err

TEST_F(GpuRadiiCommand, WritesACopyWithTheRadiiOfTheProcessor)
{
    const Result result = radii(path("in.pct") + " --json --output=" + path("-o.pct"));  // a name like an option
    PCM_REQUIRE_COMPUTE(result);
    ASSERT_EQ(result.code, 0) << result.err;
    const Json json = Json::parse(result.out);
    EXPECT_EQ(json["command"], "radii");
    EXPECT_EQ(json["output"], (folder_ / "-o.pct").string());
    EXPECT_EQ(faults_of_answer(*ops::find_operation("radii"), ops::Json::parse(result.out)), "");
    EXPECT_EQ(json["points"], 3000);
    EXPECT_EQ(json["points_in"], 3000);
    EXPECT_EQ(json["used_known_normals"], false);
    EXPECT_FALSE(json["computed_with"].get<std::string>().empty());
    ASSERT_EQ(pcmlab("radii -k 6 " + path("in.pct") + " -o " + path("cpu.pct")).code, 0);
    const auto gpu = radii_of("-o.pct"), cpu = radii_of("cpu.pct");
    ASSERT_EQ(gpu.size(), 3000u);
    for (std::size_t i = 0; i < gpu.size(); ++i) ASSERT_NEAR(gpu[i], cpu[i], 1e-5 * cpu[i]);
    EXPECT_TRUE(radii_of("in.pct").empty());
    EXPECT_EQ(pcmlab("verify " + path("-o.pct")).code, 0);
}

TEST_F(GpuRadiiCommand, InPlaceAcrossTheNormalsOfTheTree)
{
    ASSERT_EQ(pcmlab("set " + path("in.pct") + " --new normal:f32x3 normal=0,0,1").code, 0);
    const Result result = radii("--in-place -m 64M " + path("in.pct"));
    PCM_REQUIRE_COMPUTE(result);
    ASSERT_EQ(result.code, 0) << result.err;
    EXPECT_NE(result.out.find("across the normals"), std::string::npos) << result.out;
    EXPECT_NE(result.out.find("3,000 points"), std::string::npos) << result.out;
    EXPECT_EQ(radii_of("in.pct").size(), 3000u);
}

TEST_F(GpuRadiiCommand, AnErrorLeavesNoCopyAndNoChange)
{
    ASSERT_EQ(pcmlab("set " + path("in.pct") + " --new radius:u8").code, 0);
    const auto generation = Tree::open(folder_ / "in.pct")->info().generation;
    for (const std::string& target : {std::string("--in-place"), "-o " + path("copy.pct")}) {
        const Result result = radii(target + " " + path("in.pct"));
        PCM_REQUIRE_COMPUTE(result);
        EXPECT_EQ(result.code, 1);
        EXPECT_NE(result.err.find("'radius'"), std::string::npos) << result.err;
    }
    EXPECT_FALSE(std::filesystem::exists(folder_ / "copy.pct"));
    EXPECT_EQ(Tree::open(folder_ / "in.pct")->info().generation, generation);
    EXPECT_EQ(radii(path("in.pct")).code, 2);  // neither a copy nor in place
}

TEST_F(GpuRadiiCommand, RefusesWhatItWouldNotDo)
{
    for (const char* option : {"--mean-distance", "--max-distance 1", "--threads 1", "--flann"}) {
        const Result result = radii(std::string(option) + " --in-place " + path("in.pct"));
        EXPECT_EQ(result.code, 2) << option;
        EXPECT_NE(result.err.find("--device gpu"), std::string::npos) << result.err;
    }
    EXPECT_TRUE(radii_of("in.pct").empty());
}

}  // namespace

#endif
