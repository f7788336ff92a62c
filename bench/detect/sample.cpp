#include "bench/detect/sample.h"

#include "pcm/fit/shape_fit.h"

#include <chrono>

namespace pcm::bench {

PeerSample read_sample(const Tree& tree)
{
    PeerSample sample;
    sample.points.origin = tree.info().bounds().centre();
    const std::size_t source = *tree.info().schema.find("point_source_id");
    ColumnSet columns = ColumnSet::only_positions();
    columns.attributes.set(source);
    for (NodeId node = 0; node < tree.nodes().size(); ++node) {
        const Chunk chunk = tree.read_chunk(node, columns);
        for (std::size_t i = 0; i < chunk.points; ++i) {
            sample.points.add(tree.info().grid.to_source(chunk.positions->grid(i)));
            sample.ids.push_back(static_cast<std::uint32_t>(chunk.attributes[source]->value(i, 0)));
        }
    }
    const auto start = std::chrono::steady_clock::now();
    estimate_normals(sample.points, 16);
    sample.normals = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    return sample;
}

PeerResult::PeerResult(const PeerSample& sample) : sample_(sample), labels_(sample.ids.size(), 0) {}

void PeerResult::add(Shape shape, const std::vector<std::size_t>& points)
{
    Primitive primitive;
    primitive.label = static_cast<std::uint32_t>(found_.size() + 1);
    primitive.fit.shape = shape;
    primitive.fit.shape.point = sample_.points.origin + shape.point;
    primitive.fit.verdict = FitVerdict::good;
    primitive.points = points.size();
    for (const std::size_t i : points) labels_[i] = primitive.label;
    found_.push_back(primitive);
}

void PeerResult::print(const std::filesystem::path& truth, bool list)
{
    Pairs pairs;
    for (std::size_t i = 0; i < labels_.size(); ++i) ++pairs[{labels_[i], sample_.ids[i]}];
    Score score = compare(read_truth(truth), found_, pairs, 500, list);
    score.has_sigmas = false;
    bench::print(score);
}

}  // namespace pcm::bench
