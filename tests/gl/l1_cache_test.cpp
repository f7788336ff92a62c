// Vertices in L1: the cache against a naive model of the same rules, and video memory against the chunk.
#include "tests/gl/gl_support.h"

#include "pcm/gl/l1/l1_cache.h"
#include "pcm/system/error.h"

#include "tests/gl/l1_settings.h"

#include <algorithm>
#include <cstring>
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

class L1CacheWith : public testing::TestWithParam<L1Setting> {};
INSTANTIATE_TEST_SUITE_P(Settings, L1CacheWith, testing::ValuesIn(l1_settings),
                         [](const auto& setting) { return name_of(setting.param); });

}  // namespace

// Without a context, too.
TEST(L1Cache, HasCountedNothingAtFirst)
{
    const L1Statistics s = L1Cache().statistics();
    for (const std::uint64_t count : {s.hits, s.compulsory_misses, s.capacity_misses, s.forced_misses, s.evictions,
                                      s.refused, s.uploaded_bytes, s.written_back_chunks, s.written_back_bytes,
                                      s.failed_write_backs, s.resident_bytes, s.resident_chunks, s.allocated_bytes})
        EXPECT_EQ(count, 0u);
    EXPECT_EQ(s.upload_seconds, 0);
    EXPECT_EQ(s.write_back_seconds, 0);
}

