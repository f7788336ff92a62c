// The widget with which a user changes one of our settings, of whatever type it is.
#pragma once

#include "plugin/scene/parameters.h"

#include <QString>

#include <functional>
#include <memory>
#include <utility>

class QGridLayout;

namespace pcm::host {

class SettingEditor {
public:
    virtual ~SettingEditor() = default;
    void show(const QVariant& value)  // does not call `changed`
    {
        showing_ = true;
        set(value);
        showing_ = false;
    }

    const QString& name() const { return name_; }

protected:
    using Changed = std::function<void(const QString& name, const QVariant& value)>;
    SettingEditor(const QString& name, Changed changed) : name_(name), changed_(std::move(changed)) {}
    virtual void set(const QVariant& value) = 0;
    // What the user has chosen.
    void change(const QVariant& value)
    {
        if (!showing_) changed_(name_, value);
    }

private:
    bool showing_ = false;
    QString name_;
    Changed changed_;
};

// The editor of `setting`, a row that is added to `rows`: its label and its widget, both with the tooltip of the
// setting. `off_at_zero`: a number of which 0 means off, which gets a check box. Owned by the caller; the widgets are
// the parent's.
std::unique_ptr<SettingEditor> add_setting_editor(
    QGridLayout& rows, const Parameter& setting, bool off_at_zero,
    std::function<void(const QString& name, const QVariant& value)> changed);

}  // namespace pcm::host
