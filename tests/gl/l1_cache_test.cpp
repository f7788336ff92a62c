// L1 against a naive model of the same rules, and what lies in video memory against the chunk.
#include "gl_support.h"

#include "cloud/error.h"
#include "gl/l1_cache.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>
#include <random>

using namespace pcm;
using namespace pcm::test;

namespace {

ChunkPositions chunk_of(std::uint32_t points, bool wide, std::uint64_t seed)
{
    std::mt19937_64 random(seed);
    ChunkPositions positions;
    positions.origin = {-5, 1000000, 7};
    positions.wide = wide;
    for (std::size_t a = 0; a < 3; ++a) {
        if (wide) {
            positions.wide_xyz[a].resize(points);
            for (auto& v : positions.wide_xyz[a]) v = random() >> 3;
        } else {
            positions.narrow_xyz[a].resize(points);
            for (auto& v : positions.narrow_xyz[a]) v = static_cast<std::uint32_t>(random());
        }
    }
    return positions;
}

std::vector<std::byte> read_back(const VertexEntry& entry)
{
    std::vector<std::byte> bytes;
    for (const VertexRange& range : entry.ranges) {
        const std::size_t size = static_cast<std::size_t>(range.count) * entry.stride();
        const std::size_t at = bytes.size();
        bytes.resize(at + size);
        glBindBuffer(GL_COPY_WRITE_BUFFER, range.buffer);
        glGetBufferSubData(GL_COPY_WRITE_BUFFER, static_cast<GLintptr>(range.first) * entry.stride(),
                           static_cast<GLsizeiptr>(size), bytes.data() + at);
    }
    return bytes;
}

// The rules of l1_cache.h, word for word, by linear search.
struct NaiveModel {
    struct Entry {
        std::uint64_t owner;
        NodeId node;
        VertexColour colour;
        std::size_t pages;
        std::uint64_t frame;
        std::uint64_t used;  // tick
    };
    std::vector<Entry> entries;
    std::map<std::uint64_t, std::uint64_t> latest;
    std::map<std::pair<std::uint64_t, NodeId>, std::array<bool, 3>> seen;
    std::uint64_t frame = 0, tick = 0;
    std::size_t capacity = 0;  // pages
    L1Statistics statistics;

    bool is_protected(const Entry& e) const
    {
        const auto l = latest.find(e.owner);
        return l != latest.end() && e.frame == l->second && frame - e.frame < L1Cache::frames_protected;
    }
    Entry* find(std::uint64_t owner, NodeId node)
    {
        for (auto& e : entries)
            if (e.owner == owner && e.node == node) return &e;
        return nullptr;
    }
    std::size_t pages() const
    {
        std::size_t sum = 0;
        for (const auto& e : entries) sum += e.pages;
        return sum;
    }
    bool use(std::uint64_t owner, NodeId node)
    {
        Entry* e = find(owner, node);
        if (!e) return false;
        e->frame = latest[owner];
        e->used = ++tick;
        ++statistics.hits;
        return true;
    }
    bool upload(std::uint64_t owner, NodeId node, std::size_t points, VertexColour colour)
    {
        const std::size_t need = (points + L1Cache::points_per_page(colour) - 1) / L1Cache::points_per_page(colour);
        Entry* old = find(owner, node);
        std::size_t others = pages() - (old ? old->pages : 0);
        std::size_t pinned = 0;
        for (const auto& e : entries)
            if (&e != old && is_protected(e)) pinned += e.pages;
        if (pinned + need > capacity) {
            ++statistics.refused;
            return false;
        }
        while (others + need > capacity) {
            auto victim = entries.end();
            for (auto e = entries.begin(); e != entries.end(); ++e)
                if (!(e->owner == owner && e->node == node) && !is_protected(*e) &&
                    (victim == entries.end() || e->used < victim->used))
                    victim = e;
            others -= victim->pages;
            entries.erase(victim);
            ++statistics.evictions;
        }
        entries.erase(std::remove_if(entries.begin(), entries.end(),
                                     [&](const Entry& e) { return e.owner == owner && e.node == node; }),
                      entries.end());
        entries.push_back({owner, node, colour, need, latest[owner], ++tick});
        bool& before = seen[{owner, node}][static_cast<std::size_t>(colour)];
        ++(before ? statistics.capacity_misses : statistics.compulsory_misses);
        before = true;
        statistics.uploaded_bytes += points * (colour == VertexColour::none ? 12 : 16);
        return true;
    }
    void remove_owner(std::uint64_t owner)
    {
        entries.erase(std::remove_if(entries.begin(), entries.end(), [&](const Entry& e) { return e.owner == owner; }),
                      entries.end());
        for (auto s = seen.begin(); s != seen.end();) s = s->first.first == owner ? seen.erase(s) : std::next(s);
        latest.erase(owner);
    }
};

}  // namespace

