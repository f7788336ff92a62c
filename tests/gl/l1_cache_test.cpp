// L1 against a naive model of the same rules, and what lies in video memory against the chunk.
#include "tests/gl/gl_support.h"

#include "pcm/gl/l1_cache.h"
#include "pcm/system/error.h"

#include "tests/gl/l1_model.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>
#include <random>
#include <set>

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

constexpr std::uint32_t pages_a_block = (1u << 20) / L1Cache::page_bytes;

L1Model model_of(const L1Options& options)
{
    L1Model model;
    model.policy = options.policy;
    model.pages_per_block = pages_a_block;
    model.max_blocks = static_cast<std::uint32_t>(options.capacity_bytes / options.block_bytes);
    return model;
}

void expect_same_counts(const L1Statistics& s, const L1Counts& counts)
{
    EXPECT_EQ(s.hits, counts.hits);
    EXPECT_EQ(s.compulsory_misses, counts.compulsory_misses);
    EXPECT_EQ(s.capacity_misses, counts.capacity_misses);
    EXPECT_EQ(s.forced_misses, counts.forced_misses);
    EXPECT_EQ(s.evictions, counts.evictions);
    EXPECT_EQ(s.refused, counts.refused);
}

struct Setting {
    L1Policy policy;
    L1Container container;
};
class L1CacheWith : public testing::TestWithParam<Setting> {};
INSTANTIATE_TEST_SUITE_P(Settings, L1CacheWith,
                         testing::Values(Setting{L1Policy::lru, L1Container::hash_map},
                                         Setting{L1Policy::lru, L1Container::ordered_map},
                                         Setting{L1Policy::naive, L1Container::hash_map},
                                         Setting{L1Policy::naive, L1Container::ordered_map}),
                         [](const auto& setting) {
                             return std::string(setting.param.policy == L1Policy::lru ? "Lru" : "Naive") +
                                    (setting.param.container == L1Container::hash_map ? "HashMap" : "OrderedMap");
                         });

