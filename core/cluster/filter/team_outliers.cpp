#include "pcm/cluster/filter/team_outliers.h"

#include "pcm/bpc/byte_order.h"
#include "pcm/cluster/filter/team_target.h"
#include "pcm/cluster/filter/unit_results.h"
#include "pcm/cluster/rank_error.h"
#include "pcm/cluster/team_work.h"
#include "pcm/filter/value_file.h"
#include "pcm/knn/unit_plan.h"
#include "pcm/system/progress_part.h"

#include <cstring>

namespace pcm {
namespace {

constexpr double end_of_common_search = 0.8;  // share of the progress

// What jobs depend on, apart from the tree: not the factor, so that another one is tried without another search.
std::vector<std::byte> identity_of(const OutlierOptions& options)
{
    const bool counts = options.method == OutlierMethod::radius;
    ByteWriter out;
    out.put_string("outliers");
    out.put(static_cast<std::uint8_t>(counts));
    out.put(static_cast<std::uint64_t>(options.neighbours));
    out.put(counts ? options.radius : 0.0);
    out.put(static_cast<std::uint8_t>(options.backend));
    return std::move(out.bytes());
}

// Reads the values of all points.
void fill_from(const UnitResults& results, ValueFile& file)
{
    std::vector<double> values;
    for (std::size_t unit = 0; unit < results.units(); ++unit)
        results.for_each_of_unit(unit, [&](const UnitResults::Part& part) {
            values.resize(part.indices.size());
            std::memcpy(values.data(), part.columns[0].data(), part.columns[0].size());
            file.set(part.node, part.indices, values.data());
        });
}

OutlierReport remove_by(Team& team, const std::filesystem::path& tree, const TargetChoice& choice,
                        const OutlierOptions& options)
{
    TeamTarget target(team, tree, options.count_only ? TargetChoice{{}, true, false} : choice, identity_of(options));
    const std::vector<Box3i> units = plan_units(*target.tree(), usual_unit_points);
    const UnitResults results(target.jobs(), *target.tree(), units, {sizeof(double)}, 0);
    const auto set = [&](const NeighbourhoodUnit& unit, const std::vector<double>& values) {
        results.write(unit, {values.data()}, {}, {});
    };
    OutlierOptions search = options;
    search.progress = part_of(options.progress, 0, end_of_common_search / 0.85);  // the search ends at 0.85
    find_outlier_values(target.tree(), search, {set, [&](std::size_t unit) { results.write_empty(unit); }}, [&] {
        for (;;) {
            const auto unit = static_cast<std::size_t>(team.next(count_units));
            if (unit >= units.size() || !results.is_done(unit)) return unit;
        }
    });
    team.wait();
    OutlierReport report;
    if (team.rank() == 0) {
        OutlierOptions last = options;
        last.progress = part_of(options.progress, end_of_common_search, 1);
        const auto work = [&](const std::filesystem::path& folder) -> Outcome& {
            report = remove_outliers(folder, last, [&](const Tree& opened, ValueFile& file) {
                target.refuse_changed(opened);
                fill_from(results, file);
            });
            return report.outcome;
        };
        if (options.count_only)
            target.end(work(target.tree()->folder()));
        else
            target.change(work);
        for (std::string& note : target.notes()) report.notes.push_back(std::move(note));
    }
    team.wait();
    return report;
}

}  // namespace

OutlierReport remove_outliers_by(Team& team, const std::filesystem::path& tree, const TargetChoice& choice,
                                 const OutlierOptions& options)
{
    check_options(options, tree);
    if (!options.count_only) check_choice(tree, choice);
    return named_by_rank(team, tree, [&] { return remove_by(team, tree, choice, options); });
}

}  // namespace pcm
