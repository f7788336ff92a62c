// Where the program keeps the settings of its window. All views of a window have the same.
#pragma once

#include "plugin/scene/parameters.h"

#include <optional>

class QDomDocument;
class QDomElement;

namespace pcm::host {

// GUI thread.
class SettingStore {
public:
    virtual ~SettingStore() = default;

    // Those of the clouds, as they are at present.
    virtual Parameters all() const = 0;
    virtual std::optional<QVariant> value(const QString& name) const = 0;  // nothing: there is no such setting
    virtual void set(const QString& name, const QVariant& value) = 0;      // where there is such a setting

    // What the program's next start begins with; nothing: with the default that its version has then.
    virtual std::optional<QVariant> stored(const QString& name) const = 0;
    virtual void store(const QString& name) = 0;  // the present value
    virtual void forget(const QString& name) = 0;

    // A setting in a project file, and the setting of such an element; nothing where it is not a setting.
    virtual QDomElement element_of(const QString& name, QDomDocument& document) const = 0;
    virtual std::optional<Parameter> parameter_of(const QDomElement& element) const = 0;

protected:
    SettingStore() = default;
    SettingStore(const SettingStore&) = default;
    SettingStore& operator=(const SettingStore&) = default;
};

}  // namespace pcm::host
