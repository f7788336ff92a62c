// Profiles against a test of every point.
#include "pcm/measure/profile.h"

#include "pcm/cad/dxf_file.h"
#include "pcm/system/error.h"
#include "tests/measure/measured_tree.h"
#include "tests/outcome.h"

#include <algorithm>
#include <fstream>
#include <iterator>
#include <limits>
#include <random>
#include <set>

namespace {

using namespace pcm;
using namespace pcm::test;

const Vec3d origin{500000, 4800000, 100};

class Profile : public testing::Test {
protected:
    void SetUp() override
    {
        std::mt19937_64 random(11);
        std::uniform_real_distribution<double> unit(0, 100);
        for (int i = 0; i < 40000; ++i)
            points_.push_back({origin[0] + unit(random), origin[1] + unit(random), origin[2] + unit(random) / 10});
        cloud_ = measured_tree(folder_, "a", points_, origin);
        // As the tree has them.
        points_.clear();
        auto cursor = cloud_->points();
        for (PointView view; cursor.getNextData(view);)
            for (std::size_t i = 0; i < view.size(); ++i) points_.push_back(view.position(i));
    }

    // Station and offset by long double, from the definition: the nearest segment, the first of equals.
    static bool locate(const std::vector<Vec3d>& line, const Vec3d& p, double width, long double& station,
                       long double& offset)
    {
        long double best = std::numeric_limits<long double>::infinity(), before = 0;
        bool inside = false;
        for (std::size_t k = 0; k + 1 < line.size(); ++k) {
            const long double ux = (long double)(line[k + 1][0]) - line[k][0],
                              uy = (long double)(line[k + 1][1]) - line[k][1];
            const long double size = std::sqrt(ux * ux + uy * uy);
            const long double dx = (long double)(p[0]) - line[k][0], dy = (long double)(p[1]) - line[k][1];
            const long double along = (ux * dx + uy * dy) / size, right = (uy * dx - ux * dy) / size;
            const long double t = std::min(std::max(along, 0.0L), size);
            const long double distance = std::sqrt((along - t) * (along - t) + right * right);
            if (distance < best - 1e-12L) {
                best = distance;
                station = before + t;
                bool is_right = right >= 0;
                if (along > size && k + 2 < line.size())  // nearest to a corner
                    is_right = ux * ((long double)(line[k + 2][1]) - line[k + 1][1]) -
                                   uy * ((long double)(line[k + 2][0]) - line[k + 1][0]) >
                               0;
                offset = is_right ? distance : -distance;
                inside = !(k == 0 && along < 0) && !(k + 2 == line.size() && along > size);
            }
            before += size;
        }
        return inside && best <= width / 2.0L;
    }

    std::vector<ProfilePoint> visit(const ProfileOptions& options)
    {
        std::vector<ProfilePoint> found;
        const Stopwatch watch;
        const Outcome outcome =
            visit_profile(*cloud_, options, [&](const ProfilePoint& point, const PointView& view, std::size_t i) {
                EXPECT_EQ(view.position(i), point.position);
                found.push_back(point);
            });
        EXPECT_EQ(outcome.points_out, found.size());
        EXPECT_GE(outcome.points_in, found.size());
        expect_outcome(outcome, outcome.points_in, found.size(), watch);
        return found;
    }

