#include "pcm/filter/neighbour_attributes.h"

#include "pcm/filter/attribute_pass.h"
#include "pcm/filter/result_attributes.h"
#include "pcm/system/error.h"
#include "pcm/system/peak_memory.h"
#include "pcm/system/text.h"
#include "pcm/threads/watch.h"
#include "pcm/tree/tree.h"
#include "pcm/update/tree_changes.h"

#include <algorithm>
#include <cstring>
#include <memory>
#include <mutex>
#include <type_traits>
#include <utility>

namespace pcm {
namespace {

// Shares of the progress: the pass ends (before normals are made consistent), the index is written.
constexpr double end_of_joining_pass = 0.8, end_of_pass = 0.95;

// Writes the values of units through a cache.
class CacheSink final : public UnitSink {
public:
    // `propagation`: null where normals are not to be consistent.
    CacheSink(L2Cache& cache, const AttributePlaces& places, OrientationPropagation* propagation,
              NeighbourAttributeReport& report)
        : cache_(cache), places_(places), propagation_(propagation), report_(report)
    {
        written_.positions = false;
        for (const std::size_t place : places.written()) written_.attributes.set(place);
    }

    void take(const NeighbourhoodUnit& unit, const UnitAttributes& values) override
    {
        if (propagation_) propagation_->add(unit.parts, values.orientation);
        for (const NeighbourhoodUnit::Part& part : unit.parts) {
            L2Cache::Edit edit = cache_.edit(part.node, written_);
            const auto put = [&](const std::optional<std::size_t>& place, const auto& from) {
                if (!place) return;
                using Value = typename std::decay_t<decltype(from)>::value_type;
                std::byte* const to = edit.column(*place).data();
                for (std::size_t i = 0; i < part.indices.size(); ++i)
                    std::memcpy(to + part.indices[i] * sizeof(Value), &from[part.first + i], sizeof(Value));
            };
            put(places_.radius, values.radius);
            put(places_.curvature, values.curvature);
            put(places_.confidence, values.confidence);
            put(places_.mean_distance, values.mean_distance);
            put(places_.normal, values.normal);
            edit.mark_written();
        }
        const std::lock_guard lock(mutex_);
        values.counts.add_to(report_);
    }

private:
    L2Cache& cache_;
    const AttributePlaces places_;
    OrientationPropagation* const propagation_;
    std::mutex mutex_;  // guards the report
    NeighbourAttributeReport& report_;
    ColumnSet written_;
};

// Computes all attributes, and makes normals consistent.
void run_pass(L2Cache& cache, const NeighbourAttributeOptions& options, const AttributePlaces& places, Watch& watch,
              NeighbourAttributeReport& report)
{
    if (!is_consistent(options)) {
        CacheSink sink(cache, places, nullptr, report);
        run_attribute_pass(cache, options, places, sink, end_of_pass);
        return;
    }
    OrientationPropagation propagation(cache.tree(), cache.tree().folder());
    CacheSink sink(cache, places, &propagation, report);
    run_attribute_pass(cache, options, places, sink, end_of_joining_pass);
    report.flipped +=
        propagation.finish(cache, *places.normal, options.threads, watch, end_of_joining_pass, end_of_pass);
}

}  // namespace

NeighbourAttributeReport compute_neighbour_attributes(const std::filesystem::path& path,
                                                      const NeighbourAttributeOptions& asked)
{
    check_options(asked, path);
    Watch watch(asked.progress);
    NeighbourAttributeOptions options = asked;
    NeighbourAttributeReport report;
    const auto changes = std::make_shared<TreeChanges>(path);
    check_scanners(options, changes->tree()->info(), path);
    const AttributePlaces places =
        find_places(*changes->tree(), options.wanted, options.overwrite,
                    [&](const Attribute& attribute) { return place_for(*changes, attribute); });
    const TreeInfo info = changes->tree()->info();
    L2Options cache_options;
    cache_options.capacity_bytes = cache_share(options.memory_bytes);
    L2Cache cache(changes, cache_options);
    try {
        run_pass(cache, options, places, watch, report);
        report_two_surfaces(info.points, report);
        report.used_known_normals = places.known_normal.has_value();
        watch.report("Writing", end_of_pass, true);  // the last chance to cancel
        run_last_step(report.outcome, [&] { cache.flush(); });
    } catch (...) {
        cache.abandon();
        throw;
    }
    changes->end();
    watch.finish("Done");
    report.outcome.points_in = report.outcome.points_out = info.points;
    report.outcome.seconds = watch.seconds();
    report.peak_memory_bytes = peak_memory_bytes();
    return report;
}

std::string noun_of(const WantedValues& wanted)
{
    std::vector<std::string> nouns;
    if (wanted.normal) nouns.push_back("normals");
    if (wanted.radius) nouns.push_back("radii");
    if (wanted.curvature) nouns.push_back("curvature");
    if (wanted.mean_distance) nouns.push_back("mean distances");
    if (wanted.confidence && nouns.empty()) nouns.push_back("confidence of normals");
    std::string text;
    for (std::size_t i = 0; i < nouns.size(); ++i)
        text += (i == 0 ? "" : i + 1 == nouns.size() ? " and " : ", ") + nouns[i];
    return text;
}

}  // namespace pcm
