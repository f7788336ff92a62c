#include "pcm/update/erase.h"

#include "pcm/bpc/chunk_encoder.h"
#include "pcm/build/bins/observed.h"
#include "pcm/system/error.h"
#include "pcm/threads/ordered.h"
#include "pcm/threads/thread_count.h"
#include "pcm/threads/watch.h"
#include "pcm/tree/point_hash.h"
#include "pcm/tree/selected_nodes.h"
#include "pcm/update/chunk_subset.h"
#include "pcm/update/extremes.h"
#include "pcm/update/part_nodes.h"
#include "pcm/update/tree_update.h"

#include <algorithm>
#include <numeric>
#include <optional>
#include <set>
#include <utility>

namespace pcm {
namespace {

// The points of a selection.
class SelectionTest final : public ChunkTest {
public:
    SelectionTest(const Selection& selection, const TreeInfo& info)
        : selector_(selection, info.schema), rounding_(info), grid_(info.grid)
    {
        for (const std::size_t k : selector_.tested()) tested_.attributes.set(k);
    }

    ColumnSet columns() const override { return tested_; }

    bool touches(NodeId, const Node& node) const override
    {
        return selector_.relation(source_box(grid_, node.box, rounding_)) != BoxRelation::outside;
    }

    std::vector<std::uint32_t> chosen(NodeId, const Chunk& chunk) const override
    {
        std::vector<std::uint32_t> numbers(chunk.points);
        std::iota(numbers.begin(), numbers.end(), 0u);
        std::vector<const Column*> columns(chunk.attributes.size(), nullptr);
        for (const std::size_t k : selector_.tested()) columns[k] = chunk.attributes[k].get();
        // The positions that readers of the tree get.
        selector_.narrow(
            columns, [&](std::size_t i) { return rounding_(grid_.to_source(chunk.positions->grid(i))); }, numbers);
        return numbers;
    }

private:
    const Selector selector_;
    const SourceRounding rounding_;
    const Grid grid_;
    ColumnSet tested_;
};

// A node after the deletion.
struct Examined {
    PartNode node;  // complete but for the extent of its chunk
    std::uint64_t deleted = 0;
    std::uint64_t hash = 0;      // hash of the deleted points
    bool coverage_lost = false;  // some of them are not of the last level
    Chunk rest;                  // the remaining points, where points were deleted
    std::vector<std::byte> bytes;
    Observed kept;
};

// Finds the points to delete in one node at a time. Any number of threads may call.
class Eraser {
public:
    Eraser(const Tree& tree, const ChunkTest& test, std::uint32_t generation, bool count_only)
        : tree_(tree),
          info_(tree.info()),
          test_(test),
          generation_(generation),
          count_only_(count_only),
          tested_(test.columns())
    {
        tested_.positions = true;
        others_ = ColumnSet::whole(info_.schema);
        others_.positions = false;
        others_.attributes &= ~tested_.attributes;
    }

    // Encodes the node's points again for a node that has become a leaf: its spacing is 0.
    void make_leaf(Examined& examined) const
    {
        examined.node.spacing = 0;
        if (examined.deleted == 0) examined.rest = tree_.read_chunk(examined.node.id, ColumnSet::whole(info_.schema));
        examined.bytes = encode_chunk(examined.rest, info_.schema, info_.grid, identity_of(examined.node, generation_));
    }

    Examined examine(const PartNode& node) const
    {
        Examined examined;
        examined.node = node;
        examined.node.box = Box3i();
        if (node.points == 0) return examined;
        Chunk chunk = tree_.read_chunk(node.id, tested_);
        const std::vector<std::uint32_t> deleted = test_.chosen(node.id, chunk);
        examined.deleted = deleted.size();
        if (deleted.empty()) {
            examined.node.box = box_of(*chunk.positions);
            return examined;
        }
        if (count_only_) return examined;
        const Chunk more = tree_.read_chunk(node.id, others_);
        chunk.sizes = more.sizes;
        for (std::size_t k = 0; k < chunk.attributes.size(); ++k)
            if (!chunk.attributes[k]) chunk.attributes[k] = more.attributes[k];
        std::vector<std::byte> scratch;
        const RowLayout layout(info_.schema, info_.wide);
        examined.hash = hash_chunk(subset_of(chunk, deleted), layout, scratch);
        keep(chunk, deleted, examined);
        return examined;
    }

private:
    // The chunk without the deleted points; the others keep their order.
    void keep(const Chunk& chunk, const std::vector<std::uint32_t>& deleted, Examined& examined) const
    {
        std::vector<std::uint32_t> kept;
        std::vector<std::uint32_t> left = examined.node.level_points;
        std::size_t next = 0, run = 0;
        std::uint32_t run_end = 0;
        for (std::uint32_t i = 0; i < chunk.points; ++i) {
            while (i >= run_end) run_end += examined.node.level_points[run++];
            if (next == deleted.size() || deleted[next] != i) {
                kept.push_back(i);
                continue;
            }
            ++next;
            --left[run - 1];
            examined.coverage_lost = examined.coverage_lost || info_.spacings[examined.node.first_level + run - 1] > 0;
        }
        PartNode& node = examined.node;
        node.points = static_cast<std::uint32_t>(kept.size());
        node.extent = Extent();
        while (!left.empty() && left.back() == 0) left.pop_back();
        const auto first = std::find_if(left.begin(), left.end(), [](std::uint32_t points) { return points > 0; });
        node.first_level =
            kept.empty() ? std::uint16_t(0) : static_cast<std::uint16_t>(node.first_level + (first - left.begin()));
        left.erase(left.begin(), first);
        node.level_points = std::move(left);
        if (kept.empty()) return;
        examined.rest = subset_of(chunk, kept);
        node.box = box_of(*examined.rest.positions);
        for (std::uint32_t i = 0; i < examined.rest.points; ++i) examined.kept.see(examined.rest.positions->grid(i));
        examined.bytes = encode_chunk(examined.rest, info_.schema, info_.grid, identity_of(node, generation_));
    }

