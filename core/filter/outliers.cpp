#include "pcm/filter/outliers.h"

#include "pcm/cache/l2_cache.h"
#include "pcm/filter/point_values.h"
#include "pcm/filter/result_attributes.h"
#include "pcm/filter/value_file.h"
#include "pcm/filter/value_statistics.h"
#include "pcm/system/error.h"
#include "pcm/system/peak_memory.h"
#include "pcm/system/text.h"
#include "pcm/threads/for_each_index.h"
#include "pcm/threads/thread_count.h"
#include "pcm/threads/watch.h"
#include "pcm/update/erase.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>

namespace pcm {
namespace {

constexpr double end_of_search = 0.85, end_of_statistics = 0.9;  // shares of the progress
constexpr double mad_to_deviation = 1.4826;                      // for normally distributed numbers

// A tree whose points are only counted may lie where nothing can be written.
std::filesystem::path scratch_folder(const Tree& tree, const OutlierOptions& options)
{
    return options.count_only ? std::filesystem::temp_directory_path() : tree.folder();
}

// Finds the mean distance, or the number, of each point's neighbours.
class ValueVisitor final : public NeighbourhoodVisitor {
public:
    ValueVisitor(const OutlierValues& found, bool counts) : found_(found), counts_(counts) {}
    void begin(const NeighbourhoodUnit& unit) override { values_.resize(unit.points); }
    void visit(const NeighbourhoodUnit&, const Neighbourhoods& some) override
    {
        for (std::size_t i = 0; i < some.size(); ++i)
            values_[some.number(i)] =
                counts_ ? static_cast<double>(some.count(i)) : mean_distance_of(some.squared(i), some.count(i));
    }
    void end(const NeighbourhoodUnit& unit) override { found_.set(unit, values_); }
    void skip(std::size_t unit) override { found_.skip(unit); }

private:
    const OutlierValues& found_;
    const bool counts_;
    std::vector<double> values_;
};

using Fill = std::function<void(const Tree& tree, ValueFile& file)>;

void search(L2Cache& cache, const OutlierOptions& options, const OutlierValues& values,
            const std::function<std::size_t()>& next_unit)
{
    const bool counts = options.method == OutlierMethod::radius;
    NeighbourhoodOptions search;
    search.neighbours = options.neighbours;
    if (counts) search.max_distance = options.radius;
    search.memory_bytes = options.memory_bytes / 3;
    search.threads = options.threads;
    search.backend = options.backend;
    search.progress = options.progress;
    search.end = end_of_search;
    search.next_unit = next_unit;
    for_each_neighbourhood(cache, search, [&] { return std::make_unique<ValueVisitor>(values, counts); });
}

L2Options cache_options(const OutlierOptions& options)
{
    L2Options cache;
    cache.capacity_bytes = cache_share(options.memory_bytes);
    return cache;
}

// Searches the neighbours of all points through the cache.
Fill fill_through(L2Cache& cache, const OutlierOptions& options)
{
    return [&](const Tree&, ValueFile& file) {
        const auto set = [&](const NeighbourhoodUnit& unit, const std::vector<double>& values) {
            for (const NeighbourhoodUnit::Part& part : unit.parts)
                file.set(part.node, part.indices, values.data() + part.first);
        };
        search(cache, options, {set, [](std::size_t) {}}, {});
    };
}

// The points with a value above, or below, a limit.
class OutlierTest final : public ChunkTest {
public:
    OutlierTest(const Tree& tree, const OutlierOptions& options, const Fill& fill, OutlierReport& report)
        : counts_(options.method == OutlierMethod::radius), file_(tree, scratch_folder(tree, options))
    {
        fill(tree, file_);
        if (counts_)
            limit_ = static_cast<double>(options.neighbours);
        else
            limit_ = threshold(options, report);
    }

    std::vector<std::uint32_t> chosen(NodeId node, const Chunk&) const override
    {
        std::vector<std::uint32_t> outliers;
        const std::vector<double> values = file_.get(node);
        for (std::uint32_t i = 0; i < values.size(); ++i)
            if (counts_ ? values[i] < limit_ : values[i] > limit_) outliers.push_back(i);
        return outliers;
    }

private:
    double threshold(const OutlierOptions& options, OutlierReport& report) const
    {
        if (file_.size() == 0) return 0;
        Watch watch(options.progress);
        const auto for_each = [&](const auto& see) {
            file_.for_each([&](const double* values, std::size_t count) {
                watch.report("Finding the threshold", end_of_search);
                see(values, count);
            });
        };
        if (options.method == OutlierMethod::statistical) {
            const MeanAndDeviation all = mean_and_deviation(for_each);
            report.centre = all.mean;
            report.deviation = all.deviation;
        } else {
            const double median = median_of(for_each, file_.size(), [](double v) { return v; });
            const double mad = median_of(for_each, file_.size(), [&](double v) { return std::fabs(v - median); });
            report.centre = median;
            report.deviation = mad > 0 ? mad_to_deviation * mad : 0.1 * median;
            if (median == 0) {
                report.notes.push_back(
                    "more than half of the points lie at one place with all their neighbours, so no distance says "
                    "what an outlier is");
                return report.threshold = std::numeric_limits<double>::max();
            }
        }
        return report.threshold = report.centre + options.factor * report.deviation;
    }

