// pcmlab query as a user meets it, against brute force over the points.

#include "pcm/cloud/region.h"
#include "tests/cli/command.h"

#include <algorithm>
#include <cmath>

namespace {

using namespace pcm::test;

class QueryCommand : public CommandTest {
protected:
    void SetUp() override
    {
        points_ = records(Shape::surface, 20000, 4);
        write_las(folder_ / "in.las", points_, {{0.01, 0.01, 0.01}, {0, 0, 0}});
        ASSERT_EQ(pcmlab("build --chunk-points 1000 " + path("in.las")).code, 0);
    }
    Json ask(const std::string& arguments)
    {
        const Result result = pcmlab("query --json " + path("in.pct") + " " + arguments);
        EXPECT_EQ(result.code, 0) << result.err;
        return result.code == 0 ? Json::parse(result.out) : Json();
    }
    static ::pcm::Vec3d position(const LasRecord& p) { return {p.x * 0.01, p.y * 0.01, p.z * 0.01}; }
    std::size_t expected(const std::string& region) const
    {
        const ::pcm::Region chosen = ::pcm::parse_region(region);
        return static_cast<std::size_t>(std::count_if(
            points_.begin(), points_.end(), [&](const LasRecord& p) { return chosen.contains(position(p)); }));
    }
    std::vector<LasRecord> points_;
};

TEST_F(QueryCommand, CountsAndEstimatesRegions)
{
    for (const std::string region :
         {"sphere 500 300 90 60", "oriented-box 500 300 100 200 20 60 30", "cone 0 0 0 1 0.5 0.2 10",
          "ray 0 300 70 1 0 0.1 30 800", "frustum 500 300 400 500 300 0 30 1 1 1000 0 1 0"}) {
        const std::size_t wanted = expected(region);
        EXPECT_GT(wanted, 0u) << region;
        const Json counted = ask("--" + region);
        EXPECT_EQ(counted["points"], wanted) << region;
        EXPECT_EQ(counted["spacing"], 0);
        EXPECT_LT(counted["points_read"], 20000);
        EXPECT_GT(counted["bytes_read"], 0);
        EXPECT_EQ(ask("--count --region '" + region + "' --reads 1")["points"], wanted);
        for (const std::string how : {"", " --headers"}) {
            const Json estimate = ask("--estimate --" + region + how);
            EXPECT_LE(estimate["points_least"], wanted);
            EXPECT_GE(estimate["points_most"], wanted);
            EXPECT_GE(estimate["bytes"].get<double>() + estimate["bytes_read"].get<double>(), counted["bytes_read"])
                << "both read the index";
            EXPECT_TRUE(estimate["seconds_expected"].is_null());
        }
    }
    EXPECT_EQ(ask("")["points"], 20000);
    EXPECT_EQ(ask("--box 0 0 -1e9 1e9 1e9 1e9 --where 'intensity<30000'")["points"],
              std::count_if(points_.begin(), points_.end(), [](const LasRecord& p) { return p.intensity < 30000; }));
    const Json level = ask("--level 0");
    EXPECT_LT(level["points"], 20000);
    EXPECT_GT(level["spacing"], 0);
    const Result text = pcmlab("query " + path("in.pct") + " --sphere 500 300 90 60");
    EXPECT_NE(text.out.find(std::to_string(expected("sphere 500 300 90 60")) + " points"), std::string::npos)
        << text.out;
    EXPECT_NE(text.out.find("exact"), std::string::npos);
    EXPECT_NE(pcmlab("query " + path("in.pct") + " --estimate").out.find("from 20,000 to 20,000"), std::string::npos);
}

TEST_F(QueryCommand, AnAnswerWithoutPointsSaysWhereTheCloudIs)
{
    ::pcm::Box3d cloud;
    for (const LasRecord& p : points_) cloud.extend(position(p));
    const auto near = [](const Json& a, const ::pcm::Vec3d& b) {
        for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(a[k].get<double>(), b[k], 1e-9);
    };
    const Json nothing = ask("--box 5e5 0 0 6e5 1 1");
    EXPECT_EQ(nothing["points"], 0);
    EXPECT_TRUE(nothing["bounds"].is_null());
    near(nothing["tree_bounds"]["min"], cloud.min);
    near(nothing["tree_bounds"]["max"], cloud.max);
    const auto says_where = [](const Result& result) {
        return result.code == 0 && result.out.find("the cloud's points lie from ") != std::string::npos;
    };
    const std::string tree = path("in.pct"), nowhere = " --sphere 5e5 0 0 1";
    for (const std::string& command :
         {"query " + tree + nowhere, "query " + tree + nowhere + " --estimate",
          "query " + tree + " --nearest 5e5 0 0 --max-distance 1",
          "query " + tree + " --first-hit --ray 5e5 0 0 1 0 0 1", "delete " + tree + nowhere,
          "delete --count " + tree + nowhere, "set " + tree + " intensity=1" + nowhere})
        EXPECT_TRUE(says_where(pcmlab(command))) << command << pcmlab(command).out;
    const std::string somewhere = " --sphere 500 300 90 60";
    for (const std::string& command : {"query " + tree + somewhere, "query " + tree + somewhere + " --estimate",
                                       "query " + tree + " --nearest 1 2 3", "set " + tree + " intensity=1" + somewhere,
                                       "delete " + tree + somewhere})
        EXPECT_FALSE(says_where(pcmlab(command))) << command << pcmlab(command).out;
}

TEST_F(QueryCommand, BoxesThatHoldNothingAreRefused)
{
    for (const std::string& box : {"--box 2 0 0 1 1 1", "--box 0 nan 0 1 1 1", "--region 'box 0 0 5 1 1 1'"})
        for (const std::string& command :
             {"query " + path("in.pct"), "delete " + path("in.pct"), "set " + path("in.pct") + " intensity=1",
              "convert " + path("in.pct") + " " + path("out.las")}) {
            const Result result = pcmlab(command + " " + box);
            EXPECT_EQ(result.code, 1) << command << " " << box;
            EXPECT_NE(result.err.find("no point can be in the box: along "), std::string::npos) << result.err;
        }
}

TEST_F(QueryCommand, FindsNeighboursAndHits)
{
    const ::pcm::Vec3d q = {512.3, 301.7, 88};
    std::vector<double> distances;
    for (const LasRecord& p : points_) {
        const ::pcm::Vec3d at = position(p);
        distances.push_back(std::hypot(at[0] - q[0], at[1] - q[1], at[2] - q[2]));
    }
    std::sort(distances.begin(), distances.end());
    const Json found = ask("--nearest 512.3 301.7 88 -k 8");
    ASSERT_EQ(found["neighbours"].size(), 8u);
    for (std::size_t i = 0; i < 8; ++i)
        EXPECT_NEAR(found["neighbours"][i]["distance"].get<double>(), distances[i], 1e-9);
    EXPECT_EQ(found["error"], 0);
    const Json coarse = ask("--nearest 512.3 301.7 88 --level 0");
    EXPECT_GE(coarse["neighbours"][0]["distance"].get<double>(), distances[0] - 1e-9);
    EXPECT_LE(coarse["neighbours"][0]["distance"].get<double>() - distances[0], coarse["error"].get<double>() + 1e-9);
    EXPECT_EQ(
        ask("--nearest 512.3 301.7 88 -k 99 --max-distance 5")["neighbours"].size(),
        static_cast<std::size_t>(std::count_if(distances.begin(), distances.end(), [](double d) { return d <= 5; })));

    const ::pcm::Region beam = ::pcm::parse_region("cone 500 300 900 0 0 -1 1");
    double first = 1e9;
    for (const LasRecord& p : points_)
        if (beam.contains(position(p))) first = std::min(first, beam.along(position(p)));
    EXPECT_EQ(ask("--first-hit --cone 500 300 900 0 0 -1 1")["hit"]["along"], first);
    EXPECT_TRUE(ask("--first-hit --ray 500 300 900 0 0 1 1")["hit"].is_null());
}

TEST_F(QueryCommand, SaysWhatIsWrong)
{
    const auto refused = [&](const std::string& arguments, int code, const std::string& part) {
        const Result result = pcmlab("query " + path("in.pct") + " " + arguments);
        EXPECT_EQ(result.code, code) << arguments;
        EXPECT_NE(result.err.find(part), std::string::npos) << result.err;
    };
    refused("--level 99", 1, "levels 0 to");
    refused("--sphere 1 2 3 -4", 1, "radius is -4");
    refused("--sphere 1 2 3", 2, "sphere");
    refused("--sphere 1 2 3 x", 2, "'x' is not a number");
    refused("--sphere 1 2 3 4 --ray 0 0 0 1 0 0 1", 1, "one region");
    refused("--first-hit", 1, "--ray or --cone");
    refused("--first-hit --sphere 1 2 3 4", 1, "--ray or --cone");
    refused("--nearest 1 2 3 --count", 1, "cannot be combined");
    refused("--nearest 1 2 nan", 1, "not finite");
    refused("--nearest 1 2 3 --sphere 1 2 3 4", 1, "whole cloud");
    refused("-k 3", 2, "--nearest");
    refused("--headers", 1, "--estimate");
    refused("--where 'colour=3'", 1, "no attribute 'colour'");
    EXPECT_EQ(pcmlab("query " + path("in.las")).code, 1);
    EXPECT_NE(pcmlab("query " + path("nothing.pct")).err.find("no such tree"), std::string::npos);
}

}  // namespace
