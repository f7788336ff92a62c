#include "plugin/scene/selected_colour.h"

#include "plugin/scene/annotations.h"

#include <QSettings>

namespace pcm::host {

namespace {

const char* const colour_setting = "PointCloud/SelectedColour";

// Read once: views need it in each frame.
std::optional<QColor>& kept_colour()
{
    static std::optional<QColor> colour = [] {
        const QColor read(QSettings().value(colour_setting).toString());
        return read.isValid() ? std::optional(read) : std::nullopt;
    }();
    return colour;
}

}  // namespace

std::optional<QColor> chosen_selected_colour() { return kept_colour(); }

void choose_selected_colour(const QColor& colour, const Scene& scene)
{
    if (!colour.isValid()) return;
    kept_colour() = colour;
    QSettings().setValue(colour_setting, colour.name());
    scene.repaint();
}

}  // namespace pcm::host
