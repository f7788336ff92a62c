// Growth from a point, limited by what the points have in common with it, against a search through all pairs.

#include "pcm/select/grow_from.h"

#include "pcm/build/builder.h"
#include "pcm/select/select_points.h"
#include "pcm/system/error.h"
#include "pcm/tree/source_rounding.h"
#include "tests/memory_reader.h"
#include "tests/sanitizers.h"
#include "tests/support.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace {

using namespace pcm;
using namespace pcm::test;

struct Known {
    NodeId node;
    std::uint32_t number;
    Vec3d position, normal, colour;
};

double degrees_between(const Vec3d& a, const Vec3d& b)
{
    return std::acos(std::min(1.0, std::fabs(dot(a, b)) / (length(a) * length(b)))) * 180 / pi;
}

class GrowFrom : public testing::Test {
protected:
    // Points at random in a cube at map coordinates, with normals and colours of a few kinds, so that limits cut often.
    // `levels` is the largest raw colour.
    void make(ScalarType colour, double levels, std::size_t count = 4000)
    {
        Schema schema;
        schema.add({"normal", ScalarType::f32, 3, 1, 0, {}});
        schema.add({"rgb", colour, 3, 1, 0, {}});
        Grid grid;
        grid.scale = {0.001, 0.001, 0.001};
        grid.offset = {512345, 4812345, 100};
        MemoryCloud cloud = random_cloud(schema, grid, count, 5, 10);
        std::mt19937_64 random(7);
        const auto unit = [&] { return static_cast<double>(random() % 10001) / 10000; };
        for (std::size_t i = 0; i < count; ++i) {
            const bool has_normal = random() % 400 > 0;
            const double lean = 0.3 * static_cast<double>(random() % 5), sign = random() % 2 ? 1 : -1;
            for (std::size_t c = 0; c < 3; ++c) {
                const double n = sign * (c == 2 ? std::cos(lean) : c == 1 ? std::sin(lean) : 0.02 * unit());
                cloud.points.attributes[0].as<float>()[3 * i + c] = has_normal ? static_cast<float>(2 * n) : 0.0f;
                const double level = levels * (0.25 * static_cast<double>(random() % 3) + 0.5 * unit());
                if (colour == ScalarType::u8)
                    cloud.points.attributes[1].as<std::uint8_t>()[3 * i + c] = static_cast<std::uint8_t>(level);
                else
                    cloud.points.attributes[1].as<std::uint16_t>()[3 * i + c] = static_cast<std::uint16_t>(level);
            }
        }
        BuildOptions options;
        options.chunk_points = 1000;
        options.overwrite = true;
        MemoryReader reader(cloud);
        build_tree(reader, {"memory"}, folder_ / "cloud.pct", options);
        tree_ = Tree::open(folder_ / "cloud.pct");
        points_.clear();
        const SourceRounding rounding(tree_->info());
        for (NodeId node = 0; node < tree_->nodes().size(); ++node) {
            const Chunk chunk = tree_->read_chunk(node, ColumnSet::all(tree_->info().schema));
            for (std::uint32_t i = 0; i < chunk.points; ++i) {
                Known point{node, i, rounding(tree_->info().grid.to_source(chunk.positions->grid(i))), {}, {}};
                for (std::uint32_t c = 0; c < 3; ++c) {
                    point.normal[c] = chunk.attributes[0]->value(i, c);
                    point.colour[c] = chunk.attributes[1]->value(i, c);
                }
                points_.push_back(point);
            }
        }
    }

    // The points that all pairs of allowed points reach.
    std::vector<bool> by_all_pairs(std::size_t seed, double distance, const std::vector<bool>& allowed) const
    {
        std::vector<bool> reached(points_.size(), false);
        std::vector<std::size_t> next;
        if (allowed[seed]) next.push_back(seed);
        if (allowed[seed]) reached[seed] = true;
        while (!next.empty()) {
            const std::size_t i = next.back();
            next.pop_back();
            for (std::size_t j = 0; j < points_.size(); ++j)
                if (!reached[j] && allowed[j] &&
                    squared_distance(points_[i].position, points_[j].position) <= distance * distance) {
                    reached[j] = true;
                    next.push_back(j);
                }
        }
        return reached;
    }

