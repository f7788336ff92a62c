#include "plugin/render/legend.h"

#include "pcm/cloud/las_class.h"
#include "plugin/host/units.h"

#include <QFont>
#include <QFontMetrics>
#include <QPainter>

#include <algorithm>
#include <cmath>

namespace pcm::host {

namespace {

// Qt's pixels.
constexpr int margin = 8, most_title = 240, bar_width = 18, bar_height = 120, gap = 6, swatch = 11;

QFont legend_font(bool bold)
{
    QFont font("Helvetica");
    font.setPixelSize(11);
    font.setBold(bold);
    return font;
}

QString with_unit(const QString& name, const std::string& unit)
{
    return unit.empty() ? name : name + " (" + QString::fromStdString(unit) + ")";
}

QString title_of(const CloudReport& report, const std::vector<Metadata>& metadata)
{
    switch (report.style.colour) {
        case ColourMode::height:
            return with_unit("Height", height_unit(metadata));
        case ColourMode::attribute:
            return with_unit(QString::fromStdString(report.style.attribute), attribute_unit(report.style.attribute));
        default:
            return traits_of(report.style.colour).label;
    }
}

std::vector<Legend::Row> rows_of(const ClassSet& classes, const std::set<unsigned>& hidden)
{
    std::vector<Legend::Row> rows;
    for (unsigned number = 0; number < 256; ++number) {
        if (!classes[number] && !hidden.count(number)) continue;
        const auto colour = class_colour(number);
        rows.push_back({number, QColor(colour[0], colour[1], colour[2]),
                        QString::number(number) + "  " + QString::fromStdString(las_class_name(number)),
                        hidden.count(number) != 0});
    }
    return rows;
}

// Where the parts of one legend are, relative to its upper left corner.
struct Layout {
    int width = 0, height = 0, line = 0;
    Layout(const Legend& legend, const QString& heading)
    {
        const QFontMetrics text(legend_font(false)), title(legend_font(true));
        line = std::max(text.height(), swatch) + 2;
        width = std::min(title.horizontalAdvance(heading), most_title);
        for (const Legend::Row& row : legend.rows)
            width = std::max(width, swatch + gap + text.horizontalAdvance(row.name));
        for (const QString& value : {legend.low, legend.middle, legend.high})
            width = std::max(width, bar_width + gap + text.horizontalAdvance(value));
        width += 2 * margin;
        height = 2 * margin + line + (legend.low.isEmpty() ? line * int(legend.rows.size()) : bar_height + line);
    }
};

void draw_bar(QPainter& painter, const Legend& legend, int line)
{
    const int top = line + line / 2;
    for (int y = 0; y < bar_height; ++y) {
        const auto colour = ramp_colour(1 - static_cast<float>(y) / (bar_height - 1), legend.ramp);
        painter.fillRect(0, top + y, bar_width, 1,
                         QColor::fromRgbF(static_cast<double>(colour[0]), static_cast<double>(colour[1]),
                                          static_cast<double>(colour[2])));
    }
    const auto write = [&](int y, const QString& value) {
        painter.drawText(QRect(bar_width + gap, y - line / 2, 400, line), Qt::AlignLeft | Qt::AlignVCenter, value);
    };
    write(top, legend.high);
    write(top + bar_height / 2, legend.middle);
    write(top + bar_height, legend.low);
}

// Returns the rectangles of the rows.
std::vector<std::pair<QRect, unsigned>> draw_rows(QPainter& painter, const Legend& legend, int line, int width)
{
    std::vector<std::pair<QRect, unsigned>> places;
    int y = line;
    for (const Legend::Row& row : legend.rows) {
        painter.setOpacity(row.hidden ? 0.4 : 1);
        const QRect square(0, y + (line - swatch) / 2, swatch, swatch);
        row.hidden ? painter.drawRect(square) : painter.fillRect(square, row.colour);
        painter.drawText(QRect(swatch + gap, y, 400, line), Qt::AlignLeft | Qt::AlignVCenter, row.name);
        places.emplace_back(QRect(0, y, width, line), row.number);
        y += line;
    }
    painter.setOpacity(1);
    return places;
}

}  // namespace

std::optional<Legend> legend_of(const CloudReport& report, const std::vector<Metadata>& metadata,
                                const std::set<unsigned>& hidden)
{
    Legend legend;
    if (report.style.colour == ColourMode::classification) {
        legend.rows = rows_of(report.classes, hidden);
        if (legend.rows.empty()) return std::nullopt;
    } else if (report.range && has_range(report.style.colour)) {
        const ValueRange& range = *report.range;
        const double width = range.high - range.low;
        legend.ramp = ramp_of(report.style);
        legend.low = value_text(range.low, width);
        legend.middle = value_text(range.value_at(0.5), width);
        legend.high = value_text(range.high, width);
    } else {
        return std::nullopt;
    }
    legend.title = title_of(report, metadata);
    return legend;
}

void add_legend(std::vector<Legend>& legends, Legend legend, const QString& layer)
{
    for (Legend& other : legends)
        if (lines_of(other) == lines_of(legend) && other.ramp == legend.ramp) {
            other.layers << layer;
            return;
        }
    legend.layers << layer;
    legends.push_back(std::move(legend));
}

QString value_text(double value, double width)
{
    if (!(width > 0) || std::fabs(value) >= 1e12 || width < 1e-6) return QString::number(value, 'g', 8);
    const int digits = 2 - static_cast<int>(std::floor(std::log10(width)));
    QString text = QString::number(value, 'f', std::clamp(digits, 0, 8));
    if (text.contains('.')) {
        while (text.endsWith('0')) text.chop(1);
        if (text.endsWith('.')) text.chop(1);
    }
    return text == "-0" ? "0" : text;
}

QStringList lines_of(const Legend& legend)
{
    QStringList lines{legend.title};
    if (!legend.low.isEmpty()) lines << legend.low << legend.middle << legend.high;
    for (const Legend::Row& row : legend.rows) lines << row.name + (row.hidden ? " (hidden)" : "");
    return lines;
}

LegendPicture draw_legends(const std::vector<Legend>& legends, int most_height, double ratio)
{
    std::vector<Layout> layouts;
    QStringList titles;
    int width = 0, height = 0;
    for (const Legend& legend : legends) {
        // Of several, each names its layers.
        titles << (legends.size() == 1 ? legend.title : legend.layers.join(", ") + ": " + legend.title);
        const Layout layout(legend, titles.last());
        if (height + layout.height > most_height && !layouts.empty()) break;
        layouts.push_back(layout);
        width = std::max(width, layout.width);
        height += layout.height;
    }
    LegendPicture picture;
    if (layouts.empty()) return picture;
    picture.image = QImage(static_cast<int>(std::ceil(width * ratio)), static_cast<int>(std::ceil(height * ratio)),
                           QImage::Format_RGBA8888);
    picture.image.fill(QColor(0, 0, 0, 128));
    QPainter painter(&picture.image);
    painter.scale(ratio, ratio);
    painter.setPen(Qt::white);
    int top = 0;
    for (std::size_t i = 0; i < layouts.size(); ++i) {
        const Layout& layout = layouts[i];
        painter.save();
        painter.translate(margin, top + margin);
        painter.setFont(legend_font(true));
        painter.drawText(QRect(0, 0, 400, layout.line), Qt::AlignLeft | Qt::AlignVCenter,
                         QFontMetrics(painter.font()).elidedText(titles[i], Qt::ElideLeft, layout.width - 2 * margin));
        painter.setFont(legend_font(false));
        if (!legends[i].low.isEmpty()) draw_bar(painter, legends[i], layout.line);
        for (const auto& [place, number] : draw_rows(painter, legends[i], layout.line, layout.width - 2 * margin))
            picture.classes.emplace_back(place.translated(margin, top + margin), number);
        painter.restore();
        top += layout.height;
    }
    return picture;
}

}  // namespace pcm::host
