// Settings in a list, as a program without files would keep them.
#pragma once

#include "plugin/scene/setting_store.h"

#include <QDomElement>

#include <memory>

namespace pcm::host {

class FakeSettings : public SettingStore {
public:
    explicit FakeSettings(std::shared_ptr<Parameters> present) : present_(std::move(present)) {}

    Parameters all() const override { return *present_; }
    std::optional<QVariant> value(const QString& name) const override
    {
        const Parameter* const found = present_->find(name);
        return found ? std::optional(found->value) : std::nullopt;
    }
    void set(const QString& name, const QVariant& value) override
    {
        if (present_->has(name)) present_->set(name, value);
    }
    std::optional<QVariant> stored(const QString&) const override { return std::nullopt; }
    void store(const QString&) override {}
    void forget(const QString&) override {}
    QDomElement element_of(const QString&, QDomDocument&) const override { return {}; }
    std::optional<Parameter> parameter_of(const QDomElement&) const override { return std::nullopt; }

private:
    std::shared_ptr<Parameters> present_;
};

}  // namespace pcm::host