    // Returns how many points are reached.
    std::size_t check(std::size_t seed, double distance, const SeedLimits& limits, double colour_step,
                      const GrowOptions& options = {})
    {
        std::vector<bool> allowed(points_.size());
        const Known& from = points_[seed];
        for (std::size_t i = 0; i < points_.size(); ++i) {
            const Known& p = points_[i];
            const bool has_normal = length(p.normal) > 0;
            allowed[i] =
                (!limits.normal_angle || (i == seed || (has_normal && degrees_between(p.normal, from.normal) <=
                                                                          *limits.normal_angle * 180 / pi))) &&
                (!limits.colour_difference ||
                 colour_step * length(p.colour - from.colour) <= *limits.colour_difference) &&
                (!limits.within || squared_distance(p.position, from.position) <= *limits.within * *limits.within) &&
                (!options.limit.box || options.limit.box->contains(p.position));
        }
        const auto wanted = by_all_pairs(seed, distance, allowed);
        const PointSet found = grow_from(tree_, from.node, from.number, distance, limits, options);
        std::size_t count = 0;
        for (std::size_t i = 0; i < points_.size(); ++i) {
            EXPECT_EQ(found.contains(points_[i].node, points_[i].number), wanted[i]) << "point " << i;
            count += wanted[i];
        }
        EXPECT_EQ(found.size(), count);
        return count;
    }
    std::size_t seed_with_normal(std::size_t from = 0) const
    {
        while (length(points_[from].normal) == 0) ++from;
        return from;
    }

    TemporaryFolder folder_;
    std::shared_ptr<const Tree> tree_;
    std::vector<Known> points_;
};

// Not under the thread sanitizer: its threads are those that other tests of the room watch.
TEST_F(GrowFrom, PCM_NOT_UNDER_THREAD(LimitsCompareWithTheSeed))
{
    make(ScalarType::u8, 255);
    SeedLimits all;
    all.normal_angle = 0.35;
    all.colour_difference = 150;
    all.within = 9;
    const SeedLimits none;
    std::size_t partly = 0;
    for (const std::size_t at : {std::size_t(0), std::size_t(700), std::size_t(2100)}) {
        const std::size_t seed = seed_with_normal(at);
        const std::size_t free = check(seed, 2, none, 1);
        for (int which = 1; which < 8; ++which) {
            SeedLimits limits;
            if (which & 1) limits.normal_angle = all.normal_angle;
            if (which & 2) limits.colour_difference = all.colour_difference;
            if (which & 4) limits.within = all.within;
            GrowOptions options;
            options.threads = 1 + static_cast<unsigned>(which % 3);
            options.memory_bytes = which % 2 ? 1 : std::uint64_t(256) << 20;
            const std::size_t some = check(seed, 2, limits, 1, options);
            partly += some > 5 && some < free / 2;
        }
    }
    EXPECT_GT(partly, 8u);
}

TEST_F(GrowFrom, KeepsTheOptionsOfGrowing)
{
    make(ScalarType::u8, 255);
    SeedLimits limits;
    limits.colour_difference = 200;
    GrowOptions options;
    const std::size_t seed = seed_with_normal();
    options.limit.box = Box3d{points_[seed].position - Vec3d{6, 6, 6}, points_[seed].position + Vec3d{3, 6, 6}};
    EXPECT_GT(check(seed, 2.5, limits, 1, options), 5u);
    options.limit.box = Box3d{{0, 0, 0}, {1, 1, 1}};  // without the seed
    EXPECT_EQ(check(seed, 2.5, limits, 1, options), 0u);
    int calls = 0;
    options.limit.box.reset();
    options.progress = [&](const ProgressUpdate&) { return ++calls < 1; };
    EXPECT_THROW(grow_from(tree_, points_[seed].node, points_[seed].number, 2.5, limits, options), Error);
}

