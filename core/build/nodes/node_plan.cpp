#include "pcm/build/nodes/node_plan.h"

#include "pcm/build/nodes/point_sizes.h"

#include <utility>

namespace pcm {
namespace {

template <class Coord>
class Planner {
public:
    Planner(const TopTree<Coord>& top, const std::function<std::uint64_t(std::size_t)>& rows,
            const LevelsOfBins& levels)
        : top_(top), levels_(levels), rows_(top.nodes.size())
    {
        // Children come after their parents.
        for (std::size_t n = top.nodes.size(); n-- > 0;) {
            const auto& node = top.nodes[n];
            rows_[n] = node.children[0] ? rows_[node.children[0]] + rows_[node.children[1]] : rows(node.bin);
        }
    }

    std::vector<NodeJob> run(std::uint32_t chunk_points)
    {
        list(0, NodePath());
        choose_levels(chunk_points);
        return std::move(jobs_);
    }

private:
    std::optional<std::size_t> list(std::uint32_t number, const NodePath& path)
    {
        const auto& node = top_.nodes[number];
        if (rows_[number] == 0) return std::nullopt;
        NodeJob job;
        job.path = path;
        if (!node.children[0]) {
            job.bin = node.bin;
            job.histogram = levels_.histogram(node.bin);
        } else {
            for (const std::size_t side : {0, 1})
                if (rows_[node.children[side]] == 0) return list(node.children[1 - side], path);
            for (const unsigned side : {0, 1}) job.inputs[side] = *list(node.children[side], path.child(side));
            job.histogram = jobs_[job.inputs[0]].histogram;
            for (std::size_t level = 0; level < job.histogram.size(); ++level)
                job.histogram[level] += jobs_[job.inputs[1]].histogram[level];
        }
        jobs_.push_back(std::move(job));
        return jobs_.size() - 1;
    }

    // From the root down: each node above the bins takes the levels that fit.
    void choose_levels(std::uint32_t chunk_points)
    {
        for (std::size_t j = jobs_.size(); j-- > 0;) {
            NodeJob& job = jobs_[j];
            if (job.bin) continue;
            job.own = levels_that_fit(job.histogram, job.above.empty() ? 0 : job.above.back().last, chunk_points);
            std::vector<LevelRange> above = job.above;
            above.push_back(job.own);
            for (const std::size_t input : job.inputs) jobs_[input].above = above;
        }
    }

    const TopTree<Coord>& top_;
    const LevelsOfBins& levels_;
    std::vector<std::uint64_t> rows_;  // points below each node
    std::vector<NodeJob> jobs_;
};

}  // namespace

template <class Coord>
std::vector<NodeJob> plan_nodes(const TopTree<Coord>& top, const std::function<std::uint64_t(std::size_t)>& rows,
                                const LevelsOfBins& levels, std::uint32_t chunk_points)
{
    return Planner<Coord>(top, rows, levels).run(chunk_points);
}

template <class Coord>
LeveledRows leveled_rows(const SortedBins<Coord>& bins, const LevelsOfBins& levels, const NodeBuilderOptions& options,
                         std::size_t bin)
{
    LeveledRows points{bins.read(bin), levels.levels(bin), {}};
    points.sizes = find_sizes<Coord>(points.rows.data(), points.levels.size(), options.layout.bytes, options.grid);
    return points;
}

#define PCM_INSTANTIATE(Coord)                                                                                        \
    template std::vector<NodeJob> plan_nodes(const TopTree<Coord>&, const std::function<std::uint64_t(std::size_t)>&, \
                                             const LevelsOfBins&, std::uint32_t);                                     \
    template LeveledRows leveled_rows(const SortedBins<Coord>&, const LevelsOfBins&, const NodeBuilderOptions&,       \
                                      std::size_t);
PCM_INSTANTIATE(std::uint32_t)
PCM_INSTANTIATE(std::uint64_t)
#undef PCM_INSTANTIATE

}  // namespace pcm
