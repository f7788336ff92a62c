// How the tool Fit Primitives fits, as its panel has it and the user's settings keep it.
#pragma once

#include "pcm/place/fit_at.h"

#include <QString>

#include <optional>
#include <vector>

namespace pcm::host {

struct FitSettings {
    std::optional<ShapeKind> kind;  // nothing: the one that fits best
    Estimator estimator = Estimator::msac;
    FitBackend backend = FitBackend::own;
    OutlineKind outline = OutlineKind::concave;
    bool by_radius = false;  // the neighbourhood is a radius; else a number of points
    bool grow = true;
    // As typed; what is empty is the row's default (fit_numbers()).
    std::vector<QString> numbers;
};

// A number of the settings.
struct FitNumber {
    const char* key;      // in the settings, and of its field: "Threshold"
    const char* label;    // in the panel
    const char* tooltip;  // with unit and default
    const char* usual;    // shown where nothing is typed
    double least, most;   // both ends are allowed
    bool is_whole;
    bool is_basic;  // shown without asking for more options
    void (*take)(FitAtOptions& options, double number, const FitSettings& settings);
};
const std::vector<FitNumber>& fit_numbers();

// Throws Error(invalid_argument), naming the field, for text that is no number in its range. Several kinds where
// the best is asked for.
FitAtOptions options_of(const FitSettings& settings);

// The user's settings (QSettings): choices, and no numbers, which belong to the cloud that they were typed for. What
// cannot be read is at its default.
FitSettings kept_fit_settings();
void keep(const FitSettings& settings);

}  // namespace pcm::host
