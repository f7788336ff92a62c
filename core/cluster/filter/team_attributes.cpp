#include "pcm/cluster/filter/team_attributes.h"

#include "pcm/cluster/filter/chunk_jobs.h"
#include "pcm/cluster/filter/result_store.h"
#include "pcm/cluster/filter/team_target.h"
#include "pcm/cluster/filter/unit_orientation_bytes.h"
#include "pcm/cluster/rank_error.h"
#include "pcm/cluster/team_work.h"
#include "pcm/filter/attribute_pass.h"
#include "pcm/filter/result_attributes.h"
#include "pcm/knn/unit_plan.h"
#include "pcm/system/peak_memory.h"
#include "pcm/threads/thread_count.h"
#include "pcm/threads/watch.h"

#include <array>
#include <cstring>
#include <limits>
#include <optional>
#include <string>

namespace pcm {
namespace {

// Shares of the progress.
constexpr double end_of_units = 0.7, end_of_sides = 0.75, end_of_chunks = 0.95;
constexpr JobFolder::Key sides_job{"sides"};

std::array<std::uint64_t, 6> numbers_of(const AttributeCounts& c)
{
    return {c.lines, c.blobs, c.too_few, c.two_surfaces, c.flipped, c.limited};
}

AttributeCounts counts_of(const std::vector<std::byte>& bytes)
{
    std::array<std::uint64_t, 6> n{};
    std::memcpy(n.data(), bytes.data(), sizeof n);
    return {n[0], n[1], n[2], n[3], n[4], n[5]};
}

// What jobs depend on, apart from the tree.
std::vector<std::byte> identity_of(const NeighbourAttributeOptions& options)
{
    const WantedValues& wanted = options.wanted;
    ByteWriter out;
    out.put_string("attributes");
    for (const bool flag : {wanted.radius, wanted.normal, wanted.curvature, wanted.confidence, wanted.mean_distance})
        out.put(static_cast<std::uint8_t>(flag));
    out.put(static_cast<std::uint64_t>(wanted.radius_neighbours));
    out.put(static_cast<std::uint64_t>(options.neighbours));
    out.put(options.max_distance);
    out.put(options.radius_limit);
    out.put(static_cast<std::uint8_t>(options.orientation.rule));
    for (std::size_t a = 0; a < 3; ++a) out.put(options.orientation.vector[a]);
    out.put(options.unit_points);
    out.put(static_cast<std::uint8_t>(options.backend));
    return std::move(out.bytes());
}

// Writes the values of units as files.
class FileSink final : public UnitSink {
public:
    FileSink(const UnitResults& results, const AttributePlaces& places, bool joins)
        : results_(results), places_(places), joins_(joins)
    {
    }

    void take(const NeighbourhoodUnit& unit, const UnitAttributes& values) override
    {
        std::vector<const void*> columns;
        if (places_.normal) columns.push_back(values.normal.data());
        if (places_.radius) columns.push_back(values.radius.data());
        if (places_.curvature) columns.push_back(values.curvature.data());
        if (places_.confidence) columns.push_back(values.confidence.data());
        if (places_.mean_distance) columns.push_back(values.mean_distance.data());
        if (joins_) columns.push_back(values.orientation.piece.data());
        const auto numbers = numbers_of(values.counts);
        std::vector<std::byte> head(sizeof numbers);
        std::memcpy(head.data(), numbers.data(), sizeof numbers);
        results_.write(unit, columns, head, joins_ ? bytes_of(values.orientation) : std::vector<std::byte>());
    }
    void skip(std::size_t unit) override { results_.write_empty(unit); }

private:
    const UnitResults& results_;
    const AttributePlaces places_;
    const bool joins_;
};

// Which pieces of which units are turned around.
class Sides {
public:
    explicit Sides(std::size_t units) : first_(units + 1, 0) {}

