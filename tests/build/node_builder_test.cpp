// The nodes of a region against what node_builder.h says of them, counted on the rows that went in.

#include "pcm/build/nodes/node_builder.h"

#include "pcm/bpc/chunk_decoder.h"
#include "pcm/build/levels/morton_sort.h"
#include "tests/build/schema_of.h"
#include "tests/support.h"

#include <algorithm>
#include <cstring>
#include <limits>
#include <numeric>
#include <random>

namespace pcm {
namespace {

using LeveledRow = std::pair<std::uint8_t, std::string>;

// A chunk that was written, read back.
struct Written {
    const Draft* draft;
    BpcHeader header;
    std::vector<LeveledRow> rows;  // in the chunk's order
};

// A size that depends on the row, so that it shows whether it stayed with it.
std::uint8_t size_of(const std::string& row)
{
    return static_cast<std::uint8_t>(std::accumulate(row.begin(), row.end(), 0u));
}

template <class Coord>
class Nodes : public testing::Test {
public:
    static constexpr Coord largest = std::numeric_limits<Coord>::max();
    using Builder = NodeBuilder<Coord>;

    Nodes()
    {
        options.grid = Grid{{0.001, 0.001, 0.001}, {0, 0, 0}};
        options.lattice = Lattice(options.grid);
        // One of each width that is copied in its own way, and others.
        options.schema = test::schema_of({{ScalarType::u8, 1},
                                          {ScalarType::u16, 1},
                                          {ScalarType::u8, 3},
                                          {ScalarType::f32, 1},
                                          {ScalarType::u16, 3},
                                          {ScalarType::f64, 1},
                                          {ScalarType::f32, 3},
                                          {ScalarType::f64, 2}});
        options.layout = RowLayout(options.schema, sizeof(Coord) == 8);
        options.chunk_points = 100;
        options.part = 3;
        options.generation = 9;
        options.spacings = {8, 4, 2, 1, 0};
    }

    // Points in Morton order. Coarse levels have fewer points, unless `level` says otherwise for all.
    LeveledRows points(const std::string& kind, std::size_t count, int level = -1)
    {
        std::vector<std::byte> rows(count * options.layout.bytes);
        for (std::byte& b : rows) b = static_cast<std::byte>(random());
        for (std::size_t i = 0; i < count; ++i) {
            std::array<Coord, 3> p{number(), number(), number()};
            if (kind == "narrow")
                for (Coord& c : p) c = static_cast<Coord>(largest / 2 + c % 5000);
            if (kind == "ends")
                for (Coord& c : p) c = c % 2 ? largest : Coord(0);
            if (kind == "pile") p = {5, largest, 7};
            if (kind == "duplicates")
                for (Coord& c : p) c %= 4;
            std::memcpy(rows.data() + i * options.layout.bytes, p.data(), sizeof p);
        }
        const auto order = morton_order<Coord>(rows.data(), count, options.layout, options.lattice.finer);
        LeveledRows sorted;
        for (const std::uint32_t i : order) {
            const std::byte* row = rows.data() + i * options.layout.bytes;
            sorted.rows.insert(sorted.rows.end(), row, row + options.layout.bytes);
            int own = 4;
            while (own > 0 && random() % 4 == 0) --own;
            sorted.levels.push_back(static_cast<std::uint8_t>(level < 0 ? own : level));
            sorted.sizes.push_back(size_of(std::string(reinterpret_cast<const char*>(row), options.layout.bytes)));
        }
        return sorted;
    }
    std::vector<LeveledRow> rows_of(const LeveledRows& points) const
    {
        std::vector<LeveledRow> rows;
        for (std::size_t i = 0; i < points.levels.size(); ++i)
            rows.emplace_back(points.levels[i],
                              std::string(reinterpret_cast<const char*>(points.rows.data()) + i * options.layout.bytes,
                                          options.layout.bytes));
        return rows;
    }
    Point<Coord> position(const LeveledRow& row) const
    {
        return coordinates_of<Coord>(reinterpret_cast<const std::byte*>(row.second.data()));
    }

