#include "pcm/cluster/filter/chunk_jobs.h"

#include "pcm/bpc/byte_order.h"
#include "pcm/bpc/chunk_encoder.h"
#include "pcm/cluster/filter/tree_jobs.h"
#include "pcm/cluster/share_jobs.h"
#include "pcm/cluster/team_work.h"
#include "pcm/system/error.h"
#include "pcm/threads/thread_count.h"
#include "pcm/tree/point_hash.h"

#include <algorithm>
#include <cstring>
#include <string>
#include <utility>

namespace pcm {
namespace {

constexpr const char* chunks_stage = "chunks";

}  // namespace

ChunkJobs::ChunkJobs(const JobFolder& jobs, const Tree& tree, bool longer, const UnitResults& results,
                     ChunkValues values)
    : folder_(jobs), tree_(tree), longer_(longer), results_(results), values_(std::move(values))
{
    first_ =
        divide_among_jobs(static_cast<NodeId>(tree.nodes().size()), [&](NodeId id) { return tree.node(id).points; });
    jobs.begin(chunks_stage);
}

void ChunkJobs::encode(Team& team, unsigned threads, Watch& watch, double begin, double end) const
{
    const double all = static_cast<double>(std::max<std::size_t>(1, jobs()));
    share_jobs(
        team, count_nodes, jobs(), thread_count(threads),
        [&](std::size_t job) {
            if (!folder_.is_done({chunks_stage, job})) work(job);
        },
        [&](std::size_t begun) {
            watch.report("Writing chunks", begin + (end - begin) * static_cast<double>(std::min(begun, jobs())) / all);
        });
}

void ChunkJobs::work(std::size_t job) const
{
    const TreeInfo& info = tree_.info();
    const RowLayout layout(info.schema, info.wide);
    const JobFolder::Key key{chunks_stage, job};
    const std::filesystem::path path = folder_.unfinished(key);
    std::vector<std::byte> scratch;
    std::uint64_t end = 0, changed = 0;
    ByteWriter record;
    {
        File file(path, File::Mode::create_new);
        for (NodeId node = first_[job]; node < first_[job + 1]; ++node) {
            if (tree_.node(node).points == 0) continue;
            std::uint64_t hash_before = 0;
            const Chunk chunk = chunk_of(node, hash_before, changed);
            ChunkIdentity identity = tree_.identity(node);
            identity.generation = info.generation + 1;
            const std::vector<std::byte> bytes = encode_chunk(chunk, info.schema, info.grid, identity);
            file.write_at(bytes.data(), bytes.size(), end);
            end += bytes.size();
            record.put(node);
            record.put(static_cast<std::uint64_t>(bytes.size()));
            record.put(hash_before);
            record.put(hash_chunk(chunk, layout, scratch));
        }
    }
    record.put(changed);
    folder_.finish(key, path, end, record.bytes());
}

Chunk ChunkJobs::chunk_of(NodeId node, std::uint64_t& hash_before, std::uint64_t& changed) const
{
    const Schema& schema = tree_.info().schema;
    ColumnSet columns = ColumnSet::whole(schema);
    if (longer_)  // its points had no hash with these attributes
        for (const std::size_t place : values_.places) columns.attributes.reset(place);
    Chunk chunk = tree_.read_chunk(node, columns);
    std::vector<std::byte> scratch;
    if (!longer_) hash_before = hash_chunk(chunk, RowLayout(schema, tree_.info().wide), scratch);
    std::vector<Column> made;
    for (const std::size_t place : values_.places) {
        made.emplace_back(schema[place]);
        made.back().resize(chunk.points);
    }
    std::size_t points = 0;
    results_.for_each_of_node(node, [&](const UnitResults::Part& part) {
        for (std::size_t c = 0; c < made.size(); ++c) {
            std::vector<std::byte> values = part.columns[c];
            if (values_.finish && values_.places[c] == values_.finished) changed += values_.finish(part, values);
            const std::size_t width = made[c].point_bytes();
            for (std::size_t i = 0; i < part.indices.size(); ++i)
                std::memcpy(made[c].data() + part.indices[i] * width, values.data() + i * width, width);
        }
        points += part.indices.size();
    });
    if (points != chunk.points)
        throw Error(ErrorCode::corrupt, tree_.folder(),
                    std::to_string(points) + " values were computed for " + std::to_string(chunk.points) +
                        " points of node " + std::to_string(node));
    for (std::size_t c = 0; c < made.size(); ++c)
        chunk.attributes[values_.places[c]] = std::make_shared<const Column>(std::move(made[c]));
    return chunk;
}

std::uint64_t ChunkJobs::put(TreeChanges& changes, Watch& watch, double begin, double end) const
{
    std::uint64_t changed = 0;
    std::vector<std::byte> bytes;
    for (std::size_t job = 0; job < jobs(); ++job) {
        const JobFolder::Key key{chunks_stage, job};
        const std::vector<std::byte> record = folder_.record(key);
        const File file(folder_.file(key), File::Mode::read);
        ByteReader in(record.data(), record.size(), file.path());
        std::uint64_t at = 0;
        while (in.left() > sizeof changed) {
            const auto node = in.get<NodeId>();
            bytes.resize(in.get<std::uint64_t>());
            file.read_at(bytes.data(), bytes.size(), at);
            at += bytes.size();
            const auto hash_before = in.get<std::uint64_t>();
            changes.put(node, bytes, hash_before, in.get<std::uint64_t>());
        }
        changed += in.get<std::uint64_t>();
        watch.report("Putting the tree together",
                     begin + (end - begin) * static_cast<double>(job) / static_cast<double>(jobs()));
    }
    return changed;
}

}  // namespace pcm
