#include "pcm/query/estimate.h"

#include "pcm/bpc/chunk_codec.h"
#include "pcm/query/chunk_stream.h"
#include "pcm/query/read_rates.h"
#include "pcm/tree/selected_nodes.h"
#include "pcm/tree/tree_index.h"

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

// Headers of a tree's chunks; the file that was read last stays open.
class Headers {
public:
    explicit Headers(const Tree& tree) : tree_(tree) {}
    BpcHeader read(NodeId node)
    {
        const Extent& extent = tree_.node(node).extent;
        if (!file_.is_open() || extent.file != number_)
            file_ = File(tree_.folder() / data_file_name(extent.file), File::Mode::read);
        number_ = extent.file;
        return read_header(file_, extent.offset, extent.bytes);
    }

private:
    const Tree& tree_;
    File file_;
    std::uint32_t number_ = 0;
};

}  // namespace

Estimate make_estimate(L2Cache& cache, const ReadRates& rates, const Query& query, const ColumnSet& columns,
                       EstimatePrecision precision)
{
    const auto start = std::chrono::steady_clock::now();
    const Tree& tree = cache.tree();
    const Selector selector(query.selection(), tree.info().schema);
    const std::vector<SelectedNode> nodes = selected_nodes(tree, selector, query.level);
    Estimate estimate;
    estimate.conditions = selector.tests_attributes();
    std::size_t cut = 0;
    for (const SelectedNode& node : nodes) cut += node.relation == BoxRelation::crosses;
    const auto steps = static_cast<std::size_t>(
        std::clamp(std::cbrt(1e5 / static_cast<double>(std::max<std::size_t>(cut, 1))), 3.0, 8.0));
    Headers headers(tree);

    // Adds the points of one box.
    const auto add = [&](BoxRelation relation, const Box3d& box, std::uint32_t points) {
        if (relation == BoxRelation::outside) return;
        estimate.points_most += points;
        estimate.points_read += points;
        if (relation == BoxRelation::inside) {
            if (!estimate.conditions) estimate.points_least += points;
            estimate.points_expected += points;
        } else {
            estimate.points_expected += selected_part(selector, box, steps) * points;
        }
    };
    std::uint64_t reads = 0, points_from_disk = 0;
    for (const SelectedNode& selected : nodes) {
        const Node& node = tree.node(selected.node);
        const bool cached = static_cast<bool>(cache.find(selected.node, columns));
        const std::uint64_t read_before = estimate.points_read;
        const bool in_part = selected.relation == BoxRelation::crosses || selected.points < node.points;
        std::uint64_t bytes = node.extent.bytes;
        if (precision == EstimatePrecision::headers && in_part) {
            const BpcHeader header = headers.read(selected.node);
            bytes = header.header_bytes;
            for (std::size_t s = 0; s < header.segments.size(); ++s) {
                const BpcSegment& segment = header.segments[s];
                if (query.level && segment.level > *query.level) continue;
                const Box3d box = tree.info().grid.to_source(segment.box);
                const BoxRelation relation =
                    selected.relation == BoxRelation::inside ? selected.relation : selector.relation(box);
                add(relation, box, segment.count);
                if (relation == BoxRelation::outside) continue;
                if (columns.positions && s < header.positions.pieces.size()) bytes += header.positions.pieces[s].bytes;
                for (std::size_t k = 0; k < header.attributes.size(); ++k)
                    if (columns.attributes.test(k) && s < header.attributes[k].pieces.size())
                        bytes += header.attributes[k].pieces[s].bytes;
            }
            if (estimate.points_read == read_before) continue;  // no segment is touched
        } else {
            add(selected.relation, tree.box(selected.node), selected.points);
        }
        ++estimate.chunks;
        if (cached) {
            ++estimate.chunks_cached;
            continue;
        }
        ++reads;
        points_from_disk += estimate.points_read - read_before;
        estimate.bytes += bytes;
    }
    estimate.seconds = rates.seconds(reads, static_cast<double>(points_from_disk * decoded_bytes(tree, columns)));
    estimate.own_seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    return estimate;
}

}  // namespace pcm
