#include "pcm/update/erase.h"

#include "pcm/bpc/chunk_encoder.h"
#include "pcm/build/bins/observed.h"
#include "pcm/build/bins/row.h"
#include "pcm/threads/ordered.h"
#include "pcm/threads/thread_count.h"
#include "pcm/threads/watch.h"
#include "pcm/system/error.h"
#include "pcm/threads/in_turn.h"
#include "pcm/tree/point_hash.h"
#include "pcm/tree/selected_nodes.h"
#include "pcm/update/chunk_points.h"
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

// What became of a node that was looked at.
struct Looked {
    PartNode node;  // as it is afterwards, but for the place of its chunk
    std::uint64_t deleted = 0;
    std::uint64_t hash = 0;  // of the deleted points
    bool chosen = false;     // some of them are not of the last level
    Chunk rest;              // where points were deleted, those that are left
    std::vector<std::byte> bytes;
    Observed kept;
};

// Looks at one node after the other; any number of threads.
class Eraser {
public:
    Eraser(const Tree& tree, const Selection& selection, std::uint32_t generation, bool count_only)
        : tree_(tree),
          info_(tree.info()),
          selector_(selection, info_.schema),
          generation_(generation),
          count_only_(count_only)
    {
        for (const std::size_t k : selector_.tested()) tested_.attributes.set(k);
        others_ = ColumnSet::all(info_.schema);
        others_.positions = false;
        others_.attributes &= ~tested_.attributes;
    }

    // The same points in a node that has none below it any more: nothing is missing when it is drawn.
    void make_leaf(Looked& looked) const
    {
        looked.node.spacing = 0;
        if (looked.deleted == 0) looked.rest = tree_.read_chunk(looked.node.id, ColumnSet::all(info_.schema));
        looked.bytes = encode_chunk(looked.rest, info_.schema, info_.grid, identity_of(looked.node, generation_));
    }

    // Whether there may be points to delete in a node or below it.
    bool touches(const Node& node) const
    {
        return selector_.relation(source_box(info_.grid, node.box, info_.position_type == ScalarType::f32)) !=
               BoxRelation::outside;
    }

    Looked look_at(const PartNode& node) const
    {
        Looked looked;
        looked.node = node;
        looked.node.box = Box3i();
        if (node.points == 0) return looked;
        Chunk chunk = tree_.read_chunk(node.id, tested_);
        const std::vector<std::uint32_t> deleted = selected(chunk);
        looked.deleted = deleted.size();
        if (deleted.empty()) {
            looked.node.box = box_of(*chunk.positions);
            return looked;
        }
        if (count_only_) return looked;
        const Chunk more = tree_.read_chunk(node.id, others_);
        for (std::size_t k = 0; k < chunk.attributes.size(); ++k)
            if (!chunk.attributes[k]) chunk.attributes[k] = more.attributes[k];
        std::vector<std::byte> scratch;
        const RowLayout layout(info_.schema, info_.wide);
        looked.hash = hash_chunk(points_of(chunk, deleted), layout, scratch);
        keep(chunk, deleted, looked);
        return looked;
    }

private:
    std::vector<std::uint32_t> selected(const Chunk& chunk) const
    {
        std::vector<std::uint32_t> numbers(chunk.points);
        std::iota(numbers.begin(), numbers.end(), 0u);
        std::vector<const Column*> columns(chunk.attributes.size(), nullptr);
        for (const std::size_t k : selector_.tested()) columns[k] = chunk.attributes[k].get();
        // Where they are to whoever reads the tree: floats are rounded to what the source had.
        const bool single = info_.position_type == ScalarType::f32;
        selector_.narrow(
            columns,
            [&](std::size_t i) {
                Vec3d p = info_.grid.to_source(chunk.positions->grid(i));
                if (single)
                    for (double& c : p) c = static_cast<double>(static_cast<float>(c));
                return p;
            },
            numbers);
        return numbers;
    }

    // The chunk without the deleted points, in the same order.
    void keep(const Chunk& chunk, const std::vector<std::uint32_t>& deleted, Looked& looked) const
    {
        std::vector<std::uint32_t> kept;
        std::vector<std::uint32_t> left = looked.node.level_points;
        std::size_t next = 0, run = 0;
        std::uint32_t run_end = 0;
        for (std::uint32_t i = 0; i < chunk.points; ++i) {
            while (i >= run_end) run_end += looked.node.level_points[run++];
            if (next == deleted.size() || deleted[next] != i) {
                kept.push_back(i);
                continue;
            }
            ++next;
            --left[run - 1];
            looked.chosen = looked.chosen || info_.spacings[looked.node.first_level + run - 1] > 0;
        }
        PartNode& node = looked.node;
        node.points = static_cast<std::uint32_t>(kept.size());
        node.extent = Extent();
        while (!left.empty() && left.back() == 0) left.pop_back();
        const auto first = std::find_if(left.begin(), left.end(), [](std::uint32_t points) { return points > 0; });
        node.first_level =
            kept.empty() ? std::uint16_t(0) : static_cast<std::uint16_t>(node.first_level + (first - left.begin()));
        left.erase(left.begin(), first);
        node.level_points = std::move(left);
        if (kept.empty()) return;
        looked.rest = points_of(chunk, kept);
        node.box = box_of(*looked.rest.positions);
        for (std::uint32_t i = 0; i < looked.rest.points; ++i) looked.kept.see(looked.rest.positions->grid(i));
        looked.bytes = encode_chunk(looked.rest, info_.schema, info_.grid, identity_of(node, generation_));
    }

