#include "pcm/io/pipe/grid_choice.h"

#include "tests/io/bytes.h"

#include <charconv>
#include <cmath>

namespace pcm::test {
namespace {

PointBatch batch_of(const std::vector<Vec3d>& positions)
{
    PointBatch batch;
    batch.reset({}, false, positions.size());
    for (std::size_t i = 0; i < positions.size(); ++i)
        for (std::size_t a = 0; a < 3; ++a) batch.xyz[a][i] = positions[i][a];
    return batch;
}

GridProposal propose(const std::vector<Vec3d>& positions)
{
    GridChoice choice;
    choice.watch(batch_of(positions));
    return choice.propose();
}

// The worst error of the positions on the grid, all of which must fit 32 bits.
double error_on(const Grid& grid, const std::vector<Vec3d>& positions)
{
    double worst = 0;
    for (const Vec3d& p : positions)
        for (std::size_t a = 0; a < 3; ++a) {
            const std::int64_t q = nearest_on_grid(grid, a, p[a]);
            EXPECT_GE(q, std::numeric_limits<std::int32_t>::min());
            EXPECT_LE(q, std::numeric_limits<std::int32_t>::max());
            worst = std::max(worst, std::abs(grid.to_source(q, a) - p[a]));
        }
    return worst;
}

// A decimal number as text gives it.
double decimal(std::int64_t digits, int decimals)
{
    const std::string text = std::to_string(digits) + "e-" + std::to_string(decimals);
    double value = 0;
    std::from_chars(text.data(), text.data() + text.size(), value);
    return value;
}

TEST(GridChoice, DecimalsOfATextFileAreExact)
{
    std::mt19937_64 random(1);
    for (int decimals = 0; decimals <= 4; ++decimals)
        for (const std::int64_t centre : {0, 500000, -4800000}) {
            SCOPED_TRACE(std::to_string(decimals) + " at " + std::to_string(centre));
            const auto unit = static_cast<std::int64_t>(std::pow(10, decimals) + 0.5);
            std::vector<Vec3d> positions(20000);
            for (Vec3d& p : positions)
                for (double& c : p)
                    c = decimal(centre * unit + static_cast<std::int64_t>(random() % 2000000) - 1000000, decimals);
            const GridProposal proposal = propose(positions);
            const double step = std::min(0.01, decimal(1, decimals));
            for (const double s : proposal.grid.scale) EXPECT_EQ(s, step);
            // Not bit for bit equal, but only the last bits differ.
            EXPECT_EQ(error_on(proposal.grid, positions), proposal.largest_error);
            EXPECT_LE(proposal.largest_error,
                      1e-15 * (std::abs(static_cast<double>(centre)) + 1e6 * decimal(1, decimals)));
            EXPECT_EQ(proposal.exact, proposal.largest_error == 0);
            if (decimals == 0) EXPECT_TRUE(proposal.exact);
        }
}

// Programs show as many decimals as the step has: 10 along x and 1000 along y would look like a precision.
TEST(GridChoice, TheCoarsestStepOfAllAxesIsTakenButNoneAboveAHundredth)
{
    EXPECT_EQ(propose({{1.5, 20, 3000}, {-2, 40, 1000}}).grid.scale, (Vec3d{0.01, 0.01, 0.01}));
    EXPECT_TRUE(propose({{1.5, 20, 3000}, {-2, 40, 1000}}).exact);
    EXPECT_EQ(propose({{1.125, 20, 3000}, {-2, 40, 1000}}).grid.scale, (Vec3d{0.001, 0.001, 0.001}));
    // Where the finer step has no room in 32 bits, the finest that has.
    const GridProposal wide = propose({{1.125, 3e9, 0}, {-2, -3e9, 0}});
    EXPECT_EQ(wide.grid.scale, (Vec3d{0.001, 10, 0.001}));
    EXPECT_TRUE(wide.exact);
    EXPECT_TRUE(propose({{1.5, 20, 3000}}).exact);
    EXPECT_TRUE(propose({{0, 0, 0}}).exact);
    EXPECT_TRUE(propose({}).exact);
}

TEST(GridChoice, FloatsOnABinaryStepAreExact)
{
    std::mt19937_64 random(2);
    std::vector<Vec3d> positions(5000);
    for (Vec3d& p : positions)
        for (double& c : p) c = 1000 + static_cast<double>(static_cast<float>(random() % 16777216) / 16777216.0f);
    const GridProposal proposal = propose(positions);
    EXPECT_TRUE(proposal.exact);
    EXPECT_EQ(error_on(proposal.grid, positions), 0);
}

TEST(GridChoice, OtherwiseTheErrorIsBounded)
{
    std::mt19937_64 random(3);
    for (const double centre : {0.0, 1e-6, 123.456, 5e6, 1e9})
        for (const double span : {1e-6, 1.0, 1e5, 1e12}) {
            std::vector<Vec3d> positions(3000);
            std::uniform_real_distribution<double> within(centre - span, centre + span);
            for (Vec3d& p : positions)
                for (double& c : p) c = within(random);
            const GridProposal proposal = propose(positions);
            const double worst = error_on(proposal.grid, positions);
            EXPECT_LE(worst, proposal.largest_error) << centre << " " << span;
            if (!proposal.exact) {
                // At most five times the best error with 32 bits, plus the precision of a double near the centre.
                EXPECT_LE(proposal.largest_error, 5 * span / 4294967296.0 + 5e-16 * (std::abs(centre) + span));
            }
        }
}

TEST(GridChoice, PointsThatAreNotFiniteAreCountedAndIgnored)
{
    const double nan = std::nan(""), infinity = std::numeric_limits<double>::infinity();
    const GridProposal proposal = propose({{1, 2, 3}, {nan, 0.1, 0.1}, {0.1, infinity, 0.1}, {4, 5, 6}});
    EXPECT_EQ(proposal.not_finite, 2u);
    EXPECT_EQ(proposal.grid.scale, (Vec3d{0.01, 0.01, 0.01}));
}

TEST(GridChoice, ExtremeNumbersGiveAFiniteGrid)
{
    const double most = std::numeric_limits<double>::max(), least = std::numeric_limits<double>::denorm_min();
    for (const auto& positions : std::vector<std::vector<Vec3d>>{
             {{most, most, most}, {-most, -most, -most}}, {{least, 1, 1e300}, {1, -1, 0.1}}, {{1e308, 1e-308, 0}}}) {
        const GridProposal proposal = propose(positions);
        for (std::size_t a = 0; a < 3; ++a) {
            EXPECT_TRUE(proposal.grid.scale[a] > 0 && std::isfinite(proposal.grid.scale[a])) << proposal.grid.scale[a];
            EXPECT_TRUE(std::isfinite(proposal.grid.offset[a]));
        }
    }
}

TEST(GridChoice, OfAFile)
{
    TemporaryFolder folder;
    const auto path =
        write_file(folder / "a.ply",
                   "ply\nformat ascii 1.0\nelement vertex 2\nproperty double x\nproperty double y\nproperty "
                   "double z\nend_header\n1.25 2 3\n1.5 2.5 3\n");
    const GridProposal proposal = choose_grid(*open_reader(path));
    EXPECT_TRUE(proposal.exact);
    EXPECT_EQ(proposal.grid.scale, (Vec3d{0.01, 0.01, 0.01}));
    EXPECT_EQ(error_of([&] { choose_grid(*open_reader(path), [](const ProgressUpdate&) { return false; }); }).code(),
              ErrorCode::cancelled);
}

TEST(NearestOnGrid, IsNearerThanItsNeighbours)
{
    std::mt19937_64 random(4);
    for (int i = 0; i < 20000; ++i) {
        Grid grid;
        grid.scale[0] =
            std::pow(10.0, -static_cast<double>(random() % 9)) * (1 + static_cast<double>(random() % 1000) * 1e-3);
        grid.offset[0] = static_cast<double>(random() % 2000000) * 7.3 - 7e6;
        const double v = grid.offset[0] + (static_cast<double>(random() % 2000000) - 1e6) * 0.37 * grid.scale[0] * 1e3;
        const std::int64_t q = nearest_on_grid(grid, 0, v);
        const double error = std::abs(grid.to_source(q, 0) - v);
        EXPECT_LE(error, std::abs(grid.to_source(q + 1, 0) - v));
        EXPECT_LE(error, std::abs(grid.to_source(q - 1, 0) - v));
    }
}

}  // namespace
}  // namespace pcm::test