    // Reads the chunks back and checks each against its draft.
    std::vector<Written> read(const typename Builder::Output& output)
    {
        std::vector<Written> all;
        const auto path = folder / "chunks";
        File file(path, File::Mode::create_or_truncate);
        file.write_at(output.bytes.data(), output.bytes.size(), 0);
        std::size_t end = 0;
        for (const auto& piece : output.pieces) {
            EXPECT_EQ(piece.from, end);
            end += piece.size;
            const Draft& draft = *piece.draft;
            EXPECT_EQ(draft.extent.bytes, piece.size);
            const DecodedChunk decoded =
                read_chunk(file, piece.from, piece.size, draft.extent.header_bytes, ColumnSet::whole(options.schema));
            Written written{&draft, decoded.header, rows_of(decoded.chunk)};
            EXPECT_EQ(decoded.header.header_bytes, draft.extent.header_bytes);
            EXPECT_EQ(decoded.header.points, draft.points);
            EXPECT_EQ(written.rows.size(), draft.points);
            EXPECT_TRUE(decoded.chunk.sizes);
            for (std::size_t i = 0; decoded.chunk.sizes && i < written.rows.size(); ++i)
                EXPECT_EQ(decoded.chunk.sizes->as<std::uint8_t>()[i], size_of(written.rows[i].second));
            EXPECT_EQ(decoded.header.grid, options.grid);
            EXPECT_EQ(decoded.header.box, draft.box);
            Box3i box;
            for (const LeveledRow& row : written.rows) {
                const Point<Coord> p = position(row);
                box.extend(Vec3i{to_grid<Coord>(p[0]), to_grid<Coord>(p[1]), to_grid<Coord>(p[2])});
            }
            EXPECT_EQ(draft.box, box);
            ChunkIdentity identity;
            identity.path = draft.path;
            identity.part = options.part;
            identity.generation = options.generation;
            identity.first_level = draft.first_level;
            identity.level_points = draft.level_points;
            identity.spacing = draft.spacing;
            EXPECT_TRUE(decoded.header.identity == identity);
            set_levels(written);
            for (std::size_t i = 1; i < written.rows.size(); ++i)
                if (written.rows[i].first == written.rows[i - 1].first)
                    EXPECT_FALSE(
                        morton_before(position(written.rows[i]), position(written.rows[i - 1]), options.lattice.finer));
            all.push_back(std::move(written));
        }
        EXPECT_EQ(end, output.bytes.size());
        return all;
    }

    NodeBuilderOptions options;
    DraftStore drafts;
    std::mt19937_64 random{21};

private:
    Coord number() { return static_cast<Coord>(random()); }

