#include "pcm/query/estimate.h"

#include "pcm/bpc/chunk_header.h"
#include "pcm/query/chunk_stream.h"
#include "pcm/query/read_rates.h"
#include "pcm/system/seconds.h"
#include "pcm/tree/selected_nodes.h"

#include <algorithm>
#include <chrono>
#include <cmath>

namespace pcm {
namespace {

// The fraction of a box's volume that is selected, from test points on a lattice over the box's intersection with the
// selection's bounds.
double selected_part(const Selector& selector, const Box3d& box, std::size_t steps)
{
    Box3d clip = box;
    double part = 1;
    std::array<std::size_t, 3> n;
    for (std::size_t a = 0; a < 3; ++a) {
        if (selector.bounds()) {
            clip.min[a] = std::max(clip.min[a], selector.bounds()->min[a]);
            clip.max[a] = std::min(clip.max[a], selector.bounds()->max[a]);
        }
        const double whole = box.extent(a), left = clip.extent(a);
        if (left < 0) return 0;
        part *= whole > 0 ? left / whole : 1;
        n[a] = left > 0 ? steps : 1;
    }
    std::size_t hits = 0;
    for (std::size_t i = 0; i < n[0]; ++i)
        for (std::size_t j = 0; j < n[1]; ++j)
            for (std::size_t k = 0; k < n[2]; ++k) {
                const std::array<std::size_t, 3> at{i, j, k};
                Vec3d p;
                for (std::size_t a = 0; a < 3; ++a)
                    p[a] =
                        clip.min[a] + clip.extent(a) * ((static_cast<double>(at[a]) + 0.5) / static_cast<double>(n[a]));
                hits += selector.holds_at(p);
            }
    // A region between the test points is small, but not empty.
    const double of_samples = std::max(static_cast<double>(hits), 0.5) / static_cast<double>(n[0] * n[1] * n[2]);
    return part * of_samples;
}

// Adds up what the nodes that a query touches contribute.
class Estimator {
public:
    Estimator(L2Cache& cache, const Query& query, const ColumnSet& columns, EstimatePrecision precision)
        : cache_(cache),
          tree_(cache.tree()),
          query_(query),
          columns_(columns),
          precision_(precision),
          selector_(query.selection(), tree_.info().schema),
          rounding_(tree_.info()),
          nodes_(selected_nodes(tree_, selector_, query.level))
    {
        std::size_t cut = 0;
        for (const SelectedNode& node : nodes_) cut += node.relation == BoxRelation::crosses;
        steps_ = static_cast<std::size_t>(
            std::clamp(std::cbrt(1e5 / static_cast<double>(std::max<std::size_t>(cut, 1))), 3.0, 8.0));
        estimate_.conditions = selector_.tests_attributes();
    }

    Estimate run(const ReadRates& rates)
    {
        for (const SelectedNode& node : nodes_) add_node(node);
        estimate_.seconds =
            rates.seconds(reads_, static_cast<double>(points_from_disk_ * decoded_bytes(tree_, columns_)));
        return estimate_;
    }

private:
    void add_node(const SelectedNode& selected)
    {
        const Node& node = tree_.node(selected.node);
        const bool cached = static_cast<bool>(cache_.find(selected.node, columns_));
        const std::uint64_t read_before = estimate_.points_read;
        const bool in_part = selected.relation == BoxRelation::crosses || selected.points < node.points;
        std::uint64_t bytes = node.extent.bytes;
        if (precision_ == EstimatePrecision::headers && in_part) {
            bytes = add_segments(selected);
            if (estimate_.points_read == read_before) return;  // the query touches no segment
        } else {
            add_points(selected.relation, tree_.box(selected.node), selected.points);
        }
        ++estimate_.chunks;
        if (cached) {
            ++estimate_.chunks_cached;
            return;
        }
        ++reads_;
        points_from_disk_ += estimate_.points_read - read_before;
        estimate_.bytes += bytes;
    }

    // Returns the bytes that are read of the node's chunk.
    std::uint64_t add_segments(const SelectedNode& selected)
    {
        const BpcHeader header = tree_.read_header(selected.node);
        std::uint64_t bytes = header.header_bytes;
        for (std::size_t s = 0; s < header.segments.size(); ++s) {
            const BpcSegment& segment = header.segments[s];
            if (query_.level && segment.level > *query_.level) continue;
            const Box3d box = source_box(tree_.info().grid, segment.box, rounding_);
            const BoxRelation relation =
                selected.relation == BoxRelation::inside ? selected.relation : selector_.relation(box);
            add_points(relation, box, segment.count);
            if (relation == BoxRelation::outside) continue;
            if (columns_.positions && s < header.positions.pieces.size()) bytes += header.positions.pieces[s].bytes;
            for (std::size_t k = 0; k < header.attributes.size(); ++k)
                if (columns_.attributes.test(k) && s < header.attributes[k].pieces.size())
                    bytes += header.attributes[k].pieces[s].bytes;
        }
        return bytes;
    }

    // Points of which only their tight box is known.
    void add_points(BoxRelation relation, const Box3d& box, std::uint32_t points)
    {
        if (relation == BoxRelation::outside) return;
        estimate_.points_most += points;
        estimate_.points_read += points;
        if (relation == BoxRelation::inside) {
            if (!estimate_.conditions) estimate_.points_least += points;
            estimate_.points_expected += points;
        } else {
            estimate_.points_expected += selected_part(selector_, box, steps_) * points;
        }
    }

    L2Cache& cache_;
    const Tree& tree_;
    const Query& query_;
    const ColumnSet& columns_;
    const EstimatePrecision precision_;
    const Selector selector_;
    const SourceRounding rounding_;
    const std::vector<SelectedNode> nodes_;
    std::size_t steps_;  // test points per axis in a box that the query cuts: fewer where there are many such boxes
    Estimate estimate_;
    std::uint64_t reads_ = 0, points_from_disk_ = 0;
};

}  // namespace

Estimate make_estimate(L2Cache& cache, const ReadRates& rates, const Query& query, const ColumnSet& columns,
                       EstimatePrecision precision)
{
    const auto start = std::chrono::steady_clock::now();
    Estimate estimate = Estimator(cache, query, columns, precision).run(rates);
    estimate.own_seconds = seconds_since(start);
    return estimate;
}

}  // namespace pcm
