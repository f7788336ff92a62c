// Parameters with their values: what a dialog, a panel of settings or a script gives. The program that shows the dialog
// translates them to parameters of its own.
#pragma once

#include <QColor>
#include <QString>
#include <QStringList>
#include <QVariant>

#include <utility>
#include <vector>

namespace pcm::host {

struct Parameter {
    QString name;              // in scripts and in stored settings
    QVariant value;            // bool, int, float, QString or QColor
    QString label = {};        // in dialogs
    QString help = {};         // HTML
    QStringList choices = {};  // what the numbers from 0 on mean; empty: a number is a number
    QString empty = {};        // what an empty text means; shown in the empty field
    bool is_spacing = false;   // dialogs propose the current cloud's (filter/proposed_spacing.h)
};

class Parameters {
public:
    void add(Parameter parameter) { list_.push_back(std::move(parameter)); }

    bool has(const QString& name) const { return find(name) != nullptr; }
    const Parameter* find(const QString& name) const;  // null: there is none
    // Each throws Error(invalid_argument) where there is no parameter of this name, or its value is of another type.
    bool flag(const QString& name) const;
    int whole(const QString& name) const;  // the number of a choice too
    float real(const QString& name) const;
    QString text(const QString& name) const;
    QColor colour(const QString& name) const;

    // Throws Error(invalid_argument) where there is no parameter of this name.
    void set(const QString& name, const QVariant& value);

    auto begin() const { return list_.begin(); }
    auto end() const { return list_.end(); }

private:
    const QVariant& value_of(const QString& name, QMetaType::Type type) const;

    std::vector<Parameter> list_;
};

// The decimal number that a float stands for, as it was typed: 0.1f is 0.1.
double decimal_of(float value);

}  // namespace pcm::host
