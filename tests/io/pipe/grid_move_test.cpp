// Integers moved between grids, against arithmetic of 64 bits, one point at a time.

#include "pcm/io/pipe/grid_move.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <random>

namespace pcm {
namespace {

constexpr std::int64_t most = std::numeric_limits<std::int32_t>::max(), least = -most - 1;

struct Case {
    Grid from, to;
    std::array<std::int64_t, 3> steps;
};

const std::vector<Case> cases = {
    {{{0.001, 0.01, 1}, {0, 0, 0}}, {{0.001, 0.01, 1}, {0, 0, 0}}, {0, 0, 0}},
    {{{0.001, 0.001, 0.001}, {501000.001, 4799000, -3}},
     {{0.001, 0.001, 0.001}, {500000, 4800000, 0}},
     {1000001, -1000000, -3000}},
    {{{0.3, 0.1, 1e-7}, {-6.9, 1e6, 100}}, {{0.3, 0.1, 1e-7}, {3, 1e6 + 0.1, 0}}, {-33, -1, 1000000000}},
};

TEST(GridMove, IsOfWholeStepsAndKnowsItsError)
{
    std::mt19937 random(1);
    for (const Case& c : cases)
        for (const std::size_t count : {0u, 1u, 255u, 256u, 257u, 1000u}) {
            RecordBatch records;
            records.size = count;
            records.stride = 27;
            records.bytes.resize((count + 1) * records.stride);
            for (std::byte& byte : records.bytes) byte = static_cast<std::byte>(random());
            PointBatch points;
            points.reset({}, true, count);
            std::vector<std::array<std::int32_t, 3>> expected;
            double error = 0;
            for (std::size_t i = 0; i < count; ++i) {
                std::array<std::int32_t, 3> before, after;
                for (std::size_t a = 0; a < 3; ++a) {
                    before[a] = static_cast<std::int32_t>(random()) / 4;
                    after[a] = static_cast<std::int32_t>(before[a] + c.steps[a]);
                    points.grid_xyz[a][i] = before[a];
                    error = std::max(error, std::fabs(c.to.to_source(after[a], a) - c.from.to_source(before[a], a)));
                }
                std::memcpy(records.bytes.data() + i * records.stride, before.data(), sizeof before);
                expected.push_back(after);
            }
            const std::vector<std::byte> records_before = records.bytes;
            GridMove of_points(c.from, c.to), of_records(c.from, c.to);
            EXPECT_TRUE(of_points.move(points));
            EXPECT_TRUE(of_records.move(records));
            for (const GridMove& move : {of_points, of_records}) EXPECT_EQ(move.error(), error);
            EXPECT_LE(error, 1e-7);
            for (std::size_t i = 0; i < count; ++i) {
                const auto& q = expected[i];
                const std::byte* const record = records.bytes.data() + i * records.stride;
                EXPECT_EQ(std::memcmp(record, q.data(), sizeof q), 0);
                EXPECT_EQ(std::memcmp(record + 12, records_before.data() + i * records.stride + 12, 15), 0);
                for (std::size_t a = 0; a < 3; ++a) EXPECT_EQ(points.grid_xyz[a][i], q[a]);
            }
        }
}

// The last integer that fits, and the first that does not, in any place of a batch, along any axis, to either side.
TEST(GridMove, NoticesWhatNeedsMoreThan32Bits)
{
    for (const std::int64_t steps : {1, 1000, 2000000000, -1, -1000, -2000000000})
        for (std::size_t axis = 0; axis < 3; ++axis)
            for (const std::size_t at : {0u, 255u, 256u, 299u})
                for (const std::int64_t beyond : {0, 1}) {
                    Grid from{{1, 1, 1}, {0, 0, 0}};
                    const Grid to = from;
                    from.offset[axis] = static_cast<double>(steps);
                    PointBatch points;
                    points.reset({}, true, 300);
                    for (auto& column : points.grid_xyz) std::fill(column.begin(), column.end(), 0);
                    points.grid_xyz[axis][at] =
                        static_cast<std::int32_t>(steps > 0 ? most - steps + beyond : least - steps - beyond);
                    EXPECT_EQ(GridMove(from, to).move(points), beyond == 0) << steps << " " << axis << " " << at;
                }
}

TEST(GridMove, KnowsWhichBoxesFit)
{
    const Grid from{{0.5, 0.5, 0.5}, {100, 0, 0}}, to{{0.5, 0.5, 0.5}, {0, 0, 0}};
    const double end = 0.5 * static_cast<double>(most - 1);
    for (std::size_t axis = 0; axis < 3; ++axis) {
        Box3d box;
        box.min = {-1, -1, -1};
        box.max = {1, 1, 1};
        EXPECT_TRUE(GridMove(from, to).fits(box));
        box.max[axis] = end;
        EXPECT_TRUE(GridMove(from, to).fits(box));
        box.max[axis] = end + 0.5;
        EXPECT_FALSE(GridMove(from, to).fits(box));
        box.max[axis] = 1;
        box.min[axis] = -end - 0.5;
        EXPECT_FALSE(GridMove(from, to).fits(box));
        box.min[axis] = std::numeric_limits<double>::quiet_NaN();
        EXPECT_FALSE(GridMove(from, to).fits(box));
    }
    EXPECT_TRUE(GridMove(from, to).fits(Box3d()));
}

}  // namespace
}  // namespace pcm
