// Appending to a tree of another coordinate system, or of none.
#include "pcm/io/crs/coordinate_system.h"
#include "pcm/system/error.h"
#include "pcm/update/append.h"
#include "tests/update/model.h"

namespace {

using namespace pcm;
using namespace pcm::test;
namespace fs = std::filesystem;

Metadata crs(const std::string& text)
{
    const auto* bytes = reinterpret_cast<const std::byte*>(text.data());
    return {crs_comment, {bytes, bytes + text.size()}};
}

// A header of LAS 1.2, point format 1, with this global encoding.
Metadata las_header(std::uint8_t encoding)
{
    std::vector<std::byte> raw(227);
    raw[6] = std::byte{encoding};
    raw[24] = std::byte{1};
    raw[25] = std::byte{2};
    raw[104] = std::byte{1};
    return {"las.header", raw};
}

class AppendSystems : public testing::Test {
protected:
    MemoryCloud cloud(std::vector<Metadata> metadata, std::uint64_t seed) const
    {
        MemoryCloud made = surface(2000, 0, 0, 50, seed);
        made.info.metadata = std::move(metadata);
        return made;
    }
    AppendReport append(const MemoryCloud& points, bool ignore = false)
    {
        AppendOptions options;
        options.memory_bytes = 64 << 20;
        options.threads = 2;
        options.ignore_crs = ignore;
        MemoryReader reader(points);
        return append_points(path_, reader, {"more.las"}, options);
    }
    std::vector<std::string> systems() const
    {
        std::vector<std::string> found;
        const auto tree = Tree::open(path_);
        for (const Metadata& block : tree->info().metadata)
            if (is_crs_block(block))
                found.emplace_back(reinterpret_cast<const char*>(block.value.data()), block.value.size());
        return found;
    }
    static bool mentions(const std::vector<std::string>& notes, const std::string& words)
    {
        return std::any_of(notes.begin(), notes.end(),
                           [&](const std::string& note) { return note.find(words) != std::string::npos; });
    }
    const TemporaryFolder folder_;
    const fs::path path_ = folder_ / "tree.pct";
};

TEST_F(AppendSystems, AnotherSystemIsRefusedAndTheTreeStays)
{
    build(cloud({crs("EPSG:32632")}, 1), path_, Sampling::poisson);
    try {
        append(cloud({crs("EPSG:32633")}, 2));
        FAIL() << "appended points of another system";
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::invalid_argument);
        for (const char* word : {"more.las", "tree.pct", "EPSG:32632", "EPSG:32633", "--ignore-crs"})
            EXPECT_NE(std::string(error.what()).find(word), std::string::npos) << error.what();
    }
    EXPECT_EQ(Tree::open(path_)->info().generation, 1u);
    const AppendReport report = append(cloud({crs("EPSG:32633")}, 2), true);
    EXPECT_EQ(report.points_added, 2000u);
    EXPECT_TRUE(mentions(report.notes, "the difference is ignored"));
    EXPECT_EQ(systems(), std::vector<std::string>{"EPSG:32632"}) << "the tree keeps its own";
    // The same system in the same notation: no notes.
    EXPECT_FALSE(mentions(append(cloud({crs("EPSG:32632")}, 3)).notes, "system"));
    EXPECT_EQ(systems().size(), 1u);
}

TEST_F(AppendSystems, AMissingSystemIsNoted)
{
    build(cloud({}, 1), path_, Sampling::poisson);
    EXPECT_TRUE(append(cloud({}, 2)).notes.empty());
    EXPECT_TRUE(mentions(append(cloud({crs("EPSG:32632")}, 3)).notes,
                         "the tree states no coordinate system; it takes over that of the new points, EPSG:32632"));
    EXPECT_EQ(systems(), std::vector<std::string>{"EPSG:32632"});
    EXPECT_TRUE(mentions(append(cloud({}, 4)).notes, "the new points state no coordinate system"));
    EXPECT_EQ(systems(), std::vector<std::string>{"EPSG:32632"});
}

TEST_F(AppendSystems, GpsTimesOfAnotherKindAreRefused)
{
    const auto timed = [&](std::uint8_t encoding, std::uint64_t seed) {
        return cloud({las_header(encoding)}, seed);  // it has times
    };
    build(timed(0, 1), path_, Sampling::poisson);
    EXPECT_THROW(append(timed(1, 2)), Error);
    EXPECT_NO_THROW(append(timed(0, 3)));
    EXPECT_TRUE(mentions(append(timed(1, 2), true).notes, "GPS times"));
}

}  // namespace