    std::vector<std::uint64_t>& first() { return first_; }  // piece of each unit; then, the number of pieces
    void set(const std::vector<bool>& flips) { flips_ = flips; }
    // `piece`: as UnitOrientation::piece.
    bool turns(std::size_t unit, std::int32_t piece) const
    {
        return piece != 0 && flips_[first_[unit] + static_cast<std::uint64_t>(piece < 0 ? -piece : piece) - 1];
    }
    bool any() const { return std::find(flips_.begin(), flips_.end(), true) != flips_.end(); }

    std::vector<std::byte> bytes() const
    {
        ByteWriter out;
        for (const std::uint64_t first : first_) out.put(first);
        for (const bool flip : flips_) out.put(static_cast<std::uint8_t>(flip));
        return std::move(out.bytes());
    }
    void load(const std::vector<std::byte>& bytes, const std::filesystem::path& path)
    {
        ByteReader in(bytes.data(), bytes.size(), path);
        for (std::uint64_t& first : first_) first = in.get<std::uint64_t>();
        flips_.resize(first_.back());
        for (std::size_t i = 0; i < flips_.size(); ++i) flips_[i] = in.get<std::uint8_t>() != 0;
    }

private:
    std::vector<std::uint64_t> first_;
    std::vector<bool> flips_;
};

class TeamAttributes {
public:
    TeamAttributes(Team& team, const std::filesystem::path& tree, const TargetChoice& choice,
                   const NeighbourAttributeOptions& options)
        : team_(team),
          options_(options),
          watch_(options.progress),
          target_(team, tree, choice, identity_of(options)),
          schema_(target_.tree()->info().schema)
    {
        check_scanners(options, target_.tree()->info(), tree);
        places_ = find_places(*target_.tree(), options.wanted, options.overwrite, [&](const Attribute& attribute) {
            return place_for(*target_.tree(), schema_, attribute);
        });
        tree_ = target_.tree()->with_schema(schema_);
        units_ = plan_units(*tree_, options.unit_points);
        std::vector<std::size_t> widths;
        for (const std::size_t place : places_.written())
            widths.push_back(size_of(schema_[place].type) * schema_[place].components);
        if (is_consistent(options)) widths.push_back(sizeof(std::int32_t));
        results_.emplace(target_.jobs(), *tree_, units_, std::move(widths), sizeof(std::uint64_t) * 6);
    }

    NeighbourAttributeReport run()
    {
        compute();
        Sides sides(units_.size());
        const bool joins = is_consistent(options_);
        if (joins) find_sides(sides);
        ChunkValues values;
        values.places = places_.written();
        if (joins && sides.any()) {
            values.finished = *places_.normal;
            values.finish = [&](const UnitResults::Part& part, std::vector<std::byte>& normals) {
                return turn(sides, part, normals);
            };
        }
        const bool longer = schema_.size() > target_.tree()->info().schema.size();
        const ChunkJobs chunks(target_.jobs(), *tree_, longer, *results_, std::move(values));
        chunks.encode(team_, options_.threads, watch_, end_of_sides, end_of_chunks);
        if (team_.rank() == 0) finish(chunks);
        team_.wait();
        return std::move(report_);
    }

private:
    void compute()
    {
        L2Options cache_options;
        cache_options.capacity_bytes = cache_share(options_.memory_bytes);
        L2Cache cache(tree_, cache_options);
        FileSink sink(*results_, places_, is_consistent(options_));
        run_attribute_pass(cache, options_, places_, sink, end_of_units, [&] {
            for (;;) {
                const auto unit = static_cast<std::size_t>(team_.next(count_units));
                if (unit >= units_.size() || !results_->is_done(unit)) return unit;
            }
        });
        team_.wait();
    }

    // Rank 0 decides, the others read.
    void find_sides(Sides& sides)
    {
        const JobFolder& jobs = target_.jobs();
        jobs.begin(sides_job.stage);
        if (team_.rank() == 0 && !jobs.is_done(sides_job)) {
            decide(sides);
            jobs.write(sides_job, {}, sides.bytes());
        }
        team_.wait();
        sides.load(jobs.record(sides_job), jobs.file(sides_job));
    }

