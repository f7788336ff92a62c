#include "pcm/select/point_scan.h"

#include "pcm/threads/for_each_index.h"
#include "pcm/threads/thread_count.h"
#include "pcm/threads/watch.h"

#include <algorithm>
#include <numeric>
#include <utility>

namespace pcm {
namespace {

class Scan {
public:
    Scan(const Tree& tree, const Selection& selection, const ScanOptions& options,
         const std::function<void(const ScannedPoints&)>& take)
        : tree_(tree),
          options_(options),
          take_(take),
          selector_(selection, tree.info().schema),
          rounding_(tree.info()),
          nodes_(selected_nodes(tree, selector_, options.select.level))
    {
    }

    void run(Watch& watch)
    {
        for_each_index(
            nodes_.size(), thread_count(options_.select.threads), [&](std::size_t i) { scan(nodes_[i]); },
            [&](std::size_t begun) {
                watch.report(options_.stage, options_.begin + (options_.end - options_.begin) *
                                                                  static_cast<double>(begun) /
                                                                  static_cast<double>(nodes_.size()));
            });
    }

private:
    BoxRelation relation(const Box3i& grid_box) const
    {
        const Box3d box = source_box(tree_.info().grid, grid_box, rounding_);
        const BoxRelation relation = selector_.relation(box);
        return relation == BoxRelation::outside || !options_.test ? relation
                                                                  : both(relation, options_.test->relation(box));
    }

    void scan(const SelectedNode& selected) const
    {
        if (options_.within && options_.within->count(selected.node) == 0) return;
        BoxRelation whole = selected.relation;
        if (options_.test)
            whole =
                both(whole,
                     options_.test->relation(source_box(tree_.info().grid, tree_.node(selected.node).box, rounding_)));
        if (whole == BoxRelation::outside || selected.points == 0) return;
        ScannedPoints found;
        found.node = selected.node;
        const bool tests_nothing = whole == BoxRelation::inside && !selector_.tests_attributes();
        if (tests_nothing && !options_.columns) {
            found.numbers.resize(selected.points);
            std::iota(found.numbers.begin(), found.numbers.end(), 0u);
            if (options_.within && !options_.within->has_all(selected.node)) {
                found.numbers = options_.within->points(selected.node);
                while (!found.numbers.empty() && found.numbers.back() >= selected.points) found.numbers.pop_back();
            }
        } else {
            read(whole, found);
        }
        if (!found.numbers.empty()) take_(found);
    }

    void read(BoxRelation whole, ScannedPoints& found) const
    {
        ColumnSet columns;
        columns.positions = whole != BoxRelation::inside;
        for (const std::size_t k : selector_.tested()) columns.attributes.set(k);
        if (options_.columns) columns |= *options_.columns;
        if (options_.test && whole != BoxRelation::inside) columns |= options_.test->columns();
        std::vector<BoxRelation> relations;
        const auto wanted = [&](const Box3i& box, std::uint16_t level) {
            if (options_.select.level && level > *options_.select.level) return false;
            relations.push_back(whole == BoxRelation::inside ? whole : relation(box));
            if (relations.back() != BoxRelation::outside) return true;
            relations.pop_back();
            return false;
        };
        found.part = tree_.read_chunk_part(found.node, columns, wanted);
        std::uint32_t begin = 0;
        for (std::size_t k = 0; k < found.part.count.size(); ++k) {
            choose(found, begin, k, relations[k]);
            begin += found.part.count[k];
        }
    }

    // The points of segment k, which begins at point `begin` of the part.
    void choose(ScannedPoints& found, std::uint32_t begin, std::size_t k, BoxRelation relation) const
    {
        const Chunk& chunk = found.part.chunk;
        const auto position = [&](std::size_t i) {
            return rounding_(tree_.info().grid.to_source(chunk.positions->grid(i)));
        };
        std::vector<std::uint32_t> some(found.part.count[k]);
        std::iota(some.begin(), some.end(), begin);
        if (options_.within && !options_.within->has_all(found.node)) {
            const auto out = [&](std::uint32_t i) {
                return !options_.within->contains(found.node, found.part.first[k] + (i - begin));
            };
            some.erase(std::remove_if(some.begin(), some.end(), out), some.end());
        }
        std::vector<const Column*> columns(chunk.attributes.size(), nullptr);
        for (const std::size_t a : selector_.tested()) columns[a] = chunk.attributes[a].get();
        selector_.narrow(columns, position, some, relation);
        if (relation != BoxRelation::inside && options_.test) {
            std::vector<Vec3d> positions;
            positions.reserve(some.size());
            for (const std::uint32_t i : some) positions.push_back(position(i));
            options_.test->narrow(chunk, positions, some);
        }
        for (const std::uint32_t i : some) {
            found.indices.push_back(i);
            found.numbers.push_back(found.part.first[k] + (i - begin));
        }
    }

    const Tree& tree_;
    const ScanOptions& options_;
    const std::function<void(const ScannedPoints&)>& take_;
    const Selector selector_;
    const SourceRounding rounding_;
    const std::vector<SelectedNode> nodes_;
};

}  // namespace

void PlaceTest::narrow(const Chunk&, const std::vector<Vec3d>& positions, std::vector<std::uint32_t>& some) const
{
    std::size_t kept = 0;
    for (std::size_t k = 0; k < some.size(); ++k)
        if (holds(positions[k])) some[kept++] = some[k];
    some.resize(kept);
}

std::vector<Vec3d> source_positions(const ScannedPoints& found, const Grid& grid, const SourceRounding& rounding)
{
    std::vector<Vec3d> positions;
    positions.reserve(found.indices.size());
    for (const std::uint32_t i : found.indices)
        positions.push_back(rounding(grid.to_source(found.part.chunk.positions->grid(i))));
    return positions;
}

void scan_points(const Tree& tree, const Selection& selection, const ScanOptions& options,
                 const std::function<void(const ScannedPoints&)>& take)
{
    Watch watch(options.select.progress);
    watch.report(options.stage, options.begin, true);
    Scan(tree, selection, options, take).run(watch);
}

}  // namespace pcm
