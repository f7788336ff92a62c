// How a cancelled operation is shown: MeshLab reports every operation that returns false as a failure.
#pragma once

#include <QString>

#include <optional>

namespace pcm::host {

// Inside a catch block: what was cancelled, if the exception says that `what` was: "Opening city.laz was cancelled.",
// with the reason if the exception has one. Nothing for other exceptions.
std::optional<QString> cancelled_text(const QString& what);

// The next message box, which MeshLab opens as soon as the plugin has returned, is not a warning of a failure, but
// reports `text`. Nothing where there is no window.
void say_cancelled(const QString& text);

}  // namespace pcm::host
