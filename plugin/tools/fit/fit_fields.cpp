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

void FitFields::add(const char* label, const char* tooltip, QWidget* field, bool is_basic)
{
    const int row = rows_->rowCount();
    field->setToolTip(tooltip);
    auto* words = new QLabel(label);
    words->setToolTip(tooltip);
    rows_->addWidget(words, row, 0);
    rows_->addWidget(field, row, 1);
    if (is_basic) return;
    advanced_.push_back(words);
    advanced_.push_back(field);
}

QComboBox* FitFields::add_choice(const char* name, const char* label, const char* tooltip, bool is_basic)
{
    auto* box = new QComboBox;
    box->setObjectName(QString("PointCloudFit") + name);
    box->setSizeAdjustPolicy(QComboBox::AdjustToMinimumContentsLengthWithIcon);
    connect(box, QOverload<int>::of(&QComboBox::currentIndexChanged), this, &FitFields::report);
    add(label, tooltip, box, is_basic);
    return box;
}

void FitFields::add_number(const FitNumber& row)
{
    auto* edit = new QLineEdit;
    edit->setObjectName(QString("PointCloudFit") + row.key);
    edit->setPlaceholderText(row.usual);
    // Also when the field loses the focus: only what has changed counts.
    connect(edit, &QLineEdit::editingFinished, this, [this, edit] {
        if (edit->property("kept") != edit->text()) report();
    });
    numbers_.push_back(edit);
    if (std::string(row.key) != "Neighbourhood") return add(row.label, row.tooltip, edit, row.is_basic);
    size_ = new QComboBox;
    size_->setObjectName("PointCloudFitNeighbourhoodKind");
    size_->addItems({"points", "radius"});
    connect(size_, QOverload<int>::of(&QComboBox::currentIndexChanged), this, &FitFields::report);
    auto* both = new QWidget;
    auto* beside = new QHBoxLayout(both);
    beside->setContentsMargins(0, 0, 0, 0);
    beside->addWidget(edit, 1);
    beside->addWidget(size_);
    add(row.label, row.tooltip, both, row.is_basic);
}

void FitFields::add_choices()
{
    kind_ = add_choice("Shape", "Shape",
                       "What is fitted at the clicked place. Any: all kinds are fitted, and the one that explains the "
                       "points best, with the fewest parameters, is kept. Default Any.");
    kind_->addItem("Any", any_kind);
    for (const ShapeTraits& traits : shape_kinds()) kind_->addItem(traits.label, traits.name);
    estimator_ = add_choice("Estimator", "Estimator",
                            "How random samples of points are drawn and scored, where some of the points belong to "
                            "something else. MSAC suits nearly all scans. Default MSAC.");
    for (const EstimatorTraits& traits : estimators()) {
        estimator_->addItem(traits.label, traits.name);
        estimator_->setItemData(estimator_->count() - 1, traits.description, Qt::ToolTipRole);
    }
    for (const FitNumber& row : fit_numbers())
        if (row.is_basic) add_number(row);
    grow_ = new QCheckBox("through the cloud");
    grow_->setObjectName("PointCloudFitGrow");
    connect(grow_, &QCheckBox::toggled, this, &FitFields::report);
    add("Follow",
        "On: all connected points of the whole cloud that lie on the surface belong to it, and it is fitted to them "
        "again. Off: only those around the clicked places. Default on.",
        grow_);
    outline_ = add_choice("Outline", "Outline",
                          "How a plane is bounded, and what its area is of: the rectangle of least area around its "
                          "points, their convex hull, a concave outline that follows their edge and gaps, or the "
                          "polygon in which the cloud's box cuts it. Cylinders and cones end where their points end, "
                          "or at the cloud's box. Default Concave.");
    outline_->addItem("Rectangle", name_of(OutlineKind::rectangle));
    outline_->addItem("Convex", name_of(OutlineKind::convex));
    outline_->addItem("Concave", name_of(OutlineKind::concave));
    outline_->addItem("Cloud's box", name_of(OutlineKind::box));
    more_ = new QToolButton;
    more_->setText("More options");
    more_->setCheckable(true);
    more_->setToolButtonStyle(Qt::ToolButtonTextBesideIcon);
    more_->setAutoRaise(true);
    rows_->addWidget(more_, rows_->rowCount(), 0, 1, 2);
    for (const FitNumber& row : fit_numbers())
        if (!row.is_basic) add_number(row);
    backend_ =
        add_choice("Backend", "Computed by",
                   "This program's own search, or the Point Cloud Library's, for comparison, where its module is "
                   "installed. Default: own.",
                   false);
    backend_->addItem("own", "own");
    if (why_no_pcl().empty()) backend_->addItem("PCL", "pcl");
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
