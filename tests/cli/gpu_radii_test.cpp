// What pcmlab starts for radii on the GPU.
#ifdef PCM_HAVE_RENDER

#include "tests/cli/command.h"

#include "pcm/cli/render.h"
#include "pcm/point_cloud.h"

#include <fcntl.h>
#include <unistd.h>

#include <cstdlib>
#include <optional>

namespace {

using namespace pcm;
using namespace pcm::test;

class GpuRadiiCommand : public CommandTest {
protected:
    void SetUp() override
    {
        write_las(folder_ / "in.las", records(Shape::surface, 3000, 4), {{0.01, 0.01, 0.01}, {500000, 4800000, 0}});
        ASSERT_EQ(pcmlab("build --chunk-points 1000 " + path("in.las")).code, 0);
        radii_.tree = folder_ / "in.pct";
        radii_.neighbours = 6;
    }

    // The program looks for its helper beside itself: that of the tests lies beside that of the tests' command.
    Result start() const
    {
        const auto out = folder_ / "out.txt", err = folder_ / "err.txt";
        const pid_t child = fork();
        if (child == 0) {
            dup2(open(out.c_str(), O_CREAT | O_WRONLY | O_TRUNC, 0600), STDOUT_FILENO);
            dup2(open(err.c_str(), O_CREAT | O_WRONLY | O_TRUNC, 0600), STDERR_FILENO);
            try {
                cli::start_gpu_radii(radii_);
            } catch (...) {
                _exit(99);
            }
        }
        int status = 0;
        waitpid(child, &status, 0);
        const auto text = [](const std::filesystem::path& file) {
            std::ifstream stream(file);
            return std::string(std::istreambuf_iterator<char>(stream), {});
        };
        return {WEXITSTATUS(status), text(out), text(err)};
    }

    // Of the point that is computed first, if the tree has one.
    static std::optional<double> radius_of(const std::filesystem::path& tree)
    {
        const auto cloud = PointCloud::open(tree);
        if (!cloud->info().schema.find("radius")) return {};
        Query query;
        query.attributes = {"radius"};
        auto cursor = cloud->points(query);
        PointView view;
        cursor.getNextData(view);
        const auto neighbours = cloud->nearest(view.position(0), 7);
        EXPECT_NEAR(view.value(0, 0), neighbours.points.back().distance(), 1e-5 * view.value(0, 0));
        return view.value(0, 0);
    }

    cli::GpuRadii radii_;
};

#define PCM_REQUIRE_COMPUTE(result)                                   \
    if (result.err.find("no OpenGL context") != std::string::npos ||  \
        result.err.find("compute shaders need") != std::string::npos) \
    GTEST_SKIP() << result.err

TEST_F(GpuRadiiCommand, WritesACopyAndReportsIt)
{
    radii_.target.copy = folder_ / "-o.pct";  // no option
    radii_.json = true;
    const Result result = start();
    PCM_REQUIRE_COMPUTE(result);
    ASSERT_EQ(result.code, 0) << result.err;
    const Json json = Json::parse(result.out);
    EXPECT_EQ(json["tree"], radii_.target.copy.string());
    EXPECT_EQ(json["points"], 3000);
    EXPECT_EQ(json["used_known_normals"], false);
    EXPECT_TRUE(radius_of(radii_.target.copy));
    EXPECT_FALSE(radius_of(radii_.tree));
    EXPECT_EQ(pcmlab("verify " + path("-o.pct")).code, 0);
}

TEST_F(GpuRadiiCommand, InPlaceAcrossTheNormalsOfTheTree)
{
    ASSERT_EQ(pcmlab("set " + path("in.pct") + " --new normal:f32x3 normal=0,0,1").code, 0);
    radii_.target.in_place = true;
    const Result result = start();
    PCM_REQUIRE_COMPUTE(result);
    ASSERT_EQ(result.code, 0) << result.err;
    EXPECT_NE(result.out.find("across the normals"), std::string::npos) << result.out;
    EXPECT_NE(result.out.find("3,000 points"), std::string::npos) << result.out;
    EXPECT_TRUE(Tree::open(radii_.tree)->info().schema.find("radius"));
}

TEST_F(GpuRadiiCommand, AnErrorLeavesNoCopyAndNoChange)
{
    ASSERT_EQ(pcmlab("set " + path("in.pct") + " --new radius:u8").code, 0);
    const auto generation = Tree::open(radii_.tree)->info().generation;
    for (const bool in_place : {false, true}) {
        radii_.target.copy = in_place ? "" : folder_ / "copy.pct";
        radii_.target.in_place = in_place;
        const Result result = start();
        PCM_REQUIRE_COMPUTE(result);
        EXPECT_EQ(result.code, 1);
        EXPECT_NE(result.err.find("'radius'"), std::string::npos) << result.err;
    }
    EXPECT_FALSE(std::filesystem::exists(folder_ / "copy.pct"));
    EXPECT_EQ(Tree::open(radii_.tree)->info().generation, generation);
    radii_.target = {};
    EXPECT_NE(start().code, 0);  // neither a copy nor in place
}

}  // namespace

#endif