TEST(L1Cache, RandomOperationsAgreeWithANaiveModel)
{
    PCM_REQUIRE_GL(context, Profile::core);
    std::mt19937_64 random(11);
    L1Options options;
    options.block_bytes = 1u << 20;
    options.capacity_bytes = 5 * (1u << 20) + 12345;  // not a whole number of blocks
    L1Cache cache(options);
    NaiveModel model;
    model.capacity = 5 * ((1u << 20) / L1Cache::page_bytes);
    std::vector<L1Cache::Owner> owners{cache.add_owner(), cache.add_owner(), cache.add_owner()};
    for (const auto owner : owners) model.latest[owner] = 0;

    const std::vector<std::uint32_t> sizes{1, 3840, 3841, 5120, 5121, 12000, 100, 0, 70000};
    std::vector<ChunkPositions> chunks;
    for (std::size_t i = 0; i < sizes.size(); ++i) chunks.push_back(chunk_of(sizes[i], i % 2 == 1, i));
    const std::vector<std::uint8_t> rgba(4 * 70000, 200);
    const auto chunk_number = [&](NodeId node, std::uint64_t roll) { return roll < 3 ? 8u : node % 8; };

    for (int step = 0; step < 150000; ++step) {
        auto& owner = owners[random() % owners.size()];
        const auto node = static_cast<NodeId>(random() % 60);
        const std::uint64_t action = random() % 1000;
        if (action < (step / 10000 % 2 ? 100u : 2u)) {  // at times few frames, so that much is protected
            cache.begin_frame(owner);
            model.latest[owner] = ++model.frame;
        } else if (action < 700) {
            ASSERT_EQ(cache.use(owner, node) != nullptr, model.use(owner, node)) << "step " << step;
        } else if (action < 998) {
            const std::size_t chunk = chunk_number(node, random() % 1000);
            const auto colour = static_cast<VertexColour>(random() % 3);
            ASSERT_EQ(cache.upload(owner, node, chunks[chunk], {1, 1, 1}, colour, rgba.data()),
                      model.upload(owner, node, sizes[chunk], colour))
                << "step " << step;
        } else {
            cache.remove_owner(owner);
            model.remove_owner(owner);
            owner = cache.add_owner();
            model.latest[owner] = 0;
        }
        const L1Statistics s = cache.statistics();
        ASSERT_LE(s.allocated_bytes, options.capacity_bytes);
        ASSERT_LE(s.resident_bytes, s.allocated_bytes);
        ASSERT_EQ(s.resident_bytes, model.pages() * L1Cache::page_bytes) << "step " << step;
        ASSERT_EQ(s.resident_chunks, model.entries.size());
        if (step % 50 == 0) {
            for (const auto o : owners) {
                std::size_t available = model.capacity;
                for (const auto& e : model.entries)
                    if (e.owner != o && model.is_protected(e)) available -= e.pages;
                ASSERT_EQ(cache.pages_available(o), available);
            }
            // No two entries share a vertex.
            std::vector<std::array<std::uint64_t, 3>> spans;  // buffer, first byte, end
            for (const auto& e : model.entries) {
                const VertexEntry* entry = cache.find(e.owner, e.node);
                ASSERT_TRUE(entry);
                ASSERT_EQ(entry->colour, e.colour);
                std::uint32_t points = 0;
                for (const auto& r : entry->ranges) {
                    spans.push_back({r.buffer, std::uint64_t(r.first) * entry->stride(),
                                     std::uint64_t(r.first + r.count) * entry->stride()});
                    ASSERT_LE(spans.back()[2], options.block_bytes);
                    points += static_cast<std::uint32_t>(r.count);
                }
                ASSERT_EQ(points, entry->points);
            }
            std::sort(spans.begin(), spans.end());
            for (std::size_t i = 1; i < spans.size(); ++i)
                ASSERT_TRUE(spans[i - 1][0] != spans[i][0] || spans[i - 1][2] <= spans[i][1]);
        }
    }
    const L1Statistics s = cache.statistics();
    EXPECT_EQ(s.hits, model.statistics.hits);
    EXPECT_EQ(s.compulsory_misses, model.statistics.compulsory_misses);
    EXPECT_EQ(s.capacity_misses, model.statistics.capacity_misses);
    EXPECT_EQ(s.evictions, model.statistics.evictions);
    EXPECT_EQ(s.refused, model.statistics.refused);
    EXPECT_EQ(s.uploaded_bytes, model.statistics.uploaded_bytes);
    EXPECT_GT(s.evictions, 1000u);
    EXPECT_GT(s.refused, 100u);
    EXPECT_GT(s.capacity_misses, 1000u);
    EXPECT_EQ(glGetError(), static_cast<GLenum>(GL_NO_ERROR));
    cache.release();
    EXPECT_EQ(cache.statistics().allocated_bytes, 0u);
    EXPECT_TRUE(cache.upload(owners[0], 1, chunks[1], {1, 1, 1}, VertexColour::none, nullptr));  // usable afterwards
    cache.release();
}

