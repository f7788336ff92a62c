#include "pcm/ops/shared/attribute_report.h"

#include "pcm/filter/backends.h"
#include "pcm/system/text.h"

namespace pcm::ops {

void put_report(Result& result, const FilterReport& report)
{
    result.outcome = report.outcome;
    result.accuracy = sampled(report.errors);
    result.notes.insert(result.notes.end(), report.notes.begin(), report.notes.end());
    result.values["level"] = report.level ? Json(*report.level) : Json();
    result.values["points_checked"] = report.points_checked;
    Json errors = Json::array();
    for (const SampledError& error : report.errors)
        errors.push_back({{"of", error.what},
                          {"unit", error.unit},
                          {"median", error.median},
                          {"p95", error.p95},
                          {"p95_interval", Json::array({error.p95_low, error.p95_high})}});
    result.values["errors"] = std::move(errors);
}

std::vector<ResultKey> with_report_keys(std::vector<ResultKey> keys)
{
    const std::vector<ResultKey> common{
        {"level", "count?", "", "level whose points were computed; null: all points, exactly"},
        {"points_checked", "count", "points", "points compared with the exact answer"},
        {"errors", "list", "", "for each attribute: of, unit, median, p95, p95_interval"}};
    keys.insert(keys.begin(), common.begin(), common.end());
    return keys;
}

std::vector<ResultKey> attribute_keys()
{
    return with_report_keys({{"points_computed", "count", "points", "the others took a neighbour's values"},
                             {"used_known_normals", "flag", "", "radii were measured across normals that the tree had"},
                             {"radii_limited", "count?", "points", "radii that the limit made smaller"},
                             {"confidence", "object?", "points",
                              "number of points for each verdict on a normal: line, blob, too_few, two_surfaces"},
                             {"flipped", "count?", "points", "normals that the orientation turned around"}});
}

void put_attribute_report(Result& result, const WantedValues& wanted, const NeighbourAttributeReport& report)
{
    put_report(result, report);
    Json& values = result.values;
    values["points_computed"] = report.points_computed;
    values["used_known_normals"] = report.used_known_normals;
    values["radii_limited"] = wanted.radius ? Json(report.limited) : Json();
    values["confidence"] = wanted.needs_shape() ? Json({{"line", report.lines},
                                                        {"blob", report.blobs},
                                                        {"too_few", report.too_few},
                                                        {"two_surfaces", report.two_surfaces}})
                                                : Json();
    values["flipped"] = wanted.normal ? Json(report.flipped) : Json();
    result.line(result.output + ": " + outcome_text(noun_of(wanted), report));
    result.line(grouped(report.outcome.points_out) + " points, " + grouped(report.points_computed) + " computed");
    if (wanted.needs_shape())
        result.line("neighbours on a line: " + grouped(report.lines) + " points; in a blob: " + grouped(report.blobs) +
                    "; too few: " + grouped(report.too_few) + "; on two surfaces: " + grouped(report.two_surfaces));
    if (report.limited)
        result.line(grouped(report.limited) + " points are isolated: their radii are those of their surroundings");
    if (report.used_known_normals) result.line("radii were measured across the normals that the tree has");
}

void flann_argument(Arguments& arguments, bool& flann)
{
    arguments.add("flann", flann)
        .label("Search by FLANN")
        .help("Search with the FLANN library, for comparison")
        .advanced()
        .shown(offers_flann());
}

}  // namespace pcm::ops
