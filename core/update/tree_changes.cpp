#include "pcm/update/tree_changes.h"

#include "pcm/bpc/chunk_decoder.h"
#include "pcm/bpc/chunk_encoder.h"
#include "pcm/cloud/attribute_names.h"
#include "pcm/system/error.h"
#include "pcm/system/work_done.h"
#include "pcm/threads/ordered.h"
#include "pcm/threads/thread_count.h"
#include "pcm/tree/point_hash.h"

namespace pcm {

TreeChanges::TreeChanges(const std::filesystem::path& path)
    : update_(std::in_place, path), tree_(update_->tree()), hash_(tree_->info().content_hash)
{
}

std::shared_ptr<const Tree> TreeChanges::tree() const
{
    const std::shared_lock lock(mutex_);
    return tree_;
}

std::optional<TreeChanges::Place> TreeChanges::place_of(NodeId node) const
{
    const std::lock_guard lock(file_mutex_);
    const auto found = places_.find(node);
    if (found == places_.end()) return std::nullopt;
    return found->second;
}

Chunk TreeChanges::read(NodeId node, const ColumnSet& columns) const
{
    const std::shared_lock lock(mutex_);
    return read_now(node, columns);
}

Chunk TreeChanges::read_now(NodeId node, const ColumnSet& columns) const
{
    const auto place = place_of(node);
    if (!place) return tree_->read_chunk(node, columns);
    const Extent& extent = place->extent;
    Chunk chunk = read_chunk(*place->file, extent.offset, extent.bytes, extent.header_bytes, columns).chunk;
    count_points_read(tree_->node(node).points);
    add_missing_columns(chunk, tree_->info().schema, columns);
    return chunk;
}

void TreeChanges::read_many(const std::vector<ChunkRequest>& requests, const TakeChunk& take) const
{
    for (const ChunkRequest& request : requests)
        if (place_of(request.node)) return ChunkStore::read_many(requests, take);
    tree()->read_chunks(requests, take);
}

ChunkPart TreeChanges::read_part(NodeId node, const ColumnSet& columns,
                                 const std::function<bool(const Box3i& box, std::uint16_t level)>& wanted) const
{
    const std::shared_lock lock(mutex_);
    const auto place = place_of(node);
    if (!place) return tree_->read_chunk_part(node, columns, wanted);
    const Extent& extent = place->extent;
    DecodedPart decoded =
        read_chunk_part(*place->file, extent.offset, extent.bytes, extent.header_bytes, columns, wanted);
    add_missing_columns(decoded.chunk, tree_->info().schema, columns);
    ChunkPart part;
    for (const std::uint32_t s : decoded.kept) {
        part.first.push_back(decoded.header.segments[s].first);
        part.count.push_back(decoded.header.segments[s].count);
        count_points_read(part.count.back());
    }
    part.chunk = std::move(decoded.chunk);
    part.bytes_read = decoded.bytes_read;
    return part;
}

void TreeChanges::write(NodeId node, const Chunk& written, const ColumnSet& changed)
{
    const std::shared_lock lock(mutex_);
    check_open();
    const TreeInfo& info = tree_->info();
    Chunk chunk = written;  // its columns are shared
    // An attribute may have been added since the chunk was read.
    add_missing_columns(chunk, info.schema, ColumnSet::all(info.schema));
    if (chunk.points != tree_->node(node).points || !chunk.columns().contains(ColumnSet::all(info.schema)))
        throw Error(ErrorCode::invalid_argument, tree_->folder(),
                    "a chunk of other points was to replace the one of node " + std::to_string(node));
    if (chunk.points == 0) return;
    std::vector<std::byte> scratch;
    const RowLayout layout(info.schema, info.wide);
    const std::uint64_t hash = hash_chunk(chunk, layout, scratch);

    // The hash of the old points; it is known for a chunk that was written since the last commit.
    std::uint64_t hash_before = 0;
    if (!longer_schema_ && !place_of(node)) {
        ColumnSet columns = changed;
        columns.positions = false;
        Chunk before = tree_->read_chunk(node, columns);
        before.positions = chunk.positions;
        for (std::size_t k = 0; k < before.attributes.size(); ++k)
            if (!before.attributes[k]) before.attributes[k] = chunk.attributes[k];
        hash_before = hash_chunk(before, layout, scratch);
    }
    ChunkIdentity identity = tree_->identity(node);
    identity.generation = update_->generation();
    keep(node, encode_chunk(chunk, info.schema, info.grid, identity), hash_before, hash);
}

void TreeChanges::put(NodeId node, const std::vector<std::byte>& bytes, std::uint64_t hash_before, std::uint64_t hash)
{
    const std::shared_lock lock(mutex_);
    check_open();
    keep(node, bytes, hash_before, hash);
}

void TreeChanges::keep(NodeId node, const std::vector<std::byte>& bytes, std::uint64_t hash_before, std::uint64_t hash)
{
    const std::lock_guard file_lock(file_mutex_);
    Place place;
    place.hash = hash;
    place.attributes = tree_->info().schema.size();
    place.extent = update_->write(bytes);
    const std::size_t number = place.extent.file - tree_->data_files().size();
    while (files_.size() <= number)
        files_.push_back(std::make_shared<const File>(
            update_->folder() / data_file_name(static_cast<std::uint32_t>(tree_->data_files().size() + files_.size())),
            File::Mode::read));
    place.file = files_[number];
    const auto found = places_.find(node);
    hash_ += hash - (found == places_.end() ? hash_before : found->second.hash);
    places_[node] = std::move(place);
}

// Chunks that were written before the attributes were added count with zeros.
std::uint64_t TreeChanges::hash_with_added_attributes() const
{
    const TreeInfo& info = tree_->info();
    const RowLayout layout(info.schema, info.wide);
    std::vector<NodeId> others;
    std::uint64_t sum = 0;
    for (NodeId id = 0; id < tree_->nodes().size(); ++id) {
        const auto place = places_.find(id);
        if (place != places_.end() && place->second.attributes == info.schema.size())
            sum += place->second.hash;
        else if (tree_->node(id).points)
            others.push_back(id);
    }
    in_turn(
        others.size(), thread_count(0),
        [&](std::size_t i) {
            std::vector<std::byte> scratch;
            return hash_chunk(read_now(others[i], ColumnSet::all(info.schema)), layout, scratch);
        },
        [&](std::size_t, std::uint64_t hash) { sum += hash; }, [](std::size_t) {});
    return sum;
}

void TreeChanges::commit()
{
    const std::unique_lock lock(mutex_);
    if (places_.empty() && !longer_schema_) return;
    check_open();
    TreeInfo info = tree_->info();
    info.content_hash = longer_schema_ ? hash_with_added_attributes() : hash_;
    NodeVector nodes{tree_->nodes().all(), tree_->part_roots()};
    for (const auto& [node, place] : places_) nodes.nodes[node].extent = place.extent;
    try {
        update_->commit_and_continue(std::move(info), std::move(nodes));
    } catch (const Error& error) {
        if (error.is_done()) take_next_tree();
        throw;
    }
    take_next_tree();
}

void TreeChanges::take_next_tree()
{
    tree_ = update_->tree();
    hash_ = tree_->info().content_hash;
    places_.clear();
    files_.clear();
    longer_schema_ = false;
}

std::size_t TreeChanges::add_attribute(const Attribute& attribute)
{
    const std::unique_lock lock(mutex_);
    check_open();
    Schema schema = tree_->info().schema;
    check_new_name(attribute.name);
    schema.add(attribute);
    update_->end_file();  // the chunks of a data file are of one schema
    tree_ = tree_->with_schema(schema);
    longer_schema_ = true;
    return schema.size() - 1;
}

void TreeChanges::end()
{
    const std::unique_lock lock(mutex_);
    places_.clear();
    files_.clear();
    longer_schema_ = false;
    update_.reset();
}

void TreeChanges::check_open() const
{
    if (!update_)
        throw Error(ErrorCode::invalid_argument, tree_->folder(), "this point cloud was closed", "open it again");
}

}  // namespace pcm