TEST(L1Cache, VerticesAreTheChunksPointsRoundedOnce)
{
    PCM_REQUIRE_GL(context, Profile::core);
    L1Options options;
    options.block_bytes = 1u << 20;
    options.capacity_bytes = 64u << 20;
    L1Cache cache(options);
    const auto owner = cache.add_owner();
    cache.begin_frame(owner);
    const Vec3d scale{0.001, 0.01, 1e-6};
    for (const bool wide : {false, true})
        for (const std::uint32_t points : {1u, 3840u, 5121u, 200000u})
            for (const auto colour : {VertexColour::none, VertexColour::rgb}) {
                const ChunkPositions positions = chunk_of(points, wide, points);
                std::vector<std::uint8_t> rgba(4 * points);
                for (std::size_t i = 0; i < rgba.size(); ++i) rgba[i] = static_cast<std::uint8_t>(i * 7);
                ASSERT_TRUE(cache.upload(owner, points, positions, scale, colour, rgba.data()));
                const VertexEntry* entry = cache.find(owner, points);
                ASSERT_TRUE(entry);
                EXPECT_EQ(entry->origin, positions.origin);
                const std::vector<std::byte> bytes = read_back(*entry);
                ASSERT_EQ(bytes.size(), std::size_t(points) * entry->stride());
                Vec3d extent{};
                for (std::size_t i = 0; i < points; ++i) {
                    float vertex[3];
                    std::memcpy(vertex, bytes.data() + i * entry->stride(), 12);
                    for (std::size_t a = 0; a < 3; ++a) {
                        const double exact = static_cast<double>(positions.relative(i, a)) * scale[a];
                        ASSERT_EQ(vertex[a], static_cast<float>(exact));
                        extent[a] = std::max(extent[a], exact);
                    }
                    if (colour != VertexColour::none)
                        ASSERT_EQ(std::memcmp(bytes.data() + i * 16 + 12, rgba.data() + i * 4, 4), 0);
                }
                EXPECT_EQ(entry->extent, extent);
            }
    cache.release();
}

TEST(L1Cache, RefusesOptionsOutOfRange)
{
    L1Options options;
    options.block_bytes = 100;
    EXPECT_THROW(L1Cache{options}, Error);
    options.block_bytes = 5u << 20;
    EXPECT_THROW(L1Cache{options}, Error);
    options.block_bytes = 2u << 20;
    options.capacity_bytes = 1u << 20;
    EXPECT_THROW(L1Cache{options}, Error);
}