// 16-bit colours of 0 to 65535, and those that hold no more than 255.
TEST_F(GrowFrom, ColoursOfTwoBytes)
{
    for (const double levels : {65535.0, 255.0}) {
        make(ScalarType::u16, levels, 1500);
        SeedLimits limits;
        limits.colour_difference = 110;
        const std::size_t some = check(3, 3, limits, levels == 255 ? 1 : 255.0 / 65535);
        EXPECT_GT(some, 5u) << levels;
        EXPECT_LT(some, 1200u) << levels;
    }
}

TEST_F(GrowFrom, NoAngleAndNoDifferenceReachTheSeed)
{
    make(ScalarType::u8, 255, 500);
    SeedLimits limits;
    limits.normal_angle = 0;
    limits.colour_difference = 0;
    limits.within = 0;
    const std::size_t seed = seed_with_normal(40);
    EXPECT_GE(check(seed, 100, limits, 1), 1u);
}

TEST_F(GrowFrom, RefusesWhatMakesNoSense)
{
    make(ScalarType::u8, 255, 2000);
    const std::size_t seed = seed_with_normal();
    const auto refused = [&](const SeedLimits& limits, const char* part, std::size_t from) {
        try {
            grow_from(tree_, points_[from].node, points_[from].number, 1, limits);
            ADD_FAILURE() << part;
        } catch (const Error& error) {
            EXPECT_EQ(error.code(), ErrorCode::invalid_argument);
            EXPECT_NE(std::string(error.what()).find(part), std::string::npos) << error.what();
        }
    };
    for (const double bad : {-0.1, 1.6, std::nan("")}) refused({bad, {}, {}}, "angle between normals", seed);
    for (const double bad : {-1.0, 442.0, std::nan("")}) refused({{}, bad, {}}, "difference of colours", seed);
    for (const double bad : {-1.0, std::nan(""), HUGE_VAL}) refused({{}, {}, bad}, "distance from the seed", seed);
    std::size_t without = 0;
    while (without < points_.size() && length(points_[without].normal) > 0) ++without;
    ASSERT_LT(without, points_.size());
    refused({0.3, {}, {}}, "has no normal", without);
    EXPECT_THROW(grow_from(tree_, 0, 1u << 30, 1, {}), Error);
    EXPECT_THROW(grow_from(tree_, NodeId(1) << 30, 0, 1, {}), Error);

    MemoryCloud plain = random_cloud({}, Grid{{0.001, 0.001, 0.001}, {0, 0, 0}}, 100, 1, 10);
    MemoryReader reader(plain);
    build_tree(reader, {"memory"}, folder_ / "plain.pct", {});
    tree_ = Tree::open(folder_ / "plain.pct");
    points_[seed].node = 0;
    points_[seed].number = 0;
    refused({0.3, {}, {}}, "has no normals", seed);
    refused({{}, 10, {}}, "has no colours", seed);
    EXPECT_GE(grow_from(tree_, 0, 0, 1, {{}, {}, 5}).size(), 1u);
}

TEST_F(GrowFrom, NearlyAllOfTheCloudIsSaid)
{
    make(ScalarType::u8, 255, 1000);
    PointSet all = select_points(tree_, {});
    EXPECT_NE(note_on_growth(all).find("all 1,000 points"), std::string::npos) << note_on_growth(all);
    PointSet most(tree_), some(tree_);
    for (std::size_t i = 0; i < points_.size(); ++i) {
        if (i < 951) most.combine(SetOperation::add, points_[i].node, {points_[i].number});
        if (i < 940) some.combine(SetOperation::add, points_[i].node, {points_[i].number});
    }
    EXPECT_NE(note_on_growth(most).find("951 of 1,000"), std::string::npos) << note_on_growth(most);
    EXPECT_EQ(note_on_growth(some), "");
    EXPECT_EQ(note_on_growth(PointSet(tree_)), "");
}

}  // namespace
