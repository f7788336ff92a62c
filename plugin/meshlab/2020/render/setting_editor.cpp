#include "plugin/meshlab/2020/render/setting_editor.h"

#include <QCheckBox>
#include <QColorDialog>
#include <QComboBox>
#include <QDoubleSpinBox>
#include <QGridLayout>
#include <QLabel>
#include <QLineEdit>
#include <QLocale>
#include <QPushButton>
#include <QSpinBox>

namespace pcm::host {

namespace {

constexpr int least_width_px = 110;  // pixels

using OnChange = std::function<void(const QString& name, const Value& value)>;

void add_row(QGridLayout& rows, const RichParameter& setting, QWidget* label, QWidget* widget)
{
    const int row = rows.rowCount();
    for (QWidget* part : {label, widget}) {
        part->setToolTip(setting.toolTip());
        part->setWhatsThis(setting.toolTip());
    }
    widget->setObjectName(setting.name());
    // As wide as the panel leaves it: a box for numbers would be as wide as its largest one.
    widget->setSizePolicy(QSizePolicy::Ignored, QSizePolicy::Fixed);
    widget->setMinimumWidth(least_width_px);
    rows.addWidget(label, row, 0);
    rows.addWidget(widget, row, 1);
}

class Choice : public SettingEditor {
public:
    Choice(QGridLayout& rows, const RichEnum& setting, OnChange changed)
        : SettingEditor(setting.name(), std::move(changed)), box_(new QComboBox)
    {
        box_->addItems(setting.enumvalues);
        box_->setSizeAdjustPolicy(QComboBox::AdjustToMinimumContentsLengthWithIcon);
        box_->setMinimumContentsLength(12);
        add_row(rows, setting, new QLabel(setting.fieldDescription()), box_);
        QObject::connect(box_, QOverload<int>::of(&QComboBox::currentIndexChanged),
                         [this](int index) { change(EnumValue(index)); });
    }
    void set(const Value& value) override { box_->setCurrentIndex(value.getEnum()); }

private:
    QComboBox* box_;
};

class Switch : public SettingEditor {
public:
    Switch(QGridLayout& rows, const RichParameter& setting, OnChange changed)
        : SettingEditor(setting.name(), std::move(changed)), box_(new QCheckBox)
    {
        add_row(rows, setting, new QLabel(setting.fieldDescription()), box_);
        QObject::connect(box_, &QCheckBox::toggled, [this](bool on) { change(BoolValue(on)); });
    }
    void set(const Value& value) override { box_->setChecked(value.getBool()); }

private:
    QCheckBox* box_;
};

class WholeNumber : public SettingEditor {
public:
    WholeNumber(QGridLayout& rows, const RichParameter& setting, OnChange changed)
        : SettingEditor(setting.name(), std::move(changed)), box_(new QSpinBox)
    {
        box_->setRange(0, 1 << 24);
        box_->setStepType(QAbstractSpinBox::AdaptiveDecimalStepType);
        box_->setKeyboardTracking(false);
        add_row(rows, setting, new QLabel(setting.fieldDescription()), box_);
        QObject::connect(box_, QOverload<int>::of(&QSpinBox::valueChanged),
                         [this](int number) { change(IntValue(number)); });
    }
    void set(const Value& value) override { box_->setValue(value.getInt()); }

private:
    QSpinBox* box_;
};

// Without zeros at the end.
class NumberBox : public QDoubleSpinBox {
public:
    QString textFromValue(double value) const override { return locale().toString(value, 'g', 9); }
};

QDoubleSpinBox* number_box()
{
    auto* box = new NumberBox;
    QLocale plain = box->locale();
    plain.setNumberOptions(QLocale::OmitGroupSeparator);
    box->setLocale(plain);
    box->setRange(-1e9, 1e9);
    box->setDecimals(3);
    box->setStepType(QAbstractSpinBox::AdaptiveDecimalStepType);
    box->setKeyboardTracking(false);
    return box;
}

class Number : public SettingEditor {
public:
    Number(QGridLayout& rows, const RichParameter& setting, OnChange changed)
        : SettingEditor(setting.name(), std::move(changed)), box_(number_box())
    {
        add_row(rows, setting, new QLabel(setting.fieldDescription()), box_);
        QObject::connect(box_, QOverload<double>::of(&QDoubleSpinBox::valueChanged),
                         [this](double number) { change(FloatValue(static_cast<float>(number))); });
    }
    void set(const Value& value) override { box_->setValue(static_cast<double>(value.getFloat())); }

private:
    QDoubleSpinBox* box_;
};

// A number that can be switched off with one click, and on again with the number that it had.
class SwitchedNumber : public SettingEditor {
public:
    SwitchedNumber(QGridLayout& rows, const RichParameter& setting, OnChange changed)
        : SettingEditor(setting.name(), std::move(changed)),
          on_(new QCheckBox(setting.fieldDescription())),
          box_(number_box())
    {
        const auto usual = static_cast<double>(setting.value().getFloat());
        box_->setMinimum(0.001);
        box_->setValue(usual > 0 ? usual : 1);
        box_->setEnabled(false);
        add_row(rows, setting, on_, box_);
        on_->setObjectName(setting.name() + "On");
        QObject::connect(on_, &QCheckBox::toggled, box_, &QWidget::setEnabled);
        QObject::connect(on_, &QCheckBox::toggled, [this] { change_number(); });
        QObject::connect(box_, QOverload<double>::of(&QDoubleSpinBox::valueChanged), [this] { change_number(); });
    }
    void set(const Value& value) override
    {
        const auto number = static_cast<double>(value.getFloat());
        if (number > 0) box_->setValue(number);
        on_->setChecked(number > 0);
    }

private:
    void change_number() { change(FloatValue(on_->isChecked() ? static_cast<float>(box_->value()) : 0)); }

