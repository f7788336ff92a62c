// How the tool Fit Primitives fits, as its panel has it and the user's settings keep it.
#pragma once

#include "pcm/ops/argument.h"
#include "pcm/place/fit_at.h"

#include <QString>

#include <optional>
#include <string>
#include <string_view>
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

// An argument of the operation `fit`, whose label, default, limits and help the panel shows. Throws std::logic_error
// where there is none of this key.
const ops::Argument& fit_argument(std::string_view key);
QString tooltip_of(const ops::Argument& argument);  // with unit and default

// A number of the settings: an argument of the operation `fit`.
struct FitNumber {
    std::string key;                           // in the settings, and of its field: "Threshold"
    const char* argument;                      // "threshold"
    const char* argument_by_radius = nullptr;  // where the neighbourhood is a radius
    bool is_basic = false;                     // shown without asking for more options
    void (*take)(FitAtOptions& options, double number, const FitSettings& settings) = nullptr;
};
const std::vector<FitNumber>& fit_numbers();

// Throws Error(invalid_argument), naming the field, for text that is not a number in its range. Several kinds where
// the best is asked for.
FitAtOptions options_of(const FitSettings& settings);

// The user's settings (QSettings): choices, and no numbers, which belong to the cloud that they were typed for. What
// cannot be read is at its default.
FitSettings kept_fit_settings();
void keep(const FitSettings& settings);

}  // namespace pcm::host
