#include "pcm/filter/set_points.h"

#include "pcm/build/builder.h"
#include "pcm/cloud/with_type.h"
#include "pcm/io/file_text.h"
#include "pcm/select/point_scan.h"
#include "pcm/system/error.h"
#include "pcm/system/output_path.h"
#include "pcm/tree/tree_reader.h"

#include <mutex>
#include <type_traits>
#include <utility>

namespace pcm {
namespace {

class ChoiceOfSet final : public PointChoice {
public:
    explicit ChoiceOfSet(PointSet set) : set_(std::move(set)) {}
    std::uint32_t count(NodeId node) const override { return set_.count(node); }
    std::vector<std::uint32_t> points(NodeId node) const override { return set_.points(node); }

private:
    const PointSet set_;
};

ConvertReport extract_tree(const PointSet& set, const std::filesystem::path& output, const ExtractOptions& options)
{
    const auto cloud = open_set(set);
    BuildOptions build;
    build.memory_bytes = options.memory_bytes;
    build.threads = options.threads;
    build.overwrite = options.overwrite;
    build.progress = options.progress;
    const BuildReport built = build_tree(*cloud, set.tree().info().sources, output, build);
    ConvertReport report;
    report.outcome = built.outcome;
    report.bytes = built.bytes;
    report.notes = built.notes;
    return report;
}

}  // namespace

SetStatistics statistics_of(const PointSet& set, unsigned threads, const ProgressFunction& progress)
{
    const Tree& tree = set.tree();
    SetStatistics statistics;
    const auto place = tree.info().schema.find("classification");
    const bool counts_classes = place && tree.info().schema[*place].components == 1 &&
                                tree.info().schema[*place].type != ScalarType::f32 &&
                                tree.info().schema[*place].type != ScalarType::f64;
    ScanOptions scan;
    scan.within = &set;
    scan.columns = ColumnSet::only_positions();
    if (counts_classes) scan.columns->attributes.set(*place);
    scan.select.threads = threads;
    scan.select.progress = progress;
    scan.stage = "Counting the selected points";
    const SourceRounding rounding(tree.info());
    std::mutex mutex;
    scan_points(tree, {}, scan, [&](const ScannedPoints& found) {
        SetStatistics part;
        part.points = found.indices.size();
        for (const std::uint32_t i : found.indices)
            part.box.extend(rounding(tree.info().grid.to_source(found.part.chunk.positions->grid(i))));
        if (counts_classes) {
            const Column& classes = *found.part.chunk.attributes[*place];
            with_type(classes.type(), [&](auto scalar) {
                using T = decltype(scalar);
                const T* const values = classes.as<T>();
                for (const std::uint32_t i : found.indices) ++part.classes[static_cast<std::int64_t>(values[i])];
            });
        }
        const std::lock_guard lock(mutex);
        statistics.points += part.points;
        statistics.box.extend(part.box);
        for (const auto& [value, points] : part.classes) statistics.classes[value] += points;
    });
    return statistics;
}

std::unique_ptr<PointReader> open_set(const PointSet& set)
{
    return std::make_unique<TreeReader>(set.shared_tree(), std::make_shared<ChoiceOfSet>(set), 2);
}

ConvertReport extract_points(const PointSet& set, const std::filesystem::path& output, const ExtractOptions& options)
{
    if (set.empty())
        throw Error(ErrorCode::invalid_argument, set.tree().folder(), "no point is selected", "select points first");
    const bool to_tree = extension_of(output) == tree_extension;
    if (to_tree)
        output_tree(output);
    else
        output_file(output);
    std::error_code error;
    if (std::filesystem::exists(std::filesystem::status(output, error))) {
        if (std::filesystem::equivalent(output, set.tree().folder(), error))
            throw Error(ErrorCode::invalid_argument, output, "this is the tree itself; it cannot be the output too",
                        "choose another name");
        if (!options.overwrite)
            throw Error(ErrorCode::exists, output, "the output exists already", "choose another name, or overwrite it");
    }
    if (to_tree) return extract_tree(set, output, options);
    ConvertOptions convert;
    convert.write = options.write;
    convert.progress = options.progress;
    return write_cloud([&] { return open_set(set); }, output, convert);
}

}  // namespace pcm
