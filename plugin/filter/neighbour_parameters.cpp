#include "plugin/filter/neighbour_parameters.h"

#include "pcm/system/error.h"
#include "pcm/tree/tree.h"
#include "plugin/filter/parameters.h"
#include "plugin/filter/tree_target.h"
#include "plugin/panels/operation.h"
#include "plugin/scene/text.h"

namespace pcm::host {

namespace {

// A number of which 0 means that there is none. Throws Error(invalid_argument) when it is negative.
std::optional<double> positive_of(const RichParameterList& parameters, const char* name, const char* label)
{
    const auto value = static_cast<double>(parameters.getFloat(name));
    if (value == 0) return std::nullopt;
    if (value > 0) return value;
    throw Error(ErrorCode::invalid_argument, {},
                std::string(label) + " is " + exact(value) + "; it must be positive, or 0");
}

}  // namespace

void add_neighbours_parameter(RichParameterList& parameters, int usual, const QString& meaning)
{
    parameters.addParam(
        RichInt("Neighbours", usual, "Neighbours",
                "Number of nearest neighbours " + meaning +
                    QString(", from 1 to %1, without the point itself. Default %2.").arg(most_neighbours).arg(usual)));
}

std::size_t neighbours_of(const RichParameterList& parameters)
{
    return static_cast<std::size_t>(in_range(parameters, "Neighbours", "Neighbours", 1, int(most_neighbours)));
}

void add_precision_parameters(RichParameterList& parameters)
{
    parameters.addParam(RichFloat("MaxDistance", 0, "Farthest neighbour",
                                  "Neighbours that are farther from the point do not count, in the cloud's own units. "
                                  "0, the default: no limit."));
    parameters.addParam(
        RichInt("Level", -1, "Level",
                "The precision: the points of the levels of detail from 0 to this one are computed, from "
                "the neighbours in the whole cloud; each other point takes the values of the nearest "
                "one. Faster, and the log has the error. -1, the default: all points, exactly."));
    parameters.addParam(
        RichFloat("TimeLimit", 0, "Time limit (s)",
                  "Chooses the finest level that is predicted to be done within so many seconds. 0, the "
                  "default: no limit."));
    parameters.addParam(
        RichFloat("ErrorTarget", 0, "Error target (%)",
                  "Chooses the coarsest level at which 95 % of the points are predicted to have no larger "
                  "error, in percent; for normals 1 is an angle of 0.01. 0, the default: no target."));
}

void read_precision(const RichParameterList& parameters, NeighbourAttributeOptions& options)
{
    if (const auto distance = positive_of(parameters, "MaxDistance", "Farthest neighbour"))
        options.max_distance = *distance;
    if (const int level = in_range(parameters, "Level", "Level", -1, 65535); level >= 0)
        options.level = static_cast<std::uint16_t>(level);
    options.time_limit = positive_of(parameters, "TimeLimit", "Time limit");
    options.error_target_percent = positive_of(parameters, "ErrorTarget", "Error target");
}

std::optional<Vec3d> three_numbers_of(const RichParameterList& parameters, const char* name, const char* label)
{
    const QString text = parameters.getString(name).simplified();
    if (text.isEmpty()) return std::nullopt;
    const QStringList words = text.split(' ');
    Vec3d v{};
    bool good = words.size() == 3;
    for (int a = 0; a < 3 && good; ++a) v[static_cast<std::size_t>(a)] = words[a].toDouble(&good);
    if (good) return v;
    throw Error(ErrorCode::invalid_argument, {}, std::string(label) + " is '" + text.toStdString() + "'",
                "write three numbers separated by blanks: x y z");
}

void run_attribute_filter(const FilterRun& run, NeighbourAttributeOptions options)
{
    const std::filesystem::path tree = tree_of(run.parameters, run.document);
    options.memory_bytes = memory_of(run.parameters);
    options.threads = threads_of(run.parameters);
    Operation operation(run.callback);
    options.progress = operation.progress();
    UpdateTarget target(tree, target_of(run.parameters));
    const NeighbourAttributeReport report = target.update(
        [&](const std::filesystem::path& folder) { return compute_neighbour_attributes(folder, options); });
    log_warnings(run, report.outcome.warnings);
    log_notes(run, report.notes);
    run.log(target.path().string() + ": " + outcome_text(noun_of(options.wanted), report));
    run.log(grouped(report.outcome.points_out) + " points, " + grouped(report.points_computed) +
            " of them computed, peak memory " + bytes_text(report.peak_memory_bytes) + ".");
    if (options.wanted.normal)
        run.log("Neighbours on a line: " + grouped(report.lines) + " points; in a blob: " + grouped(report.blobs) +
                "; too few: " + grouped(report.too_few) + "; on two surfaces: " + grouped(report.two_surfaces) + ".");
    if (report.used_known_normals) run.log("Radii were measured across the normals that the cloud has.");
    const Schema schema = Tree::open(target.path())->info().schema;
    if (schema.find(attribute_name::radius) && schema.find(attribute_name::normal))
        run.log("The cloud has radii and normals now: Fitted splats, the default, follow them.");
    show_result(run, tree, target_of(run.parameters));
}

}  // namespace pcm::host
