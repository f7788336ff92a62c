#include "pcm/filter/neighbour_attributes.h"

#include "pcm/cloud/attribute_length.h"
#include "pcm/filter/attribute_pass.h"
#include "pcm/filter/result_attributes.h"
#include "pcm/system/error.h"
#include "pcm/system/peak_memory.h"
#include "pcm/system/text.h"
#include "pcm/threads/watch.h"
#include "pcm/tree/tree.h"
#include "pcm/update/tree_changes.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

namespace pcm {
namespace {

// Shares of the progress: the pass ends (before normals are made consistent), the index is written.
constexpr double end_of_joining_pass = 0.8, end_of_pass = 0.95;

void check(const NeighbourAttributeOptions& options, const std::filesystem::path& path)
{
    const auto refuse = [&](const char* what, const char* hint) {
        throw Error(ErrorCode::invalid_argument, path, what, hint);
    };
    if (!options.wanted.any()) refuse("no attribute is to be computed", "choose radii, normals or another attribute");
    if (!(options.radius_limit >= 0)) refuse("the limit of radii must be 0 or more", "");
    if (!(options.max_distance > 0)) refuse("the largest distance of a neighbour must be positive", "");
    if (options.wanted.normal) {
        if (!is_finite(options.orientation.vector)) refuse("the orientation is not finite", "");
        if (options.orientation.rule == NormalOrientation::Rule::direction &&
            largest_magnitude(options.orientation.vector) == 0)
            refuse("the direction that normals are to point to is 0 0 0", "give a direction such as 0 0 1");
    }
}

void check_scanners(const NeighbourAttributeOptions& options, const TreeInfo& info, const std::filesystem::path& path)
{
    if (!options.wanted.normal || options.orientation.rule != NormalOrientation::Rule::scanners) return;
    if (ScannerPlaces(info.metadata, info.schema).empty())
        throw Error(ErrorCode::invalid_argument, path, "the cloud does not say where its scanner stood",
                    "PTX and E57 files do; for one scan, give the scanner's position instead");
}

AttributePlaces make_places(TreeChanges& changes, const WantedValues& wanted, bool overwrite)
{
    AttributePlaces places;
    const auto place = [&](bool is_wanted, std::string_view name, ScalarType type, std::uint32_t components,
                           const char* description) -> std::optional<std::size_t> {
        if (!is_wanted) return {};
        const Attribute attribute{std::string(name), type, components, 1, 0, description};
        // Normals and radii are what the cloud looks like: new ones are to take the place of any.
        if (name != attribute_name::normal && name != attribute_name::radius)
            check_may_write(*changes.tree(), attribute, overwrite);
        return place_for(changes, attribute);
    };
    // In the order that exports have them.
    places.normal = place(wanted.normal, attribute_name::normal, ScalarType::f32, 3, "");
    places.radius =
        place(wanted.radius, attribute_name::radius, ScalarType::f32, 1, attribute_unit::radius_description.data());
    places.curvature = place(wanted.curvature, attribute_name::curvature, ScalarType::f32, 1,
                             "share of the smallest variance among the neighbours, 0 to 1/3");
    places.confidence =
        place(wanted.confidence, attribute_name::normal_confidence, ScalarType::u8, 1,
              "0 good, 1 neighbours on a line, 2 no plane, 3 too few neighbours, 4 on two surfaces: side uncertain");
    places.mean_distance = place(wanted.mean_distance, attribute_name::mean_distance, ScalarType::f32, 1,
                                 "of the nearest neighbours, source units");
    const Schema& schema = changes.tree()->info().schema;
    const auto known = schema.find(attribute_name::normal);
    if (wanted.radius && !wanted.normal && known && schema[*known].components == 3) places.known_normal = known;
    return places;
}

bool is_consistent(const NeighbourAttributeOptions& options)
{
    return options.wanted.normal && options.orientation.rule == NormalOrientation::Rule::consistent;
}

// Where they are more than noise makes by chance.
void report_two_surfaces(std::uint64_t points, NeighbourAttributeReport& report)
{
    if (report.two_surfaces * 200 <= points) return;
    report.notes.push_back(std::to_string(report.two_surfaces) + " points (" +
                           brief(100 * static_cast<double>(report.two_surfaces) / static_cast<double>(points)) +
                           " %) lie on two surfaces nearer to each other than their points, such as both sides of a "
                           "thin plate: which side "
                           "their normals point to is a guess (normal_confidence 4)");
}

// Computes all attributes, and makes normals consistent.
void run_pass(L2Cache& cache, const NeighbourAttributeOptions& options, const AttributePlaces& places, Watch& watch,
              NeighbourAttributeReport& report)
{
    if (!is_consistent(options)) {
        run_attribute_pass(cache, options, places, nullptr, end_of_pass, report);
        return;
    }
    OrientationPropagation propagation(cache.tree());
    run_attribute_pass(cache, options, places, &propagation, end_of_joining_pass, report);
    report.flipped +=
        propagation.finish(cache, *places.normal, options.threads, watch, end_of_joining_pass, end_of_pass);
}

}  // namespace

NeighbourAttributeReport compute_neighbour_attributes(const std::filesystem::path& path,
                                                      const NeighbourAttributeOptions& asked)
{
    check(asked, path);
    Watch watch(asked.progress);
    NeighbourAttributeOptions options = asked;
    NeighbourAttributeReport report;
    const auto changes = std::make_shared<TreeChanges>(path);
    check_scanners(options, changes->tree()->info(), path);
    const AttributePlaces places = make_places(*changes, options.wanted, options.overwrite);
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
