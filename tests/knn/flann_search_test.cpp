#include "pcm/knn/flann_search.h"

#include "pcm/knn/neighbourhoods.h"
#include "pcm/system/error.h"
#include "tests/knn/search_clouds.h"

#include <gtest/gtest.h>

#include <set>

namespace pcm {
namespace {

using namespace search_clouds;

constexpr double unbounded = std::numeric_limits<double>::infinity();

// What is promised of any cloud: as many neighbours as there are, none twice, with their exact distances. And that they
// are the nearest up to what single precision loses of an offset.
void expect_near_exact(const SearchPositions& p, const UnitSearchOptions& options, double tolerance)
{
    if (const std::string why = why_no_flann(); !why.empty()) GTEST_SKIP() << why;
    std::set<std::uint32_t> points;
    make_unit_search(p, NeighbourBackend::flann)->search(nullptr, options, [&](const FoundNeighbours& found) {
        for (std::size_t i = 0; i < found.size; ++i) {
            const std::uint32_t point = found.points[i];
            EXPECT_TRUE(points.insert(point).second);
            const std::vector<double> exact = all_pairs(p, point, options);
            ASSERT_EQ(found.counts[i], exact.size());
            std::set<std::uint32_t> seen{point};
            for (std::size_t j = 0; j < exact.size(); ++j) {
                const std::uint32_t id = found.neighbours[i * found.stride + j];
                ASSERT_TRUE(seen.insert(id).second) << point << ": " << id;
                ASSERT_EQ(found.squared[i * found.stride + j], squared_of(p, point, id));
                ASSERT_NEAR(std::sqrt(found.squared[i * found.stride + j]), std::sqrt(exact[j]), tolerance);
            }
        }
    });
    EXPECT_EQ(points.size(), p.size());
}

TEST(FlannSearch, FindsTheNearest)
{
    expect_near_exact(narrow(2000, InBox(1000, 1000, 1000), {0.01, 0.01, 0.02}), {16, unbounded}, 1e-4);
    expect_near_exact(wide(1000, InBox(1ll << 40, 1ll << 40, 1ll << 30)), {5, unbounded}, 1e6);
}

TEST(FlannSearch, FewPointsAndDuplicates)
{
    expect_near_exact(narrow(5, InBox(10, 10, 10)), {16, unbounded}, 1e-6);
    expect_near_exact(narrow(1, InBox(10, 10, 10)), {16, unbounded}, 1e-6);
    expect_near_exact(narrow(300, InBox(1, 1, 0)), {16, unbounded}, 1e-6);
    expect_near_exact(narrow(300, InBox(3, 3, 3)), {7, 2}, 1e-6);
}

TEST(FlannSearch, SomeQueries)
{
    if (const std::string why = why_no_flann(); !why.empty()) GTEST_SKIP() << why;
    const std::vector<std::uint32_t> queries{4, 2900, 7};
    std::set<std::uint32_t> points;
    make_flann_search(narrow(3000, InBox(1000, 1000, 10)))->search(&queries, {3, unbounded}, [&](const auto& found) {
        points.insert(found.points, found.points + found.size);
    });
    EXPECT_EQ(points, std::set<std::uint32_t>(queries.begin(), queries.end()));
}

TEST(FlannSearch, ItsAbsenceIsExplained)
{
    if (why_no_flann().empty()) GTEST_SKIP() << "FLANN is here";
    try {
        make_unit_search(narrow(5, InBox(10, 10, 10)), NeighbourBackend::flann);
        FAIL();
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::unsupported);
        EXPECT_NE(std::string(error.what()).find("libflann-dev"), std::string::npos) << error.what();
    }
}

}  // namespace
}  // namespace pcm
