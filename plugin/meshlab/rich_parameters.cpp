#include "plugin/meshlab/rich_parameters.h"

#include "plugin/meshlab/meshlab.h"

#include <QDomDocument>
#include <QSettings>

namespace pcm::host {

namespace {

std::unique_ptr<RichParameter> rich(const Parameter& p)
{
    const QString name = script_name_of(p.name);
    if (!p.choices.isEmpty()) return std::make_unique<RichEnum>(name, p.value.toInt(), p.choices, p.label, p.help);
    switch (p.value.userType()) {
        case QMetaType::Bool:
            return std::make_unique<RichBool>(name, p.value.toBool(), p.label, p.help);
        case QMetaType::Int:
            return std::make_unique<RichInt>(name, p.value.toInt(), p.label, p.help);
        case QMetaType::Float:
            return std::make_unique<RichFloat>(name, p.value.toFloat(), p.label, p.help);
        case QMetaType::QColor:
            return std::make_unique<RichColor>(name, p.value.value<QColor>(), p.label, p.help);
        default:
            return std::make_unique<RichString>(name, p.value.toString(), p.label, p.help);
    }
}

QVariant plain(const Value& value)
{
    if (value.isBool()) return value.getBool();
    if (const auto choice = choice_of(value)) return *choice;
    if (value.isInt()) return value.getInt();
    if (value.isFloat()) return static_cast<float>(value.getFloat());
    if (value.isColor()) return value.getColor();
    if (value.isString()) return value.getString();
    return {};
}

Parameter plain(const RichParameter& p)
{
    const auto* const choice = dynamic_cast<const RichEnum*>(&p);
    return {name_of_script(p.name()), plain(p.value()), p.fieldDescription(), p.toolTip(),
            choice ? choice->enumvalues : QStringList()};
}

class RichSettings : public SettingStore {
public:
    explicit RichSettings(RichParameterList* list) : list_(list) {}

    Parameters all() const override { return list_ ? parameters_of(*list_, setting_prefix) : Parameters(); }
    std::optional<QVariant> value(const QString& name) const override
    {
        if (!has(name)) return std::nullopt;
        return plain(list_->getParameterByName(name).value());
    }
    void set(const QString& name, const QVariant& value) override
    {
        if (!has(name)) return;
        Parameter changed = plain(list_->getParameterByName(name));
        changed.value = value;
        list_->setValue(name, rich(changed)->value());
    }
    std::optional<QVariant> stored(const QString& name) const override
    {
        QDomDocument document;
        if (!document.setContent(QSettings().value(name).toString())) return std::nullopt;
        const auto read = parameter_of(document.firstChildElement());
        return read ? std::optional(read->value) : std::nullopt;
    }
    void store(const QString& name) override
    {
        if (!has(name)) return;
        QDomDocument document("MeshLabSettings");
        document.appendChild(list_->getParameterByName(name).fillToXMLDocument(document));
        QSettings().setValue(name, document.toString());
    }
    void forget(const QString& name) override { QSettings().remove(name); }
    QDomElement element_of(const QString& name, QDomDocument& document) const override
    {
        return list_->getParameterByName(name).fillToXMLDocument(document, false);
    }
    std::optional<Parameter> parameter_of(const QDomElement& element) const override
    {
        const std::unique_ptr<RichParameter> read(read_parameter(element));
        return read ? std::optional(plain(*read)) : std::nullopt;
    }

private:
    bool has(const QString& name) const { return list_ && list_->hasParameter(name); }

    RichParameterList* const list_;
};

}  // namespace

void add_to(RichParameterList& list, const Parameters& parameters)
{
    for (const Parameter& parameter : parameters) list.addParam(*rich(parameter));
}

Parameters parameters_of(const RichParameterList& list, const char* beginning)
{
    Parameters parameters;
    for (const RichParameter& p : list)
        if (p.name().startsWith(beginning) && plain(p.value()).isValid()) parameters.add(plain(p));
    return parameters;
}

std::unique_ptr<SettingStore> setting_store(RichParameterList* list) { return std::make_unique<RichSettings>(list); }

}  // namespace pcm::host
