#include "plugin/overlay/legend.h"

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

QString text_of(const std::string& text) { return QString::fromStdString(text); }

// Where the parts of one legend are, relative to its upper left corner.
struct Layout {
    int width = 0, height = 0, line = 0;
    Layout(const Legend& legend, const QString& heading)
    {
        const QFontMetrics text(legend_font(false)), title(legend_font(true));
        line = std::max(text.height(), swatch) + 2;
        width = std::min(title.horizontalAdvance(heading), most_title);
        for (const Legend::Row& row : legend.rows)
            width = std::max(width, swatch + gap + text.horizontalAdvance(text_of(row.name)));
        for (const std::string& value : {legend.low, legend.middle, legend.high})
            width = std::max(width, bar_width + gap + text.horizontalAdvance(text_of(value)));
        width += 2 * margin;
        height = 2 * margin + line + (legend.low.empty() ? line * int(legend.rows.size()) : bar_height + line);
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
    const auto write = [&](int y, const std::string& value) {
        painter.drawText(QRect(bar_width + gap, y - line / 2, 400, line), Qt::AlignLeft | Qt::AlignVCenter,
                         text_of(value));
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
        row.hidden ? painter.drawRect(square)
                   : painter.fillRect(square, QColor(row.colour[0], row.colour[1], row.colour[2]));
        painter.drawText(QRect(swatch + gap, y, 400, line), Qt::AlignLeft | Qt::AlignVCenter, text_of(row.name));
        places.emplace_back(QRect(0, y, width, line), row.number);
        y += line;
    }
    painter.setOpacity(1);
    return places;
}

}  // namespace

void add_legend(std::vector<LayerLegend>& legends, Legend legend, const QString& layer)
{
    for (LayerLegend& other : legends)
        if (other.legend.lines() == legend.lines() && other.legend.ramp == legend.ramp) {
            other.layers << layer;
            return;
        }
    legends.push_back({std::move(legend), {layer}});
}

QStringList lines_of(const std::vector<LayerLegend>& legends)
{
    QStringList lines;
    for (const LayerLegend& shown : legends)
        for (const std::string& line : shown.legend.lines()) lines << text_of(line);
    return lines;
}

LegendPicture draw_legends(const std::vector<LayerLegend>& legends, int most_height, double ratio)
{
    std::vector<Layout> layouts;
    QStringList titles;
    int width = 0, height = 0;
    for (const LayerLegend& shown : legends) {
        // Several legends name their layers.
        const QString title = text_of(shown.legend.title);
        titles << (legends.size() == 1 ? title : shown.layers.join(", ") + ": " + title);
        const Layout layout(shown.legend, titles.last());
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
        const Legend& legend = legends[i].legend;
        if (!legend.low.empty()) {
            draw_bar(painter, legend, layout.line);
            picture.bars.push_back(
                {QRect(margin, top + margin + layout.line + layout.line / 2, layout.width - 2 * margin, bar_height),
                 legend.range});
        }
        for (const auto& [place, number] : draw_rows(painter, legend, layout.line, layout.width - 2 * margin))
            picture.classes.emplace_back(place.translated(margin, top + margin), number);
        painter.restore();
        top += layout.height;
    }
    return picture;
}

}  // namespace pcm::host
