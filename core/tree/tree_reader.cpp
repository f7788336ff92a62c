#include "pcm/tree/tree_reader.h"

#include "pcm/io/pipe/batch_shape.h"
#include "pcm/system/error.h"
#include "pcm/system/text.h"

#include <algorithm>
#include <cstring>
#include <limits>
#include <numeric>
#include <string>
#include <utility>

namespace pcm {
namespace {

bool fits_32_bits(const Box3i& box)
{
    for (std::size_t a = 0; a < 3; ++a)
        if (box.min[a] < std::numeric_limits<std::int32_t>::min() ||
            box.max[a] > std::numeric_limits<std::int32_t>::max())
            return false;
    return true;
}

template <std::size_t Size>
void gather(const std::byte* from, const std::uint32_t* points, std::size_t count, std::byte* to)
{
    for (std::size_t i = 0; i < count; ++i) std::memcpy(to + i * Size, from + points[i] * Size, Size);
}

// Copies points [first, first + count) of a column, or, given `points`, those with the numbers points[first], ....
void copy_points(const Column& column, const std::uint32_t* points, std::size_t first, std::size_t count, Column& to)
{
    const std::size_t size = column.point_bytes();
    if (count == 0) return;
    if (!points) {
        std::memcpy(to.data(), column.data() + first * size, count * size);
        return;
    }
    points += first;
    switch (size) {
        case 1:
            return gather<1>(column.data(), points, count, to.data());
        case 2:
            return gather<2>(column.data(), points, count, to.data());
        case 4:
            return gather<4>(column.data(), points, count, to.data());
        case 6:
            return gather<6>(column.data(), points, count, to.data());
        case 8:
            return gather<8>(column.data(), points, count, to.data());
        default:
            for (std::size_t i = 0; i < count; ++i)
                std::memcpy(to.data() + i * size, column.data() + points[i] * size, size);
    }
}

}  // namespace

TreeReader::TreeReader(std::shared_ptr<const Tree> tree, const std::optional<std::uint16_t>& level,
                       const Selection& selection, unsigned chunks_ahead)
    : TreeReader(std::move(tree), level, selection, nullptr, chunks_ahead)
{
}

TreeReader::TreeReader(std::shared_ptr<const Tree> tree, std::shared_ptr<const PointChoice> choice,
                       unsigned chunks_ahead)
    : TreeReader(std::move(tree), std::nullopt, {}, std::move(choice), chunks_ahead)
{
}

TreeReader::TreeReader(std::shared_ptr<const Tree> tree, const std::optional<std::uint16_t>& level,
                       const Selection& selection, std::shared_ptr<const PointChoice> choice, unsigned chunks_ahead)
    : tree_(std::move(tree)),
      level_(level),
      selector_(selection, tree_->info().schema),
      choice_(std::move(choice)),
      rounding_(tree_->info()),
      chunks_ahead_(std::max(1u, chunks_ahead))
{
    const TreeInfo& tree_info = tree_->info();
    nodes_ = selected_nodes(*tree_, selector_, level);
    if (choice_) {
        for (SelectedNode& node : nodes_) node.points = choice_->count(node.node);
        nodes_.erase(std::remove_if(nodes_.begin(), nodes_.end(), [](const SelectedNode& n) { return n.points == 0; }),
                     nodes_.end());
    }
    end_node_ = nodes_.size();
    std::uint64_t points = 0;
    for (const SelectedNode& node : nodes_) {
        first_.push_back(points);
        points += node.points;
    }
    for (const std::size_t k : selector_.kept()) columns_.attributes.set(k);
    for (const std::size_t k : selector_.tested()) columns_.attributes.set(k);

    info_.format = "point cloud tree of " + std::to_string(tree_info.levels) + " levels";
    if (level) info_.format += ", level " + std::to_string(*level);
    info_.points = points;
    info_.points_known = !selector_.tests_points();
    info_.schema = selector_.kept_schema();
    info_.metadata = tree_info.metadata;
    set_decimals(info_.metadata, {no_decimals, no_decimals, no_decimals});  // decimals hold for this tree's grid only
    info_.position_type = tree_info.position_type;
    if (tree_info.position_type == ScalarType::i32) {
        if (fits_32_bits(tree_info.box)) {
            info_.grid = tree_info.grid;
        } else {
            info_.near_grid = tree_info.grid;
            info_.position_type = ScalarType::f64;
        }
    }
    if (points) {
        Box3d box = tree_info.bounds();
        if (const auto& bounds = selector_.bounds())
            for (std::size_t a = 0; a < 3; ++a) {
                box.min[a] = std::max(box.min[a], bounds->min[a]);
                box.max[a] = std::min(box.max[a], bounds->max[a]);
            }
        if (!box.empty()) info_.promised_box = box;
    }
    if (tree_info.points_skipped)
        info_.notes.push_back(
            points_text(tree_info.points_skipped) +
            " without a finite position, or beyond a limit that was given, left out when the tree was built");
    if (tree_info.position_error > 0 && !rounding_.single_precision())
        info_.notes.push_back("positions differ by up to " + brief(tree_info.position_error) +
                              " from those of the tree's source");
}

Vec3d TreeReader::position(std::size_t i) const
{
    return rounding_(tree_->info().grid.to_source(chunk_.positions->grid(i)));
}

bool TreeReader::next_chunk()
{
    chunk_ = Chunk();
    while (next_node_ < end_node_) {
        for (; next_ahead_ < end_node_ && next_ahead_ < next_node_ + chunks_ahead_ + 1; ++next_ahead_)
            ahead_.emplace_back(pool_, static_cast<unsigned>(chunks_ahead_),
                                [tree = tree_, id = nodes_[next_ahead_].node, columns = columns_] {
                                    return tree->read_chunk(id, columns);
                                });
        Pending<Chunk> next = std::move(ahead_.front());
        ahead_.pop_front();
        const SelectedNode node = nodes_[next_node_++];
        chunk_ = next.get();
        choose(node);
        if (chunk_points_ > 0) return true;
    }
    return false;
}

void TreeReader::choose(const SelectedNode& node)
{
    chunk_points_ = node.points;
    next_point_ = 0;
    if (choice_) {
        all_ = node.points == chunk_.points;
        if (!all_) selected_ = choice_->points(node.node);
        return;
    }
    all_ = node.relation == BoxRelation::inside && !selector_.tests_attributes();
    if (all_) return;
    std::vector<const Column*> columns(chunk_.attributes.size(), nullptr);
    for (const std::size_t k : selector_.tested()) columns[k] = chunk_.attributes[k].get();
    selected_.resize(chunk_points_);
    std::iota(selected_.begin(), selected_.end(), 0u);
    selector_.narrow(
        columns, [this](std::size_t i) { return position(i); }, selected_, node.relation);
    chunk_points_ = selected_.size();
}

bool TreeReader::read(PointBatch& batch, std::size_t max_points)
{
    if (next_point_ == chunk_points_ && !next_chunk()) {
        chunk_points_ = next_point_ = 0;
        shape_batch(batch, info_.schema, info_.grid.has_value(), 0);
        return false;
    }
    const std::size_t first = next_point_;
    const std::size_t count =
        std::min({std::max<std::size_t>(max_points, 1), chunk_points_ - first, points_that_fit_a_batch(info_.schema)});
    next_point_ += count;
    shape_batch(batch, info_.schema, info_.grid.has_value(), count);
    const std::uint32_t* points = all_ ? nullptr : selected_.data();
    for (std::size_t i = 0; i < count; ++i) {
        const std::size_t from = points ? points[first + i] : first + i;
        if (batch.gridded) {
            for (std::size_t a = 0; a < 3; ++a)
                batch.grid_xyz[a][i] = static_cast<std::int32_t>(chunk_.positions->grid(from, a));
        } else {
            const Vec3d p = position(from);
            for (std::size_t a = 0; a < 3; ++a) batch.xyz[a][i] = p[a];
        }
    }
    const std::vector<std::size_t>& kept = selector_.kept();
    for (std::size_t k = 0; k < kept.size(); ++k)
        copy_points(*chunk_.attributes[kept[k]], points, first, count, batch.attributes[k]);
    return true;
}

void TreeReader::seek(std::uint64_t index)
{
    if (!seekable()) return PointReader::seek(index);
    if (index > info_.points)
        throw Error(ErrorCode::invalid_argument, tree_->folder(),
                    "cannot seek to point " + std::to_string(index) + " of a cloud of " + std::to_string(info_.points));
    const auto node = static_cast<std::size_t>(std::upper_bound(first_.begin(), first_.end(), index) - first_.begin());
    const std::size_t wanted = node ? node - 1 : 0;
    if (nodes_.empty()) return;
    if (next_node_ == 0 || wanted != next_node_ - 1 || !chunk_.positions) {
        ahead_.clear();  // waits for running tasks
        next_node_ = next_ahead_ = wanted;
        next_chunk();
    }
    next_point_ = static_cast<std::size_t>(index - first_[wanted]);
}

void TreeReader::keep_nodes(std::size_t first, std::size_t end)
{
    ahead_.clear();  // waits for running tasks
    chunk_ = Chunk();
    next_node_ = next_ahead_ = first;
    end_node_ = end;
    next_point_ = chunk_points_ = 0;
}

double TreeReader::fraction_read() const
{
    if (nodes_.empty() || (next_node_ == nodes_.size() && next_point_ == chunk_points_)) return 1.0;
    if (next_node_ == 0) return 0.0;
    const std::uint64_t total = first_.back() + nodes_.back().points;
    const double in_chunk = chunk_points_ ? static_cast<double>(next_point_) / static_cast<double>(chunk_points_) : 0.0;
    const double done = static_cast<double>(first_[next_node_ - 1]) + in_chunk * nodes_[next_node_ - 1].points;
    return done / static_cast<double>(total);
}

}  // namespace pcm
