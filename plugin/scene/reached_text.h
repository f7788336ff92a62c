// How the points of primitives were reached, as the text that project files keep.
#pragma once

#include "pcm/place/reached_from.h"

#include <QString>

#include <map>
#include <string>

namespace pcm::host {

// JSON with all digits; the keys are the caller's.
QString text_of(const std::map<std::string, ReachedFrom>& reached);

// Throws Error(bad_format), saying what is wrong with the text.
std::map<std::string, ReachedFrom> reached_of(const QString& text);

}  // namespace pcm::host
