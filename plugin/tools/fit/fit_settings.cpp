#include "plugin/tools/fit/fit_settings.h"

#include "pcm/ops/operation.h"
#include "pcm/system/error.h"

#include <QLocale>
#include <QSettings>

#include <memory>
#include <stdexcept>

namespace pcm::host {

namespace {

const char* const group = "PointCloudFit/";

std::vector<FitNumber> basic_numbers()
{
    return {
        {"Threshold", "threshold", nullptr, true,
         [](FitAtOptions& options, double number, const FitSettings&) { options.fit.threshold = number; }},
        {"Neighbourhood", "count", "radius", true,
         [](FitAtOptions& options, double number, const FitSettings& settings) {
             if (settings.by_radius)
                 options.radius = number;
             else
                 options.count = static_cast<std::size_t>(number);
         }},
        {"Step", "step", nullptr, true,
         [](FitAtOptions& options, double number, const FitSettings&) { options.step = number; }},
    };
}

// Shown on request.
std::vector<FitNumber> search_numbers()
{
    return {
        {"NormalAngle", "normal_angle", nullptr, false,
         [](FitAtOptions& options, double number, const FitSettings&) {
             options.fit.normal_angle = options.turned_angle = number * pi / 180;
         }},
        {"LeastRadius", "least_radius", nullptr, false,
         [](FitAtOptions& options, double number, const FitSettings&) { options.fit.least_radius = number; }},
        {"LargestRadius", "largest_radius", nullptr, false,
         [](FitAtOptions& options, double number, const FitSettings&) { options.fit.largest_radius = number; }},
        {"Iterations", "iterations", nullptr, false,
         [](FitAtOptions& options, double number, const FitSettings&) {
             options.fit.iterations = static_cast<std::uint32_t>(number);
         }},
        {"Probability", "probability", nullptr, false,
         [](FitAtOptions& options, double number, const FitSettings&) { options.fit.probability = number; }},
        {"Seconds", "time_limit", nullptr, false,
         [](FitAtOptions& options, double number, const FitSettings&) { options.fit.seconds = number; }},
        {"Rounds", "rounds", nullptr, false,
         [](FitAtOptions& options, double number, const FitSettings&) {
             options.rounds = static_cast<unsigned>(number);
         }},
        {"OutlineEdge", "outline_edge", nullptr, false,
         [](FitAtOptions& options, double number, const FitSettings&) { options.outline.edge = number; }},
        {"Registration", "registration", nullptr, false,
         [](FitAtOptions& options, double number, const FitSettings&) { options.registration = number; }},
        {"Seed", "seed", nullptr, false,
         [](FitAtOptions& options, double number, const FitSettings&) {
             options.fit.seed = static_cast<std::uint64_t>(number);
         }},
    };
}

}  // namespace

const ops::Argument& fit_argument(std::string_view key)
{
    static const std::unique_ptr<ops::Operation> operation = ops::find_operation("fit")->make();
    const ops::Argument* const argument = operation->arguments().find(std::string(key));
    if (!argument) throw std::logic_error("the operation fit has no argument " + std::string(key));
    return *argument;
}

QString tooltip_of(const ops::Argument& argument)
{
    const std::string unit = argument.unit().empty() ? "" : ", " + argument.unit();
    std::string usual = argument.without().empty() ? argument.default_text() : argument.without();
    for (const ops::Choice& choice : argument.choices())
        if (choice.name == usual) usual = choice.label;
    return QString::fromStdString(argument.help() + unit + ". Default: " + usual + ".");
}

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
        const ops::Argument& argument =
            fit_argument(settings.by_radius && row.argument_by_radius ? row.argument_by_radius : row.argument);
        std::string word = text.toStdString();
        if (const std::string fault = argument.fault(word); !fault.empty())
            throw Error(ErrorCode::invalid_argument, {}, argument.label() + ": " + fault,
                        "change it, or empty the field");
        const double number = QLocale::c().toDouble(QString::fromStdString(word));
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
    for (const FitNumber& row : fit_numbers())
        kept.remove(QString(group) + QString::fromStdString(row.key));  // earlier versions kept them
}

}  // namespace pcm::host
