// Settings of what the colours of points show, and of which points are shown, as parameters.
#pragma once

#include "plugin/scene/setting_store.h"

#include "pcm/gl/style/splat_style.h"

#include <QString>

#include <set>

namespace pcm::host {

struct ColourSettings {
    std::set<unsigned> hidden_classes;  // their condition is in the style
    bool legend = true;
    QString problem;  // what cannot be read; such a setting has no effect. Empty if nothing
};

void add_colour_settings(Parameters& parameters);

// Sets the members of the style that these parameters are.
ColourSettings read_colour_settings(const Parameters& parameters, CloudStyle& style);

// Hides a class, or shows it again: changes the setting.
void toggle_class(SettingStore& settings, unsigned number);

// LOW:HIGH, or empty: automatic.
void set_range(SettingStore& settings, const QString& range);

}  // namespace pcm::host
