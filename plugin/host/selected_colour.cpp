#include "plugin/host/selected_colour.h"

#include "plugin/host/annotations.h"

#include <QSettings>

namespace pcm::host {

namespace {

const char* const key = "PointCloud/SelectedColour";

// Read once: views ask in each frame.
std::optional<QColor>& kept()
{
    static std::optional<QColor> colour = [] {
        const QColor read(QSettings().value(key).toString());
        return read.isValid() ? std::optional(read) : std::nullopt;
    }();
    return colour;
}

}  // namespace

std::optional<QColor> chosen_selected_colour() { return kept(); }

void choose_selected_colour(const QColor& colour, const MeshDocument& document)
{
    if (!colour.isValid()) return;
    kept() = colour;
    QSettings().setValue(key, colour.name());
    repaint_views(document);
}

}  // namespace pcm::host
