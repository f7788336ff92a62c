#include "plugin/tools/align/align_marks.h"

#include "plugin/scene/annotations.h"
#include "plugin/tools/align/align_session.h"

#include <QVariant>

namespace pcm::host {

namespace {

const char* const owner = "align";
const char* const shown_property = "pcm_marks_shown";
const QColor moving_colour(255, 140, 0), fixed_colour(0, 170, 255), selected_colour(255, 255, 0);

Annotation mark_at(const Vec3d& place, const QString& label, const QColor& colour)
{
    Annotation mark;
    mark.marks = {place};
    mark.label = label;
    mark.label_at = place;
    mark.colour = colour;
    mark.on_top = true;
    return mark;
}

}  // namespace

void draw_marks(const AlignSession& session)
{
    std::vector<Annotation> drawn;
    if (session.property(shown_property).toBool())
        for (std::size_t i = 0; i < session.pairs().size(); ++i) {
            const PickedPair& pair = session.pairs()[i];
            const bool selected = session.selected() == int(i);
            const auto from = pair.moving ? session.shown(*pair.moving, true) : std::nullopt;
            const auto to = pair.fixed ? session.shown(*pair.fixed, false) : std::nullopt;
            if (from)
                drawn.push_back(mark_at(*from, QString::number(i + 1), selected ? selected_colour : moving_colour));
            if (to) drawn.push_back(mark_at(*to, QString::number(i + 1), selected ? selected_colour : fixed_colour));
            if (!from || !to) continue;
            Annotation line;
            line.line = {*from, *to};
            line.colour = selected ? selected_colour : moving_colour;
            line.width_px = 1;
            line.on_top = true;
            drawn.push_back(line);
        }
    session.scene().part<Annotations>().set(owner, drawn);
}

void show_marks(AlignSession& session, bool on)
{
    session.setProperty(shown_property, on);
    draw_marks(session);
}

}  // namespace pcm::host