L1Options options_of(const Setting& setting)
{
    L1Options options;
    options.block_bytes = 1u << 20;
    options.capacity_bytes = 5 * (1u << 20) + 12345;  // not a whole number of blocks
    options.policy = setting.policy;
    options.container = setting.container;
    return options;
}

}  // namespace

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
        if (action < (step / 5000 % 2 ? 100u : 2u)) {  // at times few frames, so that much is protected
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
            ASSERT_EQ(cache.upload(owner, node, chunks[chunk], {1, 1, 1}, format,
                                   {rgba.data(), floats.data(), floats.data()}),
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
                std::size_t available = model.max_blocks * pages_a_block;
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
    EXPECT_TRUE(cache.upload(owners[0], 1, chunks[1], {1, 1, 1}, {}, {}));  // usable afterwards
    cache.release();
}

namespace {

using Bytes = std::vector<std::byte>;
using Columns = std::vector<Bytes>;
using Key = std::pair<L1Cache::Owner, NodeId>;

const std::vector<std::uint32_t> strides{12, 4, 7};

Columns random_columns(std::uint32_t points, std::uint64_t seed)
{
    std::mt19937_64 random(seed);
    Columns columns;
    for (const std::uint32_t stride : strides) {
        Bytes bytes(std::size_t(points) * stride);
        const auto first = random(), step = random() | 1;
        for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = static_cast<std::byte>((first + i * step) >> 13);
        columns.push_back(std::move(bytes));
    }
    return columns;
}

std::vector<ColumnSource> sources_of(const Columns& columns)
{
    std::vector<ColumnSource> sources;
    for (std::size_t k = 0; k < columns.size(); ++k)
        sources.push_back({strides[k], [&bytes = columns[k], stride = strides[k]](std::byte* to, std::size_t first,
                                                                                  std::size_t count) {
                               std::copy_n(bytes.data() + first * stride, count * stride, to);
                           }});
    return sources;
}

// What a shader would do: other bytes in the column's buffers.
void change_in_video_memory(const ColumnEntry& entry, std::size_t column, const Bytes& bytes)
{
    for (const ColumnPiece& piece : entry.pieces) {
        const BufferRange& range = piece.columns[column];
        glBindBuffer(GL_COPY_WRITE_BUFFER, range.buffer);
        glBufferSubData(GL_COPY_WRITE_BUFFER, static_cast<GLintptr>(range.offset), static_cast<GLsizeiptr>(range.bytes),
                        bytes.data() + std::size_t(piece.first) * entry.strides[column]);
    }
}

// An owner's store, whose disk has faults at some nodes for the time being.
struct FaultyStore final : L1WriteBack {
    const std::set<NodeId>* broken = nullptr;
    std::map<NodeId, std::map<std::size_t, Bytes>> stored;
    std::uint64_t bytes = 0;
    void write(NodeId node, const ChangedColumns& changed) override
    {
        std::map<std::size_t, Bytes> read;
        for (const std::size_t k : changed.columns()) {
            read[k].resize(std::size_t(changed.points()) * strides[k]);
            changed.read(k, read[k].data());
            if (broken && broken->count(node))
                throw Error(ErrorCode::no_space, "/cloud", "node " + std::to_string(node));
        }
        for (auto& [k, column] : read) {
            bytes += column.size();
            stored[node][k] = std::move(column);
        }
    }
};

}  // namespace

TEST_P(L1CacheWith, RandomChangesOfColumnsComeBackByteForByte)
{
    PCM_REQUIRE_GL(context, Profile::core);
    std::mt19937_64 random(13);
    L1Options options = options_of(GetParam());
    L1Cache cache(options);
    L1Model model = model_of(options);
    std::set<NodeId> broken;
    model.write_back = [&](const L1Model::Entry& e) { return !broken.count(e.node); };
    std::map<L1Cache::Owner, std::shared_ptr<FaultyStore>> stores;
    std::vector<L1Cache::Owner> owners;
    const auto add_owner = [&] {
        auto store = std::make_shared<FaultyStore>();
        store->broken = &broken;
        const auto owner = cache.add_owner(store);
        stores[owner] = store;
        model.latest[owner] = 0;
        return owner;
    };
    for (int i = 0; i < 2; ++i) owners.push_back(add_owner());
    std::map<Key, Columns> shadow;  // of what was uploaded last, with what was changed since
    std::map<L1Cache::Owner, std::map<NodeId, std::map<std::size_t, Bytes>>> marked;
    const std::vector<std::uint32_t> sizes{1, 255, 256, 257, 5120, 5121, 0, 30000};
    std::uint64_t refused_by_store = 0, failed_flushes = 0, failed_shrinks = 0;

    for (std::uint64_t step = 0; step < 10000; ++step) {
        auto& owner = owners[random() % owners.size()];
        const auto node = static_cast<NodeId>(random() % 30);
        const std::uint64_t action = random() % 1000;
        if (action < 80) {
            cache.begin_frame(owner);
            model.latest[owner] = ++model.frame;
        } else if (action < 350) {
            ASSERT_EQ(cache.use_columns(owner, node) != nullptr, model.use(owner, node)) << "step " << step;
        } else if (action < 600) {
            const std::uint32_t points = sizes[random() % sizes.size()];
            std::size_t pages = 0;
            for (const std::uint32_t stride : strides) pages += L1Cache::pages_of(stride, points);
            Columns columns = random_columns(points, step);
            const bool done = model.insert(owner, node, pages, 0, step % 2 != 0);
            ASSERT_EQ(
                cache.upload_columns(owner, node, points, {1, 2, 3}, sources_of(columns), step % 2 != 0) != nullptr,
                done)
                << "step " << step;
            if (done) shadow[{owner, node}] = std::move(columns);
            if (!done && cache.write_back_error()) ++refused_by_store;
        } else if (action < 850) {
            const ColumnEntry* const entry = cache.find_columns(owner, node);
            if (entry) {
                const std::size_t k = random() % strides.size();
                Bytes bytes = random_columns(entry->points, step)[k];
                change_in_video_memory(*entry, k, bytes);
                cache.mark_written(owner, node, k);
                model.find(owner, node)->written = true;
                shadow[{owner, node}][k] = bytes;
                marked[owner][node][k] = std::move(bytes);
            }
        } else if (action < 930) {
            if (!broken.erase(node) && broken.size() < 8) broken.insert(node);
        } else if (action < 960) {
            const bool fails = model.flush(&owner) > 0;
            if (fails)
                EXPECT_THROW(cache.flush(owner), Error) << "step " << step;
            else
                EXPECT_NO_THROW(cache.flush(owner)) << "step " << step;
            failed_flushes += fails;
        } else if (action < 990) {
            const auto blocks = static_cast<std::uint32_t>(2 + random() % 4);
            const bool done = model.set_blocks(blocks);
            if (done)
                EXPECT_NO_THROW(cache.set_capacity(blocks * options.block_bytes + 5)) << "step " << step;
            else
                EXPECT_THROW(cache.set_capacity(blocks * options.block_bytes + 5), Error) << "step " << step;
            failed_shrinks += !done;
        } else {
            cache.remove_owner(owner);
            model.remove_owner(owner);
            owner = add_owner();
        }
        ASSERT_EQ(cache.statistics().resident_bytes, model.pages_in_use() * L1Cache::page_bytes) << "step " << step;
        ASSERT_LE(cache.statistics().allocated_bytes, cache.options().capacity_bytes);
        if (step % 100 == 0)
            for (const auto& e : model.entries) {
                const ColumnEntry* const entry = cache.find_columns(e.owner, e.node);
                ASSERT_TRUE(entry) << "step " << step;
                const Columns& expected = shadow.at({e.owner, e.node});
                for (std::size_t k = 0; k < strides.size(); ++k)
                    ASSERT_EQ(cache.read(e.owner, e.node, k), expected[k]) << "step " << step << " node " << e.node;
                for (const ColumnPiece& piece : entry->pieces)
                    for (const BufferRange& range : piece.columns) {
                        ASSERT_EQ(range.offset % 256, 0u);
                        ASSERT_LE(range.offset + range.bytes, options.block_bytes);
                    }
            }
    }
    expect_same_counts(cache.statistics(), model.counts);
    EXPECT_GT(refused_by_store + failed_flushes + failed_shrinks, 20u);
    EXPECT_GT(cache.statistics().evictions, 100u);
    EXPECT_GT(cache.statistics().failed_write_backs, 20u);

    // The disk works again: nothing of what was marked, by whatever owner, is lost.
    if (!broken.empty()) broken.clear();
    cache.flush();
    std::uint64_t bytes = 0;
    for (const auto& [owner, nodes] : marked)
        for (const auto& [node, columns] : nodes)
            for (const auto& [k, column] : columns) EXPECT_EQ(stores.at(owner)->stored[node][k], column);
    for (const auto& [owner, store] : stores) bytes += store->bytes;
    EXPECT_EQ(cache.statistics().written_back_bytes, bytes);
    EXPECT_EQ(cache.statistics().write_back_times.count(), cache.statistics().written_back_chunks);
    EXPECT_EQ(glGetError(), static_cast<GLenum>(GL_NO_ERROR));
    cache.release();
    EXPECT_EQ(cache.statistics().resident_chunks, 0u);
}

TEST(L1Cache, WhatCannotBeWrittenBackStaysAndTheErrorReachesTheCaller)
{
    PCM_REQUIRE_GL(context, Profile::core);
    L1Options options;
    options.block_bytes = options.capacity_bytes = 1u << 20;
    L1Cache cache(options);
    const auto store = std::make_shared<FaultyStore>();
    std::set<NodeId> broken{7};
    store->broken = &broken;
    const auto owner = cache.add_owner(store);
    const Columns columns = random_columns(30000, 1);  // 690 kB: there is room for one
    ASSERT_TRUE(cache.upload_columns(owner, 7, 30000, {}, sources_of(columns), true));
    const Columns other = random_columns(30000, 2);
    change_in_video_memory(*cache.find_columns(owner, 7), 1, other[1]);
    cache.mark_written(owner, 7, 1);
    EXPECT_THROW(cache.mark_written(owner, 7, 3), Error);
    EXPECT_THROW(cache.mark_written(owner, 8, 0), Error);
    EXPECT_THROW(cache.mark_written(cache.add_owner(), 7, 0), Error);

    const auto code_of = [](const std::exception_ptr& error) {
        try {
            std::rethrow_exception(error);
        } catch (const Error& e) {
            return e.code();
        }
    };
    cache.begin_frame(owner);
    EXPECT_FALSE(cache.upload_columns(owner, 8, 30000, {}, sources_of(columns), true));
    ASSERT_TRUE(cache.write_back_error());
    EXPECT_EQ(code_of(cache.write_back_error()), ErrorCode::no_space);
    EXPECT_THROW(cache.flush(), Error);
    EXPECT_THROW(cache.release(), Error);
    EXPECT_TRUE(store->stored.empty());
    cache.remove_owner(owner);  // as when a computation ended early
    EXPECT_THROW(cache.release(), Error);
    EXPECT_EQ(cache.read(owner, 7, 1), other[1]);
    cache.flush(owner + 1);  // nothing of that one

    broken.clear();
    cache.release();
    EXPECT_EQ(store->stored.at(7).size(), 1u);
    EXPECT_EQ(store->stored.at(7).at(1), other[1]);
    EXPECT_EQ(cache.statistics().allocated_bytes, 0u);
}

TEST(L1Cache, WhatIsWantedNoMoreIsDiscarded)
{
    PCM_REQUIRE_GL(context, Profile::core);
    L1Cache cache;
    const auto store = std::make_shared<FaultyStore>();
    const std::set<NodeId> broken{1, 2};
    store->broken = &broken;
    const Columns columns = random_columns(10, 1);
    for (const bool of_one : {true, false}) {
        const auto owner = cache.add_owner(store);
        for (const NodeId node : {1u, 2u}) {
            ASSERT_TRUE(cache.upload_columns(owner, node, 10, {}, sources_of(columns), false));
            cache.mark_written(owner, node, 2);
        }
        cache.remove_owner(owner);
        EXPECT_EQ(cache.statistics().resident_chunks, 2u);
        EXPECT_THROW(cache.release(), Error);
        of_one ? cache.discard(owner) : cache.discard();
        EXPECT_EQ(cache.statistics().resident_chunks, 0u);
        cache.release();
    }
    EXPECT_EQ(store.use_count(), 1);
    EXPECT_TRUE(store->stored.empty());
}

TEST(L1Cache, PinnedEntriesKeepTheirPlace)
{
    PCM_REQUIRE_GL(context, Profile::core);
    L1Options options;
    options.block_bytes = options.capacity_bytes = 1u << 20;
    L1Cache cache(options);
    const auto owner = cache.add_owner();
    const Columns columns = random_columns(30000, 1);
    ASSERT_TRUE(cache.upload_columns(owner, 1, 30000, {}, sources_of(columns), false));
    cache.pin(owner, 1);
    for (int frame = 0; frame < 40; ++frame) cache.begin_frame(owner);
    EXPECT_FALSE(cache.upload_columns(owner, 2, 30000, {}, sources_of(columns), false));
    EXPECT_FALSE(cache.upload_columns(owner, 1, 5, {}, sources_of(columns), false));
    EXPECT_THROW(cache.release(), Error);
    cache.remove_owner(owner);
    EXPECT_EQ(cache.read(owner, 1, 2), columns[2]);
    cache.unpin(owner, 1);
    EXPECT_EQ(cache.statistics().resident_chunks, 0u);
    EXPECT_THROW(cache.upload_columns(owner, 1, 5, {}, sources_of(columns), false), Error);  // no such owner any more
    cache.release();
}

TEST(L1Cache, RequestsEndWhenTheTimeIsSpentAndWithoutATimeWhenAllIsThere)
{
    L1Cache cache;
    std::vector<NodeId> uploaded;
    const std::vector<NodeId> nodes{4, 5, 6, 7};
    const auto ready = [](NodeId node) { return node == 5 ? Supply::absent : Supply::ready; };
    const auto upload = [&](NodeId node) {
        uploaded.push_back(node);
        return true;
    };
    Served served = cache.request(nodes, 0.0, ready, upload);  // one, whatever it takes
    EXPECT_EQ(uploaded, (std::vector<NodeId>{4}));
    EXPECT_EQ(served.uploaded, 1u);
    EXPECT_TRUE(served.out_of_time);
    served = cache.request(
        nodes, 0.0, [](NodeId node) { return node == 4 ? Supply::ready : Supply::absent; }, upload);
    EXPECT_FALSE(served.out_of_time);  // nothing that is ready is left
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
                    cache.upload(owner, points, positions, scale, format, {rgba.data(), radii.data(), normals.data()}));
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