    QCheckBox* on_;
    QDoubleSpinBox* box_;
};

class Text : public SettingEditor {
public:
    Text(QGridLayout& rows, const RichParameter& setting, OnChange changed)
        : SettingEditor(setting.name(), std::move(changed)), box_(new QLineEdit)
    {
        add_row(rows, setting, new QLabel(setting.fieldDescription()), box_);
        QObject::connect(box_, &QLineEdit::editingFinished, [this] {
            if (box_->isModified()) change(StringValue(box_->text()));
            box_->setModified(false);
        });
    }
    void set(const Value& value) override
    {
        if (box_->text() != value.getString()) box_->setText(value.getString());
    }

private:
    QLineEdit* box_;
};

class Colour : public SettingEditor {
public:
    Colour(QGridLayout& rows, const RichParameter& setting, OnChange changed)
        : SettingEditor(setting.name(), std::move(changed)), button_(new QPushButton)
    {
        add_row(rows, setting, new QLabel(setting.fieldDescription()), button_);
        QObject::connect(button_, &QPushButton::clicked, [this] {
            const QColor chosen = QColorDialog::getColor(colour_, button_);
            if (!chosen.isValid()) return;
            show(ColorValue(chosen));
            change(ColorValue(chosen));
        });
    }
    void set(const Value& value) override
    {
        colour_ = value.getColor();
        QPixmap sample(32, 12);
        sample.fill(colour_);
        button_->setIcon(sample);
        button_->setIconSize(sample.size());
        button_->setText(colour_.name());
    }

private:
    QPushButton* button_;
    QColor colour_;
};

}  // namespace

std::unique_ptr<SettingEditor> add_setting_editor(QGridLayout& rows, const RichParameter& setting, bool off_at_zero,
                                                  OnChange changed)
{
    const Value& value = setting.value();
    // A choice is a whole number too.
    if (value.isEnum())
        return std::make_unique<Choice>(rows, static_cast<const RichEnum&>(setting), std::move(changed));
    if (value.isBool()) return std::make_unique<Switch>(rows, setting, std::move(changed));
    if (value.isInt()) return std::make_unique<WholeNumber>(rows, setting, std::move(changed));
    if (value.isFloat() && off_at_zero) return std::make_unique<SwitchedNumber>(rows, setting, std::move(changed));
    if (value.isFloat()) return std::make_unique<Number>(rows, setting, std::move(changed));
    if (value.isColor()) return std::make_unique<Colour>(rows, setting, std::move(changed));
    if (value.isString()) return std::make_unique<Text>(rows, setting, std::move(changed));
    return nullptr;
}

}  // namespace pcm::host
