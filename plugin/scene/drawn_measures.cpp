#include "plugin/scene/drawn_measures.h"

#include "pcm/cloud/vector.h"
#include "plugin/scene/measure_text.h"

#include <algorithm>

namespace pcm::host {

namespace {

const QColor colour(255, 170, 0), selected_colour(255, 240, 90), draft_colour(90, 220, 255);

std::vector<Vec3d> positions(const std::vector<MeasuredPoint>& points, std::size_t first = 0)
{
    std::vector<Vec3d> places;
    for (std::size_t i = first; i < points.size(); ++i) places.push_back(points[i].position);
    return places;
}

bool is_polygon(MeasureKind kind) { return kind == MeasureKind::area || kind == MeasureKind::volume; }

Vec3d middle_of(const std::vector<Vec3d>& places)
{
    Vec3d sum{};
    for (const Vec3d& p : places) sum = sum + (p - places.front());
    return places.front() + (1.0 / static_cast<double>(places.size())) * sum;
}

// Halfway along the line.
Vec3d halfway(const std::vector<Vec3d>& line)
{
    double total = 0;
    for (std::size_t i = 1; i < line.size(); ++i) total += length(line[i] - line[i - 1]);
    double left = total / 2;
    for (std::size_t i = 1; i < line.size(); ++i) {
        const double step = length(line[i] - line[i - 1]);
        if (step >= left && step > 0) return line[i - 1] + (left / step) * (line[i] - line[i - 1]);
        left -= step;
    }
    return line.front();
}

Vec3d label_place(MeasureKind kind, const std::vector<Vec3d>& places)
{
    if (is_polygon(kind)) return middle_of(places);
    if (kind == MeasureKind::angle && places.size() > 1) return places[1];
    if (kind == MeasureKind::plane || places.size() == 1) return places.front();
    return halfway(places);
}

// The lines of one measure; the first one has the marks and the label.
std::vector<Annotation> lines_of(MeasureKind kind, const std::vector<MeasuredPoint>& points)
{
    Annotation main;
    main.marks = positions(points);
    if (kind == MeasureKind::plane) {
        Annotation plane;
        plane.line = positions(points, 1);
        plane.closed = plane.line.size() > 2;
        return {main, plane};
    }
    if (points.size() > 1) main.line = main.marks;
    main.closed = is_polygon(kind) && points.size() > 2;
    if (kind != MeasureKind::height || points.size() < 2) return {main};
    // A height is measured along the vertical line, up or down to the level of the second point.
    const Vec3d &from = main.marks[0], &to = main.marks[1];
    Annotation level;
    main.line = {from, {from[0], from[1], to[2]}};
    level.line = {main.line[1], to};
    level.width_px = 1;
    return {main, level};
}

QString label(const Measure& measure, const std::string& unit)
{
    return QString::fromStdString(measure.name) + "\n" + value_of(measure, unit);
}

}  // namespace

std::vector<Annotation> drawn_measures(const std::vector<Measure>& measures, const std::string& unit,
                                       std::optional<std::size_t> selected)
{
    std::vector<Annotation> all;
    for (std::size_t i = 0; i < measures.size(); ++i) {
        const Measure& measure = measures[i];
        if (measure.hidden || measure.points.empty()) continue;
        std::vector<Annotation> lines = lines_of(measure.kind, measure.points);
        lines.front().label = label(measure, unit);
        lines.front().label_at =
            label_place(measure.kind, lines.front().line.size() > 1 ? lines.front().line : positions(measure.points));
        for (Annotation& line : lines) {
            line.colour = selected == i ? selected_colour : colour;
            if (selected == i) line.width_px += 1;
            all.push_back(line);
        }
    }
    return all;
}

Annotation drawn_draft(MeasureKind, const std::vector<MeasuredPoint>& points)
{
    Annotation drawn;
    drawn.marks = positions(points);
    if (points.size() > 1) drawn.line = drawn.marks;
    drawn.colour = draft_colour;
    drawn.on_top = true;
    return drawn;
}

}  // namespace pcm::host
