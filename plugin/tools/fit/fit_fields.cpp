#include "plugin/tools/fit/fit_fields.h"

#include <QCheckBox>
#include <QComboBox>
#include <QGridLayout>
#include <QHBoxLayout>
#include <QLabel>
#include <QLineEdit>
#include <QToolButton>

#include <string>

namespace pcm::host {

namespace {

const char* const any_kind = "any";

void choose(QComboBox& box, const QString& data)
{
    const int found = box.findData(data);
    if (found >= 0) box.setCurrentIndex(found);
}

}  // namespace

FitFields::FitFields()
{
    rows_ = new QGridLayout(this);
    rows_->setContentsMargins(0, 0, 0, 0);
    rows_->setColumnStretch(1, 1);
    add_choices();
    show(kept_fit_settings());
    connect(more_, &QToolButton::toggled, this, &FitFields::show_more);
    bool used = backend_->currentIndex() > 0;
    for (std::size_t i = 0; i < numbers_.size(); ++i)
        used = used || (!fit_numbers()[i].is_basic && !numbers_[i]->text().isEmpty());
    more_->setChecked(used);
    show_more(used);
}

void FitFields::add(const ops::Argument& argument, QWidget* field, bool is_basic)
{
    const QString tooltip = tooltip_of(argument);
    const int row = rows_->rowCount();
    field->setToolTip(tooltip);
    auto* words = new QLabel(QString::fromStdString(argument.label()));
    words->setToolTip(tooltip);
    rows_->addWidget(words, row, 0);
    rows_->addWidget(field, row, 1);
    if (is_basic) return;
    advanced_.push_back(words);
    advanced_.push_back(field);
}

QComboBox* FitFields::add_choice(const char* name, const char* argument, bool is_basic)
{
    auto* box = new QComboBox;
    box->setObjectName(QString("PointCloudFit") + name);
    box->setSizeAdjustPolicy(QComboBox::AdjustToMinimumContentsLengthWithIcon);
    for (const ops::Choice& choice : fit_argument(argument).choices())
        box->addItem(QString::fromStdString(choice.label), QString::fromStdString(choice.name));
    connect(box, QOverload<int>::of(&QComboBox::currentIndexChanged), this, &FitFields::report);
    add(fit_argument(argument), box, is_basic);
    return box;
}

void FitFields::add_number(const FitNumber& row)
{
    auto* edit = new QLineEdit;
    const ops::Argument& argument = fit_argument(row.argument);
    edit->setObjectName(QString("PointCloudFit") + QString::fromStdString(row.key));
    edit->setPlaceholderText(QString::fromStdString(argument.is_automatic() ? "automatic"
                                                    : argument.without().empty() ? argument.default_text()
                                                                                 : argument.without()));
    // Also when the field loses the focus: only what has changed counts.
    connect(edit, &QLineEdit::editingFinished, this, [this, edit] {
        if (edit->property("kept") != edit->text()) report();
    });
    numbers_.push_back(edit);
    if (!row.argument_by_radius) return add(argument, edit, row.is_basic);
    size_ = new QComboBox;
    size_->setObjectName("PointCloudFitNeighbourhoodKind");
    size_->addItems({"points", "radius"});
    connect(size_, QOverload<int>::of(&QComboBox::currentIndexChanged), this, &FitFields::report);
    auto* both = new QWidget;
    auto* beside = new QHBoxLayout(both);
    beside->setContentsMargins(0, 0, 0, 0);
    beside->addWidget(edit, 1);
    beside->addWidget(size_);
    add(argument, both, row.is_basic);
}

void FitFields::add_choices()
{
    kind_ = add_choice("Shape", "shape");
    estimator_ = add_choice("Estimator", "estimator");
    for (int i = 0; i < estimator_->count(); ++i)
        estimator_->setItemData(i, estimators()[static_cast<std::size_t>(i)].description, Qt::ToolTipRole);
    for (const FitNumber& row : fit_numbers())
        if (row.is_basic) add_number(row);
    grow_ = new QCheckBox;
    grow_->setObjectName("PointCloudFitGrow");
    connect(grow_, &QCheckBox::toggled, this, &FitFields::report);
    add(fit_argument("grow"), grow_);
    outline_ = add_choice("Outline", "outline");
    more_ = new QToolButton;
    more_->setText("More options");
    more_->setCheckable(true);
    more_->setToolButtonStyle(Qt::ToolButtonTextBesideIcon);
    more_->setAutoRaise(true);
    rows_->addWidget(more_, rows_->rowCount(), 0, 1, 2);
    for (const FitNumber& row : fit_numbers())
        if (!row.is_basic) add_number(row);
    backend_ = add_choice("Backend", "backend", false);
    if (!why_no_pcl().empty()) backend_->removeItem(backend_->findData("pcl"));
}

void FitFields::show(const FitSettings& settings)
{
    choose(*kind_, settings.kind ? traits_of(*settings.kind).name : any_kind);
    choose(*estimator_, traits_of(settings.estimator).name);
    choose(*outline_, name_of(settings.outline));
    choose(*backend_, settings.backend == FitBackend::pcl ? "pcl" : "own");
    size_->setCurrentIndex(settings.by_radius ? 1 : 0);
    grow_->setChecked(settings.grow);
    for (std::size_t i = 0; i < numbers_.size() && i < settings.numbers.size(); ++i) {
        numbers_[i]->setText(settings.numbers[i]);
        numbers_[i]->setProperty("kept", settings.numbers[i]);
    }
    showing_ = false;
}

void FitFields::show_defaults()
{
    showing_ = true;
    FitSettings usual;
    usual.numbers.resize(fit_numbers().size());
    show(usual);
    report();
}

FitSettings FitFields::settings() const
{
    FitSettings settings;
    settings.kind = shape_kind(kind_->currentData().toString().toStdString());
    settings.estimator = estimator_of(estimator_->currentData().toString().toStdString()).value_or(settings.estimator);
    settings.outline = outline_kind(outline_->currentData().toString().toStdString()).value_or(settings.outline);
    settings.backend = backend_->currentData().toString() == "pcl" ? FitBackend::pcl : FitBackend::own;
    settings.by_radius = size_->currentIndex() == 1;
    settings.grow = grow_->isChecked();
    for (const QLineEdit* number : numbers_) settings.numbers.push_back(number->text().trimmed());
    return settings;
}

void FitFields::show_more(bool on)
{
    more_->setArrowType(on ? Qt::DownArrow : Qt::RightArrow);
    for (QWidget* widget : advanced_) widget->setVisible(on);
}

void FitFields::report()
{
    if (showing_) return;
    for (QLineEdit* number : numbers_) number->setProperty("kept", number->text());
    keep(settings());
    emit changed();
}

}  // namespace pcm::host
