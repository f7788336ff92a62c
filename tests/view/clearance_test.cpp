// Distances to the nearest points against brute force over all points, with any part of the tree in memory.
#include "pcm/view/clearance.h"

#include "pcm/build/builder.h"
#include "pcm/cloud/vector.h"
#include "pcm/point_cloud.h"
#include "tests/clouds.h"
#include "tests/support.h"
#include "tests/tree/small_tree.h"

#include <cmath>
#include <limits>
#include <random>

namespace {

using namespace pcm;
using namespace pcm::test;

class ClearanceTest : public testing::TestWithParam<Shape> {
protected:
    void SetUp() override
    {
        Grid grid;
        grid.scale = {0.001, 0.001, 0.001};
        grid.offset = {5e6, -4e6, 100};
        write_las(folder_ / "in.las", records(GetParam(), 12000, 7), grid);
        BuildOptions options;
        options.chunk_points = 1000;
        options.threads = 1;
        options.memory_bytes = 64 << 20;
        build_tree({folder_ / "in.las"}, folder_ / "t.pct", options);
        cloud_ = PointCloud::open(folder_ / "t.pct");
        auto cursor = cloud_->points();
        for (PointView view; cursor.getNextData(view);)
            for (std::size_t i = 0; i < view.size(); ++i) points_.push_back(view.position(i));
        const Box3d box = cloud_->info().bounds();
        std::mt19937_64 random(5);
        std::uniform_real_distribution<double> share(-0.5, 1.5);
        for (int i = 0; i < 60; ++i) {
            Vec3d place;
            for (std::size_t a = 0; a < 3; ++a) place[a] = box.min[a] + (box.extent(a) + 1) * share(random);
            places_.push_back(place);
        }
        places_.push_back(points_.front());
    }

    double exact(const Vec3d& place) const
    {
        double best = std::numeric_limits<double>::infinity();
        for (const Vec3d& p : points_) best = std::min(best, length(p - place));
        return best;
    }
    // The spacing of doubles at these coordinates.
    static constexpr double step = 1e-9;

    TemporaryFolder folder_;
    std::shared_ptr<PointCloud> cloud_;
    std::vector<Vec3d> points_;
    std::vector<Vec3d> places_;
};

TEST_P(ClearanceTest, HoldsWithAnyPartInMemory)
{
    read_again_in_pages(folder_ / "t.pct", cloud_);
    L2Cache& cache = cloud_->cache();
    const Tree& tree = cache.tree();
    double error_before = std::numeric_limits<double>::infinity();
    for (const double share : {0.0, 0.2, 0.6, 1.0}) {
        cache.clear();
        const auto loads_before = cache.statistics().loaded_bytes;
        for (NodeId id = 0; id < tree.nodes().size() * share; ++id)
            if (tree.node(id).points > 0) cache.get(id, ColumnSet::only_positions());
        const auto loaded = cache.statistics().loaded_bytes;
        const std::size_t pages = tree.nodes().pages_loaded();
        if (share < 1) EXPECT_LT(pages, tree.nodes().pages());
        EXPECT_EQ(loaded > loads_before, share > 0);
        double error = 0;
        for (const Vec3d& place : places_) {
            const double truth = exact(place);
            const Clearance found = clearance(cache, place);
            EXPECT_LE(found.least, truth + step);
            EXPECT_GE(found.distance, truth - step);
            EXPECT_LE(found.error(), cloud_->info().bounds().diagonal() + 1e-7);
            error += found.error();
            if (share == 1) {
                EXPECT_NEAR(found.distance, truth, 1e-7);
                EXPECT_NEAR(found.least, truth, 1e-7);
            }
            for (const ClearanceLimits& limits :
                 {ClearanceLimits{1, 0}, ClearanceLimits{5, 2500}, ClearanceLimits{4096, 0}}) {
                const Clearance limited = clearance(cache, place, limits);
                EXPECT_LE(limited.least, truth + step);
                EXPECT_GE(limited.distance, truth - step);
            }
        }
        EXPECT_LE(error, error_before * (1 + 1e-9) + step);  // more in memory: no worse
        error_before = error;
        EXPECT_EQ(cache.statistics().loaded_bytes, loaded) << "something was read";
        EXPECT_EQ(tree.nodes().pages_loaded(), pages) << "nodes were read";
    }
}

TEST_P(ClearanceTest, PlacesThatAreNotFinite)
{
    const double nan = std::numeric_limits<double>::quiet_NaN(), infinity = std::numeric_limits<double>::infinity();
    for (const Vec3d& place : {Vec3d{nan, 0, 0}, Vec3d{0, infinity, 0}, Vec3d{0, 0, -infinity}}) {
        const Clearance found = clearance(cloud_->cache(), place);
        EXPECT_EQ(found.distance, infinity);
        EXPECT_EQ(found.least, 0);
    }
}

INSTANTIATE_TEST_SUITE_P(Shapes, ClearanceTest,
                         testing::Values(Shape::surface, Shape::volume, Shape::line, Shape::duplicates,
                                         Shape::coincident, Shape::clusters),
                         [](const testing::TestParamInfo<Shape>& info) { return name(info.param); });

}  // namespace