    // By the draft's level_points; the first and the last level have points.
    static void set_levels(Written& written)
    {
        const Draft& draft = *written.draft;
        EXPECT_GT(draft.level_points.front(), 0u);
        EXPECT_GT(draft.level_points.back(), 0u);
        std::size_t i = 0;
        for (std::size_t k = 0; k < draft.level_points.size(); ++k)
            for (std::uint32_t n = 0; n < draft.level_points[k]; ++n, ++i)
                written.rows.at(i).first = static_cast<std::uint8_t>(draft.first_level + k);
        EXPECT_EQ(i, written.rows.size());
    }
    std::vector<LeveledRow> rows_of(const Chunk& chunk) const
    {
        std::vector<LeveledRow> rows;
        for (std::size_t i = 0; i < chunk.points; ++i) {
            std::string row(options.layout.bytes, 0);
            for (std::size_t a = 0; a < 3; ++a) {
                const Coord c = to_coordinate<Coord>(chunk.positions->grid(i, a));
                std::memcpy(row.data() + a * sizeof c, &c, sizeof c);
            }
            for (std::size_t k = 0; k < options.schema.size(); ++k)
                std::memcpy(row.data() + options.layout.offsets[k],
                            chunk.attributes[k]->data() + i * options.layout.sizes[k], options.layout.sizes[k]);
            rows.emplace_back(0, std::move(row));
        }
        return rows;
    }
    test::TemporaryFolder folder;
};
using Widths = testing::Types<std::uint32_t, std::uint64_t>;
TYPED_TEST_SUITE(Nodes, Widths);

void sort(std::vector<LeveledRow>& rows) { std::sort(rows.begin(), rows.end()); }

// The rows of a subtree. Checks on the way what a node takes and how the rest is divided; `first`: the levels before it
// are taken above.
template <class Coord>
std::vector<LeveledRow> expect_subtree(Nodes<Coord>& test, const Draft& draft, const std::vector<Written>& chunks,
                                       std::size_t first)
{
    std::vector<LeveledRow> own;
    for (const Written& chunk : chunks)
        if (chunk.draft == &draft) {
            EXPECT_TRUE(own.empty()) << "two chunks of one node";
            own = chunk.rows;
        }
    EXPECT_LE(own.size(), test.options.chunk_points);
    EXPECT_EQ(own.size(), draft.points);
    if (!draft.children[0] && !draft.children[1]) return own;

    // The levels that fit, all of them, and no other.
    std::size_t lowest_below = test.options.spacings.size();
    std::vector<std::size_t> all(test.options.spacings.size(), 0);
    for (const LeveledRow& row : own) ++all[row.first];
    std::vector<const Draft*> stack;
    for (const Draft* child : draft.children)
        if (child) stack.push_back(child);
    while (!stack.empty()) {
        const Draft* node = stack.back();
        stack.pop_back();
        for (std::size_t k = 0; k < node->level_points.size(); ++k) {
            all[node->first_level + k] += node->level_points[k];
            if (node->level_points[k]) lowest_below = std::min(lowest_below, node->first_level + k);
        }
        for (const Draft* child : node->children)
            if (child) stack.push_back(child);
    }
    std::size_t sum = 0, last = first;  // after the own levels
    while (last < all.size() && sum + all[last] <= test.options.chunk_points) sum += all[last++];
    EXPECT_EQ(own.size(), sum);
    EXPECT_GE(lowest_below, last);
    for (const LeveledRow& row : own) EXPECT_LT(row.first, last);
    EXPECT_EQ(draft.spacing, last > 0 ? test.options.spacings[last - 1] : 2 * test.options.spacings[0]);

    std::array<std::vector<LeveledRow>, 2> below;
    for (unsigned side = 0; side < 2; ++side)
        if (draft.children[side]) {
            EXPECT_TRUE(draft.children[side]->path == draft.path.child(side));
            below[side] = expect_subtree(test, *draft.children[side], chunks, last);
            EXPECT_FALSE(below[side].empty());
        }
    if (draft.children[0] && draft.children[1]) {
        EXPECT_GT(below[0].size() + below[1].size(), test.options.chunk_points);
        bool parted = false, pile = true;
        for (std::size_t a = 0; a < 3; ++a) {
            Coord high = 0, low = std::numeric_limits<Coord>::max();
            for (const LeveledRow& row : below[0]) high = std::max(high, test.position(row)[a]);
            for (const LeveledRow& row : below[1]) low = std::min(low, test.position(row)[a]);
            parted = parted || high < low;
        }
        for (const auto& rows : below)
            for (const LeveledRow& row : rows) pile = pile && test.position(row) == test.position(below[0][0]);
        EXPECT_TRUE(parted || pile);
    }
    for (const auto& rows : below) own.insert(own.end(), rows.begin(), rows.end());
    return own;
}

TYPED_TEST(Nodes, HoldEveryRowOnceWithTheLevelsThatFit)
{
    for (const std::string kind : {"random", "narrow", "ends", "pile", "duplicates"})
        for (const std::size_t count : {1u, 2u, 99u, 100u, 101u, 3000u})
            for (const int level : {-1, 0, 4}) {
                SCOPED_TRACE(kind + ", " + std::to_string(count) + ", level " + std::to_string(level));
                const LeveledRows points = this->points(kind, count, level);
                typename TestFixture::Builder builder(this->options, this->drafts);
                typename TestFixture::Builder::Output output;
                const auto region = builder.build(points, {}, {}, output);
                ASSERT_TRUE(region.draft);
                EXPECT_TRUE(region.above.empty());
                const auto chunks = this->read(output);
                auto rows = expect_subtree(*this, *region.draft, chunks, 0), expected = this->rows_of(points);
                sort(rows);
                sort(expected);
                ASSERT_TRUE(rows == expected);
                if (this->HasFailure()) return;
            }
}

// Among these limits are those that levels reach exactly.
TYPED_TEST(Nodes, LevelsFillAChunkToThePoint)
{
    const LeveledRows points = this->points("random", 400);
    for (std::uint32_t most = 10; most <= 130; ++most) {
        SCOPED_TRACE(most);
        this->options.chunk_points = most;
        typename TestFixture::Builder builder(this->options, this->drafts);
        typename TestFixture::Builder::Output output;
        const auto region = builder.build(points, {}, {}, output);
        ASSERT_TRUE(region.draft);
        const auto chunks = this->read(output);
        EXPECT_EQ(expect_subtree(*this, *region.draft, chunks, 0).size(), 400u);
        if (this->HasFailure()) return;
    }
}

TYPED_TEST(Nodes, AreTheSameWhateverBuiltBefore)
{
    const LeveledRows points = this->points("random", 2000);
    typename TestFixture::Builder builder(this->options, this->drafts);
    typename TestFixture::Builder::Output first, second;
    builder.build(points, {}, {}, first);
    builder.build(points, {}, {}, second);
    EXPECT_TRUE(first.bytes == second.bytes);
}

// A region in two parts under one node under another: the levels above are handed up, row by row, and land there.
TYPED_TEST(Nodes, AboveThePartsGetTheirLevels)
{
    using Builder = typename TestFixture::Builder;
    const std::vector<LevelRange> above{{0, 1}, {1, 3}};
    for (const std::string kind : {"random", "pile"})
        for (const int level : {-1, 0, 2}) {
            SCOPED_TRACE(kind + ", level " + std::to_string(level));
            const std::array<LeveledRows, 2> parts{this->points(kind, 700, level), this->points(kind, 150, level)};
            this->options.chunk_points = 1000;
            Builder builder(this->options, this->drafts);
            typename Builder::Output output;
            const NodePath top = NodePath().child(1);
            std::array<typename Builder::Region, 2> regions;
            std::vector<LeveledRow> expected, handed_up;
            for (unsigned side = 0; side < 2; ++side) {
                regions[side] = builder.build(parts[side], top.child(side), above, output);
                EXPECT_EQ(regions[side].draft == nullptr, level >= 0 && level < 3);
                const auto again = builder.hand_up(parts[side], above);
                ASSERT_EQ(again.above.size(), 2u);
                for (std::size_t d = 0; d < 2; ++d) {
                    EXPECT_EQ(again.above[d].rows, regions[side].above[d].rows);
                    EXPECT_EQ(again.above[d].levels, regions[side].above[d].levels);
                    EXPECT_EQ(again.above[d].sizes, regions[side].above[d].sizes);
                    std::vector<std::uint8_t> sizes;
                    for (const LeveledRow& row : this->rows_of(again.above[d])) sizes.push_back(size_of(row.second));
                    EXPECT_EQ(again.above[d].sizes, sizes);
                    for (const std::uint8_t l : again.above[d].levels)
                        EXPECT_TRUE(l >= above[d].first && l < above[d].last);
                }
                for (LeveledRow& row : this->rows_of(parts[side])) {
                    if (row.first < 1) handed_up.push_back(row);
                    expected.push_back(std::move(row));
                }
            }
            const std::array<Draft*, 2> children{regions[0].draft, regions[1].draft};
            auto merged = builder.merge(std::move(regions[0]), std::move(regions[1]), top, above[1], output);
            ASSERT_EQ(merged.above.size(), 1u);
            auto up = this->rows_of(merged.above[0]);
            sort(up);
            sort(handed_up);
            EXPECT_TRUE(up == handed_up);
            std::vector<LeveledRow> rows = up;
            if (level == 0) {
                EXPECT_EQ(merged.draft, nullptr);
            } else {
                ASSERT_TRUE(merged.draft);
                EXPECT_TRUE(merged.draft->path == top);
                EXPECT_EQ(merged.draft->children, children);
                EXPECT_EQ(merged.draft->spacing, level < 0 ? this->options.spacings[2] : 0.0);
            }
            for (const Written& chunk : this->read(output)) {
                for (const LeveledRow& row : chunk.rows) EXPECT_EQ(row.first < 3, chunk.draft == merged.draft);
                rows.insert(rows.end(), chunk.rows.begin(), chunk.rows.end());
            }
            sort(rows);
            sort(expected);
            EXPECT_TRUE(rows == expected);
            this->options.chunk_points = 100;
        }
}

TEST(LevelsThatFit, AreAllUpToTheFirstThatDoesNot)
{
    const auto fit = [](std::vector<std::uint64_t> histogram, std::size_t first, std::uint64_t most) {
        const LevelRange range = levels_that_fit(histogram, first, most);
        EXPECT_EQ(range.first, first);
        return range.last;
    };
    EXPECT_EQ(fit({}, 0, 5), 0u);
    EXPECT_EQ(fit({6, 1}, 0, 5), 0u);
    EXPECT_EQ(fit({5, 1}, 0, 5), 1u);
    EXPECT_EQ(fit({4, 1, 0, 1}, 0, 5), 3u);
    EXPECT_EQ(fit({4, 1, 0, 1}, 0, 6), 4u);
    EXPECT_EQ(fit({9, 4, 1, 1}, 1, 5), 3u);
    EXPECT_EQ(fit({9, 4}, 2, 5), 2u);
    EXPECT_EQ(fit({1, ~std::uint64_t(0) - 1}, 0, ~std::uint64_t(0)), 2u);
}

}  // namespace
}  // namespace pcm
