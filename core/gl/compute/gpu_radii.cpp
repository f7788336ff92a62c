#include "pcm/gl/compute/gpu_radii.h"

#include "pcm/cloud/attribute_length.h"
#include "pcm/cloud/numbers.h"
#include "pcm/gl/compute/chunk_boxes.h"
#include "pcm/gl/compute/gpu_cursor.h"
#include "pcm/gl/compute/radius_search.h"
#include "pcm/gl/tuning.h"
#include "pcm/system/error.h"
#include "pcm/threads/watch.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <unordered_map>
#include <utility>

namespace pcm {
namespace {

// Points of one node that a workgroup computes.
struct QueryBlock {
    NodeId node = no_node;
    std::size_t number = 0;                     // index of the first of its blocks in the chunk
    std::uint32_t first_point = 0, points = 0;  // range in the chunk
    Box3i box;                                  // grid coordinates
    std::uint32_t first = 0;                    // point of the batch
    double limit = infinity;                    // limit of its points, the largest of RadiusSearch::limits()
    bool begins_in(const GpuPiece& piece) const
    {
        return first_point >= piece.first && first_point - piece.first < piece.count;
    }
};

using QueryBlocks = std::vector<QueryBlock>;

Attribute attribute_of_radii()
{
    Attribute attribute;
    attribute.name = attribute_name::radius;
    attribute.type = ScalarType::f32;
    attribute.description = attribute_unit::radius_description;
    return attribute;
}

void check(const PointCloud& cloud, const GpuRadiiOptions& options)
{
    if (options.neighbours < 1 || options.neighbours > GpuRadiiOptions::most_neighbours)
        throw Error(ErrorCode::invalid_argument, {},
                    "the number of neighbours is " + std::to_string(options.neighbours) + "; it must be 1 to " +
                        std::to_string(GpuRadiiOptions::most_neighbours));
    const Schema& schema = cloud.info().schema;
    if (const auto place = schema.find(attribute_name::radius)) {
        const Attribute& radius = schema[*place];
        if (radius.type != ScalarType::f32 || radius.components != 1 || radius.scale != 1 || radius.offset != 0)
            throw Error(ErrorCode::invalid_argument, cloud.tree()->folder(),
                        "this cloud has an attribute 'radius' that is not one plain f32, so radii cannot be put there",
                        "remove or rename that attribute first");
    }
    const auto place = schema.find(attribute_name::normal);
    if (options.normals && (!place || schema[*place].components != 3))
        throw Error(ErrorCode::invalid_argument, cloud.tree()->folder(),
                    "this cloud has no attribute 'normal' with 3 components",
                    "estimate normals first, or compute radii without them");
}

// Whether some differences of positions need more than 31 bits and a sign.
bool is_wide(const TreeInfo& info)
{
    for (std::size_t a = 0; a < 3; ++a)
        if (info.points > 0 && info.box.max[a] - info.box.min[a] > std::numeric_limits<std::int32_t>::max())
            return true;
    return info.wide;
}

// The square of the distance between two boxes, source units.
double squared_gap(const Box3i& a, const Box3i& b, const Vec3d& scale)
{
    Vec3d gap;
    for (std::size_t i = 0; i < 3; ++i)
        gap[i] = static_cast<double>(std::max({a.min[i] - b.max[i], b.min[i] - a.max[i], std::int64_t(0)})) * scale[i];
    return dot(gap, gap);
}

// The limit is exact to 1e-6.
bool may_have_neighbours(double squared_distance, double limit) { return squared_distance * (1 - 4e-6) < limit; }

// Three numbers per point; see RadiusSearch::begin().
void add_normal(std::vector<double>& normals, const Column& column, const Attribute& attribute, std::size_t point)
{
    Vec3d n;
    for (std::uint32_t c = 0; c < 3; ++c) n[c] = column.value(point, c) * attribute.scale + attribute.offset;
    n = is_finite(n) && largest_magnitude(n) > 0 ? normalised(n) : Vec3d{};
    normals.insert(normals.end(), n.begin(), n.end());
}

class RadiiPass {
public:
    RadiiPass(const std::shared_ptr<PointCloud>& cloud, const std::shared_ptr<L1Cache>& l1,
              const GpuRadiiOptions& options)
        : cloud_(*cloud),
          tree_(cloud->tree()),
          wide_(is_wide(cloud->info())),
          watch_(options.progress),
          cursor_(cloud, l1, query(), {wide_ ? GpuPositions::u64 : GpuPositions::u32, false}),
          search_({options.neighbours, options.normals, wide_, cloud->info().grid.scale})
    {
        if (options.normals) normal_ = tree_->info().schema.find(attribute_name::normal);
        columns_ = ColumnSet::only_positions();
        if (normal_) columns_.attributes.set(*normal_);
    }