    void decide(Sides& sides)
    {
        L2Options cache_options;
        cache_options.capacity_bytes = cache_share(options_.memory_bytes);
        L2Cache cache(std::make_shared<ResultStore>(tree_, *results_, places_.written()), cache_options);
        OrientationPropagation propagation(*tree_, target_.scratch());
        const std::size_t column = places_.written().size();
        for (std::size_t unit = 0; unit < units_.size(); ++unit) {
            UnitOrientation joined = orientation_of(results_->more(unit), target_.scratch());
            std::vector<NeighbourhoodUnit::Part> parts;
            results_->for_each_of_unit(unit, [&](const UnitResults::Part& part) {
                parts.push_back({part.node, {}, part.indices, static_cast<std::uint32_t>(joined.piece.size())});
                joined.piece.resize(joined.piece.size() + part.indices.size());
                std::memcpy(joined.piece.data() + parts.back().first, part.columns[column].data(),
                            part.columns[column].size());
            });
            propagation.add(parts, joined);
            sides.first()[unit + 1] = sides.first()[unit] + joined.pieces.size();
            watch_.report("Orienting normals", end_of_units);
        }
        sides.set(propagation.decide(cache, *places_.normal, options_.threads, watch_, end_of_units, end_of_sides));
    }

    // The pieces are the last column.
    static std::uint64_t turn(const Sides& sides, const UnitResults::Part& part, std::vector<std::byte>& normals)
    {
        std::uint64_t turned = 0;
        for (std::size_t i = 0; i < part.indices.size(); ++i) {
            std::int32_t piece;
            std::memcpy(&piece, part.columns.back().data() + i * sizeof piece, sizeof piece);
            if (!sides.turns(part.unit, piece)) continue;
            std::array<float, 3> n;
            std::memcpy(n.data(), normals.data() + i * sizeof n, sizeof n);
            for (float& component : n) component = -component;
            std::memcpy(normals.data() + i * sizeof n, n.data(), sizeof n);
            ++turned;
        }
        return turned;
    }

    void finish(const ChunkJobs& chunks)
    {
        for (std::size_t unit = 0; unit < units_.size(); ++unit) counts_of(results_->head(unit)).add_to(report_);
        const std::uint64_t points = tree_->info().points;
        report_two_surfaces(points, report_);
        report_.used_known_normals = places_.known_normal.has_value();
        target_.change([&](const std::filesystem::path& folder) -> Outcome& {
            TreeChanges changes(folder);
            target_.refuse_changed(*changes.tree());
            find_places(*changes.tree(), options_.wanted, true,
                        [&](const Attribute& attribute) { return place_for(changes, attribute); });
            report_.flipped += chunks.put(changes, watch_, end_of_chunks, 1);
            watch_.report("Writing", 1, true);  // the last chance to cancel
            run_last_step(report_.outcome, [&] { changes.commit(); });
            changes.end();
            return report_.outcome;
        });
        for (std::string& note : target_.notes()) report_.notes.push_back(std::move(note));
        watch_.finish("Done");
        report_.outcome.points_in = report_.outcome.points_out = points;
        report_.outcome.seconds = watch_.seconds();
        report_.peak_memory_bytes = peak_memory_bytes();
    }

    Team& team_;
    const NeighbourAttributeOptions& options_;
    Watch watch_;
    TeamTarget target_;
    Schema schema_;  // with the new attributes
    AttributePlaces places_;
    std::shared_ptr<const Tree> tree_;
    std::vector<Box3i> units_;
    std::optional<UnitResults> results_;
    NeighbourAttributeReport report_;
};

}  // namespace

NeighbourAttributeReport compute_neighbour_attributes_by(Team& team, const std::filesystem::path& tree,
                                                         const TargetChoice& choice,
                                                         const NeighbourAttributeOptions& options)
{
    check_choice(tree, choice);
    check_options(options, tree);
    return named_by_rank(team, choice.in_place ? tree : choice.copy,
                         [&] { return TeamAttributes(team, tree, choice, options).run(); });
}

}  // namespace pcm