    const bool counts_;
    ValueFile file_;
    double limit_ = 0;
};

void remove(const std::filesystem::path& path, const OutlierOptions& options, const Fill& known, OutlierReport& report)
{
    EraseOptions erase;
    erase.threads = options.threads;
    erase.count_only = options.count_only;
    erase.progress = options.progress;
    erase.begin = end_of_statistics;
    const EraseReport erased = erase_points(
        path,
        [&](const std::shared_ptr<const Tree>& tree) {
            L2Cache cache(tree, cache_options(options));
            return std::make_unique<OutlierTest>(*tree, options, known ? known : fill_through(cache, options), report);
        },
        erase);
    report.outcome = erased.outcome;
    report.outliers = erased.points_deleted;
    report.coverage_kept = erased.coverage_kept;
}

// Sets the label of one node's points; chunks without changes are not written.
void label_node(L2Cache& cache, NodeId node, std::size_t place, const std::vector<std::uint32_t>& outliers)
{
    ColumnSet columns;
    columns.positions = false;
    columns.attributes.set(place);
    L2Cache::Edit edit = cache.edit(node, columns);
    const Column& before = *edit.chunk().attributes[place];
    std::vector<std::uint8_t> labels(edit.chunk().points, 0);
    for (const std::uint32_t i : outliers) labels[i] = 1;
    if (std::equal(labels.begin(), labels.end(), before.as<std::uint8_t>())) return;
    std::copy(labels.begin(), labels.end(), edit.column(place).as<std::uint8_t>());
    edit.mark_written();
}

void label(const std::filesystem::path& path, const OutlierOptions& options, const Fill& known, OutlierReport& report)
{
    Watch watch(options.progress);
    const auto changes = std::make_shared<TreeChanges>(path);
    check_may_write(*changes->tree(), outlier_attribute(), options.overwrite);
    const std::size_t place = place_for(*changes, outlier_attribute());
    L2Cache cache(changes, cache_options(options));
    try {
        const OutlierTest test(cache.tree(), options, known ? known : fill_through(cache, options), report);
        std::vector<NodeId> nodes;
        for (NodeId id = 0; id < cache.tree().nodes().size(); ++id)
            if (cache.tree().node(id).points) nodes.push_back(id);
        std::atomic<std::uint64_t> outliers{0};
        for_each_index(
            nodes.size(), thread_count(options.threads),
            [&](std::size_t i) {
                const std::vector<std::uint32_t> chosen = test.chosen(nodes[i], {});
                outliers += chosen.size();
                label_node(cache, nodes[i], place, chosen);
            },
            [&](std::size_t done) {
                watch.report("Labelling", end_of_statistics + (0.98 - end_of_statistics) * static_cast<double>(done) /
                                                                  static_cast<double>(nodes.size() + 1));
            });
        report.outliers = outliers;
        watch.report("Writing", 0.98, true);  // the last chance to cancel
        run_last_step(report.outcome, [&] { cache.flush(); });
    } catch (...) {
        cache.abandon();
        throw;
    }
    report.outcome.points_in = report.outcome.points_out = cache.tree().info().points;
    changes->end();
    watch.finish("Done");
}

}  // namespace

void check_options(const OutlierOptions& options, const std::filesystem::path& path)
{
    const auto refuse = [&](const char* what) { throw Error(ErrorCode::invalid_argument, path, what); };
    if (options.method == OutlierMethod::radius) {
        if (!(options.radius > 0)) refuse("the radius within which neighbours are counted must be positive");
    } else if (!std::isfinite(options.factor)) {
        refuse("the factor of the deviation must be finite");
    } else if (!(options.factor > 0)) {
        throw Error(ErrorCode::invalid_argument, path,
                    "with the factor " + brief(options.factor) +
                        " of the deviation about half of the points or more would be outliers: all whose mean distance "
                        "is above the average, or even below it",
                    "give a positive factor; 1 takes many points, 3 the ones that stand apart");
    }
    if (options.label && options.count_only) refuse("outliers are to be labelled, and nothing is to be changed");
}

void find_outlier_values(const std::shared_ptr<const Tree>& tree, const OutlierOptions& options,
                         const OutlierValues& values, const std::function<std::size_t()>& next_unit)
{
    check_options(options, tree->folder());
    L2Cache cache(tree, cache_options(options));
    search(cache, options, values, next_unit);
}

OutlierReport remove_outliers(const std::filesystem::path& path, const OutlierOptions& options)
{
    return remove_outliers(path, options, {});
}

OutlierReport remove_outliers(const std::filesystem::path& path, const OutlierOptions& options,
                              const std::function<void(const Tree& tree, ValueFile& file)>& fill)
{
    check_options(options, path);
    const Watch watch(options.progress);
    OutlierReport report;
    if (options.label)
        label(path, options, fill, report);
    else
        remove(path, options, fill, report);
    report.outcome.seconds = watch.seconds();
    report.peak_memory_bytes = peak_memory_bytes();
    return report;
}

}  // namespace pcm