    GpuRadiiReport run()
    {
        try {
            if (!tree_->nodes().empty()) descend(0, {});
            cursor_.flush();
        } catch (...) {
            cursor_.discard();
            search_.release();
            throw;
        }
        search_.release();
        report_.outcome.points_in = report_.outcome.points_out = tree_->info().points;
        report_.outcome.seconds = watch_.seconds();
        report_.dispatches = search_.dispatches();
        return report_;
    }

private:
    static Query query()
    {
        Query query;
        query.attributes = {std::string(attribute_name::radius)};
        return query;
    }
    const Node& node(NodeId id) const { return tree_->node(id); }

    void add_blocks(NodeId id, QueryBlocks& blocks);
    void add_subtree(NodeId id, QueryBlocks& blocks);
    void descend(NodeId id, QueryBlocks blocks);
    void compute(const QueryBlocks& blocks);
    void compute_batch(QueryBlocks batch);
    void begin(QueryBlocks& batch);
    std::vector<GpuPiece> pieces_of(const GpuView& view) const;  // for comparisons: positions alone
    void compare_with_own(NodeId id, const QueryBlocks& batch);
    void compare_with_others(QueryBlocks& batch);
    void collect(NodeId id, const QueryBlocks& batch, const std::vector<std::uint32_t>& near,
                 std::vector<std::pair<double, NodeId>>& found) const;
    void set_limits(QueryBlocks& batch);
    void finish(const QueryBlocks& batch);
    const ChunkBoxes& boxes_of(NodeId id);
    template <class Choose>
    void compare(NodeId id, const GpuView& view, const GpuPiece& piece, const QueryBlocks& batch, const Choose& choose);
    void report(bool at_once = false)
    {
        watch_.report("Computing radii", double(done_) / double(std::max<std::uint64_t>(1, tree_->info().points)),
                      at_once);
    }

