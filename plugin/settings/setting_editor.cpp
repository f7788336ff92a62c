#include "plugin/settings/setting_editor.h"

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

using OnChange = std::function<void(const QString& name, const QVariant& value)>;

void add_row(QGridLayout& rows, const Parameter& setting, QWidget* label, QWidget* widget)
{
    const int row = rows.rowCount();
    for (QWidget* part : {label, widget}) {
        part->setToolTip(setting.help);
        part->setWhatsThis(setting.help);
    }
    widget->setObjectName(setting.name);
    // As wide as the panel leaves it: a box for numbers would be as wide as its largest one.
    widget->setSizePolicy(QSizePolicy::Ignored, QSizePolicy::Fixed);
    widget->setMinimumWidth(least_width_px);
    rows.addWidget(label, row, 0);
    rows.addWidget(widget, row, 1);
}

class Choice : public SettingEditor {
public:
    Choice(QGridLayout& rows, const Parameter& setting, OnChange changed)
        : SettingEditor(setting.name, std::move(changed)), box_(new QComboBox)
    {
        box_->addItems(setting.choices);
        box_->setSizeAdjustPolicy(QComboBox::AdjustToMinimumContentsLengthWithIcon);
        box_->setMinimumContentsLength(12);
        add_row(rows, setting, new QLabel(setting.label), box_);
        QObject::connect(box_, QOverload<int>::of(&QComboBox::currentIndexChanged),
                         [this](int index) { change(index); });
    }
    void set(const QVariant& value) override { box_->setCurrentIndex(value.toInt()); }

private:
    QComboBox* box_;
};

class Switch : public SettingEditor {
public:
    Switch(QGridLayout& rows, const Parameter& setting, OnChange changed)
        : SettingEditor(setting.name, std::move(changed)), box_(new QCheckBox)
    {
        add_row(rows, setting, new QLabel(setting.label), box_);
        QObject::connect(box_, &QCheckBox::toggled, [this](bool on) { change(on); });
    }
    void set(const QVariant& value) override { box_->setChecked(value.toBool()); }

private:
    QCheckBox* box_;
};

class WholeNumber : public SettingEditor {
public:
    WholeNumber(QGridLayout& rows, const Parameter& setting, OnChange changed)
        : SettingEditor(setting.name, std::move(changed)), box_(new QSpinBox)
    {
        box_->setRange(0, 1 << 24);
        box_->setStepType(QAbstractSpinBox::AdaptiveDecimalStepType);
        box_->setKeyboardTracking(false);
        add_row(rows, setting, new QLabel(setting.label), box_);
        QObject::connect(box_, QOverload<int>::of(&QSpinBox::valueChanged), [this](int number) { change(number); });
    }
    void set(const QVariant& value) override { box_->setValue(value.toInt()); }

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
    Number(QGridLayout& rows, const Parameter& setting, OnChange changed)
        : SettingEditor(setting.name, std::move(changed)), box_(number_box())
    {
        add_row(rows, setting, new QLabel(setting.label), box_);
        QObject::connect(box_, QOverload<double>::of(&QDoubleSpinBox::valueChanged),
                         [this](double number) { change(static_cast<float>(number)); });
    }
    void set(const QVariant& value) override { box_->setValue(value.toDouble()); }

private:
    QDoubleSpinBox* box_;
};

// A number that can be switched off with one click, and on again with the number that it had.
class SwitchedNumber : public SettingEditor {
public:
    SwitchedNumber(QGridLayout& rows, const Parameter& setting, OnChange changed)
        : SettingEditor(setting.name, std::move(changed)), on_(new QCheckBox(setting.label)), box_(number_box())
    {
        const auto usual = setting.value.toDouble();
        box_->setMinimum(0.001);
        box_->setValue(usual > 0 ? usual : 1);
        box_->setEnabled(false);
        add_row(rows, setting, on_, box_);
        on_->setObjectName(setting.name + "On");
        QObject::connect(on_, &QCheckBox::toggled, box_, &QWidget::setEnabled);
        QObject::connect(on_, &QCheckBox::toggled, [this] { change_number(); });
        QObject::connect(box_, QOverload<double>::of(&QDoubleSpinBox::valueChanged), [this] { change_number(); });
    }
    void set(const QVariant& value) override
    {
        const auto number = value.toDouble();
        if (number > 0) box_->setValue(number);
        on_->setChecked(number > 0);
    }

private:
    void change_number() { change(on_->isChecked() ? static_cast<float>(box_->value()) : 0.0f); }

    QCheckBox* on_;
    QDoubleSpinBox* box_;
};

class Text : public SettingEditor {
public:
    Text(QGridLayout& rows, const Parameter& setting, OnChange changed)
        : SettingEditor(setting.name, std::move(changed)), box_(new QLineEdit)
    {
        add_row(rows, setting, new QLabel(setting.label), box_);
        QObject::connect(box_, &QLineEdit::editingFinished, [this] {
            if (box_->isModified()) change(box_->text());
            box_->setModified(false);
        });
    }
    void set(const QVariant& value) override
    {
        if (box_->text() != value.toString()) box_->setText(value.toString());
    }

private:
    QLineEdit* box_;
};

class Colour : public SettingEditor {
public:
    Colour(QGridLayout& rows, const Parameter& setting, OnChange changed)
        : SettingEditor(setting.name, std::move(changed)), button_(new QPushButton)
    {
        add_row(rows, setting, new QLabel(setting.label), button_);
        QObject::connect(button_, &QPushButton::clicked, [this] {
            const QColor chosen = QColorDialog::getColor(colour_, button_);
            if (!chosen.isValid()) return;
            show(chosen);
            change(chosen);
        });
    }
    void set(const QVariant& value) override
    {
        colour_ = value.value<QColor>();
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

std::unique_ptr<SettingEditor> add_setting_editor(QGridLayout& rows, const Parameter& setting, bool off_at_zero,
                                                  OnChange changed)
{
    if (!setting.choices.isEmpty()) return std::make_unique<Choice>(rows, setting, std::move(changed));
    switch (setting.value.userType()) {
        case QMetaType::Bool:
            return std::make_unique<Switch>(rows, setting, std::move(changed));
        case QMetaType::Int:
            return std::make_unique<WholeNumber>(rows, setting, std::move(changed));
        case QMetaType::Float:
            if (off_at_zero) return std::make_unique<SwitchedNumber>(rows, setting, std::move(changed));
            return std::make_unique<Number>(rows, setting, std::move(changed));
        case QMetaType::QColor:
            return std::make_unique<Colour>(rows, setting, std::move(changed));
        default:
            return std::make_unique<Text>(rows, setting, std::move(changed));
    }
}

}  // namespace pcm::host