    const Tree& tree_;
    const TreeInfo& info_;
    const ChunkTest& test_;
    const std::uint32_t generation_;
    const bool count_only_;
    ColumnSet tested_, others_;
};

class Erasure {
public:
    Erasure(const std::filesystem::path& path, const MakeChunkTest& make_test, const EraseOptions& options)
        : options_(options), threads_(thread_count(options.threads)), watch_(options.progress)
    {
        if (options.count_only)
            tree_ = Tree::open(path);
        else
            update_.emplace(path);
        if (update_) tree_ = update_->tree();
        test_ = make_test(tree_);
        eraser_.emplace(*tree_, *test_, update_ ? update_->generation() : 0, options.count_only);
    }

    EraseReport run()
    {
        nodes_ = part_nodes(*tree_);
        alive_.assign(tree_->nodes().size(), true);
        std::vector<bool> touched(tree_->nodes().size(), false);
        for (NodeId id = 0; id < touched.size(); ++id) {
            const Node& node = tree_->node(id);
            touched[id] = (node.parent == no_node || touched[node.parent]) && test_->touches(id, node);
        }
        std::vector<std::size_t> to_examine;  // children before their parents
        for (std::size_t n = nodes_.size(); n-- > 0;)
            if (touched[nodes_[n].id]) to_examine.push_back(n);

        report_.outcome.points_in = tree_->info().points;
        in_turn(
            to_examine.size(), threads_, [&](std::size_t i) { return eraser_->examine(nodes_[to_examine[i]]); },
            [&](std::size_t i, Examined&& examined) { take(nodes_[to_examine[i]], std::move(examined)); },
            [&](std::size_t done) {
                report_progress("Finding points to delete",
                                0.95 * static_cast<double>(done) /
                                    static_cast<double>(std::max<std::size_t>(1, to_examine.size())));
            });
        report_.outcome.points_out = report_.outcome.points_in - report_.points_deleted;
        if (update_ && report_.points_deleted) commit();
        report_.outcome.seconds = watch_.seconds();
        return std::move(report_);
    }

private:
    void report_progress(std::string_view stage, double fraction)
    {
        watch_.report(stage, options_.begin + (1 - options_.begin) * fraction);
    }

    void take(PartNode& node, Examined&& examined)
    {
        report_.points_deleted += examined.deleted;
        if (examined.coverage_lost) report_.coverage_kept = false;
        if (!update_) return;
        bool leaf = true;
        for (const NodeId child : tree_->node(node.id).children) leaf = leaf && (child == no_node || !alive_[child]);
        alive_[node.id] = !leaf || examined.node.points > 0;
        if (leaf && examined.node.points && examined.node.spacing > 0) eraser_->make_leaf(examined);
        if (examined.deleted) {
            changed_.insert(node.id);
            hash_ += examined.hash;
            kept_.merge(examined.kept);
        }
        if (!examined.bytes.empty()) {
            examined.node.extent = update_->write(examined.bytes);
            ++report_.nodes_rewritten;
        } else if (examined.deleted) {
            update_->write_tombstone(examined.node);
            ++report_.nodes_emptied;
        }
        node = std::move(examined.node);
    }

    void commit()
    {
        report_progress("Writing the index", 0.96);
        TreeInfo info = tree_->info();
        NodeVector joined = join_parts(nodes_, info.spacings, info.grid.scale);
        info.points = report_.outcome.points_out;
        info.content_hash -= hash_;
        if (joined.nodes.empty()) {
            info.box = Box3i();
            info.extremes = {};
            // As after a build without points: an append chooses new levels.
            info.spacings.clear();
            info.levels = 0;
            info.coverage_kept = true;
            info.position_error = 0;
        } else {
            info.box = joined.nodes[0].box;
            info.extremes = find_extremes(*tree_, changed_, kept_, info.box);
            info.coverage_kept = info.coverage_kept && report_.coverage_kept;
        }
        watch_.report("Done", 1);  // the last chance to cancel
        run_last_step(report_.outcome, [&] { update_->commit(std::move(info), std::move(joined)); });
        report_.bytes_written = update_->bytes_written();
    }

    const EraseOptions& options_;
    const unsigned threads_;
    Watch watch_;
    std::optional<TreeUpdate> update_;
    std::shared_ptr<const Tree> tree_;
    std::unique_ptr<ChunkTest> test_;
    std::optional<Eraser> eraser_;
    std::vector<PartNode> nodes_;
    std::vector<bool> alive_;  // nodes with points in their subtree
    std::set<NodeId> changed_;
    std::uint64_t hash_ = 0;
    Observed kept_;
    EraseReport report_;
};

}  // namespace

EraseReport erase_points(const std::filesystem::path& tree, const Selection& selection, const EraseOptions& options)
{
    if (!selection.chooses_points())
        throw Error(ErrorCode::invalid_argument, tree, "nothing says which points are to be deleted",
                    "give a box or a condition");
    return erase_points(
        tree,
        [&](const std::shared_ptr<const Tree>& opened) {
            return std::make_unique<SelectionTest>(selection, opened->info());
        },
        options);
}

EraseReport erase_points(const std::filesystem::path& tree, const MakeChunkTest& make_test, const EraseOptions& options)
{
    return Erasure(tree, make_test, options).run();
}

}  // namespace pcm