TEST_P(L1CacheWith, RandomUploadsOfVerticesAgreeWithANaiveModel)
{
    PCM_REQUIRE_GL(context, Profile::core);
    std::mt19937_64 random(11);
    const L1Options options = options_of(GetParam());
    L1Cache cache(options);
    L1Model model = model_of(options);
    std::vector<L1Cache::Owner> owners{cache.add_owner(), cache.add_owner(), cache.add_owner()};
    for (const auto owner : owners) model.latest[owner] = 0;

    const std::vector<std::uint32_t> sizes{1, 3840, 3841, 5120, 5121, 12000, 100, 0, 70000};
    std::vector<ChunkPositions> chunks;
    for (std::size_t i = 0; i < sizes.size(); ++i) chunks.push_back(chunk_of(sizes[i], i % 2 == 1, i));
    const std::vector<std::uint8_t> rgba(4 * 70000, 200);
    const std::vector<float> floats(3 * 70000, 1.0f);
    std::uint64_t uploaded_bytes = 0;

    for (int step = 0; step < 60000; ++step) {
        auto& owner = owners[random() % owners.size()];
        const auto node = static_cast<NodeId>(random() % 60);
        const std::uint64_t action = random() % 1000;
        if (action < (step / 5000 % 2 ? 100u : 2u)) {  // phases of few frames, in which much is protected
            cache.begin_frame(owner);
            model.latest[owner] = ++model.frame;
        } else if (action < 700) {
            ASSERT_EQ(cache.use(owner, node) != nullptr, model.use(owner, node)) << "step " << step;
        } else if (action < 998) {
            const std::size_t chunk = random() % 1000 < 3 ? 8 : node % 8;
            const VertexFormat format{static_cast<ColourSource>(random() % 4), random() % 2 == 1, random() % 2 == 1};
            const std::uint32_t per_page = L1Cache::points_per_page(format);
            const bool done =
                model.insert(owner, node, (sizes[chunk] + per_page - 1) / per_page, format.number(), false);
            ASSERT_EQ(cache.upload(
                          owner, node,
                          make_vertices(chunks[chunk], {1, 1, 1}, format, {rgba.data(), floats.data(), floats.data()})),
                      done)
                << "step " << step;
            if (!done) continue;
            model.find(owner, node)->content = format.number();
            uploaded_bytes += sizes[chunk] * format.stride();
        } else {
            cache.remove_owner(owner);
            model.remove_owner(owner);
            owner = cache.add_owner();
            model.latest[owner] = 0;
        }
        const L1Statistics s = cache.statistics();
        ASSERT_LE(s.allocated_bytes, options.capacity_bytes);
        ASSERT_LE(s.resident_bytes, s.allocated_bytes);
        ASSERT_EQ(s.resident_bytes, model.pages_in_use() * L1Cache::page_bytes) << "step " << step;
        ASSERT_EQ(s.resident_chunks, model.entries.size());
        if (step % 50 == 0) {
            for (const auto o : owners) {
                std::size_t available = model.max_blocks * pages_per_block;
                for (const auto& e : model.entries)
                    if (e.owner != o && model.is_protected(e)) available -= e.pages.size();
                ASSERT_EQ(cache.pages_available(o), available);
            }
            // No two entries share a vertex.
            std::vector<std::array<std::uint64_t, 3>> spans;  // buffer, first byte, end
            for (const auto& e : model.entries) {
                const VertexEntry* entry = cache.find(e.owner, e.node);
                ASSERT_TRUE(entry);
                ASSERT_EQ(entry->format.number(), e.content);
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
    expect_same_counts(s, model.counts);
    EXPECT_EQ(s.uploaded_bytes, uploaded_bytes);
    EXPECT_EQ(s.upload_times.count(), s.compulsory_misses + s.capacity_misses);
    EXPECT_GT(s.evictions, 1000u);
    EXPECT_GT(s.refused, 100u);
    EXPECT_GT(s.capacity_misses, 1000u);
    EXPECT_EQ(glGetError(), static_cast<GLenum>(GL_NO_ERROR));
    cache.release();
    EXPECT_EQ(cache.statistics().allocated_bytes, 0u);
    EXPECT_TRUE(cache.upload(owners[0], 1, make_vertices(chunks[1], {1, 1, 1}, {}, {})));  // usable afterwards
    cache.release();
}

TEST(L1Cache, RequestsEndWhenTheTimeIsSpentAndWithoutALimitWhenAllIsUploaded)
{
    L1Cache cache;
    std::vector<NodeId> uploaded;
    const std::vector<NodeId> nodes{4, 5, 6, 7};
    const auto ready = [](NodeId node) { return node == 5 ? Supply::absent : Supply::ready; };
    const auto upload = [&](NodeId node) {
        uploaded.push_back(node);
        return true;
    };
    Served served = cache.request(nodes, 0.0, ready, upload);  // at least one
    EXPECT_EQ(uploaded, (std::vector<NodeId>{4}));
    EXPECT_EQ(served.uploaded, 1u);
    EXPECT_TRUE(served.out_of_time);
    served = cache.request(
        nodes, 0.0, [](NodeId node) { return node == 4 ? Supply::ready : Supply::absent; }, upload);
    EXPECT_FALSE(served.out_of_time);  // every ready node was uploaded
    uploaded.clear();
    served = cache.request(nodes, std::nullopt, ready, upload);
    EXPECT_EQ(uploaded, (std::vector<NodeId>{4, 6, 7}));
    EXPECT_FALSE(served.out_of_time || served.refused);
    served = cache.request(
        nodes, 1e9, [](NodeId node) { return node == 6 ? Supply::stop : Supply::ready; }, upload);
    EXPECT_EQ(served.uploaded, 2u);
    served = cache.request(nodes, 1e9, ready, [](NodeId node) { return node == 4; });
    EXPECT_EQ(served.uploaded, 1u);
    EXPECT_TRUE(served.refused);
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
            for (unsigned form = 0; form < 8; ++form) {
                const VertexFormat format{form & 1 ? ColourSource::rgb : ColourSource::none, (form & 2) != 0,
                                          (form & 4) != 0};
                const ChunkPositions positions = chunk_of(points, wide, points);
                std::vector<std::uint8_t> rgba(4 * points);
                for (std::size_t i = 0; i < rgba.size(); ++i) rgba[i] = static_cast<std::uint8_t>(i * 7);
                std::vector<float> radii(points), normals(3 * points);
                for (std::size_t i = 0; i < points; ++i) radii[i] = static_cast<float>((i * 7919) % 10007) * 0.01f;
                for (std::size_t i = 0; i < normals.size(); ++i) normals[i] = static_cast<float>(i % 1000) * 0.001f;
                ASSERT_TRUE(
                    cache.upload(owner, points,
                                 make_vertices(positions, scale, format, {rgba.data(), radii.data(), normals.data()})));
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
                    const std::byte* const at = bytes.data() + i * entry->stride();
                    if (format.colour != ColourSource::none)
                        ASSERT_EQ(std::memcmp(at + VertexFormat::colour_place, rgba.data() + i * 4, 4), 0);
                    if (format.radius) ASSERT_EQ(std::memcmp(at + format.radius_place(), &radii[i], 4), 0);
                    if (format.normal) ASSERT_EQ(std::memcmp(at + VertexFormat::normal_place, &normals[3 * i], 12), 0);
                }
                EXPECT_EQ(entry->extent, extent);
                EXPECT_EQ(entry->largest_radius, format.radius ? *std::max_element(radii.begin(), radii.end()) : 0);
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
// What splats of a chunk are estimated by: the largest radius and the root of the mean square.
TEST(L1Radii, AreThoseOfAllPoints)
{
    PCM_REQUIRE_GL(context, Profile::core);
    L1Cache cache{L1Options{}};
    const auto owner = cache.add_owner();
    std::mt19937_64 random(3);
    for (const std::uint32_t points : {1u, 2u, 127u, 128u, 129u, 5000u}) {
        std::vector<float> radii(points);
        double squares = 0;
        float largest = 0;
        for (float& radius : radii) {
            radius = static_cast<float>(random() % 1000) / 100 + 0.01f;
            squares += double(radius) * double(radius);
            largest = std::max(largest, radius);
        }
        std::swap(radii[0], *std::max_element(radii.begin(), radii.end()));
        const double before = cache.statistics().upload_seconds;
        const VertexFormat format{ColourSource::none, true, false};
        ASSERT_TRUE(cache.upload(
            owner, points,
            make_vertices(chunk_of(points, false, points), {1, 1, 1}, format, {nullptr, radii.data(), nullptr})));
        const VertexEntry* entry = cache.find(owner, points);
        ASSERT_TRUE(entry);
        EXPECT_EQ(entry->largest_radius, largest);
        EXPECT_NEAR(entry->typical_radius / std::sqrt(squares / points), 1, 1e-6) << points;
        EXPECT_GT(cache.statistics().upload_seconds, before) << "the time of the upload counts";
    }
}
