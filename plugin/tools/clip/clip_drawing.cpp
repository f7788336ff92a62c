#include "plugin/tools/clip/clip_drawing.h"

#include "pcm/cloud/vector.h"

namespace pcm::host {

namespace {

const QColor edges(255, 170, 0), off(150, 150, 150), lit_colour(255, 255, 0);
const QColor axis_colours[3] = {QColor(230, 60, 50), QColor(60, 180, 60), QColor(70, 110, 240)};

QColor colour_of(const BoxHandle& handle)
{
    switch (handle.kind) {
        case BoxHandle::Kind::face:
            return axis_colours[handle.axis];
        case BoxHandle::Kind::turn:
            return QColor(200, 80, 220);
        default:
            return QColor(255, 255, 255);
    }
}

}  // namespace

std::vector<Annotation> drawing_of(const ClipBox& box, const std::optional<BoxHandle>& lit)
{
    std::vector<Annotation> drawing;
    const auto corners = corners_of(box);
    const auto add_line = [&](std::initializer_list<std::size_t> numbers, bool closed) {
        Annotation line;
        for (const std::size_t i : numbers) line.line.push_back(corners[i]);
        line.closed = closed;
        line.colour = box.enabled ? edges : off;
        line.width_px = 1.5;
        drawing.push_back(line);
    };
    add_line({0, 1, 3, 2}, true);
    add_line({4, 5, 7, 6}, true);
    for (std::size_t i = 0; i < 4; ++i) add_line({i, i + 4}, false);
    for (const BoxHandle& handle : all_handles()) {
        Annotation mark;
        mark.marks = {place_of(box, handle)};
        const bool is_lit = lit && *lit == handle;
        mark.colour = is_lit ? lit_colour : colour_of(handle);
        mark.width_px = is_lit ? 5 : 3;
        mark.on_top = true;
        if (is_lit && handle.kind == BoxHandle::Kind::turn)  // an arm to turn by
            mark.line = {box.centre, place_of(box, handle)};
        drawing.push_back(mark);
    }
    return drawing;
}

}  // namespace pcm::host
