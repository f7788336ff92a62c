// What fitted shapes look like in views, and their labels.
#pragma once

#include "pcm/cloud/affine.h"
#include "pcm/shapes/primitive_list.h"
#include "plugin/scene/annotations.h"

#include <QColor>
#include <QString>

#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace pcm::host {

struct PrimitiveStyle {
    QColor colour;
    bool strong = false;  // wider lines, as visible behind points as before them
    QString label;        // next to it; empty: none
};

// Outline or circles, lines along the surface and the axis. `placement` moves source coordinates to the scene's;
// absent: they are the same. Empty for a primitive whose bounds are not known.
std::vector<Annotation> drawn_primitive(const Primitive& primitive, const std::optional<Affine>& placement,
                                        const PrimitiveStyle& style);

QColor colour_of(const Primitive& primitive);

// The number that says how large it is: "r 0.03961 ± 0.00002 m", "area 2.5 ± 0.1 m²". `unit` is that of lengths, or
// empty.
QString size_of(const Primitive& primitive, const std::string& unit);
// Names and values of all that is known, most important first; standard deviations after ±.
std::vector<std::pair<QString, QString>> lines_of(const Primitive& primitive, const std::string& unit);
// The same, and the pipe run (piping/pipe_run.h) that it is a part of, among the shapes of its cloud that are shown.
std::vector<std::pair<QString, QString>> lines_of(const PrimitiveList& list, std::size_t index,
                                                  const std::string& unit);

}  // namespace pcm::host
