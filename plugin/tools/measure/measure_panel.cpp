#include "plugin/tools/measure/measure_panel.h"

#include "pcm/system/error.h"
#include "pcm/system/text.h"
#include "plugin/panels/message_area.h"
#include "plugin/panels/named_list.h"
#include "plugin/panels/tool_dock.h"
#include "plugin/scene/measure_text.h"
#include "plugin/scene/project_unit.h"
#include "plugin/scene/text.h"
#include "plugin/scene/tidy_numbers.h"
#include "plugin/tools/measure/draft.h"

#include <QComboBox>
#include <QGridLayout>
#include <QLabel>
#include <QLineEdit>
#include <QLocale>
#include <QProgressBar>
#include <QPushButton>
#include <QSignalBlocker>
#include <QVBoxLayout>

#include <cmath>

namespace pcm::host {

namespace {

constexpr MeasureKind kinds[] = {MeasureKind::distance, MeasureKind::height, MeasureKind::angle,   MeasureKind::area,
                                 MeasureKind::plane,    MeasureKind::point,  MeasureKind::profile, MeasureKind::volume};
constexpr int progress_steps = 1000;
constexpr int hint_lines = 4, message_lines = 4;

std::optional<double> number_in(const QLineEdit& field, const char* label, bool above_zero)
{
    const QString text = field.text().trimmed();
    if (text.isEmpty()) return std::nullopt;
    bool is_number = false;
    const double value = QLocale::c().toDouble(text, &is_number);
    if (!is_number || !std::isfinite(value) || (above_zero && !(value > 0)))
        throw Error(
            ErrorCode::invalid_argument, {},
            std::string(label) + ": '" + text.toStdString() + "' is not a number" + (above_zero ? " above 0" : ""));
    return value;
}

}  // namespace

MeasurePanel::MeasurePanel(QWidget* window) : QDockWidget("Measure", window)
{
    setObjectName("PointCloudMeasureDock");
    auto* form = new QWidget;
    auto* column = new QVBoxLayout(form);
    add_fields(*column);
    add_list(*column);
    words_ = new MessageArea("PointCloudMeasureMessage", message_lines);
    column->addWidget(words_);
    fill_dock(*this, form);
    show_fields();
    show_values(nullptr, {});
}

QLineEdit* MeasurePanel::add_field(QGridLayout& rows, const char* name, const char* label, const char* tooltip)
{
    auto* edit = new QLineEdit;
    auto* words = new QLabel(label);
    edit->setObjectName(name);
    edit->setToolTip(tooltip);
    words->setToolTip(tooltip);
    const int row = rows.rowCount();
    rows.addWidget(words, row, 0);
    rows.addWidget(edit, row, 1);
    rows_[edit] = {words, edit};
    return edit;
}

QComboBox* MeasurePanel::add_choice(QGridLayout& rows, const char* name, const char* label, const char* tooltip)
{
    auto* choice = new QComboBox;
    auto* words = new QLabel(label);
    choice->setObjectName(name);
    choice->setToolTip(tooltip);
    choice->setSizeAdjustPolicy(QComboBox::AdjustToMinimumContentsLengthWithIcon);
    words->setToolTip(tooltip);
    const int row = rows.rowCount();
    rows.addWidget(words, row, 0);
    rows.addWidget(choice, row, 1);
    rows_[choice] = {words, choice};
    return choice;
}

void MeasurePanel::add_fields(QVBoxLayout& column)
{
    fields_ = new QWidget;
    auto* rows = new QGridLayout(fields_);
    rows->setContentsMargins(0, 0, 0, 0);
    kind_ = add_choice(*rows, "PointCloudMeasureKind", "Measure",
                       "What the next clicks on points measure. Default Distance.");
    for (const MeasureKind kind : kinds) kind_->addItem(title_of(kind), static_cast<int>(kind));
    connect(kind_, QOverload<int>::of(&QComboBox::currentIndexChanged), this, [this] {
        show_fields();
        emit kind_chosen();
    });
    cloud_ = add_choice(*rows, "PointCloudMeasureCloud", "Cloud",
                        "The layer whose points are in the profile or the volume. Default: the one that the first "
                        "point is clicked on.");
    width_ = add_field(*rows, "PointCloudMeasureWidth", "Width",
                       "The width of the profile across its line, half of it on each side, in source units. Default: "
                       "from the spacing of the points at the line and from its length, a round number.");
    compared_ = add_choice(*rows, "PointCloudMeasureCompared", "Against",
                           "What the volume is measured against: a level, or the points of another layer. Default: a "
                           "level.");
    level_ = add_field(*rows, "PointCloudMeasureLevel", "Level",
                       "The height that the volume is measured against, in source units. Default: that of the lowest "
                       "point of the polygon.");
    cell_ = add_field(*rows, "PointCloudMeasureCell", "Cell",
                      "The side of the cells whose heights are compared, in source units. Default: so that cells that "
                      "have points have about 9, as for the filter and the command; the values show it.");
    unit_ =
        add_choice(*rows, "PointCloudMeasureUnit", "Unit",
                   "What one unit of the coordinates is, where the clouds do not state it. It is kept in the project, "
                   "and also stands in drawings of primitives; numbers are never converted. Default: not known.");
    for (const UnitChoice& choice : unit_choices) unit_->addItem(choice.words, choice.symbol);
    connect(unit_, QOverload<int>::of(&QComboBox::activated), this,
            [this] { emit unit_chosen(unit_->currentData().toString()); });
    column.addWidget(fields_);
    hint_ = new MessageArea("PointCloudMeasureHint", hint_lines);
    column.addWidget(hint_);
    auto* buttons = new QGridLayout;
    add_button(*buttons, 0, 0, Button::end, "End measure",
               "Ends the line or polygon. Enter, a double click or the right button in the view.");
    add_button(*buttons, 0, 2, Button::cancel, "Cancel",
               "Discards the points clicked so far, or stops what runs. Esc.");
    add_button(*buttons, 0, 4, Button::defaults, "Panel defaults",
               "Empties the fields above, which then have their default values; the list stays.");
    column.addLayout(buttons);
    progress_ = new QProgressBar;
    progress_->setObjectName("PointCloudMeasureProgress");
    progress_->setRange(0, progress_steps);
    keep_place(*progress_);
    progress_->hide();
    column.addWidget(progress_);
}

void MeasurePanel::add_list(QVBoxLayout& column)
{
    list_ = new NamedList("PointCloudMeasureList", {"Name", "Value"});
    list_->setToolTip(
        "The measures of the project. The tick shows a measure in views; a double click on a name "
        "changes it.");
    connect(list_, &NamedList::renamed, this, &MeasurePanel::renamed);
    connect(list_, &NamedList::hidden, this, &MeasurePanel::hidden);
    connect(list_, &NamedList::chosen, this, &MeasurePanel::selected);
    column.addWidget(list_, 3);
    auto* buttons = new QGridLayout;
    buttons->setHorizontalSpacing(4);
    add_button(*buttons, 0, 0, Button::look_at, "Jump to", "The camera looks at the selected measure.");
    add_button(
        *buttons, 0, 2, Button::plot, "Compute",
        "Plots the points of the selected profile in a window, or finds the selected volume again, with Against, "
        "Level and Cell as they are now.");
    add_button(*buttons, 0, 4, Button::copy, "Copy",
               "Copies the selected measure, or all of them, as text. Ctrl+C in the view.");
    add_button(*buttons, 1, 0, Button::undo, "Undo", "Takes the last change of the list back. Ctrl+Z in the view.");
    add_button(*buttons, 1, 2, Button::redo, "Redo", "Repeats what was undone. Ctrl+Shift+Z in the view.");
    add_button(*buttons, 1, 4, Button::clear, "Delete all", "Deletes all measures; Undo brings them back.");
    constexpr int half = 3;  // half of the columns
    add_button(*buttons, 2, 0, Button::remove, "Delete measure", "Deletes the selected measure; Undo brings it back.",
               half);
    add_button(*buttons, 2, half, Button::save, "Export measures",
               "Writes all measures to a file, in source coordinates: CSV, GeoJSON, DXF, or JSON, which the command "
               "pcmlab measure reads.",
               half);
    column.addLayout(buttons);
    values_ = new ValueTable("PointCloudMeasureValues", "Selected measure");
    values_->setToolTip(
        "All numbers of the selected measure, with their standard deviations. Angles are in degrees, "
        "others in the unit of the coordinates.");
    column.addWidget(values_, 3);
}

QPushButton* MeasurePanel::add_button(QGridLayout& rows, int row, int column, Button button, const char* text,
                                      const char* tooltip, int span)
{
    auto* widget = buttons_[button] = new QPushButton(text);
    widget->setToolTip(tooltip);
    widget->setFocusPolicy(Qt::NoFocus);  // Enter and Esc stay the view's
    connect(widget, &QPushButton::clicked, this, [this, button] { emit pressed(button); });
    widget->setMinimumWidth(40);
    rows.addWidget(widget, row, column, 1, span);
    return widget;
}

MeasureKind MeasurePanel::kind() const { return static_cast<MeasureKind>(kind_->currentData().toInt()); }

void MeasurePanel::show_fields()
{
    const bool profile = kind() == MeasureKind::profile, volume = kind() == MeasureKind::volume;
    const std::map<QWidget*, bool> shown{
        {cloud_, profile || volume}, {width_, profile}, {compared_, volume}, {level_, volume}, {cell_, volume}};
    for (const auto& [field, is_shown] : shown)
        for (QWidget* part : rows_[field]) part->setVisible(is_shown);
}

void MeasurePanel::show_list(const MeasureList& list, std::optional<std::size_t> selected, const std::string& unit)
{
    std::vector<NamedList::Row> rows;
    for (std::size_t i = 0; i < list.size(); ++i)
        rows.push_back({list[i].name, list[i].hidden, {value_of(list[i], unit)}});
    list_->show_rows(rows, selected);
    const bool some = selected.has_value();
    buttons_[Button::look_at]->setEnabled(some);
    buttons_[Button::remove]->setEnabled(some);
    buttons_[Button::plot]->setEnabled(
        some && (list[*selected].kind == MeasureKind::profile || list[*selected].kind == MeasureKind::volume));
    buttons_[Button::clear]->setEnabled(!list.empty());
    buttons_[Button::copy]->setEnabled(!list.empty());
    buttons_[Button::save]->setEnabled(!list.empty());
    buttons_[Button::undo]->setEnabled(list.can_undo());
    buttons_[Button::redo]->setEnabled(list.can_redo());
    show_values(some ? &list[*selected] : nullptr, unit);
}

void MeasurePanel::show_values(const Measure* measure, const std::string& unit)
{
    std::vector<std::pair<QString, QString>> lines;
    if (measure) {
        try {
            for (const MeasureValue& value : values_of(*measure))
                lines.emplace_back(QString::fromStdString(value.name), QString::fromStdString(text_of(value, unit)));
        } catch (...) {
            lines.emplace_back("no value", QString::fromStdString(current_error()));
        }
        if (measure->width > 0)
            lines.emplace_back("width", decimal_text(measure->width, measure->points.front().grid_step / 10) + " " +
                                            QString::fromStdString(unit));
        for (std::size_t i = 0; i < measure->points.size(); ++i)
            lines.emplace_back(QString("point %1").arg(i + 1), coordinates_of(measure->points[i]));
    }
    values_->show_values(lines);
}

void MeasurePanel::show_unit(const LengthUnit& unit)
{
    for (QWidget* part : rows_[unit_]) part->setVisible(!unit.is_stated);
    const QSignalBlocker silent(unit_);
    unit_->setCurrentIndex(std::max(0, unit_->findData(QString::fromStdString(unit.symbol))));
}

void MeasurePanel::show_clouds(const std::vector<Cloud>& clouds)
{
    for (QComboBox* choice : {cloud_, compared_}) {
        const QSignalBlocker silent(choice);
        const QVariant before = choice->currentData();
        choice->clear();
        choice->addItem(choice == cloud_ ? "of the first point" : "a level", -1);
        for (const Cloud& cloud : clouds) choice->addItem(cloud.label, cloud.layer_id);
        choice->setCurrentIndex(std::max(0, choice->findData(before.isValid() ? before : QVariant(-1))));
    }
}

void MeasurePanel::show_hint(const QString& text) { hint_->say(text); }

void MeasurePanel::say(const QString& text) { words_->say(text); }

void MeasurePanel::show_progress(const std::optional<std::pair<QString, double>>& progress)
{
    progress_->setVisible(progress.has_value());
    if (!progress) return;
    progress_->setFormat(progress->first + " %p%");
    progress_->setValue(static_cast<int>(progress->second * progress_steps));
}

std::optional<double> MeasurePanel::width() const { return number_in(*width_, "Width", true); }

std::optional<double> MeasurePanel::level() const { return number_in(*level_, "Level", false); }

std::optional<double> MeasurePanel::cell() const { return number_in(*cell_, "Cell", true); }

void MeasurePanel::propose_width(const QString& text) { width_->setPlaceholderText(text); }

void MeasurePanel::show_defaults()
{
    for (QComboBox* choice : {cloud_, compared_}) choice->setCurrentIndex(0);
    for (QLineEdit* field : {width_, level_, cell_}) field->clear();
}

void MeasurePanel::propose_cell(const QString& text) { cell_->setPlaceholderText(text); }

std::optional<int> MeasurePanel::cloud() const
{
    const int id = cloud_->currentData().toInt();
    return id < 0 ? std::nullopt : std::optional<int>(id);
}

std::optional<int> MeasurePanel::compared_cloud() const
{
    const int id = compared_->currentData().toInt();
    return id < 0 ? std::nullopt : std::optional<int>(id);
}

}  // namespace pcm::host