    const Tree& tree_;
    const TreeInfo& info_;
    const Selector selector_;
    const std::uint32_t generation_;
    const bool count_only_;
    ColumnSet tested_, others_;
};

class Erasure {
public:
    Erasure(const std::filesystem::path& path, const Selection& selection, const EraseOptions& options)
        : options_(options), threads_(thread_count(options.threads)), watch_(options.progress)
    {
        if (!selection.chooses_points())
            throw Error(ErrorCode::invalid_argument, path, "nothing says which points are to be deleted",
                        "give a box or a condition");
        if (options.count_only)
            tree_ = Tree::open(path);
        else
            update_.emplace(path);
        if (update_) tree_ = update_->tree();
        eraser_.emplace(*tree_, selection, update_ ? update_->generation() : 0, options.count_only);
    }

    EraseReport run()
    {
        nodes_ = part_nodes(*tree_);
        alive_.assign(tree_->nodes().size(), true);
        std::vector<bool> touched(tree_->nodes().size(), false);
        for (NodeId id = 0; id < touched.size(); ++id) {
            const Node& node = tree_->node(id);
            touched[id] = (node.parent == no_node || touched[node.parent]) && eraser_->touches(node);
        }
        std::vector<std::size_t> to_look_at;  // children before their parents
        for (std::size_t n = nodes_.size(); n-- > 0;)
            if (touched[nodes_[n].id]) to_look_at.push_back(n);

        report_.outcome.points_in = tree_->info().points;
        in_turn(
            to_look_at.size(), threads_, [&](std::size_t i) { return eraser_->look_at(nodes_[to_look_at[i]]); },
            [&](std::size_t i, Looked&& looked) { take(nodes_[to_look_at[i]], std::move(looked)); },
            [&](std::size_t done) {
                watch_.report("Looking at points",
                              0.95 * static_cast<double>(done) /
                                  static_cast<double>(std::max<std::size_t>(1, to_look_at.size())));
            });
        report_.outcome.points_out = report_.outcome.points_in - report_.points_deleted;
        if (update_ && report_.points_deleted) commit();
        report_.outcome.seconds = watch_.seconds();
        return report_;
    }

private:
    void take(PartNode& node, Looked&& looked)
    {
        report_.points_deleted += looked.deleted;
        if (looked.chosen) report_.coverage_kept = false;
        if (!update_) return;
        bool leaf = true;
        for (const NodeId child : tree_->node(node.id).children) leaf = leaf && (child == no_node || !alive_[child]);
        alive_[node.id] = !leaf || looked.node.points > 0;
        if (leaf && looked.node.points && looked.node.spacing > 0) eraser_->make_leaf(looked);
        if (looked.deleted) {
            changed_.insert(node.id);
            hash_ += looked.hash;
            kept_.merge(looked.kept);
        }
        if (!looked.bytes.empty()) {
            looked.node.extent = update_->write(looked.bytes);
            ++report_.nodes_rewritten;
        } else if (looked.deleted) {
            update_->bury(looked.node);
            ++report_.nodes_emptied;
        }
        node = std::move(looked.node);
    }

    void commit()
    {
        watch_.report("Writing the index", 0.96);
        TreeInfo info = tree_->info();
        NodeVector joined = join_parts(nodes_, info.spacings, info.grid.scale);
        info.points = report_.outcome.points_out;
        info.content_hash -= hash_;
        if (joined.nodes.empty()) {
            info.box = Box3i();
            info.extremes = {};
            // As of a build without points: whoever appends may choose other levels.
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
        update_->commit(std::move(info), std::move(joined));
        report_.bytes_written = update_->bytes_written();
    }

    const EraseOptions& options_;
    const unsigned threads_;
    Watch watch_;
    std::optional<TreeUpdate> update_;
    std::shared_ptr<const Tree> tree_;
    std::optional<Eraser> eraser_;
    std::vector<PartNode> nodes_;
    std::vector<bool> alive_;  // nodes that have points, or some below
    std::set<NodeId> changed_;
    std::uint64_t hash_ = 0;
    Observed kept_;
    EraseReport report_;
};

}  // namespace

EraseReport erase_points(const std::filesystem::path& tree, const Selection& selection, const EraseOptions& options)
{
    return Erasure(tree, selection, options).run();
}

}  // namespace pcm
