// pcmlab select as a user meets it, against brute force over the points.

#include "pcm/cloud/region.h"
#include "pcm/cloud/vector.h"
#include "tests/cli/command.h"

#include <algorithm>
#include <set>

namespace {

using namespace pcm::test;
using ::pcm::Region;
using ::pcm::Vec3d;

class SelectCommand : public CommandTest {
protected:
    void SetUp() override
    {
        points_ = records(Shape::surface, 10000, 4);
        write_las(folder_ / "in.las", points_, {{0.01, 0.01, 0.01}, {0, 0, 0}});
        ASSERT_EQ(pcmlab("build --chunk-points 1000 " + path("in.las")).code, 0);
    }
    Json select(const std::string& arguments, const std::string& tree = "in.pct")
    {
        const Result result = pcmlab("select --json " + path(tree) + " " + arguments);
        EXPECT_EQ(result.code, 0) << result.err;
        return result.code == 0 ? Json::parse(result.out) : Json();
    }
    void refused(const std::string& arguments, int code, const std::string& part)
    {
        const Result result = pcmlab("select " + path("in.pct") + " " + arguments);
        EXPECT_EQ(result.code, code) << arguments << result.err;
        EXPECT_NE(result.err.find(part), std::string::npos) << arguments << ": " << result.err;
    }
    static Vec3d position(const LasRecord& p) { return {p.x * 0.01, p.y * 0.01, p.z * 0.01}; }
    template <class Wanted>
    std::size_t count(const Wanted& wanted) const
    {
        return static_cast<std::size_t>(std::count_if(points_.begin(), points_.end(), wanted));
    }
    std::vector<LasRecord> points_;
    const std::string sphere_ = "--sphere 500 300 90 100 ";
    const Region region_ = ::pcm::parse_region("sphere 500 300 90 100");
};

TEST_F(SelectCommand, CountsWithBoxAndClasses)
{
    const Json json = select(sphere_ + "--where 'classification<9'");
    ::pcm::Box3d box;
    const auto in = [&](const LasRecord& p) { return region_.contains(position(p)) && (p.classification & 31) < 9; };
    for (const LasRecord& p : points_)
        if (in(p)) box.extend(position(p));
    EXPECT_EQ(json["points"], count(in));
    EXPECT_EQ(json["box"]["min"].get<Vec3d>(), box.min);
    EXPECT_EQ(json["box"]["max"].get<Vec3d>(), box.max);
    EXPECT_EQ(json["classes"]["8"], count([&](const LasRecord& p) { return in(p) && (p.classification & 31) == 8; }));
    EXPECT_TRUE(json["done"].is_null());
    EXPECT_GT(json["peak_memory"], 0);
    EXPECT_EQ(select(sphere_ + "--invert")["points"],
              10000 - count([&](const LasRecord& p) { return region_.contains(position(p)); }));
    const Result text = pcmlab("select " + path("in.pct") + " " + sphere_);
    EXPECT_NE(text.out.find("points selected, from "), std::string::npos) << text.out;
    const Json none = select("--sphere 0 0 90000 1");
    EXPECT_EQ(none["points"], 0);
    EXPECT_TRUE(none["box"].is_null());
}

TEST_F(SelectCommand, BrushesAndGrows)
{
    const auto near = [&](const Vec3d& centre, double radius) {
        return count(
            [&](const LasRecord& p) { return ::pcm::squared_distance(position(p), centre) <= radius * radius; });
    };
    EXPECT_EQ(select("--brush 500 300 98.7 --radius 40")["points"], near({500, 300, 98.7}, 40));
    EXPECT_GE(select("--brush 500 300 98.7 700 300 127 --radius 40")["points"], near({500, 300, 98.7}, 40));
    // Through all of the surface, and no farther than wanted.
    EXPECT_EQ(select("--grow-from 500 300 98 --distance 60")["points"], 10000);
    const Json some = select("--grow-from 500 300 98 --distance 60 --within 50");
    EXPECT_GT(some["points"], 20);
    EXPECT_LT(some["points"], 1000);
    EXPECT_EQ(
        select("--grow-from 300 300 70 --distance 60 --clip-outside 'box 490 -1 -1e9 560 1e9 1e9'")["points"],
        count([&](const LasRecord& p) { return position(p)[0] < 490; }) + (position(points_[0])[0] > 1e9 ? 1 : 0));
    EXPECT_EQ(select("--sphere 500 300 98 50 --grow --distance 60")["points"], 10000);
    refused("--grow-from 500 300 98 --distance 60 --clip-outside 'sphere 500 300 98 50'", 1, "not among");
}

// Exactness is tested in tests/select; here that the options arrive, with degrees and not radians.
TEST_F(SelectCommand, GrowsThroughWhatIsLikeTheSeed)
{
    const Json all = select("--grow-from 500 300 98 --distance 60");
    EXPECT_EQ(all["points"], 10000);
    ASSERT_EQ(all["notes"].size(), 1u);
    EXPECT_NE(all["notes"][0].get<std::string>().find("all 10,000 points of the cloud"), std::string::npos);
    EXPECT_TRUE(select("--grow-from 500 300 98 --distance 60 --within 50")["notes"].empty());
    refused("--grow-from 500 300 98 --distance 60 --normal-angle 20", 1, "has no normals");
    refused("--grow-from 500 300 98 --distance 60 --normal-angle 91", 2, "--normal-angle");
    refused("--grow-from 500 300 98 --distance 60 --colour-difference 442", 2, "--colour-difference");
    refused(sphere_ + "--grow --distance 60 --normal-angle 20", 2, "--grow-from");
    refused(sphere_ + "--grow --distance 60 --colour-difference 20", 2, "--grow-from");

    // Colours at random.
    EXPECT_EQ(select("--grow-from 500 300 98 --distance 60 --colour-difference 441.7")["points"], 10000);
    const double alike = select("--grow-from 500 300 98 --distance 60 --colour-difference 100")["points"];
    EXPECT_GT(alike, 0);
    EXPECT_LT(alike, 5000);

    // A roof whose sides are 53 degrees apart, seen from one of them.
    std::vector<LasRecord> roof = points_;
    for (LasRecord& p : roof) p.z = (p.x < 50000 ? p.x : 100000 - p.x) / 2;
    write_las(folder_ / "roof.las", roof, {{0.01, 0.01, 0.01}, {0, 0, 0}});
    ASSERT_EQ(pcmlab("build " + path("roof.las")).code, 0);
    const Result normals = pcmlab("normals " + path("roof.pct") + " -o " + path("normals.pct"));
    ASSERT_EQ(normals.code, 0) << normals.err;
    const auto within = [&](const std::string& degrees) {
        return select("--grow-from 200 300 100 --distance 60 --normal-angle " + degrees, "normals.pct")["points"]
            .get<double>();
    };
    EXPECT_EQ(within("90"), 10000);
    const double side = static_cast<double>(count([](const LasRecord& p) { return p.x < 50000; }));
    EXPECT_NEAR(within("20"), side, 0.03 * side);
}

// From straight above, orthographic: the surface hides nothing of itself; a lower copy of it would be hidden.
TEST_F(SelectCommand, OfALassoTheFront)
{
    const std::string view = "1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1 0.001 0 0 0 0 0.001 0 0 0 0 -0.001 0 0 0 0 1 500 300 0 ";
    const std::string lasso = "--region 'lasso " + view + "-0.2 -0.2 0.2 -0.2 0.2 0.2 -0.2 0.2' ";
    const auto in = [&](const LasRecord& p) {
        const Vec3d q = position(p);
        return q[0] >= 300 && q[0] < 700 && q[1] >= 100 && q[1] < 500;
    };
    EXPECT_EQ(select(lasso)["points"], count(in));
    EXPECT_EQ(select(lasso + "--front 800 800")["points"], count(in));
    write_las(folder_ / "low.las", points_, {{0.01, 0.01, 0.01}, {0, 0, -200}});
    const Result built = pcmlab("build " + path("in.las") + " " + path("low.las") + " -o " + path("two.pct"));
    ASSERT_EQ(built.code, 0) << built.err;
    EXPECT_EQ(select(lasso, "two.pct")["points"], 2 * count(in));
    const double front = select(lasso + "--front 800 800", "two.pct")["points"];
    EXPECT_LT(front, 1.1 * static_cast<double>(count(in)));
    EXPECT_GE(front, static_cast<double>(count(in)));
    // A condition chooses what is selected, and what hides it.
    EXPECT_EQ(select(lasso + "--front 800 800 --where 'classification<9'")["points"],
              count([&](const LasRecord& p) { return in(p) && (p.classification & 31) < 9; }));
    refused("--sphere 1 2 3 4 --front 800 800", 2, "needs a lasso");
    refused(lasso + "--front 0 800", 1, "1 to 16384");
}

TEST_F(SelectCommand, SavesExtractsClassifiesAndDeletes)
{
    const std::size_t in = count([&](const LasRecord& p) { return region_.contains(position(p)); });
    const Json saved = select(sphere_ + "--save-attribute yard -o " + path("copy.pct"));
    EXPECT_EQ(saved["done"], "saved");
    EXPECT_EQ(saved["points_changed"], in);
    EXPECT_EQ(saved["output"], (folder_ / "copy.pct").string());
    EXPECT_EQ(select("--where yard=1", "copy.pct")["points"], in);
    const Json classified = select("--where yard=1 --classify 77 --in-place", "copy.pct");
    EXPECT_EQ(classified["class"], 77);
    // One number, anywhere in the command line, and the names of LAS; the report says which class that is.
    const Result seven = pcmlab("select " + path("copy.pct") + " --where yard=1 --in-place --classify 7");
    EXPECT_NE(seven.out.find("class 7 'low point (noise)' given to"), std::string::npos) << seven.out;
    EXPECT_EQ(select("--classify 7 --in-place --where yard=1", "copy.pct")["points_changed"], 0);
    EXPECT_EQ(select("--where yard=1 --classify Ground --in-place", "copy.pct")["class"], 2);
    const Result named = pcmlab("select --where yard=1 --classify groud --in-place " + path("copy.pct"));
    EXPECT_EQ(named.code, 1);
    EXPECT_NE(named.err.find("'groud' is neither an integer nor a class"), std::string::npos) << named.err;
    EXPECT_EQ(select("--where yard=1 --classify 77 --in-place", "copy.pct")["points_changed"], in);
    EXPECT_EQ(select("--where classification=77", "copy.pct")["points"],
              count([&](const LasRecord& p) { return region_.contains(position(p)); }));
    EXPECT_EQ(select("--where yard=1 --classify 3 --class-attribute kind --in-place", "copy.pct")["points_changed"],
              in);
    const Json extracted = select(sphere_ + "--extract " + path("part.las"));
    EXPECT_EQ(extracted["points_changed"], in);
    EXPECT_EQ(Json::parse(pcmlab("info --json --scan " + path("part.las")).out)["points"], in);
    EXPECT_EQ(select(sphere_ + "--extract " + path("part.pct"))["points_changed"], in);
    EXPECT_EQ(select("--where 'intensity>=0'", "part.pct")["points"], in);
    EXPECT_EQ(select(sphere_ + "--delete --in-place")["points_changed"], in);
    EXPECT_EQ(select("--where 'intensity>=0'")["points"], 10000 - in);
    for (const char* tree : {"in.pct", "copy.pct", "part.pct"}) EXPECT_EQ(pcmlab("verify " + path(tree)).code, 0);
}

TEST_F(SelectCommand, RefusesWhatMakesNoSense)
{
    refused("", 1, "no points were chosen");
    refused(sphere_ + "--delete", 2, "-o COPY");
    refused(sphere_ + "--delete -o x.pct --in-place", 2, "-o COPY");
    refused(sphere_ + "--delete --classify 3 --in-place", 2, "cannot be combined");
    refused(sphere_ + "--in-place", 2, "are for --save-attribute");
    refused(sphere_ + "--overwrite", 2, "--extract");
    refused("--brush 1 2 3", 2, "--radius");
    refused("--brush 1 2 3 4 --radius 1", 2, "x y z of each point");
    refused("--grow-from 1 2 3", 2, "--distance");
    refused(sphere_ + "--distance 3", 2, "--grow");
    refused(sphere_ + "--within 3", 2, "--grow-from");
    refused(sphere_ + "--level 0 --grow --distance 3", 2, "--level");
    refused(sphere_ + "--classify 2.5 --in-place", 1, "not an integer");
    refused(sphere_ + "--classify 300 --in-place", 1, "cannot be 300");
    refused(sphere_ + "--save-attribute intensity --in-place", 1, "another type");
    refused(sphere_ + "--extract " + path("in.las"), 1, "exists already");
    refused(sphere_ + "--extract " + path("in.pct") + " --overwrite", 1, "the tree itself");
    refused("--sphere 0 0 90000 1 --extract " + path("x.las"), 1, "no point is selected");
    EXPECT_EQ(select("--where 'intensity>=0'")["points"], 10000);
}

}  // namespace
