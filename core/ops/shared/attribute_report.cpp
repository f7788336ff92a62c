#include "pcm/ops/shared/attribute_report.h"

#include "pcm/filter/backends.h"
#include "pcm/system/counted.h"
#include "pcm/system/text.h"

namespace pcm::ops {

void put_report(Result& result, const FilterReport& report)
{
    result.outcome = report.outcome;
    result.accuracy = exact_answer();
    result.notes.insert(result.notes.end(), report.notes.begin(), report.notes.end());
}

std::vector<ResultKey> attribute_keys()
{
    return {{"used_known_normals", "flag", "", "radii were measured across normals that the tree had"},
            {"radii_limited", "count?", "points", "radii that the limit made smaller"},
            {"confidence", "object?", "points",
             "number of points for each verdict on a normal: line, blob, too_few, two_surfaces"},
            {"flipped", "count?", "points", "normals that the orientation turned around"}};
}

void put_attribute_report(Result& result, const WantedValues& wanted, const NeighbourAttributeReport& report)
{
    put_report(result, report);
    Json& values = result.values;
    values["used_known_normals"] = report.used_known_normals;
    values["radii_limited"] = wanted.radius ? Json(report.limited) : Json();
    values["confidence"] = wanted.needs_shape() ? Json({{"line", report.lines},
                                                        {"blob", report.blobs},
                                                        {"too_few", report.too_few},
                                                        {"two_surfaces", report.two_surfaces}})
                                                : Json();
    values["flipped"] = wanted.normal ? Json(report.flipped) : Json();
    result.line(result.output + ": " + outcome_text(noun_of(wanted), report));
    result.line(points_text(report.outcome.points_out));
    if (wanted.needs_shape())
        result.line("neighbours on a line: " + points_text(report.lines) + "; in a blob: " + grouped(report.blobs) +
                    "; too few: " + grouped(report.too_few) + "; on two surfaces: " + grouped(report.two_surfaces));
    if (report.limited)
        result.line(counted(report.limited, "point", "is", "are") +
                    " isolated: radii there are those of the surroundings");
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