    PointCloud& cloud_;
    std::shared_ptr<const Tree> tree_;
    const bool wide_;
    Watch watch_;
    GpuCursor cursor_;
    RadiusSearch search_;
    std::optional<std::size_t> normal_;
    ColumnSet columns_;
    std::unordered_map<NodeId, ChunkBoxes> boxes_;
    std::size_t boxes_bytes_ = 0;
    std::uint64_t done_ = 0;  // points
    GpuRadiiReport report_;
};

// Boxes of the chunks used last; all are dropped when they take too much memory.
const ChunkBoxes& RadiiPass::boxes_of(NodeId id)
{
    const auto place = boxes_.find(id);
    if (place != boxes_.end()) return place->second;
    if (boxes_bytes_ > gl_tuning().radii.box_megabytes << 20) {
        boxes_.clear();
        boxes_bytes_ = 0;
    }
    const L2Cache::Handle chunk = cloud_.cache().get(id, ColumnSet::only_positions());
    const ChunkBoxes& made = boxes_.emplace(id, ChunkBoxes(*chunk->positions, node(id))).first->second;
    boxes_bytes_ += made.bytes();
    return made;
}

void RadiiPass::add_blocks(NodeId id, QueryBlocks& blocks)
{
    if (node(id).points == 0) return;
    const ChunkBoxes& own = boxes_of(id);
    for (std::size_t b = 0; b < own.blocks.size(); ++b) {
        QueryBlock block{id, b, own.blocks[b].first, own.blocks[b].count, own.box(b)};
        if (block.points == ChunkBoxes::block_points && b + 1 < own.blocks.size()) {
            ++b;
            block.points += own.blocks[b].count;
            block.box.extend(own.box(b));
        }
        blocks.push_back(block);
    }
}

void RadiiPass::add_subtree(NodeId id, QueryBlocks& blocks)
{
    add_blocks(id, blocks);
    for (const NodeId child : node(id).children)
        if (child != no_node) add_subtree(child, blocks);
}

std::size_t points_of(const QueryBlocks& blocks)
{
    std::size_t points = 0;
    for (const QueryBlock& block : blocks) points += block.points;
    return points;
}

// `blocks` are those of the nodes above that lie nearer to this node than to its sibling.
void RadiiPass::descend(NodeId id, QueryBlocks blocks)
{
    if (points_of(blocks) + node(id).subtree_points <= search_.most_points()) {
        add_subtree(id, blocks);
        return compute(blocks);
    }
    add_blocks(id, blocks);
    std::vector<NodeId> children;
    for (const NodeId child : node(id).children)
        if (child != no_node && node(child).subtree_points > 0) children.push_back(child);
    if (children.empty()) return compute(blocks);
    const Vec3d& scale = tree_->info().grid.scale;
    std::vector<QueryBlocks> parts(children.size());
    for (const QueryBlock& block : blocks) {
        const bool second = children.size() > 1 && squared_gap(block.box, node(children[1]).box, scale) <
                                                       squared_gap(block.box, node(children[0]).box, scale);
        parts[second].push_back(block);
    }
    blocks = {};
    for (std::size_t c = 0; c < children.size(); ++c) descend(children[c], std::move(parts[c]));
}

void RadiiPass::compute(const QueryBlocks& blocks)
{
    QueryBlocks batch;
    std::size_t points = 0;
    for (const QueryBlock& block : blocks) {
        if (points + block.points > search_.most_points()) {
            compute_batch(std::exchange(batch, {}));
            points = 0;
        }
        batch.push_back(block);
        points += block.points;
    }
    if (points > 0) compute_batch(std::move(batch));
}

// A point's own node, whose points are as dense, comes first, so that of the others only what is near is looked at.
void RadiiPass::compute_batch(QueryBlocks batch)
{
    begin(batch);
    NodeId last = no_node;
    for (const QueryBlock& block : batch)
        if (block.node != last) compare_with_own(last = block.node, batch);
    compare_with_others(batch);
    finish(batch);
    done_ += points_of(batch);
    ++report_.batches;
    report(true);
}

void RadiiPass::begin(QueryBlocks& batch)
{
    std::vector<std::uint32_t> positions;
    std::vector<double> normals;
    const Vec3i& origin = tree_->info().box.min;
    std::uint32_t first = 0;
    L2Cache::Handle chunk;
    NodeId held = no_node;
    for (QueryBlock& block : batch) {
        if (block.node != held) chunk = cloud_.cache().get(held = block.node, columns_);
        block.first = first;
        first += block.points;
        for (std::uint32_t i = block.first_point; i < block.first_point + block.points; ++i) {
            for (std::size_t a = 0; a < 3; ++a) {
                const auto steps =
                    static_cast<std::uint64_t>(chunk->positions->grid(i, a)) - static_cast<std::uint64_t>(origin[a]);
                positions.push_back(static_cast<std::uint32_t>(steps));
                if (wide_) positions.push_back(static_cast<std::uint32_t>(steps >> 32));
            }
            if (normal_) add_normal(normals, *chunk->attributes[*normal_], tree_->info().schema[*normal_], i);
        }
    }
    search_.begin(positions, normals);
}

std::vector<GpuPiece> RadiiPass::pieces_of(const GpuView& view) const
{
    const std::uint32_t most = search_.most_piece_points();
    std::vector<GpuPiece> pieces;
    for (const GpuPiece& whole : view.pieces())
        for (std::uint32_t first = 0; first < whole.count; first += most) {
            GpuPiece piece = whole;
            piece.first += first;
            piece.count = std::min(most, whole.count - first);
            const std::uint64_t bytes = whole.positions.bytes / whole.count;  // bytes per point
            piece.positions.offset += first * bytes;
            piece.positions.bytes = piece.count * bytes;
            pieces.push_back(std::move(piece));
        }
    return pieces;
}

// `choose` returns whether a block is to be compared with the piece.
template <class Choose>
void RadiiPass::compare(NodeId id, const GpuView& view, const GpuPiece& piece, const QueryBlocks& batch,
                        const Choose& choose)
{
    const PieceBoxes boxes(boxes_of(id), piece.first, piece.count, wide_);
    std::vector<RadiusSearch::Block> blocks;
    for (const QueryBlock& block : batch) {
        if (!choose(block)) continue;
        RadiusSearch::Block one{block.first, block.points, boxes.groups, RadiusSearch::not_inside};
        if (block.node == id) one.self = block.first_point - piece.first;
        if (block.node == id && block.begins_in(piece)) one.start = boxes.box_of(block.number);
        blocks.push_back(one);
    }
    Vec3i shift;
    for (std::size_t a = 0; a < 3; ++a) shift[a] = tree_->info().box.min[a] - view.origin()[a];
    search_.compare(piece, boxes, shift, blocks);
    report();
}

// Points of the node with points of the node, beginning with the piece that each is in.
void RadiiPass::compare_with_own(NodeId id, const QueryBlocks& batch)
{
    const GpuView view = cursor_.get(id);
    const std::vector<GpuPiece> pieces = pieces_of(view);
    for (const bool inside : {true, false})
        for (const GpuPiece& piece : pieces)
            compare(id, view, piece, batch, [&, inside](const QueryBlock& block) {
                return block.node == id && block.begins_in(piece) == inside;
            });
}

// The nodes of the subtree in which the blocks `near` can have neighbours, with the smallest square of a distance.
void RadiiPass::collect(NodeId id, const QueryBlocks& batch, const std::vector<std::uint32_t>& near,
                        std::vector<std::pair<double, NodeId>>& found) const
{
    std::vector<std::uint32_t> nearer;
    double least = infinity;
    for (const std::uint32_t b : near) {
        const double square = squared_gap(batch[b].box, node(id).box, tree_->info().grid.scale);
        if (!may_have_neighbours(square, batch[b].limit)) continue;
        nearer.push_back(b);
        least = std::min(least, square);
    }
    if (nearer.empty()) return;
    if (node(id).points > 0) found.emplace_back(least, id);
    for (const NodeId child : node(id).children)
        if (child != no_node && node(child).subtree_points > 0) collect(child, batch, nearer, found);
}

// The nearest nodes first, and of those that overlap the coarse ones: neighbours of a coarse node's points come nearer
// level by level.
void RadiiPass::compare_with_others(QueryBlocks& batch)
{
    set_limits(batch);
    std::vector<std::uint32_t> all(batch.size());
    for (std::uint32_t b = 0; b < all.size(); ++b) all[b] = b;
    std::vector<std::pair<double, NodeId>> found;
    collect(0, batch, all, found);
    std::sort(found.begin(), found.end());
    std::size_t compared = 0;
    for (const auto& [square, id] : found) {
        const auto is_near = [&, other = id](const QueryBlock& block) {
            const double gap = squared_gap(block.box, node(other).box, tree_->info().grid.scale);
            return block.node != other && may_have_neighbours(gap, block.limit);
        };
        if (std::none_of(batch.begin(), batch.end(), is_near)) continue;
        const GpuView view = cursor_.get(id);
        for (const GpuPiece& piece : pieces_of(view)) compare(id, view, piece, batch, is_near);
        ++compared;
        if (compared == 1 || compared == 2 || compared % 4 == 0) set_limits(batch);  // it waits for the device
    }
}

void RadiiPass::set_limits(QueryBlocks& batch)
{
    const std::vector<double> limits = search_.limits();
    for (QueryBlock& block : batch) {
        const auto first = limits.begin() + block.first;
        block.limit = *std::max_element(first, first + block.points);
    }
}

void RadiiPass::finish(const QueryBlocks& batch)
{
    search_.finish();
    for (auto block = batch.begin(); block != batch.end();) {
        const NodeId id = block->node;
        GpuView view = cursor_.get(id);
        for (; block != batch.end() && block->node == id; ++block)
            for (const GpuPiece& piece : view.pieces()) {
                const std::uint32_t first = std::max(block->first_point, piece.first);
                const std::uint32_t end = std::min(block->first_point + block->points, piece.first + piece.count);
                if (first >= end) continue;
                BufferRange to = piece.attributes[0];
                to.offset += std::uint64_t(first - piece.first) * sizeof(float);
                search_.copy(block->first + first - block->first_point, end - first, to);
            }
        view.mark_written(0);
    }
}

}  // namespace

GpuRadiiReport compute_radii_on_gpu(const std::shared_ptr<PointCloud>& cloud, const std::shared_ptr<L1Cache>& l1,
                                    const GpuRadiiOptions& options)
{
    check(*cloud, options);
    if (!cloud->info().schema.find(attribute_name::radius)) cloud->add_attribute(attribute_of_radii());
    return RadiiPass(cloud, l1, options).run();
}

}  // namespace pcm
