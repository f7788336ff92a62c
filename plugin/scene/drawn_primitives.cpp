#include "plugin/scene/drawn_primitives.h"

#include "pcm/measure/measure.h"
#include "pcm/piping/pipe_run.h"
#include "pcm/shapes/outline_area.h"
#include "pcm/shapes/shape_lines.h"
#include "pcm/system/rounded_text.h"
#include "pcm/system/text.h"

#include <algorithm>
#include <cmath>

namespace pcm::host {

namespace {

constexpr double degrees = 180 / pi;

using Lines = std::vector<std::pair<QString, QString>>;

// Numbers whose uncertainty is not known are rounded to four digits.
QString text_with(double value, double uncertainty, const char* dimension, const std::string& unit)
{
    const double known = std::isfinite(uncertainty) ? uncertainty : 0;
    if (!(known > 0)) value = QString::number(value, 'g', 4).toDouble();
    const std::string text = text_of(MeasureValue{{}, value, known, dimension}, unit);
    return QString::fromStdString(text) + (std::isinf(uncertainty) ? " (not determined)" : "");
}

// "area" is that of the points' outline; a rectangle around them is called one.
void add_area(const Primitive& primitive, const std::string& unit, Lines& lines)
{
    const OutlineArea found = area_of(primitive);
    lines.emplace_back(found.form == OutlineForm::rectangle ? "rectangle" : "area",
                       text_with(found.area, found.uncertainty, "^2", unit));
}

void add_sizes(const Primitive& primitive, const std::string& unit, Lines& lines)
{
    const Shape& shape = primitive.fit.shape;
    const ShapeErrors& errors = primitive.fit.errors;
    const ShapeBounds& bounds = primitive.bounds;
    const ShapeTraits& traits = traits_of(shape.kind);
    for (const ShapeSize& size : traits.sizes) {
        const double value = shape.*size.value, error = errors.*size.error;
        lines.emplace_back(size.label, size.unit == SizeUnit::angle
                                           ? text_with(value * degrees, error * degrees, "deg", unit)
                                           : text_with(value, error, "", unit));
    }
    if (!bounds.known(shape.kind)) return;
    if (traits.extent == ShapeExtent::outline) add_area(primitive, unit, lines);
    if (bounds.from < bounds.to) lines.emplace_back("length", text_with(bounds.to - bounds.from, 0, "", unit));
    if (traits.has_arc()) lines.emplace_back("arc", text_with((bounds.end - bounds.begin) * degrees, 0, "deg", unit));
}

void add_place(const Primitive& primitive, const std::string& unit, Lines& lines)
{
    const Shape& shape = primitive.fit.shape;
    const ShapeErrors& errors = primitive.fit.errors;
    const ShapeTraits& traits = traits_of(shape.kind);
    lines.emplace_back(traits.place.label, QString::fromStdString(rounded_text(shape.point, errors.position)));
    lines.emplace_back("σ of the place", text_with(errors.position, 0, "", unit));
    if (!traits.has_axis()) return;
    const double tilt = std::acos(std::clamp(std::fabs(shape.axis[2]), 0.0, 1.0)) * degrees;
    lines.emplace_back(traits.axis_name(), QString::fromStdString(rounded_text(shape.axis, errors.angle)));
    lines.emplace_back(traits.is_flat() ? "slope" : "from the vertical",
                       text_with(tilt, errors.angle * degrees, "deg", unit));
}

}  // namespace

QColor colour_of(const Primitive& primitive)
{
    return QColor(primitive.colour[0], primitive.colour[1], primitive.colour[2]);
}

std::vector<Annotation> drawn_primitive(const Primitive& primitive, const std::optional<Affine>& placement,
                                        const PrimitiveStyle& style)
{
    std::vector<Annotation> drawn;
    Box3d box;
    for (ShapeLine& line : shape_lines(primitive.fit.shape, primitive.bounds)) {
        Annotation annotation;
        annotation.line = std::move(line.points);
        if (placement)
            for (Vec3d& p : annotation.line) p = (*placement)(p);
        for (const Vec3d& p : annotation.line) box.extend(p);
        annotation.closed = line.closed;
        annotation.colour = style.colour;
        const bool outline = traits_of(primitive.fit.shape.kind).extent == ShapeExtent::outline && !line.is_axis;
        annotation.width_px = (outline ? 2 : 1) + (style.strong ? 1 : 0);
        annotation.on_top = style.strong;
        drawn.push_back(std::move(annotation));
    }
    if (drawn.empty()) return drawn;
    drawn.front().label = style.label;
    drawn.front().label_at = drawn.front().line.front();
    for (const Vec3d& p : drawn.front().line)
        if (length(p - box.max) < length(drawn.front().label_at - box.max)) drawn.front().label_at = p;
    return drawn;
}

QString size_of(const Primitive& primitive, const std::string& unit)
{
    Lines lines;
    add_sizes(primitive, unit, lines);
    if (lines.empty()) return {};
    const auto& [name, value] = lines.front();
    return (name == "radius" ? QString("r") : name) + " " + value;
}

std::vector<std::pair<QString, QString>> lines_of(const Primitive& primitive, const std::string& unit)
{
    const ShapeFit& fit = primitive.fit;
    Lines lines;
    lines.emplace_back("shape", traits_of(fit.shape.kind).label);
    if (fit.verdict != FitVerdict::good) lines.emplace_back(name_of(fit.verdict), QString::fromStdString(fit.message));
    add_sizes(primitive, unit, lines);
    lines.emplace_back("residual (rms)", text_with(fit.rms, 0, "", unit));
    lines.emplace_back("noise of a point", text_with(fit.noise, 0, "", unit));
    lines.emplace_back("points", QString::fromStdString(grouped(primitive.points)));
    lines.emplace_back("inliers fitted", QString::fromStdString(grouped(fit.inliers)));
    add_place(primitive, unit, lines);
    if (primitive.stations) lines.emplace_back("σ contains", QString::fromStdString(station_text(*primitive.stations)));
    lines.emplace_back("threshold", text_with(fit.threshold, 0, "", unit));
    lines.emplace_back("condition", QString::fromStdString(brief(fit.condition)));
    if (!primitive.estimator.empty()) lines.emplace_back("estimator", QString::fromStdString(primitive.estimator));
    if (!primitive.cloud.empty()) lines.emplace_back("cloud", QString::fromStdString(primitive.cloud));
    return lines;
}

Lines lines_of(const PrimitiveList& list, std::size_t index, const std::string& unit)
{
    Lines lines = lines_of(list[index], unit);
    std::vector<const Primitive*> same_cloud;
    for (std::size_t i = 0; i < list.size(); ++i)
        if (list[i].cloud == list[index].cloud) same_cloud.push_back(&list[i]);
    for (const PipeRun& run : pipe_runs(same_cloud)) {
        if (std::find(run.parts.begin(), run.parts.end(), &list[index]) == run.parts.end()) continue;
        lines.emplace_back("part of a pipe run", QString::fromStdString(parts_text(run)));
        lines.emplace_back("run's radius", text_with(run.radius, run.radius_error, "", unit));
        lines.emplace_back("run's length", text_with(run.length(), 0, "", unit));
        lines.emplace_back("run's bends", QString::fromStdString(bends_text(run)));
        const std::string doubt = doubt_text(run);
        if (!doubt.empty()) lines.emplace_back("run is doubtful", QString::fromStdString(doubt));
    }
    return lines;
}

}  // namespace pcm::host
