#include "plugin/tools/fit/fit_settings.h"

#include "pcm/system/error.h"
#include "pcm/system/text.h"

#include <QLocale>
#include <QSettings>

#include <cmath>

namespace pcm::host {

namespace {

const char* const group = "PointCloudFit/";
constexpr double any_length = 1e12, most_count = 1e6;

std::vector<FitNumber> basic_numbers()
{
    return {
        {"Threshold", "Threshold",
         "The largest distance of a point from the surface that counts as on it, source units. Default: empty, from "
         "the "
         "noise of the points around the place.",
         "automatic", 0, any_length, false, true,
         [](FitAtOptions& options, double number, const FitSettings&) { options.fit.threshold = number; }},
        {"Neighbourhood", "Around",
         "How much around a clicked place is fitted: the number of nearest points, or the radius in source units. The "
         "points that belong to the surface are then found in the whole cloud. Default: empty, as many as the fit "
         "needs.",
         "automatic", 0, any_length, false, true,
         [](FitAtOptions& options, double number, const FitSettings& settings) {
             if (settings.by_radius)
                 options.radius = number;
             else
                 options.count = static_cast<std::size_t>(std::min(number, most_count));
         }},
        {"Step", "Longest step",
         "How far apart neighbouring points of one surface are at most, source units: the surface is followed by steps "
         "of this length. Default: empty, a few times the spacing of the points.",
         "automatic", 0, any_length, false, true,
         [](FitAtOptions& options, double number, const FitSettings&) { options.step = number; }},
    };
}

// Shown on request.
std::vector<FitNumber> search_numbers()
{
    return {
        {"NormalAngle", "Normals within",
         "The largest angle between the shape and the surface of the points around a point, degrees: the shape is not "
         "followed where it is larger. 90: not compared. Where it is given and the cloud has normals, these are "
         "compared, too. Default: empty, 30, computed from the points, and with a threshold not compared.",
         "30", 0, 90, false, false,
         [](FitAtOptions& options, double number, const FitSettings&) {
             options.fit.normal_angle = options.turned_angle = number * pi / 180;
         }},
        {"LeastRadius", "Radius from",
         "Smaller radii (of a torus: of its tube) are not considered, source units. Default: empty, any.", "any", 0,
         any_length, false, false,
         [](FitAtOptions& options, double number, const FitSettings&) { options.fit.least_radius = number; }},
        {"LargestRadius", "Radius to",
         "Larger radii (of a torus: of its tube) are not considered, source units. Default: empty, any.", "any", 0,
         any_length, false, false,
         [](FitAtOptions& options, double number, const FitSettings&) { options.fit.largest_radius = number; }},
        {"Iterations", "Samples", "The most samples of points that the search tries. Default: empty, 10000.", "10000",
         1, 1e9, true, false,
         [](FitAtOptions& options, double number, const FitSettings&) {
             options.fit.iterations = static_cast<std::uint32_t>(number);
         }},
        {"Probability", "Probability",
         "The search ends when, with this probability, one of the samples was of good points alone. Above 0 and below "
         "1. Default: empty, 0.99.",
         "0.99", 1e-9, 1 - 1e-9, false, false,
         [](FitAtOptions& options, double number, const FitSettings&) { options.fit.probability = number; }},
        {"Seconds", "Time limit", "Ends the search with the best shape so far, seconds. Default: empty, no limit.",
         "none", 0, 1e6, false, false,
         [](FitAtOptions& options, double number, const FitSettings&) { options.fit.seconds = number; }},
        {"Seed", "Seed",
         "Start of the random numbers: the same seed gives the same result. A whole number. Default: empty, 1.", "1", 0,
         1e9, true, false,
         [](FitAtOptions& options, double number, const FitSettings&) {
             options.fit.seed = static_cast<std::uint64_t>(number);
         }},
    };
}

}  // namespace

const std::vector<FitNumber>& fit_numbers()
{
    static const std::vector<FitNumber> rows = [] {
        std::vector<FitNumber> all = basic_numbers(), more = search_numbers();
        all.insert(all.end(), more.begin(), more.end());
        return all;
    }();
    return rows;
}

FitAtOptions options_of(const FitSettings& settings)
{
    FitAtOptions options;
    if (settings.kind)
        options.fit.kind = *settings.kind;
    else
        for (const ShapeTraits& traits : shape_kinds()) options.kinds.push_back(traits.kind);
    options.fit.estimator = settings.estimator;
    options.fit.backend = settings.backend;
    options.outline.kind = settings.outline;
    options.grow = settings.grow;
    for (std::size_t i = 0; i < fit_numbers().size() && i < settings.numbers.size(); ++i) {
        const FitNumber& row = fit_numbers()[i];
        const QString text = settings.numbers[i].trimmed();
        if (text.isEmpty()) continue;
        bool good = false;
        const double number = QLocale::c().toDouble(text, &good);
        if (!good || !(number >= row.least) || !(number <= row.most) || (row.is_whole && number != std::floor(number)))
            throw Error(ErrorCode::invalid_argument, {},
                        std::string(row.label) + ": '" + text.toStdString() + "' is no " +
                            (row.is_whole ? "whole number" : "number") + " from " + exact(row.least) + " to " +
                            exact(row.most),
                        "change it, or empty the field");
        row.take(options, number, settings);
    }
    return options;
}

FitSettings kept_fit_settings()
{
    const QSettings kept;
    const auto text = [&](const char* key) { return kept.value(QString(group) + key).toString(); };
    FitSettings settings;
    settings.kind = shape_kind(text("Shape").toStdString());
    settings.estimator = estimator_of(text("Estimator").toStdString()).value_or(settings.estimator);
    settings.backend = text("Backend") == "pcl" ? FitBackend::pcl : FitBackend::own;
    settings.outline = outline_kind(text("Outline").toStdString()).value_or(settings.outline);
    settings.by_radius = kept.value(QString(group) + "ByRadius", settings.by_radius).toBool();
    settings.grow = kept.value(QString(group) + "Grow", settings.grow).toBool();
    settings.numbers.resize(fit_numbers().size());
    return settings;
}

void keep(const FitSettings& settings)
{
    QSettings kept;
    const auto set = [&](const char* key, const QVariant& value) { kept.setValue(QString(group) + key, value); };
    set("Shape", settings.kind ? traits_of(*settings.kind).name : "any");
    set("Estimator", traits_of(settings.estimator).name);
    set("Backend", settings.backend == FitBackend::pcl ? "pcl" : "own");
    set("Outline", name_of(settings.outline));
    set("ByRadius", settings.by_radius);
    set("Grow", settings.grow);
    for (const FitNumber& row : fit_numbers()) kept.remove(QString(group) + row.key);  // earlier versions kept them
}

}  // namespace pcm::host
