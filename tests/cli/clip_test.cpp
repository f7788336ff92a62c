// --clip and --clip-outside, wherever points are chosen, against brute force over the points.

#include "pcm/cloud/clip.h"
#include "tests/cli/command.h"

#include <algorithm>

namespace {

using namespace pcm::test;

class ClipOptions : public CommandTest {
protected:
    void SetUp() override
    {
        points_ = records(Shape::surface, 20000, 4);
        write_las(folder_ / "in.las", points_, {{0.01, 0.01, 0.01}, {0, 0, 0}});
        ASSERT_EQ(pcmlab("build --chunk-points 1000 " + path("in.las")).code, 0);
        const ::pcm::Region sphere = ::pcm::parse_region("sphere 500 300 90 300"),
                            polygon = ::pcm::parse_region("polygon 300 100 700 100 500 600"),
                            hole = ::pcm::parse_region("sphere 500 300 90 60");
        wanted_ = static_cast<std::size_t>(std::count_if(points_.begin(), points_.end(), [&](const LasRecord& record) {
            const ::pcm::Vec3d p{record.x * 0.01, record.y * 0.01, record.z * 0.01};
            return sphere.contains(p) && polygon.contains(p) && !hole.contains(p);
        }));
        ASSERT_GT(wanted_, 100u);
    }
    Json run(const std::string& command)
    {
        const Result result = pcmlab(command);
        EXPECT_EQ(result.code, 0) << result.err;
        return result.code == 0 ? Json::parse(result.out) : Json();
    }
    std::vector<LasRecord> points_;
    std::size_t wanted_ = 0;
    const std::string options_ =
        " --json --sphere 500 300 90 300 --clip 'polygon 300 100 700 100 500 600' "
        "--clip-outside 'sphere 500 300 90 60'";
};

TEST_F(ClipOptions, HoldInEveryCommandThatChoosesPoints)
{
    EXPECT_EQ(run("query " + path("in.pct") + options_)["points"], wanted_);
    EXPECT_LT(run("query " + path("in.pct") + options_)["points_read"], 20000);
    EXPECT_EQ(run("convert " + path("in.pct") + " " + path("tree.ply") + options_)["points"], wanted_);
    EXPECT_EQ(run("convert " + path("in.las") + " " + path("file.ply") + options_)["points"], wanted_);
    EXPECT_EQ(run("set " + path("in.pct") + " intensity=7" + options_)["points_set"], wanted_);
    EXPECT_EQ(run("delete " + path("in.pct") + options_)["points_deleted"], wanted_);
    EXPECT_EQ(run("query --json " + path("in.pct"))["points"], 20000 - wanted_);
}

// Each value goes to its own attribute, whatever the order in the schema.
TEST_F(ClipOptions, SeveralAttributesAreSetAtOnce)
{
    const auto with = [&](const std::string& where) {
        return run("query --json --where " + where + " " + path("in.pct"))["points"].get<std::size_t>();
    };
    run("set --json " + path("in.pct") + " user_data=41 intensity=4242 classification=17 point_source_id=999");
    for (const char* where : {"user_data=41", "intensity=4242", "classification=17", "point_source_id=999"})
        EXPECT_EQ(with(where), 20000u) << where;
}

// A clip alone chooses points, too.
TEST_F(ClipOptions, AClipAloneChoosesPoints)
{
    const Json all = run("query --json --clip 'sphere 500 300 90 60' " + path("in.pct")),
               rest = run("query --json --clip-outside 'sphere 500 300 90 60' " + path("in.pct"));
    EXPECT_GT(all["points"], 0);
    EXPECT_EQ(all["points"].get<std::size_t>() + rest["points"].get<std::size_t>(), 20000u);
    EXPECT_EQ(run("delete --json --clip-outside 'sphere 500 300 90 60' " + path("in.pct"))["points_deleted"],
              rest["points"]);
    const Result bad = pcmlab("query --clip 'ball 1 2 3 4' " + path("in.pct"));
    EXPECT_EQ(bad.code, 1);
    EXPECT_NE(bad.err.find("'ball' is not a known shape"), std::string::npos) << bad.err;
}

}  // namespace
