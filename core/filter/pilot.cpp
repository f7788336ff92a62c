#include "pcm/filter/pilot.h"

#include "pcm/bpc/chunk_encoder.h"
#include "pcm/filter/point_values.h"
#include "pcm/threads/thread_count.h"
#include "pcm/tree/point_hash.h"

#include <algorithm>
#include <chrono>
#include <exception>
#include <memory>
#include <mutex>

namespace pcm {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_between(Clock::time_point a, Clock::time_point b)
{
    return std::chrono::duration<double>(b - a).count();
}

struct PilotEnds : std::exception {};

struct Measured {
    std::mutex mutex;
    double prepare_seconds = 0, compute_seconds = 0;
    double points_prepared = 0, points_computed = 0;
    double sum = 0;  // so that no compiler leaves the computation out
};

// Measures instead of keeping results; ends the pass when the time is over.
class PilotVisitor final : public NeighbourhoodVisitor {
public:
    PilotVisitor(const NeighbourAttributeOptions& options, double seconds, Measured& measured)
        : wanted_(options.wanted), seconds_(seconds), measured_(measured), last_(Clock::now())
    {
    }
    ~PilotVisitor() override
    {
        const std::lock_guard lock(measured_.mutex);
        measured_.prepare_seconds += prepare_;
        measured_.compute_seconds += compute_;
        measured_.points_prepared += prepared_;
        measured_.points_computed += computed_;
        measured_.sum += sum_;
    }
    void visit(const NeighbourhoodUnit& unit, const Neighbourhoods& some) override
    {
        const bool first = !in_unit_;
        if (first) {
            const auto now = Clock::now();
            prepare_ += seconds_between(last_, now);
            prepared_ += unit.points;
            last_ = now;
            in_unit_ = true;
        }
        for (std::size_t i = 0; i < some.size(); ++i) {
            const PointValues values =
                values_of({some.dx(i), some.dy(i), some.dz(i), some.squared(i), some.count(i)}, wanted_, nullptr);
            sum_ += values.radius + values.curvature + values.mean_distance;
        }
        if (first) return;  // its search was counted as preparing
        const auto now = Clock::now();
        compute_ += seconds_between(last_, now);
        computed_ += static_cast<double>(some.size());
        last_ = now;
        if (compute_ > seconds_) throw PilotEnds();
    }
    void end(const NeighbourhoodUnit&) override { in_unit_ = false; }

private:
    const WantedValues wanted_;
    const double seconds_;
    Measured& measured_;
    Clock::time_point last_;
    bool in_unit_ = false;
    double prepare_ = 0, compute_ = 0, prepared_ = 0, computed_ = 0, sum_ = 0;
};

// Seconds per point of reading all columns of the largest chunk and encoding it.
double seconds_to_write(L2Cache& cache)
{
    const Tree& tree = cache.tree();
    NodeId largest = 0;
    for (NodeId id = 0; id < tree.nodes().size(); ++id)
        if (tree.node(id).points > tree.node(largest).points) largest = id;
    const auto start = Clock::now();
    const TreeInfo& info = tree.info();
    const auto chunk = cache.get(largest, ColumnSet::whole(info.schema));
    if (chunk->points == 0) return 0;
    std::vector<std::byte> scratch;
    hash_chunk(*chunk, RowLayout(info.schema, info.wide), scratch);
    encode_chunk(*chunk, info.schema, info.grid, tree.identity(largest));
    return seconds_between(start, Clock::now()) / chunk->points;
}

}  // namespace

double PredictedTime::of_level(const Tree& tree, std::size_t level) const
{
    const auto all = static_cast<double>(tree.info().points);
    const auto computed = static_cast<double>(tree.points_to_level(static_cast<std::uint16_t>(level)));
    return (prepare + write) * all + compute * computed;
}

PredictedTime predict_time(L2Cache& cache, const NeighbourAttributeOptions& options, const AttributePlaces& places,
                           double seconds)
{
    NeighbourhoodOptions search = search_options(options, places);
    search.level.reset();
    search.stage = "Measuring the time of the search";
    search.end = 0;
    seconds = std::clamp(seconds, 0.01, 1.0);
    Measured measured;
    const unsigned threads = thread_count(options.threads);
    const auto start = Clock::now();
    try {
        for_each_neighbourhood(cache, search,
                               [&] { return std::make_unique<PilotVisitor>(options, seconds, measured); });
    } catch (const PilotEnds&) {
    }
    PredictedTime time;
    if (measured.points_prepared > 0) time.prepare = measured.prepare_seconds / measured.points_prepared / threads;
    if (measured.points_computed > 0) time.compute = measured.compute_seconds / measured.points_computed / threads;
    if (measured.points_computed == 0 && measured.points_prepared > 0)
        time.compute = seconds_between(start, Clock::now()) / measured.points_prepared;
    // Another search, for fewer neighbours, and the joining itself: measured 0.8 to 1.3 times as long as the
    // computation from 16 neighbours.
    if (options.wanted.normal && options.orientation.rule == NormalOrientation::Rule::consistent)
        time.compute *= 1 + 1.2 * std::min(1.0, 16.0 / static_cast<double>(options.neighbours));
    time.write = seconds_to_write(cache);
    return time;
}

}  // namespace pcm
