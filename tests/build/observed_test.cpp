// Statistics of a cloud do not depend on how its points were divided among threads.

#include "pcm/build/bins/observed.h"

#include <gtest/gtest.h>

#include <random>
#include <vector>

namespace pcm {
namespace {

TEST(Observed, MergedPartsAreTheWhole)
{
    std::mt19937_64 random(2);
    for (const std::int64_t reach : {1, 3, 1000000})
        for (int trial = 0; trial < 200; ++trial) {
            std::vector<Vec3i> points(random() % 20);
            for (Vec3i& p : points)
                for (std::int64_t& c : p) c = static_cast<std::int64_t>(random()) % (reach + 1);
            std::vector<Observed> parts(4);
            Observed whole, merged, as_columns;
            std::array<std::vector<std::int64_t>, 3> columns;
            for (std::size_t from = 0; from < points.size();) {  // batches, some empty
                const std::size_t to = from + random() % (points.size() - from + 1);
                for (std::size_t a = 0; a < 3; ++a) {
                    columns[a].clear();
                    for (std::size_t i = from; i < to; ++i) columns[a].push_back(points[i][a]);
                }
                as_columns.see(columns, to - from);
                from = to;
            }
            for (const Vec3i& p : points) {
                Observed& part = parts[random() % 3];  // one sees nothing
                for (Observed* each : {&whole, &part}) {
                    each->see(p);
                    each->hash += static_cast<std::uint64_t>(p[0] * 3 + p[1]);
                    each->position_error = std::max(each->position_error, static_cast<double>(p[2]));
                }
            }
            for (std::size_t i = 0; i < parts.size(); ++i) merged.merge(parts[(i + 1) % parts.size()]);
            ASSERT_EQ(merged.points, points.size());
            ASSERT_EQ(merged.hash, whole.hash);
            ASSERT_EQ(merged.position_error, whole.position_error);
            ASSERT_EQ(merged.extremes, whole.extremes);
            ASSERT_EQ(as_columns.points, points.size());
            ASSERT_EQ(as_columns.extremes, whole.extremes);
            if (points.empty()) continue;
            // The extremes, and of equal ones the smallest point.
            for (std::size_t k = 0; k < 6; ++k) {
                const std::size_t a = k / 2;
                Vec3i best = points[0];
                for (const Vec3i& p : points) {
                    const bool beyond = k % 2 ? p[a] > best[a] : p[a] < best[a];
                    if (beyond || (p[a] == best[a] && p < best)) best = p;
                }
                ASSERT_EQ(whole.extremes[k], best);
            }
        }
}

}  // namespace
}  // namespace pcm
