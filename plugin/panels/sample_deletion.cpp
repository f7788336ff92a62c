#include "plugin/panels/sample_deletion.h"

#include "pcm/system/error.h"
#include "pcm/update/erase.h"
#include "plugin/scene/layer_matrix.h"
#include "plugin/scene/text.h"

#include <cmath>

namespace pcm::host {

namespace {

constexpr std::uint64_t most_counted = 30'000'000;  // points to be read: a few seconds

Selection selection_of(const Region& region)
{
    Selection selection;
    selection.region = region;
    return selection;
}

}  // namespace

std::string points_in(const LayerCloud& tree, const Region& region)
{
    Query query;
    query.region = region;
    const Estimate estimate = tree.cloud->estimate(query);
    EraseOptions options;
    options.count_only = true;
    try {
        if (estimate.points_read <= most_counted)
            return grouped(erase_points(tree.cloud->tree()->folder(), selection_of(region), options).points_deleted);
    } catch (const Error&) {
        // A tree that cannot be changed: the deletion will say why, and the question is asked with an estimate.
    }
    return "about " + grouped(static_cast<std::uint64_t>(std::llround(estimate.points_expected)));
}

std::vector<std::string> delete_points_in(Scene& scene, const LayerCloud& tree, const Region& region,
                                          Operation& operation)
{
    const std::filesystem::path folder = tree.cloud->tree()->folder();
    refuse_locked(scene, folder);
    EraseOptions options;
    options.progress = operation.progress();
    const EraseReport report = erase_points(folder, selection_of(region), options);
    std::vector<std::string> lines{"Deleted " + grouped(report.points_deleted) + " of the " +
                                   grouped(report.outcome.points_in) + " points of " + folder.string() + " in " +
                                   brief(report.outcome.seconds) + " s: those in " + region.text() + "."};
    for (const std::string& warning : report.outcome.warnings) lines.push_back("Warning: " + warning);
    for (std::string& line : scene.reload(folder)) lines.push_back(std::move(line));
    return lines;
}

}  // namespace pcm::host
