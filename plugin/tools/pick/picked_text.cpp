#include "plugin/tools/pick/picked_text.h"

#include "pcm/system/rounded_text.h"
#include "pcm/system/text.h"

namespace pcm::host {

namespace {

QString all_digits(double value) { return QString::fromStdString(exact(value)); }

}  // namespace

std::vector<PickedLine> lines_of(const Picked& picked, const QString& layer)
{
    std::vector<PickedLine> lines{{"layer", layer}};
    const char* const axes[] = {"x", "y", "z"};
    for (std::size_t a = 0; a < 3; ++a) {
        const std::string& text = picked.position_text[a];
        lines.push_back({axes[a], text.empty() ? all_digits(picked.position[a]) : QString::fromStdString(text)});
    }
    if (picked.shown_at != picked.position)
        for (std::size_t a = 0; a < 3; ++a)
            lines.push_back({QString("%1 as the layer is moved").arg(axes[a]), all_digits(picked.shown_at[a])});
    for (const PickedValue& attribute : picked.attributes)
        lines.push_back({QString::fromStdString(attribute.name), QString::fromStdString(attribute.value)});
    lines.push_back({"spacing of points", QString::fromStdString(brief(picked.spacing))});
    lines.push_back({"grid step", all_digits(picked.grid_step)});
    lines.push_back({"point", QString("%1 of node %2").arg(picked.point).arg(picked.node)});
    return lines;
}

QString label_of(const Picked& picked)
{
    const char* const axes[] = {"x ", "\ny ", "\nz "};
    std::string text;
    for (std::size_t a = 0; a < 3; ++a) text += axes[a] + rounded_text(picked.position[a], picked.spacing / 10);
    return QString::fromStdString(text);
}

QString logged_text(const std::vector<PickedLine>& lines)
{
    return QString("%1 %2 %3, %4").arg(lines[1].value, lines[2].value, lines[3].value, lines[0].value);
}

QString copied_text(const std::vector<PickedLine>& lines)
{
    QString text;
    for (const PickedLine& line : lines) text += line.name + "\t" + line.value + "\n";
    return text;
}

}  // namespace pcm::host