    TemporaryFolder folder_;
    std::vector<Vec3d> points_;
    std::shared_ptr<PointCloud> cloud_;
};

TEST_F(Profile, IsEveryPointNearTheLineOnce)
{
    const std::vector<std::vector<Vec3d>> lines{
        {{10, 10, 0}, {90, 80, 0}},
        {{10, 20, 0}, {50, 60, 0}, {90, 20, 5}},
        {{10, 20, 0}, {60, 20, 0}, {60, 20, 9}, {20, 22, 0}},               // nearly back, with a point twice
        {{10, 10, 0}, {80, 10, 0}, {80, 80, 0}, {10, 80, 0}, {10, 12, 0}},  // nearly closed
        {{-50, 50, 0}, {150, 51, 0}},
    };
    for (std::vector<Vec3d> line : lines) {
        for (Vec3d& p : line) p = p + origin;
        for (const double width : {0.3, 4.0, 25.0}) {
            ProfileOptions options;
            options.line = line;
            options.width = width;
            std::vector<ProfilePoint> found = visit(options);
            const auto by_place = [](const auto& a, const auto& b) { return a.position < b.position; };
            std::sort(found.begin(), found.end(), by_place);
            std::vector<ProfilePoint> expected;
            std::vector<Vec3d> used;
            for (const Vec3d& p : line)
                if (used.empty() || p[0] != used.back()[0] || p[1] != used.back()[1]) used.push_back(p);
            for (const Vec3d& p : points_) {
                long double station = 0, offset = 0;
                if (locate(used, p, width, station, offset))
                    expected.push_back({double(station), double(offset), p, 0});
            }
            std::sort(expected.begin(), expected.end(), by_place);
            ASSERT_EQ(found.size(), expected.size()) << width;
            ASSERT_GT(found.size(), 0u);
            for (std::size_t i = 0; i < found.size(); ++i) {
                ASSERT_EQ(found[i].position, expected[i].position);
                EXPECT_NEAR(found[i].station, expected[i].station, 1e-9);
                EXPECT_NEAR(found[i].offset, expected[i].offset, 1e-9);
            }
        }
    }
}

TEST_F(Profile, OffsetsAreRightOfTheLine)
{
    const ProfileLine line({{0, 0, 0}, {0, 10, 0}});
    EXPECT_EQ(line.locate({3, 4, 9})->offset, 3);
    EXPECT_EQ(line.locate({-3, 4, 9})->offset, -3);
    EXPECT_EQ(line.locate({-3, 4, 9})->station, 4);
    EXPECT_FALSE(line.locate({0, -0.001, 0}));
    EXPECT_FALSE(line.locate({0, 10.001, 0}));
    EXPECT_TRUE(line.locate({0, 10, 0}));
    EXPECT_EQ(line.length(), 10);
}

TEST_F(Profile, HeightsConditionsClipsAndLevels)
{
    ProfileOptions options;
    options.line = {origin + Vec3d{0, 50, 0}, origin + Vec3d{100, 50, 0}};
    options.width = 10;
    const std::size_t all = visit(options).size();
    options.lowest = 103;
    options.highest = 104.5;
    const std::vector<ProfilePoint> between = visit(options);
    EXPECT_LT(between.size(), all / 4);
    EXPECT_GT(between.size(), all / 10);
    for (const ProfilePoint& point : between) {
        EXPECT_GE(point.position[2], 103);
        EXPECT_LE(point.position[2], 104.5);
    }
    options.lowest.reset();
    for (const ProfilePoint& point : visit(options)) EXPECT_LE(point.position[2], 104.5);
    options.highest.reset();
    options.where = {parse_condition("intensity<500")};
    const std::size_t half = visit(options).size();
    EXPECT_NEAR(static_cast<double>(half), static_cast<double>(all) / 2, static_cast<double>(all) / 20);
    options.where.clear();
    options.clips = {{Region::sphere(origin + Vec3d{50, 50, 5}, 20), true}};
    for (const ProfilePoint& point : visit(options))
        EXPECT_GT(length(point.position - (origin + Vec3d{50, 50, 5})), 20);
    options.clips.clear();
    options.level = 1;
    const Outcome outcome = visit_profile(*cloud_, options, [](const ProfilePoint&, const PointView&, std::size_t) {});
    EXPECT_LT(outcome.points_out, all / 4);
    EXPECT_GT(outcome.error, 0);
}

TEST_F(Profile, SampleIsTheFinestLevelThatFits)
{
    ProfileOptions options;
    options.line = {origin + Vec3d{0, 0, 0}, origin + Vec3d{100, 100, 0}};
    options.width = 20;
    options.attributes = {"intensity"};
    const ProfileSample whole = sample_profile(*cloud_, options, 100000);
    EXPECT_FALSE(whole.level);
    EXPECT_EQ(whole.outcome.error, 0);
    EXPECT_EQ(whole.points.size(), visit(options).size());
    ASSERT_EQ(whole.attributes.size(), 1u);
    EXPECT_EQ(whole.attributes[0].size(), whole.points.size());
    for (std::size_t most : {whole.points.size() - 1, whole.points.size() / 5, std::size_t{600}}) {
        const ProfileSample sample = sample_profile(*cloud_, options, most);
        ASSERT_TRUE(sample.level);
        EXPECT_LE(sample.points.size(), most);
        EXPECT_GT(sample.outcome.error, 0);
        // The next finer level has more.
        ProfileOptions finer = options;
        finer.level = static_cast<std::uint16_t>(*sample.level + 1);
        EXPECT_GT(visit(finer).size(), most);
    }
}

TEST_F(Profile, CsvHasAllDigitsAndDrawingsTheProfile)
{
    ProfileOptions options;
    options.line = {origin + Vec3d{0, 50, 0}, origin + Vec3d{100, 50, 0}};
    options.width = 1;
    options.attributes = {"intensity", "rgb"};
    const Outcome outcome = write_profile(*cloud_, options, folder_ / "p.csv");
    std::ifstream file(folder_ / "p.csv");
    std::string row;
    std::getline(file, row);
    EXPECT_EQ(row, "station,offset,x,y,z,intensity,rgb.0,rgb.1,rgb.2\r");
    const std::set<Vec3d> all(points_.begin(), points_.end());
    std::size_t rows = 0;
    while (std::getline(file, row)) {
        std::array<double, 9> n{};
        ASSERT_EQ(std::sscanf(row.c_str(), "%lf,%lf,%lf,%lf,%lf,%lf,%lf,%lf,%lf", &n[0], &n[1], &n[2], &n[3], &n[4],
                              &n[5], &n[6], &n[7], &n[8]),
                  9);
        EXPECT_EQ(all.count({n[2], n[3], n[4]}), 1u);
        EXPECT_NEAR(n[2] - origin[0], n[0], 1e-9);
        EXPECT_NEAR(origin[1] + 50 - n[3], n[1], 1e-9);
        ++rows;
    }
    EXPECT_EQ(rows, outcome.points_out);
    EXPECT_THROW(write_profile(*cloud_, options, folder_ / "p.csv"), Error);
    EXPECT_THROW(write_profile(*cloud_, options, folder_ / "p.txt"), Error);
    ProfileFileOptions overwrite;
    overwrite.overwrite = true;
    EXPECT_EQ(write_profile(*cloud_, options, folder_ / "p.csv", overwrite).points_out, rows);
    if (!writes_dxf()) return;
    options.attributes.clear();
    EXPECT_EQ(write_profile(*cloud_, options, folder_ / "p.dxf").points_out, rows);
    std::ifstream drawing(folder_ / "p.dxf");
    const std::string text{std::istreambuf_iterator<char>(drawing), {}};
    std::size_t count = 0;
    for (std::size_t at = 0; (at = text.find("\nPOINT\n", at)) != std::string::npos; ++at) ++count;
    EXPECT_EQ(count, rows);
}

TEST_F(Profile, WhatIsWrongIsRefused)
{
    const auto refused = [&](const std::function<void(ProfileOptions&)>& change) {
        ProfileOptions options;
        options.line = {origin, origin + Vec3d{10, 0, 0}};
        change(options);
        try {
            visit_profile(*cloud_, options, [](const ProfilePoint&, const PointView&, std::size_t) {});
        } catch (const Error& error) {
            return error.code();
        }
        return ErrorCode::io;
    };
    const double nan = std::numeric_limits<double>::quiet_NaN();
    EXPECT_EQ(refused([](ProfileOptions& o) { o.line.pop_back(); }), ErrorCode::invalid_argument);
    EXPECT_EQ(refused([](ProfileOptions& o) { o.line[1] = o.line[0] + Vec3d{0, 0, 9}; }), ErrorCode::invalid_argument);
    EXPECT_EQ(refused([&](ProfileOptions& o) { o.line[1][0] = nan; }), ErrorCode::invalid_argument);
    EXPECT_EQ(refused([](ProfileOptions& o) { o.width = -1; }), ErrorCode::invalid_argument);
    EXPECT_EQ(refused([&](ProfileOptions& o) { o.width = nan; }), ErrorCode::invalid_argument);
    EXPECT_EQ(refused([&](ProfileOptions& o) { o.lowest = nan; }), ErrorCode::invalid_argument);
    EXPECT_EQ(refused([](ProfileOptions& o) { o.lowest = 3, o.highest = 2; }), ErrorCode::invalid_argument);
    EXPECT_EQ(refused([](ProfileOptions& o) { o.attributes = {"no such"}; }), ErrorCode::invalid_argument);
    EXPECT_EQ(refused([](ProfileOptions& o) { o.progress = [](const ProgressUpdate&) { return false; }; }),
              ErrorCode::cancelled);
}

}  // namespace
