// Points that stand apart from the others: removed, or labelled.
#pragma once

#include "pcm/filter/filter_report.h"
#include "pcm/knn/neighbourhoods.h"
#include "pcm/system/progress.h"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <vector>

namespace pcm {

class ValueFile;

enum class OutlierMethod : std::uint8_t {
    // D: mean distance of a point to its k nearest neighbours; outliers have D > mean + factor * deviation of all
    // points (deviation: sqrt(sum((D - mean)^2) / n)).
    statistical,
    // The same with the median of D, and 1.4826 times the median of |D - median| (MAD) as the deviation: for clouds
    // whose
    // outliers are too far away or too many for mean and deviation. Where more than half of all D are
    // equal,
    // so that the MAD is 0, a tenth of the median takes the place of the deviation. No point is an outlier where more
    // than half of the points lie at one place with all k neighbours.
    robust,
    radius,  // outliers have fewer than `neighbours` others within `radius`
};

struct OutlierOptions {
    OutlierMethod method = OutlierMethod::statistical;
    std::size_t neighbours = 16;  // 1 to most_neighbours
    double factor = 3;            // finite, positive; for the statistical and the robust method
    double radius = 0;            // source units, inclusive, positive; for the method `radius`
    bool label = false;       // removes nothing: writes the attribute "outlier" (u8), 1 for outliers and 0 for others
    bool overwrite = false;   // label: an attribute "outlier" that this filter did not make may be lost
    bool count_only = false;  // changes nothing; the report shows what would be removed
    std::uint64_t memory_bytes = std::uint64_t(512) << 20;
    unsigned threads = 0;  // 0: one per processor
    NeighbourBackend backend = NeighbourBackend::own;
    ProgressFunction progress;
};

struct OutlierReport : FilterReport {
    std::uint64_t outliers = 0;
    // Statistics of the mean distances of all points: mean or median, deviation, and the distance above which a point
    // is an outlier; source units. 0 for the method `radius`.
    double centre = 0, deviation = 0, threshold = 0;
    bool coverage_kept = true;  // as EraseReport
};

// In place and atomic: whatever ends it early, also a crash, a cancelled progress or a full disk, leaves the tree as it
// was (see update/target.h for a copy). All values and statistics are in double, so the outliers are those of comparing
// all pairs, at map coordinates too. A scratch file of 8 bytes a point lies in the tree's folder while it runs
// (when points are only counted, in the system's folder for temporary files); it has no name. Removing keeps the levels
// of the other points (see update/erase.h). Throws Error(invalid_argument) for options out of range, and for an
// attribute "outlier" of another type or, unless `overwrite`, of another origin; Error(exists) when another process or
// thread changes the tree; what reading and writing throw. What fails after the tree is changed is a warning of the
// outcome.
OutlierReport remove_outliers(const std::filesystem::path& tree, const OutlierOptions& options);

// What outliers are known by: each point's mean distance to its neighbours or, for the method `radius`, their number.
// `set` gets the values of a unit's points, keyed by number in it; `skip` a unit without points. Any thread calls them.
struct OutlierValues {
    std::function<void(const NeighbourhoodUnit& unit, const std::vector<double>& values)> set;
    std::function<void(std::size_t unit)> skip;
};
// Searches the units of `next_unit` (NeighbourhoodOptions). Throws what remove_outliers() throws for the options.
void find_outlier_values(const std::shared_ptr<const Tree>& tree, const OutlierOptions& options,
                         const OutlierValues& values, const std::function<std::size_t()>& next_unit);
// remove_outliers() for values that are known: `fill` sets those of all points of the tree as it is opened.
OutlierReport remove_outliers(const std::filesystem::path& tree, const OutlierOptions& options,
                              const std::function<void(const Tree& tree, ValueFile& file)>& fill);
void check_options(const OutlierOptions& options, const std::filesystem::path& path);

}  // namespace pcm
